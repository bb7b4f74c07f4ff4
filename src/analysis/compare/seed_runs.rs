//! Runs of one seed on the three backends, and the quantities that distributions are compared by.

use serde::{Deserialize, Serialize};

use super::doubt::{self, Doubt, LedgerBound};
use super::question::Question;
use crate::backend::{BackendKind, BackendOptions, Status};
use crate::math::Summary;
use crate::scenario::{AntDrive, Scenario};
use crate::simulation::run_facts::{self, fact};
use crate::simulation::{DoubtTimes, Keep, MakeBackend, Simulation, Trace};

/// What a comparison keeps of the runs with one seed, in the order of [`BackendKind::COMPARED`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeedRuns {
    /// Quantities of each run; `null` where the run has none.
    pub(super) values: [Vec<Option<f64>>; 3],
    pub(super) statuses: [Status; 3],
    /// First reason to doubt an exact run; left out if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) doubt: Option<Doubt>,
    /// First time at which decisions of the quasi-static run and of the engine differ from those of
    /// the inertial run (s).
    pub(super) first_different: [Option<f64>; 2],
}

/// Quantities of one run; `None` where the run has none.
struct Run {
    values: Vec<Option<f64>>,
    trace: Trace,
    status: Status,
    doubtful: DoubtTimes,
}

/// Quantity that runs are compared by.
pub(super) struct Quantity {
    /// Name that ends in the unit.
    pub(super) name: &'static str,
    of: fn(&run_facts::Run, &Trace) -> Option<f64>,
    /// Order of magnitude of the terms of the quantity, which sets its rounding.
    pub(super) size: fn(&AntDrive, &Scenario) -> f64,
    /// Whether the values are 0 and 1, and the mean a fraction of the runs.
    pub(super) is_fraction: bool,
}

/// Largest difference of equal means, divided by the inertial mean (1): half of the precision to
/// which such force statistics are printed.
pub(super) const EQUAL: f64 = 0.05;

pub(super) const MEASURES: [Quantity; 6] = [
    mean("time_to_nest_s", |run, _| fact("time_to_nest_s").in_table(run).as_number(), |_, scenario| scenario.duration),
    Quantity { is_fraction: true, ..mean("fraction_arrived", |run, _| fact("arrived").in_table(run).as_number(), |_, _| 1.0) },
    mean("mean_speed_m_per_s", |run, _| fact("mean_speed_m_per_s").in_table(run).as_number(), |drive, _| drive.pull_speed),
    mean("pull_mean_n", |run, _| fact("pull_mean_n").in_table(run).as_number(), |drive, _| drive.release.strong_pull),
    mean("pull_sd_n", |run, _| fact("pull_sd_n").in_table(run).as_number(), |drive, _| drive.release.strong_pull),
    mean("n_transporting", |_, trace| mean_attached(trace), |_, _| 1.0),
];

const fn mean(name: &'static str, of: fn(&run_facts::Run, &Trace) -> Option<f64>, size: fn(&AntDrive, &Scenario) -> f64) -> Quantity {
    Quantity { name, of, size, is_fraction: false }
}

/// Mean number of attached springs over all rows (1).
fn mean_attached(trace: &Trace) -> Option<f64> {
    let attached = Summary::of(trace.rows.iter().map(|row| row.tips.len() as f64));
    (attached.n() > 0).then(|| attached.mean())
}

/// Runs the seed `at` places after the scenario's on all backends.
pub(super) fn seed_runs(question: &Question, at: usize, watch: impl Fn(f64) -> bool) -> Option<(SeedRuns, [Trace; 3])> {
    let Question { scenario, settings, engine: (_, engine), references: exact, .. } = *question;
    let seeded = Scenario { seed: scenario.seed.wrapping_add(at as u64), ..scenario.clone() };
    let run = |nth: u32, kind, make: &MakeBackend| {
        let question = Question { scenario: &seeded, ..*question };
        let options = settings.at_fixed_step(&seeded, kind);
        run_of(&question, &options, make, |share| watch((f64::from(nth) + share) / BackendKind::COMPARED.len() as f64))
    };
    let runs = [run(0, BackendKind::QuasiStatic, exact)?, run(1, BackendKind::Inertial, exact)?, run(2, BackendKind::Rapier, engine)?];
    let first_different = [0, 2].map(|other| first_different_decision(&runs[1].trace, &runs[other].trace));
    let found = SeedRuns {
        values: runs.each_ref().map(|run| run.values.clone()),
        statuses: runs.each_ref().map(|run| run.status),
        doubt: first_doubt(&seeded, &runs),
        first_different,
    };
    Some((found, runs.map(|run| run.trace)))
}

/// First reason to doubt an exact run of one seed.
fn first_doubt(scenario: &Scenario, runs: &[Run; 3]) -> Option<Doubt> {
    let bound = LedgerBound::new(scenario, false, EQUAL);
    let exact = BackendKind::COMPARED.into_iter().zip(runs).filter(|(kind, _)| kind.is_exact());
    let doubts = exact.flat_map(|(kind, run)| doubt::of_run(kind, &run.trace, &run.doubtful, bound));
    doubts.min_by(|a, b| a.time_s.total_cmp(&b.time_s))
}

fn run_of(question: &Question, options: &BackendOptions, make: &MakeBackend, watch: impl Fn(f64) -> bool) -> Option<Run> {
    let Question { scenario, controller, .. } = *question;
    let mut run = Simulation::from_parts(scenario, options, Keep::Trace, controller(scenario), make(scenario, options));
    run.run(|time| watch(time / scenario.duration));
    if !run.is_finished() {
        return None;
    }
    let (trace, outcome) = run.into_results();
    let facts = run_facts::Run { scenario, options, outcome: &outcome, path_length: None, wall_time: None };
    let values = MEASURES.iter().map(|measure| (measure.of)(&facts, &trace)).collect();
    Some(Run { values, trace, status: outcome.steps.status, doubtful: outcome.doubtful })
}

/// First time at which the events of two runs differ (s).
fn first_different_decision(a: &Trace, b: &Trace) -> Option<f64> {
    let mut events = a.events.iter().zip(&b.events);
    let differ = events.find(|(a, b)| (a.time, a.spring, a.ant, a.kind) != (b.time, b.spring, b.ant, b.kind));
    let n_common = a.events.len().min(b.events.len());
    let first_unpaired = || a.events.get(n_common).or(b.events.get(n_common)).map(|event| event.time);
    differ.map(|(a, b)| a.time.min(b.time)).or_else(first_unpaired)
}
