//! Path of one backend with its numerical error.
//!
//! Quasi-static and inertial runs estimate their error themselves (error control). An engine does
//! not: it runs at the step that was asked for and at halves of it, and the last three of these
//! runs show its limit of small steps. The error of the limit never falls again along the path.
//!
//! The engine's path at the step that was asked for is kept too. Its distance from the limit is
//! the time-step error; the distance of the limit from the inertial path is the model error.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;
use serde::Serialize;

use super::limit::Convergence;
use super::settings::LEAST_HALVINGS;
use crate::backend::{BackendKind, BackendOptions, Computes, PoseError, StepReport, n_steps_in};
use crate::math::Pose;
use crate::scenario::Scenario;
use crate::simulation::{Account, Controller, DoubtTimes, Keep, MakeBackend, Outcome, Row, Simulation, Trace};
use crate::stop::Stop;

/// Path of a load with its numerical error; JSON has its step and counts only.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    #[serde(skip)]
    pub kind: BackendKind,
    #[serde(skip)]
    pub computes: Computes,
    /// Path in the limit of small steps, with its error.
    #[serde(skip)]
    pub limit: Vec<Point>,
    /// Path at the step that was asked for, for an engine; equal to `limit` for other backends.
    #[serde(skip)]
    pub points: Vec<Point>,
    /// Run from which forces, events and figures come; an engine's at the step asked for.
    #[serde(skip)]
    pub trace: Trace,
    /// Rows of an engine at smaller steps, of which the last three runs show the limit, this one
    /// among them if it needs to be; empty for other backends.
    #[serde(skip)]
    pub finer: Vec<Vec<Row>>,
    /// How an engine converges with its step.
    #[serde(skip)]
    pub(super) convergence: Convergence,
    /// Step of that run (s); `None` under error control.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Counts and worst status of all runs behind this path.
    pub steps: StepReport,
    /// Whether the run from which forces and figures come can be trusted.
    pub account: Account,
    /// When the first of these runs failed (s); `None` if none did.
    #[serde(skip)]
    pub failed_at: Option<f64>,
    /// When these runs first were doubtful.
    #[serde(skip)]
    pub doubtful: DoubtTimes,
}

/// Pose of the load at one instant, with its numerical error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Time from the start of the run (s).
    pub time: f64,
    pub pose: Pose,
    pub error: PoseError,
}

impl Solution {
    /// Path of `scenario` on the backends from `make`, under the controllers from `controller`.
    ///
    /// Runs under error control if `options` ask for it, else at the given step and at as many
    /// halvings of it, two at least. There is a point at the end of each of `n_parts` equal parts
    /// of a control period. `watch` gets the share done (1) and answers whether to go on; `None` if
    /// it said no.
    pub fn find(
        scenario: &Scenario,
        options: &BackendOptions,
        (n_parts, halvings): (u64, u32),
        make: &MakeBackend,
        controller: impl Fn() -> Box<dyn Controller> + Sync,
        watch: impl Fn(f64) -> bool + Sync,
    ) -> Option<Self> {
        let start = |options: &BackendOptions| {
            Simulation::from_parts(scenario, options, Keep::Trace, controller(), make(scenario, options))
                .with_rows_per_period(n_parts)
                .with_companion()
        };
        match options.tolerance {
            Some(_) => Self::under_error_control(scenario, options, start, watch),
            None => Self::extrapolated(scenario, options, halvings.max(LEAST_HALVINGS), start, watch),
        }
    }

    fn under_error_control<'a>(
        scenario: &Scenario,
        options: &BackendOptions,
        start: impl Fn(&BackendOptions) -> Simulation<'a>,
        watch: impl Fn(f64) -> bool,
    ) -> Option<Self> {
        let mut run = start(options);
        run.run_to_tolerance(start, |time| watch(time / scenario.duration));
        if !run.is_finished() {
            return None;
        }
        let computes = run.computes();
        let (trace, outcome) = run.into_results();
        let limit: Vec<Point> = trace.rows.iter().map(Point::of).collect();
        Some(Self {
            kind: options.kind,
            computes,
            points: limit.clone(),
            limit,
            trace,
            finer: Vec::new(),
            convergence: Convergence::default(),
            step_s: None,
            steps: outcome.steps,
            account: outcome.account,
            failed_at: outcome.failed_at,
            doubtful: outcome.doubtful,
        })
    }

    fn extrapolated<'a>(
        scenario: &Scenario,
        options: &BackendOptions,
        halvings: u32,
        start: impl Fn(&BackendOptions) -> Simulation<'a> + Sync,
        watch: impl Fn(f64) -> bool + Sync,
    ) -> Option<Self> {
        let n_levels = halvings + 1;
        let cost_of_all = f64::from((1 << n_levels) - 1);
        let done: Vec<AtomicU64> = (0..n_levels).map(|_| AtomicU64::new(0)).collect();
        let stop = Stop::current();
        // A control period has a whole number of steps, of which halves have twice as many.
        let n_steps = n_steps_in(scenario.control_period, options.step_s);
        let level = |level: u32| {
            let halved = scenario.control_period / (n_steps << level) as f64;
            let options = BackendOptions { step_s: if level == 0 { options.step_s } else { halved }, ..*options };
            let mut run = start(&options);
            let share = f64::from(1 << level) / cost_of_all;
            run.run(|time| {
                done[level as usize].store((share * time / scenario.duration).to_bits(), Relaxed);
                watch(done.iter().map(|part| f64::from_bits(part.load(Relaxed))).sum())
            });
            run.is_finished().then(|| ((options.step_s, run.computes()), run.into_results()))
        };
        // The longest first: two threads then end at about the same time.
        let mut levels: Vec<_> =
            (0..n_levels).rev().collect::<Vec<_>>().into_par_iter().map(|at| stop.within(|| level(at))).collect::<Option<Vec<_>>>()?;
        levels.reverse();
        let is_engine = !options.kind.is_exact();
        let mut steps = StepReport::default();
        levels.iter().for_each(|(_, (_, outcome))| steps.add(&outcome.steps));
        let failed_at = levels.iter().filter_map(|(_, (_, outcome))| outcome.failed_at).reduce(f64::min);
        let last_three = &mut levels[n_levels as usize - 3..];
        let (limit, convergence) = limit_of(last_three.iter().map(|(_, (trace, _))| trace.rows.as_slice()), scenario.system.load.radius);
        let mut finer = Vec::new();
        if is_engine {
            // The first run keeps its own.
            let finest = last_three.iter_mut().skip(usize::from(halvings == LEAST_HALVINGS));
            finer.extend(finest.map(|(_, (trace, _))| std::mem::take(&mut trace.rows)));
        }
        let ((step_s, computes), (trace, Outcome { account, .. })) = levels.remove(if is_engine { 0 } else { halvings as usize });
        let points = if is_engine { trace.rows[..limit.len()].iter().map(Point::of).collect() } else { limit.clone() };
        // Only the exact runs of a comparison are doubted, and they are under error control.
        let doubtful = DoubtTimes::default();
        let step_s = Some(step_s);
        Some(Self { kind: options.kind, computes, limit, points, trace, finer, convergence, step_s, steps, account, failed_at, doubtful })
    }

    /// Adds the distance from a less exact path to the error of this one, from there on. Both have
    /// controllers that follow the load, whose commands an error changes.
    pub fn add_distance_from(&mut self, other: &Self) {
        let n = self.points.len().min(other.points.len());
        self.shorten_to(n);
        let mut largest = PoseError::default();
        for (point, other) in self.points.iter_mut().zip(&other.points) {
            let (position, heading) = point.difference(other);
            largest = largest.max(&PoseError { position, heading });
            point.error = point.error.max(&largest);
        }
        self.limit.clone_from(&self.points);
    }

    /// Leaves out all but the first `n` instants.
    pub fn shorten_to(&mut self, n: usize) {
        self.points.truncate(n);
        self.limit.truncate(n);
        self.trace.rows.truncate(n);
        self.finer.iter_mut().for_each(|rows| rows.truncate(n));
    }

    /// Largest edge displacement from the start, for a load of this `radius` (m).
    pub fn reach(&self, radius: f64) -> f64 {
        self.points.iter().map(|point| point.pose.edge_displacement(&self.points[0].pose, radius)).fold(0.0, f64::max)
    }

    /// Path length: sum of all edge displacements from point to point, for a load of this `radius`
    /// (m).
    pub fn path_length(&self, radius: f64) -> f64 {
        let increments = self.points.windows(2).map(|pair| pair[1].pose.edge_displacement(&pair[0].pose, radius));
        increments.fold(0.0, |sum, increment| sum + increment)
    }
}

/// The limit of small steps from the rows at three steps, and how they converge to it, for a load
/// of this `radius` (m).
fn limit_of<'a>(rows: impl Iterator<Item = &'a [Row]>, radius: f64) -> (Vec<Point>, Convergence) {
    let [a, b, c] = rows.collect::<Vec<_>>()[..] else { unreachable!("there are three") };
    let apart = |a: &[Row], b: &[Row]| {
        let distances = a.iter().zip(b).map(|(a, b)| a.motion.pose.edge_displacement(&b.motion.pose, radius));
        distances.fold(0.0, |sum, distance| sum + distance * distance).sqrt()
    };
    let convergence = Convergence::of(apart(a, b), apart(b, c));
    let mut largest = PoseError::default();
    // Controllers that follow the load may end one run before another.
    let point = |((a, b), c): ((&Row, &Row), &Row)| {
        let (pose, error) = convergence.of_poses([a, b, c].map(|row| &row.motion.pose));
        largest = error.max(&largest);
        Point { time: a.time, pose, error: largest }
    };
    (a.iter().zip(b).zip(c).map(point).collect(), convergence)
}

impl Point {
    /// A row of a run as it is. The error of a fixed step is not known and counts as zero.
    fn of(row: &Row) -> Self {
        Self { time: row.time, pose: row.motion.pose, error: row.error.unwrap_or_default() }
    }

    /// Position (m) and heading (rad) differences to another point.
    pub fn difference(&self, other: &Self) -> (f64, f64) {
        ((self.pose.position - other.pose.position).norm(), (self.pose.heading - other.pose.heading).abs())
    }
}
