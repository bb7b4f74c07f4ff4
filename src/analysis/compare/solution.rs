//! A backend's path with its own error.
//!
//! The exact methods run under error control, and their error is what that estimates. An engine has none; with p(h) its path at the step h,
//! `2 p(h/2) - p(h)` is second order as long as nothing happens between nodes; the same at h/4 is its limit. Grasps and releases fall on nodes here, onsets,
//! stops and captures do not, and leave errors that are no series in the step: the limit may then be as wrong as the finest path is without extrapolation. The larger
//! one of both distances, between the two extrapolations and between the two finest paths, bounds its error from then on. An engine is shown at the step that its user asked for as well: its distance from its own limit is the error of that step, the
//! limit's distance from the reference an error that no step removes.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use crate::backend::{BackendKind, BackendOptions, StepReport};
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::{Driver, Keep, Make, Row, Simulation, Trace};

/// Path of a load with its own error.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    pub kind: BackendKind,
    /// The path in the limit of small steps, and how far that may be wrong.
    pub limit: Vec<Point>,
    /// The path at the step asked for, for an engine, whose user sees no other; the same as `limit` for the exact methods.
    pub points: Vec<Point>,
    /// The run of the exact methods, with an engine that at the step asked for: forces, events and figures come from it.
    pub trace: Trace,
    /// Step of that run (s); `None` under error control.
    pub step_s: Option<f64>,
    /// Counts and endings of all runs that the path was made from.
    pub steps: StepReport,
}

/// Where the load is at one instant, and how far that may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// (s)
    pub time: f64,
    /// (m, world)
    pub position: Vec2,
    /// (rad)
    pub heading: f64,
    /// (m)
    pub position_error: f64,
    /// (rad)
    pub heading_error: f64,
}

impl Solution {
    /// Runs `scenario` on the backends that `make` makes, with the drivers that `driver` makes, under error control if `options` ask for it, else at their step and at halves of it, with points at
    /// the ends of `n_parts` equal parts of each control period; `watch` as in [`Simulation::run`], with the share done (1). `None` when it said to stop.
    pub fn find(
        scenario: &Scenario,
        options: &BackendOptions,
        n_parts: u64,
        make: &Make,
        driver: impl Fn() -> Box<dyn Driver> + Sync,
        watch: impl Fn(f64) -> bool + Sync,
    ) -> Option<Self> {
        let start =
            |options: &BackendOptions| Simulation::on(scenario, options, Keep::Trace, driver(), make(scenario, options)).in_parts(n_parts);
        match options.tolerance {
            Some(_) => Self::within(scenario, options, start, watch),
            None => Self::extrapolated(scenario, options, start, watch),
        }
    }

    fn within<'a>(
        scenario: &Scenario,
        options: &BackendOptions,
        start: impl Fn(&BackendOptions) -> Simulation<'a>,
        watch: impl Fn(f64) -> bool,
    ) -> Option<Self> {
        let mut run = start(options);
        run.run_within(start, |time| watch(time / scenario.duration));
        if !run.is_finished() {
            return None;
        }
        let (trace, outcome) = run.into_results();
        let limit: Vec<Point> = trace.rows.iter().map(as_run).collect();
        Some(Self { kind: options.kind, points: limit.clone(), limit, trace, step_s: None, steps: outcome.steps })
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
        let level = |level: u32| {
            let options = BackendOptions { step_s: options.step_s / f64::from(1 << level), ..*options };
            let mut run = start(&options);
            let share = f64::from(1 << level) / cost_of_all;
            run.run(|time| {
                done[level as usize].store((share * time / scenario.duration).to_bits(), Relaxed);
                watch(done.iter().map(|part| f64::from_bits(part.load(Relaxed))).sum())
            });
            run.is_finished().then(|| (options.step_s, run.into_results()))
        };
        // The longest first: two threads then end at about the same time.
        let mut levels: Vec<_> = (0..n_levels).rev().collect::<Vec<_>>().into_par_iter().map(level).collect::<Option<Vec<_>>>()?;
        levels.reverse();
        let rows: Vec<&[Row]> = levels.iter().map(|(_, (trace, _))| trace.rows.as_slice()).collect();
        let is_engine = !options.kind.is_exact();
        let mut limit: Vec<Point> = (0..rows[0].len()).map(|i| extrapolated(&rows[0][i], &rows[1][i], &rows[2][i])).collect();
        for i in 1..limit.len() {
            limit[i].position_error = limit[i].position_error.max(limit[i - 1].position_error);
            limit[i].heading_error = limit[i].heading_error.max(limit[i - 1].heading_error);
        }
        let points = if is_engine { rows[0].iter().map(as_run).collect() } else { limit.clone() };
        let mut steps = StepReport::default();
        levels.iter().for_each(|(_, (_, outcome))| steps.add(&outcome.steps));
        let (step_s, (trace, _)) = levels.swap_remove(if is_engine { 0 } else { 2 });
        Some(Self { kind: options.kind, limit, points, trace, step_s: Some(step_s), steps })
    }

    /// How far a point of the load at `radius` (m) from its origin gets from where it started (m), at most.
    pub fn reach(&self, radius: f64) -> f64 {
        let from = &self.points[0];
        let far = |point: &Point| (point.position - from.position).norm() + radius * (point.heading - from.heading).abs();
        self.points.iter().map(far).fold(0.0, f64::max)
    }

    /// Length of the way of a point of the load at `radius` (m) from its origin (m), at most.
    pub fn path_length(&self, radius: f64) -> f64 {
        let way = |pair: &[Point]| (pair[1].position - pair[0].position).norm() + radius * (pair[1].heading - pair[0].heading).abs();
        self.points.windows(2).map(way).fold(0.0, |sum, way| sum + way)
    }
}

/// A path as one run gives it. The error of a fixed step belongs to what is shown, so that the path is certain as it stands.
fn as_run(row: &Row) -> Point {
    let (pose, error) = (row.motion.pose, row.error.unwrap_or_default());
    Point { time: row.time, position: pose.position, heading: pose.heading, position_error: error.position, heading_error: error.heading }
}

/// The path in the limit of small steps. Its error is no more than its distance from the same out of one level less, or than that of the two finest paths.
fn extrapolated(coarse: &Row, middle: &Row, fine: &Row) -> Point {
    let [a, b, c] = [coarse, middle, fine].map(|row| row.motion.pose);
    let (before, position) = (2.0 * b.position - a.position, 2.0 * c.position - b.position);
    let (heading_before, heading) = (2.0 * b.heading - a.heading, 2.0 * c.heading - b.heading);
    Point {
        time: coarse.time,
        position,
        heading,
        position_error: (position - before).norm().max((c.position - b.position).norm()),
        heading_error: (heading - heading_before).abs().max((c.heading - b.heading).abs()),
    }
}
