//! Runs baselines again and compares.

use std::sync::Mutex;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::baseline::{Baseline, Build};
use super::changes::{self, BuildChange, ScenarioChange};
use super::difference::Difference;
use super::measure::{Row, moving_row};
use super::record::{Event, Record};
use super::tolerance::Tolerances;
use cohaul::backend::BackendOptions;
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Health, Keep, Outcome, Simulation, Trace};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// Every quantity is within its tolerance.
    #[serde(rename = "agrees")]
    Agrees,
    /// Some quantity exceeds its tolerance, or a decision differs.
    #[serde(rename = "differs")]
    Differs,
    /// The new run had a step without a finite solution, so that nothing was compared.
    #[serde(rename = "not computed")]
    NotComputed,
}

/// Result of one new run and its comparison with a baseline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    pub name: String,
    pub verdict: Verdict,
    /// Whether all numbers are equal to the last digit.
    pub is_exact: bool,
    /// Name of the scenario of the new run.
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
    /// The new run, as a baseline would store it.
    #[serde(skip)]
    pub found: Baseline,
}

#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Scenario that replaces the scenario of each baseline.
    pub scenario: Option<Scenario>,
    /// Whether all tolerances are zero.
    pub exact: bool,
}

/// Runs every baseline again with the build `now`. `watch` receives the fraction done (1) and
/// returns whether to continue; the result is `None` when it did not.
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

/// Runs a scenario to its end. `watch` receives the time (s) and returns whether to continue; the
/// result is `None` when it did not.
pub fn run(scenario: &Scenario, options: &BackendOptions, watch: impl FnMut(f64) -> bool) -> Option<(Trace, Outcome)> {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(watch);
    run.is_finished().then(|| run.into_results())
}

impl Check {
    /// Compared rows and decisions as traces of motion, stored and found, for figures.
    pub fn traces(&self) -> [Trace; 2] {
        let pairs = &self.difference.pairs;
        let of = |rows: Vec<&Row>, record: &Record| Trace {
            rows: rows.into_iter().map(moving_row).collect(),
            events: record.events.iter().map(Event::without_tip).collect(),
            ..Trace::default()
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
    let tolerances = if settings.exact { Tolerances::default() } else { baseline.tolerances };
    let (verdict, difference) = if outcome.account.health == Health::Failed {
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
