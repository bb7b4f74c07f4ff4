//! Stored runs of this project: an upgrade of the engine or a change of a solver shows here, with
//! when and in what paths first part. Then what a check promises: the same run agrees to the last
//! digit, a changed one is caught where the change first acts, and a damaged file is told by name.
//!
//! After a change that is meant, `cohaul check tests/baselines --accept` stores what is found now.

use std::fs;
use std::path::{Path, PathBuf};

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, default_step};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation, Trace};
use cohaul_report::manifest::Libraries;
use cohaul_studies::check::report::{CheckReport, check_text, this_build};
use cohaul_studies::check::{self, Baseline, Build, Check, Quantity, Record, Settings, Side, Tolerances, Verdict, read_folder, usual_name};
use serde_json::{Value, json};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baselines")
}

fn stored(name: &str) -> Baseline {
    Baseline::read(&folder().join(format!("{name}.json"))).unwrap()
}

fn check_all(baselines: &[Baseline], settings: &Settings) -> Vec<Check> {
    check::check(baselines, settings, &this_build(), |_| true).unwrap()
}

fn check_one(baseline: &Baseline) -> Check {
    check_all(std::slice::from_ref(baseline), &Settings::default()).remove(0)
}

/// The baseline held against another scenario.
fn against(baseline: &Baseline, scenario: Scenario) -> Check {
    check_all(std::slice::from_ref(baseline), &Settings { scenario: Some(scenario), exact: false }).remove(0)
}

/// The run of a baseline on this build, stored anew.
fn stored_anew(baseline: &Baseline) -> Baseline {
    let (trace, outcome) = check::run(&baseline.scenario, &baseline.options, |_| true).unwrap();
    let Baseline { name, scenario, options, .. } = baseline;
    Baseline::of(name, scenario, options, &this_build(), (&trace, &outcome), baseline.record.rows.len())
}

fn text(checks: Vec<Check>) -> String {
    check_text(&CheckReport::new(checks, false, 0.0))
}

/// Tolerances: the defaults, whose reason stands in `check::tolerance`.
#[test]
fn this_build_agrees_with_every_stored_run() {
    let baselines = read_folder(&folder()).unwrap();
    let checks = check_all(&baselines, &Settings::default());
    assert!(checks.iter().all(|check| check.verdict == Verdict::Agrees), "{}", text(checks));
    for (baseline, check) in baselines.iter().zip(&checks) {
        assert_eq!(check.difference.pairs.len(), baseline.record.rows.len(), "{}", baseline.name);
        assert!(check.scenario_changes.is_empty());
    }
}

#[test]
fn stored_runs_cover_every_backend_and_stay_small() {
    let baselines = read_folder(&folder()).unwrap();
    let has = |is: &dyn Fn(&BackendOptions) -> bool| baselines.iter().any(|baseline| is(&baseline.options));
    for kind in BackendKind::ALL {
        assert!(has(&|options| options.kind == kind));
    }
    let is_rapier = |options: &BackendOptions| options.kind == BackendKind::Rapier;
    assert!(has(&|options| is_rapier(options) && options.rapier.settings == EngineSettings::EngineDefaults));
    assert!(has(&|options| is_rapier(options) && options.rapier.precision == Precision::F32));
    assert!(has(&|options| options.kind == BackendKind::Inertial && options.integrator == Integrator::Midpoint));
    assert!(baselines.iter().any(|baseline| matches!(baseline.scenario.drive, Drive::Ants(_)) && baseline.record.events.len() > 20));
    // Each energy of a contact, on each backend that has it.
    for (column, n) in [("side_friction_j", 3), ("impacts_j", 2), ("obstacle_work_j", 3)] {
        let stored = baselines.iter().filter(|baseline| baseline.record.ending.number(column).is_some_and(|energy| energy > 0.0));
        assert!(stored.count() >= n, "{column}");
    }
    let size: u64 = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().metadata().unwrap().len()).sum();
    assert!(size < 500_000, "{size} bytes");
}

/// Through the file and back: floats keep all their digits.
#[test]
fn an_unchanged_run_agrees_to_the_last_digit() {
    for baseline in read_folder(&folder()).unwrap() {
        let anew = stored_anew(&baseline);
        let read = Baseline::parse(&anew.to_json(), &anew.name, "anew").unwrap();
        assert_eq!(read, anew);
        let check = check_all(&[read], &Settings { exact: true, ..Settings::default() }).remove(0);
        assert!(check.verdict == Verdict::Agrees && check.is_exact, "{}", text(vec![check]));
        assert_eq!(check.found.record, anew.record);
    }
}

/// The scenario with one value of its expanded file replaced.
fn changed(scenario: &Scenario, pointer: &str, value: impl Into<Value>) -> Scenario {
    let mut file = serde_json::to_value(scenario.expanded()).unwrap();
    *file.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value.into();
    Scenario::parse(&file.to_string(), "changed").unwrap()
}

/// A tip that is grasped at 51.2 ms and goes elsewhere by a millionth of its way: the first row
/// after that is the first that differs, and the grasp is what came last before.
#[test]
fn a_changed_waypoint_is_caught_where_it_first_acts() {
    for name in [
        "busy-tips-quasi-static",
        "busy-tips-inertial",
        "busy-tips-inertial-midpoint",
        "busy-tips-rapier",
        "busy-tips-rapier-box-as-shipped",
    ] {
        let baseline = stored(name);
        let check = against(&baseline, changed(&baseline.scenario, "/drive/paths/1/waypoints/1/2", 0.09 * (1.0 + 1e-6)));
        assert_eq!(check.verdict, Verdict::Differs, "{name}");
        let [change] = check.scenario_changes.as_slice() else { panic!("{:?}", check.scenario_changes) };
        assert_eq!((change.path.as_str(), &change.stored), ("drive.paths[1].waypoints[1][2]", &json!(0.09)));
        let first = check.difference.first_divergence.as_ref().unwrap();
        // The tip drifts off by 90 nm in 0.25 s, so by 1 nm or 0.7 nN within a row; the tolerance
        // on pulls is 0.5 nN.
        let time_of = |row: &check::Row| row[0];
        let after = baseline.record.rows.iter().map(time_of).find(|time| *time > 0.0512).unwrap();
        assert_eq!(first.time_s, after, "{name}");
        assert!(first.agreed_until_s.is_some_and(|until| until < 0.0512));
        let event = first.last_event.unwrap();
        assert_eq!((event.spring, event.time_s), (1, 0.0512));
        assert!(check.difference.first_different_decision.is_none(), "prescribed tips decide nothing");
        let said = text(vec![check]);
        assert!(said.contains("first in ") && said.contains("grasp of spring 1 at 0.0512 s"), "{said}");
    }
}

/// Side friction goes with its coefficient, and the loss at an impact with 1 - e^2: a change of
/// either shows in the energy that it belongs to.
#[test]
fn a_changed_contact_is_caught_in_its_energy() {
    for (name, pointer, value, column) in [
        ("box-wall-friction-quasi-static", "/obstacles/0/friction_coefficient", 0.3 * (1.0 + 1e-5), "side_friction_j"),
        ("rebound-inertial", "/obstacles/0/restitution", 0.6 * (1.0 + 1e-5), "impacts_j"),
        ("push-aside-quasi-static", "/obstacles/0/friction_coefficient", 0.3 * (1.0 + 1e-4), "obstacle_work_j"),
    ] {
        let baseline = stored(name);
        let check = against(&baseline, changed(&baseline.scenario, pointer, value));
        let deviation = check.difference.deviations.iter().find(|deviation| deviation.measure == column).unwrap();
        assert!(deviation.difference > deviation.tolerance, "{name}: {deviation:?}");
        assert_eq!(check_one(&baseline).verdict, Verdict::Agrees, "{name}");
    }
}

/// What an upgrade could bring: another step, other joints, another precision, another integrator.
/// A step halved or joints of another kind are other physics to first order; single precision is
/// 6e-8 a step.
#[test]
fn a_perturbed_option_is_caught() {
    let perturbed = |name: &str, perturb: &dyn Fn(&mut BackendOptions)| {
        let mut baseline = stored(name);
        perturb(&mut baseline.options);
        let check = check_one(&baseline);
        assert_eq!(check.verdict, Verdict::Differs, "{name}");
        let first = check.difference.first_divergence.as_ref().unwrap_or_else(|| panic!("{name}"));
        assert!(first.time_s > 0.0 && matches!(&first.expected, Side::Numbers(values) if !values.is_empty()));
    };
    for name in ["slide-spin", "busy-tips", "release-jump"] {
        perturbed(&format!("{name}-rapier"), &|options| options.step_s *= 0.5);
        perturbed(&format!("{name}-rapier"), &|options| options.rapier.settings = EngineSettings::EngineDefaults);
        perturbed(&format!("{name}-rapier"), &|options| options.rapier.precision = Precision::F32);
        perturbed(&format!("{name}-inertial"), &|options| options.integrator = Integrator::Midpoint);
    }
    for friction in [FrictionModel::Polygon, FrictionModel::Box] {
        perturbed("busy-tips-rapier", &|options| options.rapier.friction = friction);
    }
}

/// A hair below and a hair above what the change does to the position.
#[test]
fn a_difference_counts_beyond_its_tolerance_and_not_at_it() {
    let baseline = stored("busy-tips-rapier");
    let scenario = changed(&baseline.scenario, "/load/mass_kg", 0.0016 * (1.0 + 1e-6));
    let apart = |check: &Check| {
        let deviations = &check.difference.deviations;
        deviations.iter().find(|deviation| deviation.quantity == Quantity::Position).unwrap().difference
    };
    let difference = apart(&against(&baseline, scenario.clone()));
    assert!(difference > baseline.tolerances.position_m, "{difference}");
    for (factor, verdict) in [(1.0 - 1e-12, Verdict::Differs), (1.0, Verdict::Agrees), (1.0 + 1e-12, Verdict::Agrees)] {
        let wide = Tolerances {
            position_m: factor * difference,
            heading_rad: 1.0,
            velocity_m_per_s: 1.0,
            turn_rate_rad_per_s: 1.0,
            energy_j: 1.0,
            pull_n: 1.0,
            ..baseline.tolerances
        };
        let check = against(&Baseline { tolerances: wide, ..baseline.clone() }, scenario.clone());
        assert_eq!(check.verdict, verdict, "{factor}");
        assert!(!check.is_exact);
    }
}

fn trace(scenario: &Scenario, options: &BackendOptions) -> Trace {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(|_| true);
    run.into_results().0
}

/// Ants that let go more easily: the first different decision is the first event that is not
/// in both traces.
#[test]
fn decisions_that_part_are_named() {
    let baseline = stored("four-ants-rapier");
    let scenario = changed(&baseline.scenario, "/drive/strong_pull_n", 0.002);
    let [expected, found] = [&baseline.scenario, &scenario].map(|scenario| trace(scenario, &baseline.options).events);
    let n_equal =
        expected.iter().zip(&found).take_while(|(a, b)| (a.time, a.kind, a.spring, a.ant) == (b.time, b.kind, b.spring, b.ant)).count();
    assert!(n_equal > 0 && n_equal < expected.len());
    let check = against(&baseline, scenario);
    let part = check.difference.first_different_decision.unwrap();
    assert_eq!(part.n_equal, n_equal);
    assert_eq!(part.time_s, expected[n_equal].time.min(found[n_equal].time));
    let first = check.difference.first_divergence.as_ref().unwrap();
    assert_eq!((first.measure, first.time_s), ("decision", part.time_s));
    assert_eq!(first.last_event.map(|event| event.time_s), Some(expected[n_equal - 1].time));
    let words: Vec<String> = text(vec![check]).split_whitespace().map(str::to_owned).collect();
    assert!(words.join(" ").contains(&format!("the last of {n_equal} equal decisions")));
}

#[test]
fn a_run_that_ends_earlier_parts_there() {
    let baseline = stored("busy-tips-inertial");
    let check = against(&baseline, Scenario { duration: 0.3, ..baseline.scenario.clone() });
    let first = check.difference.first_divergence.as_ref().unwrap();
    assert_eq!((first.measure, first.time_s), ("time_s", 0.3));
    assert_eq!((first.expected.clone(), first.found.clone()), (Side::Numbers(vec![0.4033]), Side::Numbers(vec![0.3])));
    let compared = check.difference.pairs.len();
    assert!(compared < baseline.record.rows.len() && check.difference.pairs[compared - 1].0[0] <= 0.3);
}

/// Another control period has no rows at the stored instants. Prescribed tips need no clock, so the
/// inertial path is nearly the same and lies straight between its rows up to their curvature.
#[test]
fn a_path_without_rows_at_the_stored_instants_is_taken_as_straight_between_its_own() {
    let baseline = stored("busy-tips-inertial");
    let period = 0.0037;
    let check = against(&baseline, Scenario { control_period: period, ..baseline.scenario.clone() });
    assert_eq!(check.difference.pairs.len(), baseline.record.rows.len());
    // Accelerations are below force over mass: all pulls and friction, 0.1 N over 1.6 g. Straight
    // over a period: a h^2 / 8.
    let bound = 0.1 / 0.0016 * period * period / 8.0;
    let deviation = &check.difference.deviations[0];
    assert!(deviation.measure == "position_m" && deviation.difference < bound, "{deviation:?} {bound}");
}

/// The path is the same to the last digit; only the work behind it is not.
#[test]
fn a_silent_slow_down_shows() {
    let baseline = stored_anew(&stored("busy-tips-rapier"));
    for (share, verdict) in [(0.95, Verdict::Agrees), (0.85, Verdict::Differs), (1.2, Verdict::Differs)] {
        let mut before = baseline.clone();
        let n_solves = baseline.record.ending.number("n_solves").unwrap();
        before.record.ending.steps.numbers.insert("n_solves".into(), check::Number::Count((share * n_solves) as u64));
        let check = check_one(&before);
        assert_eq!(check.verdict, verdict, "{share}");
        assert!(check.difference.first_divergence.is_none() && !check.is_exact);
        let beyond: Vec<_> = check.difference.beyond().map(|deviation| deviation.measure).collect();
        assert_eq!(beyond, if verdict == Verdict::Differs { vec!["n_solves"] } else { vec![] });
    }
}

#[test]
fn a_step_without_an_answer_is_not_computed() {
    let mut baseline = stored("busy-tips-rapier");
    baseline.options.rapier.precision = Precision::F32;
    // Infinite in single precision.
    let check = against(&baseline, changed(&baseline.scenario, "/drive/paths/1/waypoints/1/2", 1e45));
    assert_eq!((check.verdict, check.is_exact), (Verdict::NotComputed, false));
    assert!(text(vec![check]).contains("not computed"));
}

/// Beyond the events that are kept nothing is known: more of them are no difference.
#[test]
fn events_beyond_those_kept_are_not_compared() {
    let baseline = stored_anew(&stored("four-ants-inertial"));
    let kept = Record { events: baseline.record.events[..5].to_vec(), ..baseline.record.clone() };
    assert!(check_one(&Baseline { record: kept.clone(), ..baseline.clone() }).is_exact);
    let mut other = kept;
    other.events[4].spring = (other.events[4].spring + 1) % 4;
    let check = check_one(&Baseline { record: other, ..baseline });
    assert_eq!(check.difference.first_different_decision.map(|part| part.n_equal), Some(4));
}

#[test]
fn another_engine_is_told_and_no_difference() {
    let mut baseline = stored_anew(&stored("slide-spin-rapier"));
    baseline.build =
        Build([("rapier2d".to_owned(), "0.0.1".to_owned()), ("cohaul".to_owned(), env!("CARGO_PKG_VERSION").to_owned())].into());
    let check = check_one(&baseline);
    assert_eq!(check.verdict, Verdict::Agrees);
    let engine = check.build_changes.iter().find(|change| change.what == "rapier2d").unwrap();
    assert_eq!(engine.stored.as_deref(), Some("0.0.1"));
    assert!(!check.build_changes.iter().any(|change| change.what == "cohaul" || change.what == "commit"));
    assert!(text(vec![check]).contains(&format!("rapier2d {}, stored with 0.0.1 in 1 of 1", Libraries::USED.rapier2d)));
}

#[test]
fn names_tell_what_is_unusual() {
    let scenario = stored("slide-spin-rapier").scenario;
    let usual = |kind| BackendOptions::new(kind, default_step(kind, &scenario.system, scenario.control_period));
    let name = |options: &BackendOptions| usual_name("slide", &scenario, options);
    assert_eq!(name(&usual(BackendKind::QuasiStatic)), "slide-quasi-static");
    let mut options = usual(BackendKind::Rapier);
    options.rapier.precision = Precision::F32;
    assert_eq!(name(&options), "slide-rapier-f32");
    options.step_s = 2.5e-4;
    assert_eq!(name(&options), "slide-rapier-f32-step-s-0.00025");
}

/// Every default is a share of a scale that the scene has: none is zero, and a load twice as large
/// has twice the tolerance on its position.
#[test]
fn default_tolerances_go_with_the_scene() {
    for baseline in read_folder(&folder()).unwrap() {
        let Baseline { scenario, options, record, name, .. } = &baseline;
        let tolerances = Tolerances::of(scenario, options, &record.rows);
        assert!(tolerances.entries().iter().all(|(_, value)| *value > 0.0), "{name}");
        let radius = scenario.system.load.radius;
        // A load with an outline has no radius in its file.
        if serde_json::to_value(scenario.expanded()).unwrap()["load"].get("radius_m").is_some() && scenario.system.world.is_empty() {
            let wide = changed(scenario, "/load/radius_m", 2.0 * radius);
            assert_eq!(Tolerances::of(&wide, options, &record.rows).position_m, 2.0 * tolerances.position_m);
        }
        let in_single = options.kind == BackendKind::Rapier && options.rapier.precision == Precision::F32;
        assert_eq!(tolerances.position_m, if in_single { 1e-3 } else { 1e-8 } * radius, "{name}");
    }
}

/// The file of a good baseline after `damage`, and what is told of it.
fn faults(damage: impl FnOnce(&mut Value)) -> String {
    let mut file: Value = serde_json::from_str(&stored("busy-tips-rapier").to_json()).unwrap();
    damage(&mut file);
    Baseline::parse(&file.to_string(), "x", "x.json").unwrap_err().to_string()
}

#[test]
fn every_fault_of_a_file_is_named_with_its_place() {
    type Damage = fn(&mut Value);
    let cases: [(Damage, &[&str]); 22] = [
        (|f| *f = json!([1]), &["x.json: must be an object, found a list of 1"]),
        (|f| f["format"] = json!("other"), &["format: must be \"cohaul baseline\", found \"other\""]),
        (|f| f["version"] = json!(2), &["version: must be 1, the one that this program reads, found 2"]),
        (|f| f["speling"] = json!(1), &["speling: is an unknown key", "tolerances"]),
        (|f| drop(f.as_object_mut().unwrap().remove("events")), &["events: is required, found nothing"]),
        (|f| f["tolerances"]["position_m"] = json!(-1.0), &["tolerances.position_m: must not be negative, found -1.0"]),
        (|f| f["tolerances"]["positon_m"] = json!(1.0), &["tolerances.positon_m: is an unknown key"]),
        (|f| f["tolerances"]["pull_n"] = json!("wide"), &["tolerances.pull_n: cannot be read", "found \"wide\""]),
        (|f| f["tolerances"]["pull_n"] = json!(null), &["tolerances.pull_n: cannot be read", "found null"]),
        (|f| f["options"]["rapier"]["friction"] = json!("sticky"), &["options.rapier.friction", "sticky"]),
        (|f| f["options"]["stiffness"] = json!(1), &["options.stiffness: is an unknown key"]),
        (|f| f["options"]["step_s"] = json!(0.0), &["options.step_s: must be positive, found 0.0"]),
        (|f| f["scenario"]["load"]["mass_kg"] = json!(-1.0), &["scenario.load.mass_kg: must be positive, found -1.0"]),
        (|f| f["scenario"]["load"]["mass_kg"] = json!(0.002), &["scenario_sha256: must be the hash of the scenario"]),
        (|f| f["path"]["columns"][1] = json!("x_mm"), &["path.columns: must be time_s, x_m", "x_mm"]),
        (|f| f["path"]["rows"] = json!([]), &["path.rows: must hold a row"]),
        (|f| f["path"]["rows"][3] = json!([1.0]), &["path.rows[3]: cannot be read"]),
        (|f| f["path"]["rows"][3][0] = json!(0.0), &["path.rows[3][0]: must be later than the row before", "found 0.0"]),
        (|f| f["ending"]["time_s"] = json!(0.5), &["path.rows[39][0]: must be the end, ending.time_s = 0.5"]),
        (|f| f["ending"]["arrived"] = json!(true), &["ending.arrived: must be null without ants, found true"]),
        (|f| f["events"][1]["spring"] = json!(9), &["events[1].spring: must be below the number of springs, 4, found 9"]),
        (|f| drop(f["events"].as_array_mut().unwrap().pop()), &["events: must be a list of 5"]),
    ];
    for (damage, words) in cases {
        let told = faults(damage);
        assert!(words.iter().all(|word| told.contains(word)), "{words:?}: {told}");
        assert!(told.lines().all(|line| line.starts_with("x.json: ")));
    }
    let several = faults(|file| {
        file["tolerances"]["position_m"] = json!(-1.0);
        file["scenario"]["springs"] = json!(7);
        file["scenario"]["load"]["mass_kg"] = json!(0.0);
        file["ending"]["steps"]["status"] = json!("failed");
    });
    let places = ["tolerances.position_m", "scenario.springs", "scenario.load.mass_kg", "ending.steps.status"];
    assert!(places.iter().all(|place| several.contains(&format!("x.json: {place}: "))) && several.lines().count() == 4, "{several}");
}

#[test]
fn text_that_is_no_json_and_keys_given_twice_are_told() {
    let good = stored("slide-spin-rapier").to_json();
    let told = |text: &str| Baseline::parse(text, "x", "x.json").unwrap_err().to_string();
    for cut in [0, 1, good.len() / 3, good.len() - 3] {
        assert!(told(&good[..cut]).contains("must be JSON"), "{cut}");
    }
    let twice = good.replacen("\"energy_j\"", "\"heading_rad\": 1.0,\n    \"energy_j\"", 1);
    assert!(told(&twice).contains("tolerances.heading_rad: must be given once"), "{}", told(&twice));
    assert!(told(&good.replacen("\"energy_j\": ", "\"energy_j\": 1e999", 1)).contains("must be JSON"));
}
