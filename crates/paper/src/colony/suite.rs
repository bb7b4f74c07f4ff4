//! Runs of the fitted ants on all backends, as tasks.

use serde::{Deserialize, Serialize};

use super::measures::{Measures, nest_of};
use cohaul::backend::{BackendKind, BackendOptions, Status};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row, Simulation};
use cohaul_studies::runner::Tasks;

/// Which runs are made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Each backend with its number of seeds (1); the recording is compared with the first one.
    pub sets: Vec<(BackendKind, usize)>,
    pub first_seed: u64,
    /// Longest time of a run: that of the recording (s).
    pub duration_s: f64,
    /// Time between two frames in which a run is seen (s).
    pub frame_period_s: f64,
}

/// What is kept of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    pub status: Status,
    pub arrived: Option<bool>,
    pub measures: Measures,
}

impl Plan {
    /// Backends and seeds of all tasks.
    fn runs(&self) -> Vec<(BackendKind, u64)> {
        let seeds = |n: usize| self.first_seed..self.first_seed + n as u64;
        self.sets.iter().flat_map(|(kind, n)| seeds(*n).map(|seed| (*kind, seed))).collect()
    }

    /// The records of each backend.
    pub fn of_backends<'a>(&self, mut records: &'a [RunRecord]) -> Vec<(BackendKind, &'a [RunRecord])> {
        let mut next = |n: usize| {
            let (own, rest) = records.split_at(n);
            records = rest;
            own
        };
        self.sets.iter().map(|(kind, n)| (*kind, next(*n))).collect()
    }

    /// Rows of a run in the frames of the recording, and how it ended; `None` if `go_on` ended it.
    pub fn frames(
        &self,
        fitted: &Scenario,
        kind: BackendKind,
        seed: u64,
        go_on: impl Fn() -> bool,
    ) -> Option<(Vec<Row>, Status, Option<bool>)> {
        let scenario = Scenario { duration: fitted.duration.min(self.duration_s), seed, ..fitted.clone() };
        let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
        let mut run = Simulation::new(&scenario, &options, Keep::Trace);
        run.run(|_| go_on());
        if !run.is_finished() {
            return None;
        }
        let (trace, outcome) = run.into_results();
        let stride = (self.frame_period_s / scenario.control_period).round().max(1.0) as usize;
        Some((trace.rows.into_iter().step_by(stride).collect(), outcome.steps.status, outcome.arrived))
    }

    /// Time between two rows of [`Plan::frames`] (s).
    pub fn seen_period(&self, fitted: &Scenario) -> f64 {
        fitted.control_period * (self.frame_period_s / fitted.control_period).round().max(1.0)
    }
}

/// The runs of `plan`, backend after backend.
pub fn tasks<'a>(plan: &'a Plan, fitted: &'a Scenario) -> Tasks<'a, RunRecord> {
    // An engine takes some twenty times as long as the quasi-static solution.
    let cost = |kind: BackendKind| if kind.is_exact() { 1.0 + 2.0 * f64::from(u8::from(kind.has_inertia())) } else { 20.0 };
    let runs = plan.runs();
    let costs = runs.iter().map(|(kind, _)| cost(*kind)).collect();
    let run = move |task: usize, go_on: &(dyn Fn() -> bool + Sync)| {
        let (kind, seed) = runs[task];
        let (rows, status, arrived) = plan.frames(fitted, kind, seed, go_on)?;
        Some(RunRecord { status, arrived, measures: Measures::of(&rows, plan.seen_period(fitted), nest_of(fitted), seed) })
    };
    Tasks { costs, run: Box::new(run) }
}
