//! A saved state that somebody edited, or that a disk has damaged, is an error or another run, and
//! never a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};

use cohaul::backend::{BackendKind, BackendOptions, Integrator, Tolerance};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, SavedRun, Simulation};
use serde_json::{Value, json};

/// Two tips pull a load along a wall and into it, past the times of a grasp and a release.
fn tips() -> Scenario {
    let file = json!({
        "name": "tips beside a wall", "duration_s": 0.5, "control_period_s": 0.01,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "side_friction_coefficient": 0.3 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": 3, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4, "damping_ratio": 0.1 } }],
        "obstacles": [{ "name": "wall", "outline": { "rectangle": { "size_m": [0.01, 0.2] } }, "position_m": [0.02, 0.0] }],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.0, 0.0385, 0.0], [0.2, 0.09, 0.01], [0.5, 0.09, 0.03]], "release_s": 0.45 },
            { "spring": 1, "waypoints": [[0.05, -0.02, 0.034], [0.5, 0.03, 0.05]] },
            { "spring": 2, "waypoints": [[0.01, -0.02, -0.034], [0.1, 0.0, -0.034]], "release_s": 0.15 } ] }
    });
    Scenario::parse(&file.to_string(), "tips").unwrap()
}

fn options(scenario: &Scenario) -> Vec<BackendOptions> {
    let quasi_static = BackendOptions::new(BackendKind::QuasiStatic, 2.5e-3);
    let inertial = BackendOptions::new(BackendKind::Inertial, 1e-3);
    let within = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-5, &scenario.system.load));
    let engine = BackendOptions::new(BackendKind::Rapier, 1e-3);
    vec![quasi_static, inertial, BackendOptions { integrator: Integrator::Euler, ..inertial }, within, engine]
}

/// The state at 0.25 s, when the load is at the wall and springs 0 and 1 are attached.
fn saved(scenario: &Scenario, options: &BackendOptions) -> Value {
    let mut run = Simulation::new(scenario, options, Keep::Outcome);
    run.run(|time| time < 0.25);
    serde_json::to_value(run.save().unwrap()).unwrap()
}

/// Why a state is refused; `None` when the run goes on for a few steps.
fn refusal(scenario: &Scenario, state: Value) -> Option<String> {
    let saved: SavedRun = match serde_json::from_value(state) {
        Ok(saved) => saved,
        Err(error) => return Some(error.to_string()),
    };
    match Simulation::resume(scenario, &saved, Keep::Outcome) {
        Err(error) => Some(error.to_string()),
        Ok(mut run) => {
            (0..3).for_each(|_| run.step());
            None
        }
    }
}

#[test]
fn an_edited_state_is_refused_and_says_why() {
    let scenario = tips();
    let options = &options(&scenario);
    let quasi_static = saved(&scenario, &options[0]);
    assert_eq!(refusal(&scenario, quasi_static.clone()), None);
    let attachments = quasi_static["backend"]["springs"]["attachments"].clone();
    let twice = json!([attachments[0], attachments[0]]);
    let tolerance = |position: f64, heading: f64| json!({ "position_m": position, "heading_rad": heading });
    for (part, value, why) in [
        ("/format", json!(2), "in format 2"),
        ("/version", json!("0.0.9"), "saved by version 0.0.9 in format 1, this is version"),
        ("/options/step_s", json!(0), "a step of 0 s"),
        ("/options/step_s", json!(-1), "a step of -1 s"),
        ("/options/step_s", json!(1e-300), "a step of"),
        ("/options/tolerance", tolerance(0.0, 1e-3), "a tolerance of 0 m"),
        ("/options/tolerance", tolerance(1e-5, -1.0), "and -1 rad"),
        ("/tick", json!(26), "not in the control period after tick 26"),
        ("/tick", json!(u64::MAX), "not in the control period"),
        ("/time", json!(0.2371), "not in the control period after tick 25"),
        ("/time", json!(-1), "not in the control period"),
        ("/n_parts", json!(u64::MAX), "rows in a control period"),
        ("/backend/springs/attachments", twice, "attachments that are not of 3 springs"),
        ("/backend/springs/attachments", json!([attachments[0]]), "at 0.25 s, spring 1 free, which is attached"),
        ("/backend/springs/attachments/1/spring", json!(2), "spring 1 free, which is attached"),
        ("/backend/springs/attachments/0/tip", json!([1e300, 0]), "spring 0 with its tip at [1"),
        ("/backend/state/motion/pose/position", json!([1e300, 0]), "a motion with the entry 1e300"),
    ] {
        let mut edited = quasi_static.clone();
        if let Some(place) = edited.pointer_mut(part) {
            *place = value;
        } else {
            edited["options"]["tolerance"] = value;
        }
        let told = refusal(&scenario, edited).unwrap_or_else(|| panic!("{part}: resumed"));
        assert!(told.contains(why), "{part}: {told}");
    }
    let mut controlled = saved(&scenario, &options[4]);
    controlled["options"]["tolerance"] = tolerance(1e-5, 1e-3);
    assert!(refusal(&scenario, controlled).unwrap().contains("a tolerance applies to"));
}

/// Pointers to everything in a value.
fn pointers(value: &Value, at: &str) -> Vec<String> {
    let below: Vec<String> = match value {
        Value::Object(map) => map.iter().flat_map(|(key, value)| pointers(value, &format!("{at}/{key}"))).collect(),
        Value::Array(list) => list.iter().enumerate().flat_map(|(index, value)| pointers(value, &format!("{at}/{index}"))).collect(),
        _ => Vec::new(),
    };
    [at.to_owned()].into_iter().chain(below).collect()
}

/// Everything in a state replaced by every odd value. Whole numbers of any size stand for counts
/// and indices only: among lengths they make a scene that takes long, and breaks nothing.
#[test]
fn odd_values_anywhere_in_a_state_are_answered() {
    let scenario = tips();
    let odd = [json!(null), json!("x"), json!(0), json!(-1), json!(1e308), json!(5e-324), json!([]), json!({})];
    let counts = [json!(7), json!(1e6), json!(u64::MAX)];
    let (mut n_refused, mut panicked) = (0, Vec::new());
    for options in options(&scenario) {
        let state = saved(&scenario, &options);
        for at in pointers(&state, "").iter().skip(1) {
            let is_count = state.pointer(at).is_some_and(Value::is_u64);
            for value in odd.iter().chain(counts.iter().filter(|_| is_count)) {
                let mut edited = state.clone();
                *edited.pointer_mut(at).unwrap() = value.clone();
                match catch_unwind(AssertUnwindSafe(|| refusal(&scenario, edited))) {
                    Ok(told) => n_refused += usize::from(told.is_some()),
                    Err(_) => panicked.push(format!("{} {at} {value}", options.kind.name())),
                }
            }
        }
    }
    assert!(panicked.is_empty(), "{}", panicked.join("\n"));
    assert!(n_refused > 1000, "{n_refused}");
}
