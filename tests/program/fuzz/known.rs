//! Inputs that the program once answered by a panic, wrongly, or at any length.

use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, SavedRun, Simulation};
use cohaul_studies::journal::{load_single, save_single};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::corpus;
use crate::files::{SCENES, WRITTEN, merge_header, read_journal};

/// Its steps have no length beforehand, and the state held a product with that length.
#[test]
fn a_run_within_a_tolerance_goes_on_from_its_file() {
    let (scenario, room) = (&SCENES[0], tempdir().unwrap());
    let tolerance = Tolerance::at_edge(1e-5, &scenario.system.load);
    for kind in [BackendKind::QuasiStatic, BackendKind::Inertial] {
        let mut whole = Simulation::new(scenario, &BackendOptions::within(kind, tolerance), Keep::Outcome);
        whole.run(|time| time < 0.25);
        let path = room.path().join(kind.name());
        save_single(&path, "run", &whole.save().unwrap()).unwrap();
        let saved: SavedRun = load_single(&path, "run").unwrap().unwrap();
        let mut resumed = Simulation::resume(scenario, &saved, Keep::Outcome).unwrap();
        for run in [&mut whole, &mut resumed] {
            run.run(|time| time < 0.3);
        }
        assert_eq!(resumed.outcome(), whole.outcome(), "{}", kind.name());
    }
}

#[test]
fn a_record_without_content_is_no_record() {
    let head = json!({ "study": "bench", "identity": { "step_s": 0.1 }, "begin": 0, "end": 100_000_000 });
    assert_eq!(read_journal(format!("{head}\n0,[0.1,[]]\n").as_bytes()), Ok(()));
    let told = read_journal(format!("{head}\n1").as_bytes()).unwrap_err();
    assert!(told.contains("has a record that is none of a bench"), "{told}");
}

/// What follows from two numbers in range is in range too, so that the expanded file is accepted.
#[test]
fn products_of_given_numbers_are_in_range() {
    let told = |load: Value, gravity: f64| {
        let mut scene: Value = serde_json::from_str(&corpus::small()).unwrap();
        scene["obstacles"] = json!([]);
        scene["load"] = load;
        scene["ground"]["gravity_m_per_s2"] = json!(gravity);
        Scenario::parse(&scene.to_string(), "scene").unwrap_err().to_string()
    };
    let wide = told(json!({ "mass_kg": 1, "radius_m": 1e40 }), 9.81);
    assert!(wide.contains("load.inertia_kg_m2: must be given"), "{wide}");
    let heavy = told(json!({ "mass_kg": 1e40, "radius_m": 1 }), 1e20);
    assert!(heavy.contains("ground.gravity_m_per_s2: must give a weight in the range"), "{heavy}");
}

/// The header of a shard with one value in another's place.
fn header(at: &str, put: Value) -> Result<(), String> {
    let (head, rows) = WRITTEN.0.split_once('\n').unwrap();
    let mut whole = json!({ "head": serde_json::from_str::<Value>(head).unwrap(), "rows": rows });
    *whole["head"].pointer_mut(at).unwrap() = put;
    merge_header(whole.to_string().as_bytes())
}

#[test]
fn a_header_of_a_shard_is_that_of_a_sweep() {
    for (at, put, why) in [
        ("/identity/columns", json!([]), "its columns are not those of its design"),
        ("/identity/columns/5/name", json!("step"), "its columns are not those of its design"),
        ("/identity/n_seeds", json!(0), "its number of runs does not follow from its design"),
        ("/identity/variants", json!([]), "its number of runs does not follow from its design"),
        ("/identity/design/axes/0/list", json!([]), "its number of runs does not follow from its design"),
        ("/begin", json!(9), "cells 9 to"),
        ("/identity/version", json!(1), "has no rows of a sweep"),
    ] {
        let told = header(at, put).unwrap_err();
        assert!(told.contains(why), "{at}: {told}");
    }
}
