//! Path of one backend with its numerical error.
//!
//! Quasi-static and inertial runs estimate their error themselves (error control). An engine does
//! not. With p(h) its path at the step h, `2 p(h/2) - p(h)` is second order while nothing happens
//! between nodes; the same at h/4 is taken as the limit. Grasps and releases fall on nodes. Slip
//! onsets, stops and pinnings do not, and spoil the expansion in the step: the limit may then be
//! as wrong as the finest path. The error is therefore the larger one of two distances, between the
//! two extrapolations and between the two finest paths, times Roache's factor of safety for three
//! grids, 1.25 (Annu. Rev. Fluid Mech. 29, 123, 1997). It never falls again.
//!
//! The engine's path at the step that was asked for is kept too. Its distance from the limit is
//! the time-step error; the distance of the limit from the inertial path is the model error.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;
use serde::Serialize;

use super::engine::EngineName;
use super::settings::{MakeController, Settings, Tier};
use crate::backend::{BackendKind, BackendOptions, Computes, PoseError, StepReport};
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
    /// Rows of an engine at a half and at a quarter of the step; `None` for other backends.
    #[serde(skip)]
    pub finer: Option<[Vec<Row>; 2]>,
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

/// Factor of safety of the error of a limit of small steps (1).
pub(super) const SAFETY: f64 = 1.25;

/// What a comparison asks of every backend.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub tier: Tier,
    pub scenario: &'a Scenario,
    pub settings: &'a Settings,
    /// Makes rapier, or what replaces it, with its name.
    pub engine: (&'a EngineName, &'a MakeBackend<'a>),
    /// Makes the quasi-static and the inertial backend.
    pub references: &'a MakeBackend<'a>,
    pub controller: &'a MakeController<'a>,
}

impl Question<'_> {
    /// Path on the backends from `make`: see [`Solution::find`].
    pub fn solution(&self, options: &BackendOptions, make: &MakeBackend, watch: impl Fn(f64) -> bool + Sync) -> Option<Solution> {
        let n_parts = self.settings.parts_of_period(self.tier, self.scenario);
        Solution::find(self.scenario, options, n_parts, make, || (self.controller)(self.scenario), watch)
    }
}

impl Solution {
    /// Path of `scenario` on the backends from `make`, under the controllers from `controller`.
    ///
    /// Runs under error control if `options` ask for it, else at the given step and at a half and
    /// a quarter of it. There is a point at the end of each of `n_parts` equal parts of a control
    /// period. `watch` gets the share done (1) and answers whether to go on; `None` if it said no.
    pub fn find(
        scenario: &Scenario,
        options: &BackendOptions,
        n_parts: u64,
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
            None => Self::extrapolated(scenario, options, start, watch),
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
            finer: None,
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
        start: impl Fn(&BackendOptions) -> Simulation<'a> + Sync,
        watch: impl Fn(f64) -> bool + Sync,
    ) -> Option<Self> {
        let n_levels = 3;
        let cost_of_all = f64::from((1 << n_levels) - 1);
        let done: Vec<AtomicU64> = (0..n_levels).map(|_| AtomicU64::new(0)).collect();
        let stop = Stop::current();
        let level = |level: u32| {
            let options = BackendOptions { step_s: options.step_s / f64::from(1 << level), ..*options };
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
        let rows: Vec<&[Row]> = levels.iter().map(|(_, (trace, _))| trace.rows.as_slice()).collect();
        let is_engine = !options.kind.is_exact();
        // Controllers that follow the load may end one run before another.
        let n_rows = rows.iter().map(|rows| rows.len()).min().unwrap_or_default();
        let mut limit: Vec<Point> = (0..n_rows).map(|i| Point::extrapolated(&rows[0][i], &rows[1][i], &rows[2][i])).collect();
        for i in 1..limit.len() {
            limit[i].error = limit[i].error.max(&limit[i - 1].error);
        }
        let points = if is_engine { rows[0].iter().map(Point::of).collect() } else { limit.clone() };
        let mut steps = StepReport::default();
        levels.iter().for_each(|(_, (_, outcome))| steps.add(&outcome.steps));
        let failed_at = levels.iter().filter_map(|(_, (_, outcome))| outcome.failed_at).reduce(f64::min);
        let ((step_s, computes), (trace, Outcome { account, .. })) = levels.remove(if is_engine { 0 } else { 2 });
        let mut rows_of = |at: usize| std::mem::take(&mut levels[at].1.0.rows);
        let finer = is_engine.then(|| [rows_of(0), rows_of(1)]);
        // Only the exact runs of a comparison are doubted, and they are under error control.
        let doubtful = DoubtTimes::default();
        Some(Self { kind: options.kind, computes, limit, points, trace, finer, step_s: Some(step_s), steps, account, failed_at, doubtful })
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
        self.finer.iter_mut().flatten().for_each(|rows| rows.truncate(n));
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

impl Point {
    /// A row of a run as it is. The error of a fixed step is not known and counts as zero.
    fn of(row: &Row) -> Self {
        Self { time: row.time, pose: row.motion.pose, error: row.error.unwrap_or_default() }
    }

    /// The limit of small steps from rows at the steps h, h/2 and h/4.
    fn extrapolated(coarse: &Row, middle: &Row, fine: &Row) -> Self {
        let [a, b, c] = [coarse, middle, fine].map(|row| row.motion.pose);
        let limit = |a: &Pose, b: &Pose| Pose { position: 2.0 * b.position - a.position, heading: 2.0 * b.heading - a.heading };
        let (before, pose) = (limit(&a, &b), limit(&b, &c));
        let error = PoseError {
            position: SAFETY * (pose.position - before.position).norm().max((c.position - b.position).norm()),
            heading: SAFETY * (pose.heading - before.heading).abs().max((c.heading - b.heading).abs()),
        };
        Self { time: coarse.time, pose, error }
    }

    /// Position (m) and heading (rad) differences to another point.
    pub fn difference(&self, other: &Self) -> (f64, f64) {
        ((self.pose.position - other.pose.position).norm(), (self.pose.heading - other.pose.heading).abs())
    }
}
