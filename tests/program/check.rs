//! `cohaul check` as its users meet it: exit codes, what stands on standard output, what lies in
//! the folders, and that nothing is written when the input is wrong.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::path::Path;
use std::process::Output;

use cohaul_report::manifest::Libraries;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

fn call(args: &[&str]) -> Output {
    root::cohaul().args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// What stands on standard output, given the exit code; nothing else may stand on standard error.
fn said(args: &[&str], code: i32) -> String {
    let output = call(args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}{}", text(&output.stdout), text(&output.stderr));
    assert_eq!(text(&output.stderr), "", "{args:?}");
    text(&output.stdout).to_owned()
}

/// The one JSON object on standard output; `from_str` refuses anything after it.
fn json_of(args: &[&str], code: i32) -> Value {
    serde_json::from_str(&said(args, code)).unwrap()
}

/// Exit code 2, nothing on standard output, and a text with all of `words`.
fn refused(args: &[&str], words: &[&str]) {
    let output = call(args);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert_eq!(text(&output.stdout), "", "{args:?}");
    assert!(words.iter().all(|word| error.contains(word)), "{args:?}: {words:?}: {error}");
    assert!(!error.contains("panicked"), "{error}");
}

struct Room {
    folder: TempDir,
}

impl Room {
    fn new() -> Self {
        Self { folder: tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(self.path(folder)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn read(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    /// The JSON file `name` after a change.
    fn change(&self, name: &str, change: impl FnOnce(&mut Value)) {
        let mut value = self.read(name);
        change(&mut value);
        fs::write(self.path(name), value.to_string()).unwrap();
    }

    /// A pulled tip that turns and is let go; its load starts with this speed (m/s).
    fn tips(&self, name: &str, speed: f64) -> String {
        let file = json!({
            "name": "one tip", "duration_s": 0.173, "control_period_s": 0.01, "seed": 7,
            "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [speed, 0.0] },
            "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
            "springs": [{ "ring": { "n": 2, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
                "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
            "drive": { "kind": "tips", "paths": [
                { "spring": 0, "waypoints": [[0.0, 0.0385, 0.0], [0.0555, 0.09, 0.01], [0.15, 0.1, 0.02]], "release_s": 0.12 } ] }
        });
        fs::write(self.path(name), file.to_string()).unwrap();
        self.path(name)
    }

    /// A folder with baselines of [`Room::tips`] on all backends.
    fn baselines(&self) -> String {
        let (file, folder) = (self.tips("tips.json", 0.1), self.path("stored"));
        said(
            &["check", "store", &file, "--baselines", &folder, "--backend", "quasi-static", "--backend", "inertial", "--backend", "rapier"],
            0,
        );
        folder
    }
}

const NAMES: [&str; 3] = ["tips-inertial", "tips-quasi-static", "tips-rapier"];

#[test]
fn what_was_stored_agrees_with_itself() {
    let room = Room::new();
    let folder = room.baselines();
    assert_eq!(room.names("stored"), NAMES.map(|name| format!("{name}.json")), "and nothing beside them");
    let table = said(&["check", &folder], 0);
    assert!(
        table.starts_with("check: all agree\n") && table.matches("to the last digit").count() == 3 && table.lines().count() == 4,
        "{table}"
    );
    let report = json_of(&["check", &folder, "--json", "--exact"], 0);
    assert_eq!((&report["n_agree"], &report["n_differ"], &report["n_not_computed"]), (&json!(3), &json!(0), &json!(0)));
    for (baseline, name) in report["baselines"].as_array().unwrap().iter().zip(NAMES) {
        assert_eq!((&baseline["name"], &baseline["verdict"], &baseline["is_exact"]), (&json!(name), &json!("agrees"), &json!(true)));
        assert!(baseline["first_divergence"].is_null() && baseline["deviations"].as_array().unwrap().len() > 10);
    }
    // One of them alone, by its name or its file's.
    for name in ["tips-rapier", "tips-rapier.json"] {
        assert_eq!(json_of(&["check", &folder, name, "--json"], 0)["baselines"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn a_baseline_needs_nothing_but_itself_and_says_what_it_is() {
    let room = Room::new();
    let folder = room.baselines();
    fs::remove_file(room.path("tips.json")).unwrap();
    said(&["check", &folder], 0);
    let file = room.read("stored/tips-rapier.json");
    assert_eq!((&file["format"], &file["version"]), (&json!("cohaul baseline"), &json!(1)));
    assert_eq!(file["scenario"]["seed"], 7);
    assert_eq!((&file["options"]["kind"], &file["options"]["rapier"]["friction"]), (&json!("rapier"), &json!("aligned")));
    assert_eq!(
        (&file["build"]["cohaul"], &file["build"]["rapier2d"]),
        (&json!(env!("CARGO_PKG_VERSION")), &json!(Libraries::USED.rapier2d))
    );
    assert_eq!(file["events"].as_array().unwrap().len(), 2);
    // 17 whole control periods, the start, and the end between two ticks.
    let rows = file["path"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &rows[18][0]), (19, &json!(0.173)));
}

#[test]
fn stored_baselines_are_replaced_only_when_asked() {
    let room = Room::new();
    let folder = room.baselines();
    let file = room.tips("tips.json", 0.2);
    let before = room.read("stored/tips-rapier.json");
    let store = ["check", "store", &file, "--baselines", &folder, "--backend", "rapier"];
    refused(&store, &["tips-rapier.json", "already exists", "--replace"]);
    assert_eq!(room.read("stored/tips-rapier.json"), before);
    said(&[&store[..], &["--replace", "--rows", "5"]].concat(), 0);
    let after = room.read("stored/tips-rapier.json");
    assert_eq!(after["scenario"]["load"]["velocity_m_per_s"][0], 0.2);
    assert_eq!(after["path"]["rows"].as_array().unwrap().len(), 5);
    said(&["check", &folder], 0);
    // Unusual options and a seed have names of their own.
    said(&[&store[..], &["--precision", "f32", "--seed", "3", "--step-s", "0.001"]].concat(), 0);
    said(&[&store[..], &["--name", "mine"]].concat(), 0);
    let new = ["mine.json", "tips-inertial.json", "tips-quasi-static.json", "tips-rapier.json", "tips-seed-3-rapier-f32-step-s-0.001.json"];
    assert_eq!(room.names("stored"), new);
}

#[test]
fn nothing_is_stored_of_what_is_wrong() {
    let room = Room::new();
    let (file, folder) = (room.tips("tips.json", 0.1), room.path("stored"));
    let bad = room.tips("bad.json", 0.1);
    room.change("bad.json", |file| file["load"]["mass_kg"] = json!(-1));
    let store = |more: &[&str], words: &[&str]| refused(&[&["check", "store", "--baselines", &folder], more].concat(), words);
    store(&[&file, &bad], &["bad.json", "load.mass_kg", "must be positive"]);
    store(&[&room.path("missing.json")], &["missing.json", "No such file"]);
    store(&[&file, &file], &["tips-quasi-static", "must be the name of one baseline"]);
    store(&[&file, "--backend", "rapier", "--backend", "inertial", "--name", "one"], &["one", "must be the name of one baseline"]);
    for name in ["", "a/b", "..", ".hidden", "/"] {
        store(&[&file, "--name", name], &["NAME", "must be that of a file"]);
    }
    store(&[&file, "--step-s", "0"], &["--step-s", "must be positive"]);
    store(&[], &["SCENARIO"]);
    refused(&["check", "store", &file], &["--baselines"]);
    refused(&["check", "store", &file, "--baselines", &file], &["tips.json"]);
    assert!(!Path::new(&folder).exists());
    // A tip beyond any energy in single precision: the run fails, and is no baseline.
    let far = room.tips("far.json", 0.1);
    room.change("far.json", |file| file["drive"]["paths"][0]["waypoints"][1][1] = json!(1e45));
    let output = call(&["check", "store", &far, "--baselines", &folder, "--backend", "rapier", "--precision", "f32"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("far-rapier-f32.json: not stored") && !Path::new(&folder).exists());
}

#[test]
fn a_changed_scenario_differs_and_the_difference_is_told() {
    let room = Room::new();
    let (folder, out) = (room.baselines(), room.path("out"));
    let file = room.tips("changed.json", 0.101);
    let args = ["check", &folder, "tips-inertial", "tips-quasi-static", "--scenario", &file];
    let table = said(&args, 1);
    assert!(table.starts_with("check: 1 agree, 1 differ, 0 not computed\n"), "{table}");
    for words in
        ["differs           tips-inertial", "load.velocity_m_per_s[0] is 0.101, stored with 0.1", "first in ", "grasp of spring 0 at 0 s"]
    {
        assert!(table.contains(words), "{words}: {table}");
    }
    let report = json_of(&[&args[..], &["--json", "--out", &out]].concat(), 1);
    let [inertial, quasi_static] = [0, 1].map(|at| &report["baselines"][at]);
    let change = &inertial["scenario_changes"][0];
    assert_eq!(*change, json!({ "path": "load.velocity_m_per_s[0]", "stored": 0.1, "now": 0.101 }));
    // The start itself is another, by 1 mm/s.
    let first = &inertial["first_divergence"];
    assert_eq!((&first["time_s"], &first["measure"]), (&json!(0.0), &json!("velocity_m_per_s")));
    assert_eq!((&first["expected"], &first["found"]), (&json!([0.1, 0.0]), &json!([0.101, 0.0])));
    assert!(first["agreed_until_s"].is_null());
    // Without inertia the speed at the start does not matter.
    assert_eq!((&quasi_static["verdict"], &quasi_static["scenario_changes"].as_array().unwrap().len()), (&json!("agrees"), &1));

    let files = [
        "difference-tips-inertial.csv",
        "difference-tips-inertial.svg",
        "difference-tips-quasi-static.csv",
        "manifest.json",
        "summary.json",
    ];
    assert_eq!(room.names("out"), files);
    assert_eq!(room.read("out/summary.json"), report);
    let manifest = room.read("out/manifest.json");
    assert!(manifest["seed"].is_null() && manifest["scenario"]["tips-inertial"]["seed"] == 7);
    let table = fs::read_to_string(room.path("out/difference-tips-inertial.csv")).unwrap();
    assert!(
        table.starts_with("time_s,expected_x_m,found_x_m,")
            && table.lines().next().unwrap().ends_with(",apart_net_pull_n,apart_total_pull_n")
    );
    assert_eq!(table.lines().count(), 20);
    let figure = fs::read_to_string(room.path("out/difference-tips-inertial.svg")).unwrap();
    assert!(figure.trim_end().ends_with("</svg>") && figure.contains(">expected<") && figure.contains(">found<"));
    // An earlier output is replaced, anything else is not.
    said(&["check", &folder, "--out", &out], 0);
    refused(&["check", &folder, "--out", &folder], &["is not empty and no earlier output"]);
    refused(&["check", &folder, "--scenario", &file], &["NAME"]);
}

#[test]
fn results_are_written_as_junit_xml() {
    let room = Room::new();
    let (folder, xml) = (room.baselines(), room.path("deep/check.xml"));
    said(&["check", &folder, "--junit", &xml], 0);
    let good = fs::read_to_string(&xml).unwrap();
    assert!(good.contains("<testsuites name=\"cohaul check\" tests=\"3\" failures=\"0\" errors=\"0\""), "{good}");
    assert!(NAMES.iter().all(|name| good.contains(&format!("<testcase classname=\"check\" name=\"{name}\"/>"))), "{good}");
    let file = room.tips("changed.json", 0.101);
    said(&["check", &folder, "tips-inertial", "--scenario", &file, "--junit", &xml], 1);
    let bad = fs::read_to_string(&xml).unwrap();
    assert!(bad.contains("failures=\"1\"") && bad.contains("<failure message=\"differs first in "), "{bad}");
    assert!(bad.contains("load.velocity_m_per_s[0] is 0.101"), "{bad}");
    refused(&["check", &folder, "--junit", &folder], &["--junit", "must be a file", "folder"]);
}

#[test]
fn what_is_accepted_agrees_from_then_on_and_keeps_its_tolerances() {
    let room = Room::new();
    let folder = room.baselines();
    let file = room.tips("changed.json", 0.101);
    room.change("stored/tips-inertial.json", |file| file["tolerances"]["pull_n"] = json!(0.5));
    let args = ["check", &folder, "tips-inertial", "--scenario", &file];
    said(&args, 1);
    let report = json_of(&[&args[..], &["--accept", "--json"]].concat(), 0);
    assert_eq!(report["accepted"], json!(["tips-inertial"]));
    let table = said(&["check", &folder, "--exact"], 0);
    assert!(table.starts_with("check: all agree\n"), "{table}");
    let after = room.read("stored/tips-inertial.json");
    assert_eq!((&after["tolerances"]["pull_n"], &after["scenario"]["load"]["velocity_m_per_s"][0]), (&json!(0.5), &json!(0.101)));
    // Nothing is written where nothing differs.
    let before = fs::metadata(room.path("stored/tips-rapier.json")).unwrap().modified().unwrap();
    assert_eq!(json_of(&["check", &folder, "--accept", "--json"], 0)["accepted"], json!([]));
    assert_eq!(fs::metadata(room.path("stored/tips-rapier.json")).unwrap().modified().unwrap(), before);
}

#[test]
fn the_last_digit_counts_only_when_asked() {
    let room = Room::new();
    let folder = room.baselines();
    room.change("stored/tips-rapier.json", |file| {
        let x = &mut file["path"]["rows"][9][1];
        *x = json!(x.as_f64().unwrap().next_up());
    });
    assert!(said(&["check", &folder], 0).contains("within less than 0.01 % of its tolerances"));
    let table = said(&["check", &folder, "--exact"], 1);
    assert!(table.contains("2 agree, 1 differ") && table.contains("first in position at 0.09 s"), "{table}");
    assert!(table.contains("in position at 0.09 s, agreed up to 0.08 s"), "{table}");
}

#[test]
fn bad_folders_names_and_files_are_told_and_nothing_runs() {
    let room = Room::new();
    let folder = room.baselines();
    refused(&["check"], &["DIR"]);
    refused(&["check", &room.path("missing")], &["missing", "cannot be listed", "No such file"]);
    refused(&["check", &room.path("tips.json")], &["tips.json", "cannot be listed"]);
    fs::create_dir(room.path("empty")).unwrap();
    refused(&["check", &room.path("empty")], &["empty: holds no baseline", "cohaul check store"]);
    refused(&["check", &folder, "tips-rapier", "nobody", "noone"], &["nobody.json: cannot be read", "noone.json"]);
    refused(&["check", &folder, "../tips"], &["NAME", "without its folder"]);
    refused(&["check", &folder, "tips-rapier", "tips-rapier.json"], &["must be given once"]);
    refused(&["check", &folder, "tips-rapier", "--scenario", &room.path("missing.json")], &["missing.json"]);
    // All faults of all files at once.
    room.change("stored/tips-rapier.json", |file| {
        file["tolerances"]["position_m"] = json!(-1.0);
        file["speling"] = json!(1);
    });
    room.change("stored/tips-inertial.json", |file| file["version"] = json!(2));
    let told = [
        "tips-rapier.json: tolerances.position_m: must not be negative",
        "speling: is an unknown key",
        "tips-inertial.json: version: must be 1",
    ];
    let out = room.path("out");
    refused(&["check", &folder, "--json", "--out", &out], &told);
    assert!(!Path::new(&out).exists());
    said(&["check", &folder, "tips-quasi-static"], 0);
    fs::write(room.path("stored/notes.json"), "{").unwrap();
    refused(&["check", &folder], &["notes.json: line 1", "must be JSON"]);
}

#[test]
fn help_tells_both_forms() {
    let help = said(&["check", "--help"], 0);
    assert!(help.contains("Usage: cohaul check") && help.contains("store") && help.contains("--accept"), "{help}");
    assert!(said(&["check", "store", "--help"], 0).contains("--baselines <DIR>"));
}
