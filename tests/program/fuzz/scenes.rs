//! Scenarios, and short runs of those that are accepted.

use std::time::Duration;

use cohaul::analysis::ExpectedCost;
use cohaul::analysis::compare::{Numbers, Settings};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, Tolerance};
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Health, Keep, Outcome, Simulation};
use cohaul_report::json;
use cohaul_studies::run::summary::RunSummary;

use crate::corpus;
use crate::survey::{Format, survey};
use crate::watch::{TO_STOP, within};

/// Steps of a short run, and the time after which it is stopped.
const N_STEPS: usize = 12;
const LONGEST: Duration = Duration::from_millis(100);

/// What holds of each scenario that is accepted: it reads as it was written, its cost and its
/// scales are numbers, and short runs of it are in order.
fn read(input: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(input);
    let scenario = Scenario::parse(&text, "scene.json").map_err(|error| error.to_string())?;
    for warning in scenario.warnings() {
        assert!(!warning.to_string().contains("NaN"), "a warning: {warning}");
    }
    let again = scenario.expanded().checked("again").unwrap_or_else(|error| panic!("the expanded file is refused: {error}"));
    assert_eq!(again.hash(), scenario.hash(), "the expanded file is another scenario");
    let cost = ExpectedCost::of_comparison(&scenario, &Settings::default());
    assert!(cost.time_s >= 0.0 && cost.n_steps >= 0.0, "{cost:?}");
    json::check(&Numbers::before_run(&scenario)).unwrap_or_else(|error| panic!("before a run: {error}"));
    for options in options(&scenario) {
        short_run(&scenario, &options);
    }
    Ok(())
}

fn options(scenario: &Scenario) -> Vec<BackendOptions> {
    let at_step = |kind| BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
    let within = |kind| BackendOptions::within(kind, Tolerance::at_edge(1e-3 * scenario.system.load.radius, &scenario.system.load));
    let [quasi_static, inertial, rapier] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier].map(at_step);
    let midpoint = BackendOptions { integrator: Integrator::Midpoint, ..inertial };
    vec![quasi_static, inertial, midpoint, rapier, within(BackendKind::QuasiStatic), within(BackendKind::Inertial)]
}

/// A few steps of a run. It ends when it is stopped, and its account is in order.
pub fn short_run(scenario: &Scenario, options: &BackendOptions) {
    let about = format!("{} of {}", options.kind.name(), scenario.name.chars().take(40).collect::<String>());
    let (outcome, time) = within(LONGEST, &about, || {
        let mut run = Simulation::new(scenario, options, Keep::Trace);
        for _ in 0..N_STEPS {
            run.step();
        }
        run.outcome()
    });
    assert!(time < LONGEST + TO_STOP, "{} does not end when it is stopped, for {time:?}", options.kind.name());
    if let Some(outcome) = outcome {
        check_account(scenario, &outcome, options);
    }
}

/// Every number is finite, and the account says why a run is not ok.
pub fn check_account(scenario: &Scenario, outcome: &Outcome, options: &BackendOptions) {
    let name = options.kind.name();
    let account = &outcome.account;
    let run = Run { scenario, options, outcome, path_length: None, wall_time: None };
    json::check(&RunSummary { run, inertia_estimate: None }).unwrap_or_else(|error| panic!("{name}, {:?}: {error}", account.health));
    json::check(outcome).unwrap_or_else(|error| panic!("{name}, {:?}: {error}", account.health));
    assert_eq!(account.worst().map_or(Health::Ok, |worst| worst.health), account.health, "{name}: {account:?}");
    if outcome.failed_at.is_some() {
        assert_eq!(account.health, Health::Failed, "{name}: {account:?}");
    }
    assert!(outcome.motion.pose.is_finite(), "{name}: {outcome:?}");
}

#[test]
fn changed_scenarios_are_refused_or_run() {
    let texts = corpus::scenarios();
    let files = corpus::values(&texts);
    survey(&Format { name: "scenario", texts, files, read }, 600);
}

/// Most bytes make no JSON, and are refused sooner.
#[test]
fn changed_bytes_of_scenarios_are_refused_or_run() {
    survey(&Format { name: "bytes of a scenario", texts: corpus::scenarios(), files: Vec::new(), read }, 1500);
}
