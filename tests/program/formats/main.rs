//! No key of a format changes without its version: keys and types of real outputs of small scenes
//! are those of the lists beside this file.
//!
//! ```text
//! keys.rs      key paths with types, and the comparison with a list
//! outputs.rs   the outputs of each command, the files that users keep, and the live page
//! schema.rs    key paths of scenarios, from the schema
//! *.txt        one list for each format
//! ```
//!
//! `COHAUL_REWRITE=1` adds new keys to the lists, and writes the list of another version anew. A
//! type that these scenes do not show may be written into a list by hand.

#![cfg(unix)]

mod keys;
mod outputs;
#[path = "../../common/root.rs"]
mod root;
mod schema;

use std::collections::BTreeMap;
use std::path::PathBuf;

use cohaul::formats::{self, Found};
use cohaul::scenario::{Scenario, ScenarioError};
use cohaul_app::live::{Edit, LiveScene};
use cohaul_report::folder::check_target;
use keys::{Keys, compare, text_of};
use serde_json::{Value, json};

/// The list of the format of this name.
fn list_of(name: &str) -> PathBuf {
    let file = name.trim_start_matches("cohaul ").replace(' ', "-") + ".txt";
    root::root().to_path_buf().join("tests/program/formats").join(file)
}

#[test]
fn no_key_changes_without_its_version() {
    let mut found: BTreeMap<&str, Keys> = outputs::all();
    found.insert(formats::SCENARIO.name, schema::keys());
    let rewrites = std::env::var_os("COHAUL_REWRITE").is_some();
    let mut faults = Vec::new();
    for format in formats::ALL {
        let path = list_of(format.name);
        let keys = found.remove(format.name).unwrap_or_else(|| panic!("no output of {:?} is looked at", format.name));
        let stored = std::fs::read_to_string(&path).ok();
        let Err(misfit) = compare(format, stored.as_deref(), &keys) else { continue };
        match misfit.list.filter(|_| rewrites) {
            Some(list) => std::fs::write(&path, text_of(format.version, &list)).expect("a list can be written"),
            None => faults.push(format!("{}:\n  {}", path.display(), misfit.why.join("\n  "))),
        }
    }
    assert!(found.is_empty(), "outputs of no known format: {:?}", found.keys());
    let how = "COHAUL_REWRITE=1 cargo test --test formats adds new keys, and writes the list of another version anew";
    assert!(faults.is_empty(), "{}\n{how}", faults.join("\n"));
}

const SCENE: &str = "scenarios/analytic/release-jump.json";

/// The scene with this version of its format.
fn scene_of_version(version: u64) -> Result<Scenario, ScenarioError> {
    let mut scene: Value = serde_json::from_str(&std::fs::read_to_string(root::root().join(SCENE)).unwrap()).unwrap();
    scene["format"] = json!(version);
    scene["a key of the future"] = json!(1);
    if version <= 1 {
        scene.as_object_mut().unwrap().remove("a key of the future");
    }
    Scenario::parse(&scene.to_string(), "scene.json")
}

/// A newer version has keys that the program does not know: only the version is named.
#[test]
fn a_scenario_may_state_its_version_and_a_newer_one_is_refused_by_name_and_number() {
    let plain = Scenario::read(&root::root().join(SCENE)).unwrap();
    assert_eq!(scene_of_version(1).unwrap().hash(), plain.hash());
    for (version, found) in [(0, "0"), (2, "2"), (u64::MAX, "18446744073709551615")] {
        let error = scene_of_version(version).unwrap_err().to_string();
        assert_eq!(error, format!("scene.json: format: must be 1, which this program reads of \"cohaul scenario\", found {found}"));
    }
}

#[test]
fn what_is_read_back_is_refused_if_it_is_newer_and_read_if_it_has_no_version() {
    let room = tempfile::tempdir().unwrap();
    let call = |arguments: &[&str]| root::cohaul().args(arguments).output().unwrap();
    let path = |name: &str| room.path().join(name).to_str().unwrap().to_owned();
    let (run, fit) = (path("run"), path("fit"));
    assert!(call(&["run", "scenarios/paper/four-tips-held.json", "--tips", "--out", &run]).status.success());
    assert!(call(&["calibrate", "fit", "data/spring-calibration.csv", "--out", &fit]).status.success());
    let change = |file: &str, format: Option<Value>| {
        let mut value: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        match format {
            Some(format) => value["format"] = format,
            None => drop(value.as_object_mut().unwrap().remove("format")),
        }
        std::fs::write(file, value.to_string()).unwrap();
    };
    let (manifest, calibration) = (format!("{run}/manifest.json"), format!("{fit}/calibration.json"));
    let forces = ["calibrate", "forces", &run, "--calibration", &calibration];
    for (file, format) in [(&manifest, formats::MANIFEST), (&calibration, formats::CALIBRATE_FIT)] {
        change(file, None);
        assert!(call(&forces).status.success(), "{file}");
        change(file, Some(json!({ "name": format.name, "version": 2 })));
        let output = call(&forces);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        let why = format!("format.version: must be 1, which this program reads of {:?}, found 2", format.name);
        assert!(error.contains(file.as_str()) && error.contains(&why), "{error}");
        change(file, Some(json!(format)));
    }
    // A folder with a newer manifest is never replaced.
    assert!(check_target(run.as_ref()).is_ok());
    change(&manifest, Some(json!({ "name": "cohaul manifest", "version": 2 })));
    assert!(check_target(run.as_ref()).unwrap_err().to_string().contains("of \"cohaul manifest\", found 2; move the folder away"));
}

#[test]
fn a_scene_that_a_newer_page_saved_is_refused() {
    let mut scene = LiveScene::new(Scenario::read(&root::root().join(SCENE)).unwrap());
    let mut saved = scene.saved(0.0);
    assert_eq!(saved.format, Some(formats::LIVE.found()));
    for format in [None, saved.format.clone()] {
        saved.format = format;
        assert!(scene.apply(&Edit::Open(Box::new(saved.clone())), 0.0).is_ok());
    }
    saved.format = Some(Found { version: 3, ..formats::LIVE.found() });
    let error = scene.apply(&Edit::Open(Box::new(saved)), 0.0).unwrap_err();
    assert!(error.contains("which this program reads of \"cohaul live\", found 3"), "{error}");
}
