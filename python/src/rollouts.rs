//! Many short runs in one call, on all threads: from states and commands, or under the drive of the
//! scenario with several seeds.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use cohaul::backend::{BackendOptions, Status};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::ObstaclePose;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};
use cohaul::stop::Stop;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::options::{Asked, read};
use crate::scene::Scene;
use crate::seen::{Pushes, force_of_each};
use crate::state::{State, n_numbers};
use crate::trace::Column;
use crate::work::{computed, internal, pool};

/// Sizes of a call.
#[derive(Clone, Copy)]
struct Sizes {
    n_rollouts: usize,
    n_periods: usize,
    n_springs: usize,
    n_obstacles: usize,
    /// Length of a state as numbers.
    n_numbers: usize,
}

/// Bytes of a number in the memory of an array.
type Bytes = [u8; size_of::<f64>()];

/// What is commanded, in the order of memory.
struct Commands<'a> {
    /// A state for each rollout.
    states: &'a [Bytes],
    /// x and y of each tip at the end of each control period of each rollout (m, world); NaN
    /// releases it.
    tips: &'a [Bytes],
    /// Obstacles that are steered, and x, y and heading of each at the end of each control period.
    steered: Vec<usize>,
    pushers: &'a [Bytes],
    period: f64,
}

/// What rollouts show: poses and twists from their start on, and what each control period ends
/// with.
struct Shown<T> {
    poses: T,
    twists: T,
    pulls: T,
    forces: T,
    statuses: T,
    last: T,
}

/// Results of all rollouts, one after the other.
#[pyclass(frozen, module = "cohaul._native")]
pub struct RolloutData {
    sizes: Sizes,
    shown: Shown<Arc<Vec<f64>>>,
}

impl<T> Shown<T> {
    fn map<'a, U>(&'a mut self, mut of: impl FnMut(&'a mut T) -> U) -> Shown<U> {
        let Self { poses, twists, pulls, forces, statuses, last } = self;
        Shown { poses: of(poses), twists: of(twists), pulls: of(pulls), forces: of(forces), statuses: of(statuses), last: of(last) }
    }
}

impl Shown<Vec<f64>> {
    /// Zeros, whose memory is first touched by the threads that write into it.
    fn new(sizes: &Sizes) -> Self {
        let Sizes { n_rollouts, n_periods, n_springs, n_obstacles, n_numbers } = *sizes;
        let zeros = |n: usize| vec![0.0; n * n_rollouts];
        Self {
            poses: zeros(3 * (n_periods + 1)),
            twists: zeros(3 * (n_periods + 1)),
            pulls: zeros(2 * n_periods * n_springs),
            forces: zeros(2 * n_periods * n_obstacles),
            statuses: zeros(n_periods),
            last: zeros(n_numbers),
        }
    }

    /// The part of each of so many rollouts.
    fn each(&mut self, n_rollouts: usize) -> Vec<Shown<&mut [f64]>> {
        let mut left = self.map(Vec::as_mut_slice);
        let of = |n_left: usize| {
            left.map(|left| {
                let width = left.len() / n_left;
                let (now, later) = std::mem::take(left).split_at_mut(width);
                *left = later;
                now
            })
        };
        (1..=n_rollouts).rev().map(of).collect()
    }
}

impl Shown<&mut [f64]> {
    fn show_motion(&mut self, at: usize, pose: &Pose, twist: &Twist) {
        self.poses.as_chunks_mut().0[at] = [pose.position.x, pose.position.y, pose.heading];
        self.twists.as_chunks_mut().0[at] = [twist.linear.x, twist.linear.y, twist.angular];
    }

    fn show_end(&mut self, period: usize, pulls: impl ExactSizeIterator<Item = Vec2>, forces: Vec<Vec2>, status: Status) {
        write(self.pulls, period, pulls);
        write(self.forces, period, forces.into_iter());
        self.statuses[period] = f64::from(status as u8);
    }
}

/// Writes the points of one period into a list of those of all, of which each has as many.
fn write(into: &mut [f64], period: usize, points: impl ExactSizeIterator<Item = Vec2>) {
    let from = period * points.len();
    for (out, point) in into.as_chunks_mut().0[from..].iter_mut().zip(points) {
        *out = [point.x, point.y];
    }
}

impl Commands<'_> {
    /// Runs one rollout.
    ///
    /// # Errors
    /// When its state is none.
    fn rollout(
        &self,
        (scenario, options): (&Scenario, &BackendOptions),
        sizes: &Sizes,
        which: usize,
        shown: &mut Shown<&mut [f64]>,
    ) -> Result<(), String> {
        let Sizes { n_periods, n_springs, n_obstacles, n_numbers, .. } = *sizes;
        let numbers: Vec<f64> = self.states[which * n_numbers..][..n_numbers].iter().copied().map(f64::from_ne_bytes).collect();
        let mut state = State::of_numbers(scenario, options, &format!("states[{which}]"), &numbers)?;
        let motion = state.backend.motion();
        shown.show_motion(0, &motion.pose, &motion.twist);
        let mut pushes = Pushes::default();
        for period in 0..n_periods {
            let at = which * n_periods + period;
            state.targets.clear();
            for (spring, tip) in self.tips[2 * n_springs * at..].as_chunks().0.iter().take(n_springs).enumerate() {
                let [x, y] = tip.map(f64::from_ne_bytes);
                if x.is_nan() && state.tips[spring].is_some() {
                    state.release(spring);
                }
                state.targets.push(Vec2::new(x, y));
            }
            pushes.poses.clear();
            for (obstacle, pose) in self.steered.iter().zip(self.pushers[3 * self.steered.len() * at..].as_chunks().0) {
                let [x, y, heading] = pose.map(f64::from_ne_bytes);
                pushes.poses.push(ObstaclePose { obstacle: *obstacle, pose: Pose::new(x, y, heading) });
            }
            let status = state.advance(scenario, &pushes, self.period).map_err(|error| error.to_string())?;
            let motion = state.backend.motion();
            shown.show_motion(period + 1, &motion.pose, &motion.twist);
            let forces = if n_obstacles == 0 { Vec::new() } else { force_of_each(n_obstacles, &state.backend.side_contacts()) };
            shown.show_end(period, (0..n_springs).map(|spring| state.backend.pull(spring)), forces, status);
        }
        shown.last.copy_from_slice(&state.numbers(scenario));
        Ok(())
    }
}

/// A run of the scenario's own drive with another seed, which may end early.
fn driven(scenario: &Scenario, options: &BackendOptions, sizes: &Sizes, seed: u64, shown: &mut Shown<&mut [f64]>) {
    let duration = sizes.n_periods as f64 * scenario.control_period;
    let scenario = Scenario { seed, duration, ..scenario.clone() };
    let mut run = Simulation::new(&scenario, options, Keep::Trace);
    run.run(|_time| true);
    shown.map(|numbers| numbers.fill(f64::NAN));
    let (trace, outcome) = run.into_results();
    for row in &trace.rows {
        let at = ((row.time / scenario.control_period).round() as usize).min(sizes.n_periods);
        shown.show_motion(at, &row.motion.pose, &row.motion.twist);
        if at > 0 {
            let pull = |spring: usize| row.tips.iter().find(|tip| tip.spring == spring).map_or(Vec2::zeros(), |tip| tip.pull);
            let forces = force_of_each(sizes.n_obstacles, &row.contacts);
            shown.show_end(at - 1, (0..sizes.n_springs).map(pull), forces, outcome.steps.status);
        }
    }
}

/// Runs rollouts from states under commands, which are the memory of arrays. `sizes` are the
/// numbers of rollouts and of control periods.
#[pyfunction]
#[pyo3(signature = (scene, options, states, tips, steered, pushers, sizes, period_s, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn rollouts(
    py: Python,
    scene: &Scene,
    options: &str,
    states: &[u8],
    tips: &[u8],
    steered: Vec<usize>,
    pushers: &[u8],
    sizes: (usize, usize),
    period_s: f64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<RolloutData> {
    let (scenario, sizes) = (Arc::clone(&scene.scenario), sizes_of(&scene.scenario, sizes));
    let options = read::<Asked>(options)?.options(&scenario)?;
    let [states, tips, pushers] = [states, tips, pushers].map(|bytes| bytes.as_chunks().0);
    let commands = Commands { states, tips, steered, pushers, period: period_s };
    let n = sizes.n_rollouts * sizes.n_periods;
    let found = [commands.states.len(), commands.tips.len(), commands.pushers.len()];
    let expected = [sizes.n_rollouts * sizes.n_numbers, 2 * n * sizes.n_springs, 3 * n * commands.steered.len()];
    if found != expected || commands.steered.iter().any(|obstacle| *obstacle >= sizes.n_obstacles) {
        return Err(internal(format!("arrays of {expected:?} numbers, found {found:?}")));
    }
    all(py, sizes, threads, progress, |which, shown| commands.rollout((&scenario, &options), &sizes, which, shown))
}

/// Runs the scenario's own drive with each seed for a number of control periods.
#[pyfunction]
#[pyo3(signature = (scene, options, seeds, n_periods, threads, progress))]
pub fn seeded_rollouts(
    py: Python,
    scene: &Scene,
    options: &str,
    seeds: Vec<u64>,
    n_periods: usize,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<RolloutData> {
    let (scenario, sizes) = (Arc::clone(&scene.scenario), sizes_of(&scene.scenario, (seeds.len(), n_periods)));
    let options = read::<Asked>(options)?.options(&scenario)?;
    all(py, sizes, threads, progress, |which, shown| {
        driven(&scenario, &options, &sizes, seeds[which], shown);
        Ok(())
    })
}

fn sizes_of(scenario: &Scenario, (n_rollouts, n_periods): (usize, usize)) -> Sizes {
    let (n_springs, n_obstacles) = (scenario.system.springs.len(), scenario.system.world.obstacles.len());
    Sizes { n_rollouts, n_periods, n_springs, n_obstacles, n_numbers: n_numbers(scenario) }
}

fn all(
    py: Python,
    sizes: Sizes,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
    one: impl Fn(usize, &mut Shown<&mut [f64]>) -> Result<(), String> + Sync + Send,
) -> PyResult<RolloutData> {
    let threads = pool(threads)?;
    let n_done = AtomicUsize::new(0);
    let mut shown = Shown::new(&sizes);
    let found = computed(py, progress, |watch| {
        let stop = Stop::current();
        let one = |(which, mut shown): (usize, Shown<&mut [f64]>)| {
            let is_on = watch.go_on(n_done.fetch_add(1, Relaxed) as f64 / sizes.n_rollouts as f64);
            is_on.then(|| stop.within(|| one(which, &mut shown)))
        };
        let each = shown.each(sizes.n_rollouts);
        threads.install(|| each.into_par_iter().enumerate().map(one).collect::<Option<Result<(), String>>>())
    })?;
    // Only an interrupt stops it, and that is an exception already.
    found.expect("the rollouts ended").map_err(PyValueError::new_err)?;
    Ok(RolloutData { sizes, shown: shown.map(|numbers| Arc::new(std::mem::take(numbers))) })
}

/// Numbers of one kind.
type Of = fn(&Shown<Arc<Vec<f64>>>) -> &Arc<Vec<f64>>;

#[pymethods]
impl RolloutData {
    fn column(&self, name: &str) -> PyResult<Column> {
        let Sizes { n_rollouts, n_periods, n_springs, n_obstacles, n_numbers } = self.sizes;
        let (of, shape): (Of, Vec<usize>) = match name {
            "poses" => (|shown| &shown.poses, vec![n_rollouts, n_periods + 1, 3]),
            "twists" => (|shown| &shown.twists, vec![n_rollouts, n_periods + 1, 3]),
            "pulls" => (|shown| &shown.pulls, vec![n_rollouts, n_periods, n_springs, 2]),
            "contact_forces" => (|shown| &shown.forces, vec![n_rollouts, n_periods, n_obstacles, 2]),
            "statuses" => (|shown| &shown.statuses, vec![n_rollouts, n_periods]),
            "states" => (|shown| &shown.last, vec![n_rollouts, n_numbers]),
            _ => return Err(PyKeyError::new_err(name.to_owned())),
        };
        Ok(Column::of_numbers(Arc::clone(of(&self.shown)), &shape))
    }
}

/// Real time (s) of as many rollouts in Rust, each of `n_periods` advances by `shift` (m) of all
/// tips from `starts`, on so many threads. Pose and pulls are read after each.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn rust_rollouts_s(
    py: Python,
    scene: &Scene,
    options: &str,
    starts: Vec<(f64, f64)>,
    shift: (f64, f64),
    period_s: f64,
    sizes: (usize, usize),
    threads: usize,
) -> PyResult<f64> {
    let scenario = Arc::clone(&scene.scenario);
    let options = read::<Asked>(options)?.options(&scenario)?;
    let (threads, shift) = (pool(Some(threads))?, Vec2::new(shift.0, shift.1));
    let one = |_: usize| {
        let mut backend = cohaul::backend::build(&scenario.system, scenario.start, &options);
        let mut tips: Vec<Vec2> = starts.iter().map(|(x, y)| Vec2::new(*x, *y)).collect();
        tips.iter().enumerate().for_each(|(spring, tip)| backend.attach(spring, *tip));
        let mut seen = 0.0;
        for _ in 0..sizes.1 {
            tips.iter_mut().for_each(|tip| *tip += shift);
            backend.advance(&tips, period_s);
            seen += backend.motion().pose.position.x;
            seen += (0..tips.len()).map(|spring| backend.pull(spring).x).sum::<f64>();
        }
        seen
    };
    let clock = Instant::now();
    let seen: f64 = py.allow_threads(|| threads.install(|| (0..sizes.0).into_par_iter().map(one).sum()));
    std::hint::black_box(seen);
    Ok(clock.elapsed().as_secs_f64())
}
