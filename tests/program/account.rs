//! Every run gives a true account of itself: scenes whose runs once said that all is well, and
//! random scenes, whose runs are right within what they say.

#[path = "../common/random_scenes.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod random_scenes;
#[path = "../common/root.rs"]
mod root;

use std::process::Output;

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Account, Cause, Health, Keep, Outcome, Simulation};
use serde_json::Value;
use tempfile::tempdir;

fn call(args: &[&str]) -> Output {
    root::cohaul().args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Scene, backend, further options, and the worst account that is true.
const SCENES: [(&str, &str, &[&str], Health); 6] = [
    ("tip-past-root", "quasi-static", &[], Health::Failed),
    ("tip-past-root", "rapier", &[], Health::Doubtful),
    ("near-root-damped", "inertial", &[], Health::Failed),
    ("nan-squeeze-damped", "inertial", &[], Health::Failed),
    ("stiff-spring", "inertial", &["--step-s", "0.005"], Health::Doubtful),
    ("stiff-spring", "inertial", &[], Health::Ok),
];

/// The exit code is the same in text, in JSON and with files, and so is the account. Nothing that
/// is no number is printed.
#[test]
fn a_run_has_one_account_and_one_exit_code_in_all_forms() {
    for (scene, backend, options, health) in SCENES {
        let file = format!("tests/common/{scene}.json");
        let room = tempdir().unwrap();
        let out = room.path().join("out");
        let args = [&["run", &file, "--backend", backend][..], options].concat();
        let forms: [&[&str]; 4] = [&[], &["--verbose"], &["--json"], &["--out", out.to_str().unwrap()]];
        for form in forms {
            let output = call(&[&args[..], form].concat());
            assert_eq!(output.status.code(), Some(i32::from(health == Health::Failed)), "{args:?} {form:?}");
            let (printed, warned) = (text(&output.stdout), text(&output.stderr));
            assert!(!printed.contains("NaN") && !printed.contains("inf "), "{args:?} {form:?}: {printed}");
            assert_eq!(warned.contains("the run "), health != Health::Ok, "{args:?} {form:?}: {warned}");
        }
        let strict = call(&[&args[..], &["--strict", "--quiet"]].concat());
        assert_eq!(strict.status.code(), Some(i32::from(health != Health::Ok)), "{args:?}");
        let summary: Value = serde_json::from_slice(&std::fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["account"]["health"], serde_json::to_value(health).unwrap(), "{args:?}");
    }
}

fn run(scenario: &Scenario, options: &BackendOptions) -> Outcome {
    let mut simulation = Simulation::new(scenario, options, Keep::Outcome);
    simulation.run(|_| true);
    simulation.outcome()
}

/// A run that fails ends at the step without an answer, with numbers that are finite. Two obstacles
/// squeeze this load.
#[test]
fn a_failed_run_has_no_number_beyond_its_failure() {
    let scenario = Scenario::read(&root::root().join("tests/common/nan-squeeze-damped.json")).unwrap();
    let options = BackendOptions::at_step(None, BackendKind::Inertial, &scenario.system, scenario.control_period);
    let outcome = run(&scenario, &options);
    assert_eq!(outcome.account.findings[0].cause, Cause::Squeezed, "{:?}", outcome.account);
    assert!(Some(outcome.time) == outcome.failed_at && outcome.time < scenario.duration, "{outcome:?}");
    let energy = &outcome.energy;
    assert!(energy.largest_entry().is_finite() && energy.defect().is_finite() && outcome.motion.pose.is_finite(), "{outcome:?}");
}

/// At a quarter of the step the end is the same within a tenth of the path, or the step error that
/// the run states. Runs of ants are not comparable: their decisions follow the load.
#[test]
fn random_runs_that_are_ok_are_right_within_what_they_say() {
    let mut n_ok = 0;
    for seed in 0..40 {
        let scenario = random_scenes::random_scenario(seed);
        if matches!(scenario.drive, Drive::Ants(_)) {
            continue;
        }
        for kind in BackendKind::COMPARED {
            let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
            let finer = BackendOptions { step_s: options.step_s / 4.0, ..options };
            let (coarse, fine) = (run(&scenario, &options), run(&scenario, &finer));
            if coarse.account.health != Health::Ok || fine.account.health != Health::Ok {
                continue;
            }
            n_ok += 1;
            let radius = scenario.system.load.radius;
            let displacement = fine.motion.pose.edge_displacement(&scenario.start.pose, radius);
            let allowed = coarse.account.step_error_m.unwrap_or_default().max(0.1 * displacement.max(0.01 * radius));
            let error = coarse.motion.pose.edge_displacement(&fine.motion.pose, radius);
            assert!(error <= allowed, "seed {seed}, {}: off by {error:e} m, said {allowed:e} m", kind.name());
        }
    }
    assert!(n_ok > 60, "only {n_ok} runs are ok");
}

/// Forces that the engine leaves open count by the path on which they act. The limits are 0.03
/// and 0.5 of it.
#[test]
fn open_forces_of_the_engine_count_where_the_load_moves() {
    let scenario = Scenario::read(&root::root().join("scenarios/analytic/ramp-and-hold.json")).unwrap();
    let options = BackendOptions::at_step(None, BackendKind::Rapier, &scenario.system, scenario.control_period);
    let mut outcome = run(&scenario, &options);
    assert_eq!(outcome.account.health, Health::Ok, "{:?}", outcome.account);
    // Every step leaves more open than all of its forces.
    (outcome.steps.residual, outcome.steps.n_not_converged) = (27.0, outcome.steps.n_steps);
    let path = outcome.resolution.path_length_m;
    for (share, health) in
        [(0.0, Health::Ok), (0.025, Health::Ok), (0.04, Health::Doubtful), (0.45, Health::Doubtful), (0.6, Health::Failed)]
    {
        outcome.resolution.unsolved_m = share * path;
        let account = Account::of(&scenario, &options, &outcome);
        assert_eq!(account.health, health, "{share}: {account:?}");
        assert!(account.findings.iter().all(|finding| finding.cause == Cause::EngineNotSolved), "{account:?}");
    }
}

/// An account states how far its ledger is open, with its sign.
#[test]
fn an_account_states_what_vanished() {
    let scenario = Scenario::read(&root::root().join("scenarios/analytic/ramp-and-hold.json")).unwrap();
    let options = BackendOptions::at_step(None, BackendKind::Inertial, &scenario.system, scenario.control_period);
    let whole = run(&scenario, &options);
    assert!(whole.account.health == Health::Ok && whole.account.defect_share.abs() < 0.01, "{:?}", whole.account);
    for (share, health) in [(0.08, Health::Ok), (0.15, Health::Doubtful)] {
        let mut outcome = whole.clone();
        outcome.energy.friction -= share * outcome.energy.largest_entry();
        let account = Account::of(&scenario, &options, &outcome);
        assert_eq!(account.health, health, "{share}: {account:?}");
        // The ledger of the run itself closes to a hundredth.
        assert!((account.defect_share + share).abs() < 0.01, "{share}: {account:?}");
    }
}
