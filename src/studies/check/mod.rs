//! Floor 4: stored runs, and what a changed build, engine or scenario makes of them.
//!
//! A baseline is a run in one file: the scenario as run, how the load was moved, some rows of its path, its decisions and how it ended. A check runs it
//! again and says which quantities lie further apart than their tolerances, and where the two runs first part.
//!
//! ```text
//! measure.rs    what is kept of a row, and what is compared in it
//! record.rs     what is kept of a run
//! tolerance.rs  how far apart still agrees, from the scales of the scene
//! baseline.rs   a stored run: from a run, and names
//! file.rs       its file: folder and layout
//! reader.rs     from a file to a baseline, every fault named
//! rules.rs      what must hold in a file beyond its shape
//! difference.rs two runs -> deviations, decisions that part, the first divergence
//! changes.rs    what else changed: keys of the scenario, versions of the build
//! ```
//!
//! On one machine a build repeats its runs bit for bit. Another compiler or mathematical library differs by rounding that grows along the path, which
//! the default tolerances leave room for; what an engine does differently is larger.

mod baseline;
mod changes;
mod difference;
mod file;
mod measure;
mod pairs;
mod reader;
mod record;
pub mod report;
mod rules;
mod tolerance;

use std::sync::Mutex;

use rayon::prelude::*;
use serde::Serialize;

use crate::backend::{BackendOptions, Status};
use crate::scenario::Scenario;
use crate::simulation::run_facts::Run;
use crate::simulation::{Keep, Outcome, Simulation, Trace};

pub use baseline::{Baseline, Build, usual_name};
pub use changes::{BuildChange, ScenarioChange};
pub use difference::{Change, Decision, Deviation, Difference, Divergence, Told};
pub use file::{FORMAT, VERSION, read_folder, write_file};
pub use measure::{COLUMNS, MEASURES, Measure, Row};
pub use record::{Ending, Event, MOST_EVENTS, Number, Record, Steps};
pub use tolerance::{Quantity, Tolerances};

/// What a check amounts to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// Every quantity lies within its tolerance.
    #[serde(rename = "agrees")]
    Agrees,
    #[serde(rename = "differs")]
    Differs,
    /// The run of now had a step without a finite answer: nothing is compared.
    #[serde(rename = "not computed")]
    NotComputed,
}

/// What holding one run of now against its baseline found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    pub name: String,
    pub verdict: Verdict,
    /// Whether all numbers are the same to the last digit.
    pub is_exact: bool,
    /// Name of the scenario as run now.
    pub scenario: String,
    pub scenario_sha256: String,
    pub seed: u64,
    pub options: BackendOptions,
    pub build_changes: Vec<BuildChange>,
    pub scenario_changes: Vec<ScenarioChange>,
    #[serde(flatten)]
    pub difference: Difference,
    #[serde(skip)]
    pub stored: Record,
    /// What is found now, as a baseline would keep it.
    #[serde(skip)]
    pub found: Baseline,
}

/// How to check.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Runs this in place of each baseline's own scenario.
    pub scenario: Option<Scenario>,
    /// Counts every difference: tolerances are zero.
    pub exact: bool,
}

/// Runs every baseline again, on the build `now`. `watch` sees the share done (1) and says whether to go on; `None` when it said no.
pub fn check(baselines: &[Baseline], settings: &Settings, now: &Build, watch: impl Fn(f64) -> bool + Sync) -> Option<Vec<Check>> {
    let total: f64 = baselines.iter().map(|baseline| scenario_of(baseline, settings).duration).sum();
    let done = Mutex::new(0.0);
    let one = |baseline: &Baseline| {
        let scenario = scenario_of(baseline, settings);
        let mut reached = 0.0;
        let (trace, outcome) = run(scenario, &baseline.options, |time| {
            let mut done = done.lock().expect("no thread panicked while it counted");
            *done += (time - reached) / total;
            reached = time;
            watch(*done)
        })?;
        Some(judged(baseline, scenario, settings, now, (&trace, &outcome)))
    };
    baselines.par_iter().map(one).collect()
}

/// Runs a scenario to its end; `None` when `watch`, which sees the time (s), said no.
pub fn run(scenario: &Scenario, options: &BackendOptions, watch: impl FnMut(f64) -> bool) -> Option<(Trace, Outcome)> {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(watch);
    run.is_finished().then(|| run.into_results())
}

impl Check {
    /// The rows that were compared, as stored and as found, with the decisions of each: traces to draw. They hold motion alone.
    pub fn traces(&self) -> [Trace; 2] {
        let pairs = &self.difference.pairs;
        let of = |rows: Vec<&Row>, record: &Record| Trace {
            rows: rows.into_iter().map(measure::moving_row).collect(),
            events: record.events.iter().map(Event::at_no_place).collect(),
            transitions: Vec::new(),
        };
        let (expected, found) = pairs.iter().map(|(expected, found)| (expected, found)).unzip();
        [of(expected, &self.stored), of(found, &self.found.record)]
    }
}

fn scenario_of<'a>(baseline: &'a Baseline, settings: &'a Settings) -> &'a Scenario {
    settings.scenario.as_ref().unwrap_or(&baseline.scenario)
}

fn judged(baseline: &Baseline, scenario: &Scenario, settings: &Settings, now: &Build, found: (&Trace, &Outcome)) -> Check {
    let (trace, outcome) = found;
    let run = Run { scenario, options: &baseline.options, outcome, path_length: None, wall_time: None };
    let tolerances = if settings.exact { Tolerances::EXACT } else { baseline.tolerances };
    let (verdict, difference) = if outcome.steps.status == Status::Failed {
        (Verdict::NotComputed, Difference::default())
    } else {
        let difference = Difference::between(&baseline.record, trace, &run, &tolerances);
        (if difference.is_any() { Verdict::Differs } else { Verdict::Agrees }, difference)
    };
    Check {
        name: baseline.name.clone(),
        verdict,
        is_exact: verdict == Verdict::Agrees && difference.is_none(),
        scenario: scenario.name.clone(),
        scenario_sha256: scenario.hash(),
        seed: scenario.seed,
        options: baseline.options,
        build_changes: changes::of_builds(&baseline.build, now),
        scenario_changes: changes::of_scenarios(&baseline.scenario, scenario),
        difference,
        stored: baseline.record.clone(),
        found: Baseline {
            scenario: scenario.clone(),
            build: now.clone(),
            record: Record::of(trace, &run, baseline.record.rows.len()),
            ..baseline.clone()
        },
    }
}
