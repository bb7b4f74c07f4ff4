//! A load that is moved step by step.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Instant;

use cohaul::backend::{BackendOptions, SavedState, Status, StepReport};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};

use crate::controller::must_be;
use crate::options::{Asked, read, refused};
use crate::points::{array_of, numbers, point, point_array, points};
use crate::scene::Scene;
use crate::seen::{Contact, Seen};
use crate::state::{State, n_numbers};
use crate::work::{computed, guarded, internal};

/// Most steps in one advance (1).
const MOST_STEPS: f64 = 1e5;
/// Most steps in an advance that does not hear interrupts (1): starting a thread and saving the
/// state would take longer than they do.
const MOST_UNHEARD: f64 = 500.0;
/// Longest time of one advance under error control (s), which chooses its steps.
const LONGEST: f64 = 1e3;

/// A load on a backend, and what is done with it.
#[pyclass(frozen, subclass, module = "cohaul._native")]
pub struct Stepper {
    scenario: Arc<Scenario>,
    options: BackendOptions,
    state: Mutex<State>,
}

/// Complete state, as text.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    scenario_hash: String,
    options: BackendOptions,
    time_s: f64,
    totals: StepReport,
    tips: Vec<Option<Vec2>>,
    is_steered: Vec<bool>,
    backend: SavedState,
}

impl Stepper {
    /// The state, for this thread alone.
    ///
    /// # Errors
    /// While another thread uses it, and after a panic.
    fn state(&self) -> PyResult<MutexGuard<'_, State>> {
        let state = self.state.try_lock();
        let state =
            state.map_err(|_| PyRuntimeError::new_err("simulation: must be used by one thread at a time, found another one in it"))?;
        match state.is_broken {
            true => Err(internal("this simulation cannot be used after a panic".to_owned())),
            false => Ok(state),
        }
    }

    /// Whether an advance may take so long that it has to hear interrupts.
    fn lasts(&self, duration_s: f64) -> bool {
        let most = if self.options.tolerance.is_some() { self.scenario.control_period } else { MOST_UNHEARD * self.options.step_s };
        duration_s > most
    }

    /// Does what changes the state. An interrupt ends it in its midst, and puts the state back.
    fn undone_by_interrupt<T: Send>(&self, py: Python, work: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
        let before = self.saved()?;
        computed(py, None, |_watch| work()).unwrap_or_else(|interrupt| {
            // What was stopped has left its lock as after a panic.
            self.state.clear_poison();
            self.put(&before)?;
            Err(interrupt)
        })
    }

    /// Complete state.
    fn saved(&self) -> PyResult<Saved> {
        let saved = self.with(|state| {
            let backend = state.backend.save()?;
            let (time_s, totals, tips, is_steered) = (state.time, state.totals, state.tips.clone(), state.is_steered.clone());
            Ok(Saved { scenario_hash: self.scenario.hash(), options: self.options, time_s, totals, tips, is_steered, backend })
        })?;
        saved.map_err(|error: cohaul::backend::SaveError| PyRuntimeError::new_err(error.to_string()))
    }

    /// Continues from a state. One that does not fit leaves this one as it is.
    fn put(&self, saved: &Saved) -> PyResult<()> {
        let mut state = guarded(|| State::new(&self.scenario, &self.options)).map_err(internal)?;
        guarded(|| state.backend.restore(&saved.backend)).map_err(internal)?.map_err(|error| unfit(error.to_string()))?;
        if (0..saved.tips.len()).any(|spring| state.backend.tip(spring).is_some() != saved.tips[spring].is_some()) {
            return Err(unfit("its tips are not those of its load".to_owned()));
        }
        (state.time, state.totals) = (saved.time_s, saved.totals);
        (state.tips, state.is_steered) = (saved.tips.clone(), saved.is_steered.clone());
        *self.state()? = state;
        Ok(())
    }

    fn seen(&self) -> PyResult<Seen> {
        self.with(|state| state.seen(&self.scenario))
    }

    fn with<T>(&self, work: impl FnOnce(&mut State) -> T) -> PyResult<T> {
        let state = &mut *self.state()?;
        guarded(|| work(state)).map_err(|message| {
            state.is_broken = true;
            internal(message)
        })
    }
}

#[pymethods]
impl Stepper {
    #[new]
    #[pyo3(signature = (scene, options))]
    fn new(scene: &Scene, options: &str) -> PyResult<Self> {
        let scenario = Arc::clone(&scene.scenario);
        let options = read::<Asked>(options)?.options(&scenario)?;
        let state = guarded(|| State::new(&scenario, &options)).map_err(internal)?;
        Ok(Self { scenario, options, state: Mutex::new(state) })
    }

    /// Attaches a free spring with its tip at `tip` (m, world).
    fn attach(&self, spring: &Bound<PyAny>, tip: &Bound<PyAny>) -> PyResult<()> {
        let (tip, spring) = (point(tip)?, must_be(&self.state()?.tips, spring, false)?);
        self.with(|state| state.attach(spring, tip))
    }

    /// Releases an attached spring, which relaxes at once.
    fn release(&self, spring: &Bound<PyAny>) -> PyResult<()> {
        let spring = must_be(&self.state()?.tips, spring, true)?;
        self.with(|state| state.release(spring))
    }

    /// Moves all tips straight to `tips` (m, world, one entry a spring), and the obstacles of
    /// `pushers` straight to their poses (x, y in m, heading in rad, world) or by the spring of a
    /// hand, within a time (s). Returns how the steps ended: `converged`, `not_converged` or
    /// `failed`. An interrupt leaves all as it was before.
    #[pyo3(signature = (tips, duration_s, pushers=None))]
    fn advance(&self, py: Python, tips: &Bound<PyAny>, duration_s: f64, pushers: Option<&Bound<PyDict>>) -> PyResult<&'static str> {
        let most = if self.options.tolerance.is_some() { LONGEST } else { MOST_STEPS * self.options.step_s };
        if !(duration_s > 0.0 && duration_s <= most) {
            return Err(refused("duration_s", &format!("must be above 0 and at most {most} s"), duration_s));
        }
        let pushes = crate::seen::pushers(pushers, self.scenario.system.world.obstacles.len())?;
        let before = if pushes.hand.is_some() { Some(self.saved()?) } else { None };
        let (mut targets, attached) = {
            let state = &mut *self.state()?;
            (std::mem::take(&mut state.targets), state.tips.iter().map(Option::is_some).collect::<Vec<_>>())
        };
        points(tips, attached.len(), &mut targets, |spring| attached[spring])?;
        let advance = || {
            self.with(|state| {
                state.targets = targets;
                state.advance(&self.scenario, &pushes, duration_s)
            })
        };
        let status =
            if self.lasts(duration_s) || before.is_some() { self.undone_by_interrupt(py, advance) } else { py.allow_threads(advance) }?;
        match (status, before) {
            (Ok(status), _) => Ok(name_of(status)),
            (Err(error), before) => {
                before.as_ref().map_or(Ok(()), |before| self.put(before))?;
                Err(PyValueError::new_err(error.to_string()))
            }
        }
    }

    /// Complete state as text, from which `load` continues bit for bit.
    fn save(&self) -> PyResult<String> {
        serde_json::to_string(&self.saved()?).map_err(|error| internal(error.to_string()))
    }

    /// Continues from a state that `save` returned for this scenario and these options.
    fn load(&self, text: &str) -> PyResult<()> {
        let saved: Saved = serde_json::from_str(text).map_err(|error| unfit(error.to_string()))?;
        let hash = self.scenario.hash();
        if saved.scenario_hash != hash {
            return Err(unfit(format!("it is of the scenario {}, this one is {hash}", saved.scenario_hash)));
        }
        if saved.options != self.options
            || saved.tips.len() != self.scenario.system.springs.len()
            || saved.is_steered.len() != self.scenario.system.world.obstacles.len()
        {
            return Err(unfit("it has other options, springs or obstacles".to_owned()));
        }
        self.put(&saved)
    }

    /// The state as numbers.
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = self.with(|state| state.numbers(&self.scenario))?;
        array_of(py, numbers.into_iter(), n_numbers(&self.scenario))
    }

    /// Continues from a state of numbers, in the memory of an array.
    fn set_numbers(&self, path: &str, bytes: &[u8]) -> PyResult<()> {
        let numbers = numbers(bytes);
        let made = guarded(|| State::of_numbers(&self.scenario, &self.options, path, &numbers)).map_err(internal)?;
        let made = made.map_err(PyValueError::new_err)?;
        *self.state()? = made;
        Ok(())
    }

    /// Time so far (s).
    #[getter]
    fn time_s(&self) -> PyResult<f64> {
        Ok(self.state()?.time)
    }

    /// Position (m, world) and heading (rad) of the load: (x, y, heading).
    #[getter]
    fn pose(&self) -> PyResult<(f64, f64, f64)> {
        let pose = self.state()?.backend.motion().pose;
        Ok((pose.position.x, pose.position.y, pose.heading))
    }

    /// Velocity (m/s, world) and turn rate (rad/s) of the load.
    #[getter]
    fn twist(&self) -> PyResult<(f64, f64, f64)> {
        let twist = self.state()?.backend.motion().twist;
        Ok((twist.linear.x, twist.linear.y, twist.angular))
    }

    /// Whether each spring is attached.
    #[getter]
    fn attached(&self) -> PyResult<Vec<bool>> {
        Ok(self.state()?.tips.iter().map(Option::is_some).collect())
    }

    /// Tip of each spring (m, world); NaN for a free one.
    #[getter]
    fn tips<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let tips = self.state()?.tips.clone();
        point_array(py, tips.iter().map(|tip| tip.unwrap_or(Vec2::new(f64::NAN, f64::NAN))))
    }

    /// Pull on the tip of each spring (N, world); zero for a free one.
    #[getter]
    fn pulls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pulls = self.with(|state| (0..state.tips.len()).map(|spring| state.backend.pull(spring)).collect::<Vec<_>>())?;
        point_array(py, pulls.into_iter())
    }

    /// x, y (m, world) and heading (rad) of each obstacle.
    #[getter]
    fn obstacles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen()?.obstacle_array(py)
    }

    /// Contacts with obstacles in the last step: obstacle, point (m, world), and force on the load
    /// (N, world).
    #[getter]
    fn contacts(&self) -> PyResult<Vec<Contact>> {
        Ok(self.seen()?.contacts())
    }

    /// Force of each obstacle on the load in the last step (N, world).
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen()?.force_array(py)
    }

    /// Friction force of the ground on each support in the last step (N, world).
    #[getter]
    fn friction_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen()?.friction_array(py)
    }

    /// Energy ledger (J), and counts of the steps so far.
    fn facts(&self) -> PyResult<String> {
        let (energy, totals) = self.with(|state| (state.backend.energy(), state.totals))?;
        let energy = serde_json::json!({
            "elastic_j": energy.elastic, "kinetic_j": energy.kinetic, "dissipated_j": energy.dissipated(),
            "tip_work_j": energy.tip_work, "defect_j": energy.defect(),
        });
        serde_json::to_string(&serde_json::json!({ "energy": energy, "steps": totals })).map_err(|error| internal(error.to_string()))
    }
}

fn unfit(why: String) -> PyErr {
    PyValueError::new_err(format!("state: must be one that save() returned for this scenario and backend: {why}"))
}

const fn name_of(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::NotConverged => "not_converged",
        Status::Failed => "failed",
    }
}

/// Real time (s) of `n` advances in Rust: all springs attached where `starts` says, and every tip
/// moved by `shift` (m) in each of them. Pose and pulls are read after each.
#[pyfunction]
pub fn rust_loop_s(scene: &Scene, options: &str, starts: &Bound<PyAny>, shift: (f64, f64), duration_s: f64, n: u32) -> PyResult<f64> {
    let scenario = &scene.scenario;
    let options = read::<Asked>(options)?.options(scenario)?;
    let mut state = State::new(scenario, &options);
    let mut tips = Vec::new();
    points(starts, state.tips.len(), &mut tips, |_| true)?;
    tips.iter().enumerate().for_each(|(spring, tip)| state.attach(spring, *tip));
    let shift = Vec2::new(shift.0, shift.1);
    let mut seen = 0.0;
    let clock = Instant::now();
    for _ in 0..n {
        tips.iter_mut().for_each(|tip| *tip += shift);
        state.backend.advance(&tips, duration_s);
        seen += state.backend.motion().pose.position.x;
        seen += (0..tips.len()).map(|spring| state.backend.pull(spring).x).sum::<f64>();
    }
    std::hint::black_box(seen);
    Ok(clock.elapsed().as_secs_f64())
}
