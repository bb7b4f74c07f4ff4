//! The program as its users meet it: exit codes, what stands on standard output, what lies in an
//! output folder, and that nothing is written when the input is wrong.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

use assert_cmd::Command;
use cohaul::scenario::Scenario;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

const BACKENDS: [&str; 3] = ["quasi-static", "inertial", "rapier"];

fn program() -> Command {
    Command::from_std(root::cohaul())
}

fn call(args: &[&str]) -> Output {
    program().args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The one JSON object on standard output; `from_str` refuses anything after it.
fn json_of(args: &[&str]) -> Value {
    let output = call(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
    let value: Value = serde_json::from_str(text(&output.stdout)).unwrap_or_else(|error| panic!("{args:?}: {error}"));
    assert!(value.is_object());
    value
}

/// Exit code 2, nothing on standard output, and a text with all of `words`.
fn refused(args: &[&str], words: &[&str]) {
    let output = call(args);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert_eq!(text(&output.stdout), "", "{args:?}");
    assert!(words.iter().all(|word| error.contains(word)), "{args:?}: {error}");
    assert!(!error.contains("panicked"), "{error}");
}

fn scenarios() -> PathBuf {
    root::root().join("scenarios")
}

fn every_scenario() -> Vec<PathBuf> {
    let list = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let mut files: Vec<_> = list(&scenarios()).iter().filter(|path| path.is_dir()).flat_map(|folder| list(folder)).collect();
    files.sort();
    assert!(files.len() >= 26, "{files:?}");
    files
}

/// A folder with scenario files to run.
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

    fn write(&self, name: &str, content: &str) -> String {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    /// A copy of a shipped scenario, lasting no longer than `most_s`.
    fn shortened(&self, name: &str, most_s: f64) -> String {
        let mut file: Value = serde_json::from_str(&fs::read_to_string(scenarios().join(name)).unwrap()).unwrap();
        let duration = file["duration_s"].as_f64().unwrap().min(most_s);
        file["duration_s"] = duration.into();
        self.write(&name.replace('/', "-"), &file.to_string())
    }

    fn four_ants(&self, duration_s: f64) -> String {
        self.shortened("paper/four-ants-four-springs.json", duration_s)
    }

    /// A tip that is grasped, turns, and is let go, over 17.3 control periods.
    fn tips(&self) -> String {
        let file = json!({
            "name": "one tip", "duration_s": 0.173, "control_period_s": 0.01, "seed": 7,
            "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
            "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
            "springs": [{ "ring": { "n": 2, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
                "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
            "drive": { "kind": "tips", "paths": [
                { "spring": 0, "waypoints": [[0.0, 0.0385, 0.0], [0.0555, 0.09, 0.01], [0.15, 0.1, 0.02]], "release_s": 0.12 } ] }
        });
        self.write("tips.json", &file.to_string())
    }

    fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {value}"))
}

/// Pointers to all nulls.
fn nulls(value: &Value, pointer: &str) -> Vec<String> {
    match value {
        Value::Null => vec![pointer.to_owned()],
        Value::Object(fields) => fields.iter().flat_map(|(key, value)| nulls(value, &format!("{pointer}/{key}"))).collect(),
        Value::Array(items) => items.iter().enumerate().flat_map(|(i, value)| nulls(value, &format!("{pointer}/{i}"))).collect(),
        _ => Vec::new(),
    }
}

/// What `run --json` promises for every drive; returns nothing that is not sane.
fn assert_run(value: &Value, backend: &str, scenario: &Scenario) {
    assert_eq!(value["scenario"], scenario.name);
    assert_eq!(value["backend"], backend);
    assert_eq!(value["seed"], scenario.seed);
    let of = |pointer: &str| number(value, pointer);
    let end = of("/final/time_s");
    // Ants end earlier when they arrive.
    assert!(end > 0.0 && end <= scenario.duration, "{end}");
    for pointer in ["/final/position_m/0", "/final/position_m/1", "/final/heading_rad", "/final/turn_rate_rad_per_s"] {
        of(pointer);
    }
    assert_eq!(value["final"]["velocity_m_per_s"].as_array().map(Vec::len), Some(2));
    for pointer in ["/energy/elastic_j", "/energy/kinetic_j", "/energy/dissipated_j"] {
        // Nobody gives energy back to the ground; rounding of a sum of terms around a millijoule.
        assert!(of(pointer) >= -1e-12, "{pointer}: {}", of(pointer));
    }
    // Without inertia there is no kinetic energy, however fast the load starts.
    assert!(backend != "quasi-static" || (of("/energy/kinetic_j") == 0.0 && of("/energy/initial_j") == 0.0));
    let _ = (of("/energy/tip_work_j"), of("/energy/defect_j"));
    let (n_steps, n_skipped, n_bad) = (of("/steps/n_steps"), of("/steps/n_skipped"), of("/steps/n_not_converged"));
    assert!(n_steps >= (end / scenario.control_period).floor() && n_skipped <= n_steps && n_bad <= n_steps);
    let _ = of("/steps/n_solves");
    assert_eq!(value["steps"]["status"] == "converged", n_bad == 0.0);
    assert!(of("/wall_s") > 0.0 && of("/wall_s") < 600.0);
    let allowed: &[&str] = if value["arrived"] == false { &["/time_to_nest_s"] } else { &[] };
    assert_eq!(nulls(value, ""), allowed);
}

#[test]
fn every_shipped_scenario_runs_on_every_backend() {
    let room = Room::new();
    for file in every_scenario() {
        let name = file.strip_prefix(scenarios()).unwrap().to_str().unwrap();
        let short = room.shortened(name, 3.0);
        let scenario = Scenario::read(short.as_ref()).unwrap();
        for backend in BACKENDS {
            let value = json_of(&["run", &short, "--json", "--backend", backend]);
            assert_run(&value, backend, &scenario);
            assert_eq!(number(&value, "/steps/n_not_converged"), 0.0, "{name} {backend}");
        }
    }
}

#[test]
fn run_json_says_what_ants_did() {
    let room = Room::new();
    let late = json_of(&["run", &room.four_ants(8.0), "--json"]);
    assert_eq!((&late["arrived"], &late["time_to_nest_s"]), (&json!(false), &Value::Null));
    let file = scenarios().join("paper/five-ants-ten-springs.json");
    let scenario = Scenario::read(&file).unwrap();
    let out = room.path("out");
    let value = json_of(&["run", file.to_str().unwrap(), "--json", "--out", &out]);
    assert_eq!(value["arrived"], true);
    assert_eq!(value["time_to_nest_s"], value["final"]["time_s"]);
    assert!(number(&value, "/time_to_nest_s") < scenario.duration);
    let pull = &value["pull_force_n"];
    let [mean, sd, max] = ["/mean", "/sd", "/max"].map(|key| number(pull, key));
    // Ants of millinewtons.
    assert!(0.0 < mean && mean < max && 0.0 < sd && max < 0.1, "{pull}");
    assert!(pull["n"].as_u64().is_some_and(|n| n > 2));
    let rows = rows_of(&out, scenario.control_period, number(&value, "/time_to_nest_s"));
    let to_nest = |row: &[f64]| (row[1] - 0.2).hypot(row[2] + 0.17);
    let [before, last] = [2, 1].map(|back| to_nest(&rows[rows.len() - back]));
    assert!(last <= 0.01 && before > 0.01, "the first row within the radius is the last: {before} {last}");
}

/// Rows of `trace.csv`: every tick up to `end` (s), then the end itself.
fn rows_of(folder: &str, control_period: f64, end: f64) -> Vec<Vec<f64>> {
    let rows = rows_in(folder, "trace.csv");
    assert_ticks(&rows, control_period, end);
    rows
}

/// Rows of a table with a trace, the first columns of which are checked.
fn rows_in(folder: &str, name: &str) -> Vec<Vec<f64>> {
    let table = fs::read_to_string(Path::new(folder).join(name)).unwrap();
    let mut lines = table.lines();
    let contract = "time_s,x_m,y_m,heading_rad,vx_m_per_s,vy_m_per_s,turn_rate_rad_per_s,";
    assert!(lines.next().unwrap().starts_with(contract));
    let seven = |line: &str| line.split(',').take(7).map(|field| field.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<_> = lines.map(seven).collect();
    assert!(rows.iter().flatten().all(|value| value.is_finite()));
    rows
}

/// No tick is missing before the end, and the end is there once.
fn assert_ticks(rows: &[Vec<f64>], control_period: f64, end: f64) {
    for (tick, row) in rows[..rows.len() - 1].iter().enumerate() {
        assert_eq!(row[0], tick as f64 * control_period);
    }
    assert_eq!(rows.last().unwrap()[0], end);
    assert_eq!(rows.len(), (end / control_period - 1e-9).ceil() as usize + 1);
}

#[test]
fn run_out_writes_every_tick_and_the_exact_end() {
    let room = Room::new();
    let file = room.tips();
    for backend in BACKENDS {
        let out = room.path(backend);
        let value = json_of(&["run", &file, "--backend", backend, "--json", "--out", &out]);
        assert_eq!(names(out.as_ref()), ["events.csv", "manifest.json", "overview.svg", "summary.json", "trace.csv", "transitions.csv"]);
        let rows = rows_of(&out, 0.01, 0.173);
        let end = rows.last().unwrap();
        let final_of = |pointer: &str| number(&value["final"], pointer);
        assert_eq!(end[1..4], [final_of("/position_m/0"), final_of("/position_m/1"), final_of("/heading_rad")]);
        assert_eq!(end[4..7], [final_of("/velocity_m_per_s/0"), final_of("/velocity_m_per_s/1"), final_of("/turn_rate_rad_per_s")]);
        assert!(end[1] > 1e-3, "the load moved");
        let read = |name: &str| fs::read_to_string(Path::new(&out).join(name)).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&read("summary.json")).unwrap(), value);
        assert!(read("overview.svg").trim_end().ends_with("</svg>"));
        assert_eq!(read("events.csv").lines().count(), 3, "a head, a grasp and a release");
        let transitions = read("transitions.csv");
        assert!(transitions.starts_with("time_s,transition,support,shift_m,turn_rad,energy_j,obstacle,law\n"), "{transitions}");
        // The load is drawn over its slip limit; whether an engine's is, it does not say.
        assert_eq!(transitions.contains(",slip_onset,,,,,,\n"), backend != "rapier", "{transitions}");
        let n_onset = value.pointer("/transitions/n_slip_onset").and_then(Value::as_u64);
        assert_eq!(n_onset, (backend != "rapier").then(|| transitions.matches(",slip_onset,").count() as u64));
        let manifest: Value = serde_json::from_str(&read("manifest.json")).unwrap();
        let scenario = Scenario::read(file.as_ref()).unwrap();
        assert_eq!((&manifest["scenario_sha256"], &manifest["seed"]), (&json!(scenario.hash()), &json!(7)));
        assert_eq!(manifest["options"]["kind"], backend);
        assert_eq!(manifest["command_line"].as_array().map(Vec::len), Some(8));
        // The scenario as run is a scenario, and the same one.
        assert_eq!(Scenario::parse(&manifest["scenario"].to_string(), "manifest").unwrap().hash(), scenario.hash());
    }
}

/// Rows are written as they come and forgotten, unless something else needs them later: the files
/// are the same. A full trace has more columns of the same run.
#[test]
fn rows_that_are_passed_on_are_those_that_are_kept() {
    let room = Room::new();
    let ants = room.four_ants(3.0);
    let [passed, kept, full] = ["passed", "kept", "full"].map(|name| room.path(name));
    json_of(&["run", &ants, "--json", "--out", &passed]);
    json_of(&["run", &ants, "--json", "--out", &kept, "--tips"]);
    json_of(&["run", &ants, "--json", "--out", &full, "--full-trace"]);
    let read = |folder: &str, name: &str| fs::read_to_string(Path::new(folder).join(name)).unwrap();
    for name in ["trace.csv", "events.csv", "transitions.csv", "overview.svg"] {
        assert!(read(&passed, name) == read(&kept, name), "{name}");
    }
    assert!(read(&full, "overview.svg") == read(&passed, "overview.svg"));
    let (narrow, wide) = (read(&passed, "trace.csv"), read(&full, "trace.csv"));
    assert_eq!(narrow.lines().count(), 1202, "a head, and every tick of 3 s");
    for (narrow, wide) in narrow.lines().zip(wide.lines()) {
        let (narrow, wide): (Vec<&str>, Vec<&str>) = (narrow.split(',').collect(), wide.split(',').collect());
        assert_eq!((narrow.len(), wide.len()), (8, 22));
        assert_eq!((&narrow[..7], narrow[7]), (&wide[..7], wide[13]));
    }
}

/// Whatever a run had written when it was interrupted goes, with the folders that were made for it.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing_behind() {
    let room = Room::new();
    // A day to a nest a kilometre away.
    let mut ants: Value = serde_json::from_str(&fs::read_to_string(room.four_ants(1.0)).unwrap()).unwrap();
    ants["duration_s"] = 86_400.0.into();
    ants["drive"]["nest_position_m"] = json!([1000.0, 0.0]);
    let ants = room.write("far.json", &ants.to_string());
    let mut run = root::cohaul()
        .args(["run", &ants, "--backend", "rapier", "--out", &room.path("new/deep/out")])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let is_writing = || fs::read_dir(room.path("new/deep")).is_ok_and(|mut entries| entries.next().is_some());
    while !is_writing() {
        assert!(run.try_wait().unwrap().is_none(), "it ended by itself");
        // Without a pause: an interrupt right after the first file counts as well.
        std::thread::yield_now();
    }
    let interrupt = std::process::Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!Path::new(&room.path("new")).exists());
}

#[test]
fn only_an_earlier_output_is_replaced() {
    let room = Room::new();
    let (file, out) = (room.tips(), room.path("out"));
    json_of(&["run", &file, "--json", "--out", &out]);
    json_of(&["run", &file, "--json", "--out", &out, "--backend", "rapier"]);
    json_of(&["compare", &file, "--json", "--out", &out]);
    fs::write(Path::new(&out).join("thesis.txt"), "mine").unwrap();
    for command in ["run", "compare"] {
        refused(&[command, &file, "--out", &out], &["thesis.txt", "not part of the earlier output"]);
        refused(&[command, &file, "--out", &file], &["is a file"]);
    }
    let foreign = room.path("foreign");
    fs::create_dir(&foreign).unwrap();
    fs::write(Path::new(&foreign).join("a.txt"), "mine").unwrap();
    refused(&["run", &file, "--out", &foreign], &["is not empty"]);
    assert_eq!(names(foreign.as_ref()), ["a.txt"]);
    let edited = room.path("edited");
    json_of(&["run", &file, "--json", "--out", &edited]);
    fs::write(Path::new(&edited).join("events.csv"), "with my notes").unwrap();
    refused(&["run", &file, "--out", &edited], &["events.csv: must be as it was written, found another hash", "changed since"]);
    assert_eq!(fs::read_to_string(Path::new(&edited).join("events.csv")).unwrap(), "with my notes");
    assert_eq!(room.names(), ["edited", "foreign", "out", "tips.json"], "nothing else is left beside them");
}

#[test]
fn a_wrong_scenario_writes_nothing() {
    let room = Room::new();
    let good: Value = serde_json::from_str(&fs::read_to_string(room.tips()).unwrap()).unwrap();
    let mut bad = good.clone();
    bad["load"]["mass_kg"] = json!(-1);
    bad["speling"] = json!(1);
    let bad = room.write("bad.json", &bad.to_string());
    let before = room.names();
    for command in ["run", "compare"] {
        refused(&[command, &bad, "--out", &room.path("out"), "--json"], &["bad.json", "load.mass_kg", "must be positive", "-1", "speling"]);
    }
    refused(&["scenario", "show", &bad], &["load.mass_kg"]);
    refused(&["scenario", "check", &bad], &["load.mass_kg"]);
    assert_eq!(room.names(), before);
}

#[test]
fn a_file_that_is_none_is_told_by_name() {
    let room = Room::new();
    let folder = room.path("");
    let not_json = room.write("not.json", "{ \"name\": ");
    let not_text = room.path("not-text.json");
    fs::write(&not_text, [0xff, 0xfe, 0x00]).unwrap();
    for command in [&["run"][..], &["compare"], &["scenario", "show"], &["scenario", "check"]] {
        let with = |file: &str, words: &[&str]| refused(&[command, &[file]].concat(), words);
        with(&room.path("missing.json"), &["missing.json", "No such file"]);
        with(&folder, &[&folder, "directory"]);
        with(&not_json, &["not.json", "line 1"]);
        with(&not_text, &["not-text.json"]);
        with(&room.write("list.json", "[]"), &["list.json"]);
        with(&room.write("empty.json", ""), &["empty.json"]);
    }
}

#[test]
fn one_wrong_file_among_good_ones_makes_a_check_fail() {
    let room = Room::new();
    let (good, bad) = (room.tips(), room.write("bad.json", "{}"));
    let output = call(&["scenario", "check", &good, &bad, &good]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stdout).lines().filter(|line| line.ends_with(": ok")).count(), 2);
    assert!(text(&output.stderr).contains("bad.json"));
}

/// What is known before a run, by hand: 1.6 g at 9.81 m/s^2 and mu = 1.4, on the spring of the
/// paper along x.
#[test]
fn a_check_advises_on_weight_frequencies_pulls_numbers_and_times() {
    let room = Room::new();
    let found = json_of(&["scenario", "check", "--json", &room.tips()])["scenarios"][0]["advice"].take();
    let is = |pointer: &str, value: f64| assert!((number(&found, pointer) / value - 1.0).abs() < 1e-9, "{pointer}: {found}");
    is("/weight_n", 0.0016 * 9.81);
    is("/slip_limit_n", 1.4 * 0.0016 * 9.81);
    is("/slip_torque_nm", 1.4 * 0.0016 * 9.81 * 0.008);
    // Along the spring the load is free of the other two modes, across only the torsion turns it.
    let along = (0.664_f64 / 0.0016).sqrt() / std::f64::consts::TAU;
    let modes = found["natural_frequencies"].as_array().unwrap();
    assert!(modes.iter().any(|mode| (number(mode, "/frequency_hz") / along - 1.0).abs() < 1e-9 && number(mode, "/turning_share") < 1e-9));
    assert_eq!(modes.len(), 2, "a turn about the tip has no stiffness without torsion: {modes:?}");
    assert!((number(&found, "/first_pulls/0/over_slip_limit")).abs() < 1e-9, "{found}");
    // The events are a grasp at 0, a release at 0.12 s and the end at 0.173 s.
    is("/numbers/phi", (0.664_f64 / 0.0016).sqrt() * 0.173 / 2.0);
    let speeds = [(0.0555, 0.0515_f64.hypot(0.01)), (0.0945, 0.01_f64.hypot(0.01))].map(|(time, length)| (time, length / time));
    let squares: f64 = 0.0555 * speeds[0].1 * speeds[0].1 + (0.12 - 0.0555) * speeds[1].1 * speeds[1].1;
    is("/numbers/epsilon", (squares / 0.12).sqrt() * (0.664_f64 * 0.0016).sqrt() / (1.4 * 0.0016 * 9.81));
    for key in ["quasi_static", "inertial", "rapier", "compare"] {
        let time = number(&found, &format!("/expected_time_s/{key}"));
        assert!(time > 0.0 && time < 10.0, "{key}: {time}");
    }
    let said = call(&["scenario", "check", &room.tips()]);
    let said = text(&said.stdout);
    for words in ["weight", "slip limit is 22 mN", "3.24 Hz (translation)", "spring 0: 0 of the slip limit", "epsilon", "Phi", "compare"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // Ants attach when they come: only their springs are known.
    let ants = json_of(&["scenario", "check", "--json", &room.four_ants(4.0)])["scenarios"][0]["advice"].take();
    assert_eq!((&ants["first_pulls"], &ants["numbers"]["phi"]), (&json!([]), &Value::Null));
    assert_eq!(ants["natural_frequencies"].as_array().unwrap().len(), 3);
}

/// Two posts whose centres are 8 mm apart, each of 5 mm: they overlap by 2 mm.
#[test]
fn obstacles_inside_each_other_are_warned_about() {
    let room = Room::new();
    let mut scene: Value = serde_json::from_str(&fs::read_to_string(room.tips()).unwrap()).unwrap();
    let post = |name: &str, x: f64| json!({ "name": name, "outline": { "disc": { "radius_m": 0.005 } }, "position_m": [x, 0.3] });
    scene["obstacles"] = json!([post("left", 0.0), post("right", 0.008)]);
    let odd = room.write("odd.json", &scene.to_string());
    let warning =
        "obstacles[1]: should not overlap another obstacle, as \"right\" does at the start, found a depth of 2.000e-3 m in \"left\"";
    for command in [&["scenario", "check"][..], &["run"]] {
        let output = call(&[command, &[&odd]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains(&format!("warning: {odd}: {warning}")), "{}", text(&output.stderr));
    }
    let output = call(&["scenario", "check", "--json", &odd, &room.tips()]);
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!((&found["scenarios"][0]["ok"], &found["scenarios"][0]["warnings"][0]["path"]), (&json!(true), &json!("obstacles[1]")));
    assert_eq!(found["scenarios"][1]["warnings"], json!([]));
    // A hair apart there is nothing to warn of.
    scene["obstacles"] = json!([post("left", 0.0), post("right", 0.010000001)]);
    let apart = call(&["scenario", "check", &room.write("apart.json", &scene.to_string())]);
    assert!(apart.stderr.is_empty(), "{}", text(&apart.stderr));
}

/// Stiff springs, a long time and a light load each make error control expensive. The program says
/// so before it starts, with what would help.
#[test]
fn long_runs_say_so_beforehand() {
    let room = Room::new();
    let plain: Value = serde_json::from_str(&fs::read_to_string(room.tips()).unwrap()).unwrap();
    let changed = |pointer: &str, value: f64| {
        let mut scene = plain.clone();
        scene["duration_s"] = json!(1.73);
        *scene.pointer_mut(pointer).unwrap() = json!(value);
        room.write("long.json", &scene.to_string())
    };
    let cases = [
        ("/springs/0/ring/radial_stiffness_n_per_m", 1e12, "springs", "softer springs"),
        ("/load/mass_kg", 1e-12, "springs", "a larger mass"),
        ("/duration_s", 1e6, "duration_s", "a shorter duration"),
    ];
    for (pointer, value, path, words) in cases {
        let file = changed(pointer, value);
        let output = call(&["scenario", "check", "--json", &file]);
        let printed = text(&output.stderr);
        assert!(printed.contains("`cohaul compare` may take") && printed.contains(words), "{printed}");
        let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
        assert_eq!(found["scenarios"][0]["warnings"][0]["path"], json!(path));
    }
    // The last case again: the first control period is over at once.
    let (file, state) = (room.path("long.json"), room.path("state.json"));
    let run = ["run", &file, "--backend", "inertial", "--tolerance", "1e-6", "--state", &state, "--stop-s", "1e-9"];
    let output = call(&run);
    assert!(text(&output.stderr).starts_with("warning: `cohaul run` may take"), "{}", text(&output.stderr));
    let short = call(&["scenario", "check", &room.tips()]);
    assert!(short.stderr.is_empty(), "{}", text(&short.stderr));
}

#[test]
fn nonsense_on_the_command_line_is_usage() {
    let room = Room::new();
    let file = room.tips();
    for command in ["run", "compare"] {
        for step in ["0", "-1", "nan", "inf", "-inf", "abc", "", "1e-400"] {
            refused(&[command, &file, &format!("--step-s={step}")], &["--step-s", "must be"]);
        }
        // Apart from its option, too, a number below zero is a value.
        refused(&[command, &file, "--step-s", "-0.001"], &["--step-s", "must be positive and finite, found -0.001"]);
        refused(&[command, &file, "--step-s", "1e-12"], &["--step-s: must be at least", "1e-6 of the control period, found 1e-12"]);
        for seed in ["-1", "1.5", "x", "18446744073709551616"] {
            refused(&[command, &file, &format!("--seed={seed}")], &["--seed"]);
        }
        refused(&[command, &file, "--friction", "sticky"], &["--friction", "aligned"]);
        refused(&[command], &["SCENARIO"]);
    }
    refused(&["run", &file, "--backend", "bullet"], &["--backend", "quasi-static", "inertial", "rapier"]);
    refused(&["run", &file, "--stop-s", "0.1"], &["--state"]);
    refused(&["run", &file, "--backend", "inertial", "--second-order"], &["--second-order", "applies to quasi-static only", "inertial"]);
    refused(&["run", &file, "--second-order", "--tolerance", "1e-6"], &["--second-order", "--tolerance"]);
    refused(&["compare", &file, "--seeds", "0"], &["--seeds", "at least 1"]);
    refused(&["compare", &file, "--agreement", "0"], &["--tolerance-path", "must be positive"]);
    refused(&[], &["Usage"]);
    refused(&["fly"], &["fly"]);
    assert_eq!(room.names(), ["tips.json"]);
}

/// Options of one backend are idle on the others, which is said and changes nothing.
#[test]
fn an_option_without_effect_is_told() {
    let room = Room::new();
    let scenario = room.shortened("paper/four-ants-four-springs.json", 1.0);
    let of = |args: &[&str]| {
        let output = call(&[&["run", scenario.as_str(), "--json"], args].concat());
        assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
        let warned: Vec<String> = text(&output.stderr).lines().filter(|line| line.contains("changes nothing")).map(str::to_owned).collect();
        (without_wall_time(serde_json::from_slice(&output.stdout).unwrap()), warned)
    };
    let (plain, warned) = of(&[]);
    assert!(warned.is_empty());
    let idle = of(&["--friction", "box", "--integrator", "euler"]);
    assert_eq!(idle.0, plain);
    let expected = [("--integrator", "inertial"), ("--friction", "rapier")];
    assert_eq!(
        idle.1,
        expected.map(|(option, backend)| format!("warning: {option}: changes nothing; it applies to {backend} only, found quasi-static"))
    );
    assert!(of(&["--backend", "rapier", "--friction", "box"]).1.is_empty());
    let tips = room.tips();
    for (args, expected) in [
        (&["compare", tips.as_str(), "--seeds", "2"][..], "--seeds: changes nothing; it applies to closed-loop only, found prescribed"),
        (
            &["compare", &tips, "--recorded-from", "rapier"],
            "--recorded-from: changes nothing; it applies to replayed only, found prescribed",
        ),
        (
            &["compare", &scenario, "--tier", "closed-loop", "--seeds", "1", "--tolerance", "1e-6", "--agreement", "0.1"],
            "--tolerance: changes nothing; it applies to prescribed, replayed only, found closed-loop",
        ),
    ] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}");
        assert!(text(&output.stderr).contains(&format!("warning: {expected}")), "{args:?}: {}", text(&output.stderr));
    }
    assert!(of(&["--backend", "inertial", "--integrator", "euler"]).1.is_empty());
}

#[test]
fn all_commands_print_help_and_exit_codes_are_told() {
    for command in [&[][..], &["run"], &["compare"], &["scenario"], &["scenario", "show"], &["scenario", "check"], &["scenario", "schema"]]
    {
        for flag in ["-h", "--help"] {
            let output = call(&[command, &[flag]].concat());
            assert_eq!(output.status.code(), Some(0), "{command:?}");
            assert!(text(&output.stdout).contains("Usage: cohaul"), "{command:?}");
            assert!(output.stderr.is_empty());
        }
    }
    assert!(text(&call(&["--help"]).stdout).contains("Exit codes:\n  0    done\n"));
    assert!(text(&call(&["--version"]).stdout).starts_with("cohaul "));
}

#[test]
fn the_seed_of_the_command_line_beats_the_scenarios() {
    let room = Room::new();
    let mut file: Value = serde_json::from_str(&fs::read_to_string(room.four_ants(4.0)).unwrap()).unwrap();
    file["seed"] = json!(3);
    let seeded = room.write("seeded.json", &file.to_string());
    let end = |args: &[&str]| {
        let value = json_of(&[&["run", &seeded, "--json"], args].concat());
        (value["seed"].clone(), value["final"].clone())
    };
    let (own, other) = (end(&[]), end(&["--seed", "4"]));
    assert_eq!((&own.0, &other.0), (&json!(3), &json!(4)));
    assert_ne!(own.1, other.1);
    assert_eq!(own, end(&["--seed", "3"]));
    // Seeds are whole 64-bit numbers, not floats.
    assert_eq!(end(&["--seed", "18446744073709551615"]).0, json!(u64::MAX));
}

/// All but how long it took.
/// What is not left out any more has no count, and the run is the same in every digit.
#[test]
fn kinds_of_work_can_be_kept_in() {
    let room = Room::new();
    let file = room.four_ants(2.0);
    let skipped = |value: &Value, kind: &str| number(value, &format!("/steps/skipped/{kind}"));
    let usual = json_of(&["run", &file, "--json"]);
    assert!(skipped(&usual, "distant_ants") > 0.0);
    assert_eq!(number(&usual, "/steps/share_skipped"), number(&usual, "/steps/n_skipped") / number(&usual, "/steps/n_steps"));
    let all_done = ["run", &file, "--json", "--no-skip", "distant-ants", "--no-skip", "still-tips"];
    let slow = json_of(&all_done);
    assert_eq!((skipped(&slow, "distant_ants"), skipped(&slow, "still_tips")), (0.0, 0.0));
    assert_eq!((&slow["final"], &slow["pull_force_n"]), (&usual["final"], &usual["pull_force_n"]));
    refused(&["run", &file, "--no-skip", "ants"], &["--no-skip", "distant-ants"]);
    refused(&["compare", &file, "--no-skip", "ants"], &["--no-skip", "stick-certificate"]);
}

fn without_wall_time(mut value: Value) -> Value {
    assert!(value.as_object_mut().unwrap().remove("wall_s").is_some());
    value
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_result() {
    let room = Room::new();
    let (ants, tips) = (room.four_ants(3.0), room.tips());
    for (file, stops) in [(&ants, ["1.3", "2.1"]), (&tips, ["0.02", "0.1201"])] {
        let within = ["quasi-static", "inertial"].map(|backend| vec!["--backend", backend, "--tolerance", "1e-5"]);
        for backend in BACKENDS.map(|backend| vec!["--backend", backend]).into_iter().chain(within) {
            let state = room.path("state.json");
            let plain = [&["run", file, "--json"], &backend[..]].concat();
            for stop in stops {
                let output = call(&[&plain[..], &["--state", &state, "--stop-s", stop]].concat());
                assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
                assert!(output.stdout.is_empty() && text(&output.stderr).contains("continues from"));
                assert!(Path::new(&state).exists());
            }
            let resumed = json_of(&[&plain[..], &["--state", &state]].concat());
            assert_eq!(without_wall_time(resumed), without_wall_time(json_of(&plain)), "{backend:?}");
            assert!(!Path::new(&state).exists(), "a run that is done leaves no state");
        }
    }
    assert_eq!(room.names().len(), 2, "{:?}", room.names());
}

#[test]
fn an_interrupted_run_with_files_writes_the_whole_trace() {
    let room = Room::new();
    let (file, state) = (room.tips(), room.path("state.json"));
    let [whole, resumed] = ["whole", "resumed"].map(|name| room.path(name));
    json_of(&["run", &file, "--json", "--out", &whole]);
    let output = call(&["run", &file, "--out", &resumed, "--state", &state, "--stop-s", "0.1"]);
    assert_eq!(output.status.code(), Some(130));
    assert!(!Path::new(&resumed).exists(), "half a run writes no folder");
    json_of(&["run", &file, "--json", "--out", &resumed, "--state", &state]);
    for name in ["trace.csv", "events.csv", "transitions.csv"] {
        let read = |folder: &str| fs::read_to_string(Path::new(folder).join(name)).unwrap();
        assert_eq!(read(&resumed), read(&whole), "{name}");
    }
}

/// A run that kept no rows cannot be resumed into a folder with all of them.
#[test]
fn a_state_without_rows_is_not_passed_off_as_a_whole_trace() {
    let room = Room::new();
    let (file, state, out) = (room.tips(), room.path("state.json"), room.path("out"));
    assert_eq!(call(&["run", &file, "--state", &state, "--stop-s", "0.1"]).status.code(), Some(130));
    refused(&["run", &file, "--state", &state, "--out", &out], &["state.json", "kept no trace"]);
    assert!(Path::new(&state).exists() && !Path::new(&out).exists());
}

#[test]
fn a_state_that_does_not_fit_is_refused_and_kept() {
    let room = Room::new();
    let (file, state) = (room.tips(), room.path("state.json"));
    assert_eq!(call(&["run", &file, "--state", &state, "--stop-s", "0.05"]).status.code(), Some(130));
    let good = fs::read_to_string(&state).unwrap();
    let with = |more: &[&str], words: &[&str]| {
        refused(&[&["run", &file, "--state", &state], more].concat(), words);
        assert_eq!(fs::read_to_string(&state).unwrap(), good);
    };
    with(&["--seed", "8"], &["state.json", "saved from the scenario"]);
    with(&["--backend", "rapier"], &["state.json", "quasi-static", "rapier"]);
    with(&["--step-s", "0.001"], &["state.json: must be of the run asked for, found another: --step-s ", " for 0.001"]);
    with(&["--backend", "inertial"], &["found another: --backend quasi-static for inertial"]);
    // As an older program would have written it; the mark of the line is that of its text.
    let (header, record) = good.split_once('\n').unwrap();
    let older = header[9..].replace(concat!("\"version\":\"", env!("CARGO_PKG_VERSION")), "\"version\":\"0.0.9");
    let mark: String = <sha2::Sha256 as sha2::Digest>::digest(&older)[..4].iter().map(|byte| format!("{byte:02x}")).collect();
    fs::write(&state, format!("{mark} {older}\n{record}")).unwrap();
    refused(&["run", &file, "--state", &state], &["state.json: was saved by another version of cohaul: version is \"0.0.9\", not"]);
    for garbage in ["", "{", "[]", "{\"tick\": 3}", &good[..good.len() / 2]] {
        fs::write(&state, garbage).unwrap();
        refused(&["run", &file, "--state", &state], &["state.json", "not a saved run"]);
        assert_eq!(fs::read_to_string(&state).unwrap(), garbage);
    }
    refused(&["run", &file, "--state", &room.path("")], &["directory"]);
}

#[test]
fn a_comparison_that_cannot_reach_its_tolerance_says_so() {
    let room = Room::new();
    let file = room.tips();
    let warning = |tolerance: &str| {
        let output = call(&["compare", &file, "--tolerance", tolerance, "--no-check-suggestions"]);
        assert_eq!(output.status.code(), Some(0));
        text(&output.stderr).to_owned()
    };
    let told = warning("1e-30");
    assert!(told.starts_with("warning: the reference error, ") && told.contains(" exceeds the tolerance, 1.000e-30 m and "), "{told}");
    assert!(!warning("1e-6").contains("exceeds the tolerance"));
}

/// Undamped, a load that is let go at 2.5 times its slip limit goes twice as far as one without
/// inertia; one that only turns differs although its position does not; a slow pull lags by v / w =
/// 0.25 mm on 67 mm; and a load that sticks gives no answer, whatever rounding an engine leaves.
#[test]
fn verdicts_name_what_is_known_to_part_the_paths() {
    let verdict = |file: &str| {
        let json = json_of(&["compare", &format!("scenarios/{file}"), "--json"]);
        json["tiers"]["prescribed"]["verdict"].as_str().unwrap().to_owned()
    };
    assert_eq!(verdict("analytic/release-jump.json"), "inertia and engine");
    assert_eq!(verdict("analytic/spin.json"), "inertia and engine");
    assert_eq!(verdict("analytic/centre-pull.json"), "agree");
    assert_eq!(verdict("stress/hold-below-limit.json"), "nothing moved");
}

/// A slow pull lags by 0.37 % of its path, the peak pull is 0.7 % above the slip limit, and the
/// peak speed is twice that of the tip. Tolerances on the other side of these numbers turn each
/// verdict.
#[test]
fn each_quantity_has_a_tolerance_of_its_own() {
    let verdicts = |options: &[&str]| {
        let json = json_of(&[&["compare", "scenarios/analytic/centre-pull.json", "--json"], options].concat());
        ["path", "pulls", "speed", "energy"].map(|of| {
            let verdict = json["tiers"]["prescribed"]["verdicts"][of]["verdict"].as_str().unwrap();
            verdict.starts_with("inertia")
        })
    };
    assert_eq!(verdicts(&[]), [false, false, true, false]);
    let others = ["--tolerance-pull", "0.001", "--tolerance-speed", "0.6", "--tolerance-energy", "0.002"];
    assert_eq!(verdicts(&[&["--tolerance-path", "0.003"], &others[..]].concat()), [true, true, false, true]);
    // The name of the option before.
    assert!(verdicts(&["--tolerance-share", "0.003"])[0]);
}

/// What a pathwise tier promises.
fn assert_pathwise(tier: &Value) {
    for part in ["inertia_effect", "engine_error", "reference_error"] {
        for (max, last) in [("position_max_m", "position_final_m"), ("heading_max_rad", "heading_final_rad")] {
            let (max, last) = (number(&tier[part], &format!("/{max}")), number(&tier[part], &format!("/{last}")));
            assert!(0.0 <= last && last <= max, "{part}: {last} {max}");
        }
    }
    // There are none at obstacles.
    assert!(tier.pointer("/numbers/zeta").unwrap().as_f64().is_none_or(|zeta| zeta >= 0.0));
    let frictionless = tier["numbers"]["epsilon"].is_null();
    assert!(frictionless || number(tier, "/numbers/epsilon") >= 0.0 && number(tier, "/predicted/while_driven_m") >= 0.0);
    assert!(tier["numbers"]["phi"].is_null() || number(tier, "/numbers/phi") > 0.0);
    let verdicts = ["agree", "inertia", "engine", "inertia and engine", "inconclusive", "nothing moved"];
    assert_eq!(tier["verdict"], tier["verdicts"]["path"]["verdict"]);
    for (quantity, unit) in [("path", "m"), ("heading", "rad"), ("pulls", "N"), ("speed", "m/s"), ("energy", "J")] {
        let of = &tier["verdicts"][quantity];
        assert!(verdicts.contains(&of["verdict"].as_str().unwrap()) && of["unit"] == unit, "{of}");
        for part in ["inertia_effect", "engine_error", "reference_error"] {
            assert!(number(of, &format!("/{part}")) >= 0.0, "{of}");
        }
        assert!(number(of, "/tolerance") > 0.0, "{of}");
    }
    let first = tier["first_divergence"].as_object().unwrap();
    assert!(first.contains_key("inertia_effect") && first.contains_key("engine_error"));
    for divergence in first.values().filter(|divergence| !divergence.is_null()) {
        assert!(number(divergence, "/time_s") > 0.0 && divergence.get("trigger").is_some());
    }
    let allowed = [
        "/numbers/phi",
        "/numbers/zeta",
        "/numbers/epsilon",
        "/predicted/while_driven_m",
        "/predicted/where_tips_stop_m",
        "/predicted/coasting_m",
        "/predicted/release_factor",
        "/predicted/estimated_m",
        "/predicted/estimated_is_negligible",
        "/largest_pull_over_slip_limit",
        "/first_divergence/inertia_effect",
        "/first_divergence/engine_error",
        "/time_step_order",
        "/trigger",
    ];
    let nulls = nulls(tier, "");
    assert!(nulls.iter().all(|pointer| allowed.iter().any(|end| pointer.ends_with(end))), "{nulls:?}");
}

fn assert_closed_loop(tier: &Value, n_seeds: u64) {
    assert_eq!(tier["n_seeds"], n_seeds);
    assert!(["agree", "inertia", "engine", "inconclusive", "decorrelated"].contains(&tier["verdict"].as_str().unwrap()));
    let measures = tier["measures"].as_array().unwrap();
    let names: Vec<_> = measures.iter().map(|measure| measure["name"].as_str().unwrap()).collect();
    for name in ["time_to_nest_s", "mean_speed_m_per_s", "pull_mean_n", "n_transporting"] {
        assert!(names.contains(&name), "{names:?}");
    }
    for measure in measures {
        let intervals = ["quasi_static", "inertial", "engine"].map(|part| (part, "mean_interval_95"));
        for (part, key) in intervals.into_iter().chain(["inertia_effect", "engine_error"].map(|part| (part, "interval"))) {
            assert!(number(&measure[part], "/n") <= n_seeds as f64 && number(&measure[part], "/sd") >= 0.0);
            let interval = &measure[part][key];
            assert!(interval.is_null() || number(interval, "/low") <= number(interval, "/high"));
        }
    }
    let allowed = ["/mean_interval_95", "/interval", "/n_needed", "/n_seeds_needed", "/reference_error", "/quasi_static_s", "/engine_s"];
    let nulls = nulls(tier, "");
    assert!(nulls.iter().all(|pointer| allowed.iter().any(|end| pointer.ends_with(end))), "{nulls:?}");
}

#[test]
fn every_shipped_scenario_compares() {
    let room = Room::new();
    for file in every_scenario() {
        let name = file.strip_prefix(scenarios()).unwrap().to_str().unwrap();
        // A thousand springs cost a hundred times as much as four.
        let most_s = if name.contains("thousand") { 0.1 } else { 2.0 };
        let file = room.shortened(name, most_s);
        let scene: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
        let value = json_of(&["compare", &file, "--json", "--seeds", "2"]);
        let tiers: Vec<_> = value["tiers"].as_object().unwrap().keys().map(String::as_str).collect();
        for tier in ["prescribed", "replayed"].iter().filter(|tier| tiers.contains(tier)) {
            let is_known = value["tiers"][tier]["predicted"]["estimated_m"].is_f64();
            assert!(is_known || !scene["obstacles"].is_null(), "{name}");
        }
        if scene["drive"]["kind"] == "ants" {
            assert_eq!(tiers, ["closed_loop", "replayed"], "{name}");
            assert_pathwise(&value["tiers"]["replayed"]);
            assert_closed_loop(&value["tiers"]["closed_loop"], 2);
        } else {
            assert_eq!(tiers, ["prescribed"], "{name}");
            assert_pathwise(&value["tiers"]["prescribed"]);
        }
        assert!(number(&value, "/wall_s") > 0.0 && value["seed"].is_u64() && value["scenario"].is_string());
    }
}

/// A report is asked for, stands with the other files, and is said to be there; in a folder or not
/// at all.
#[test]
fn a_report_of_a_run_is_written_when_it_is_asked_for() {
    let room = Room::new();
    let (file, out) = (room.tips(), room.path("out"));
    let output = call(&["run", &file, "--backend", "inertial", "--out", &out, "--report"]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    let report = Path::new(&out).join("report.html");
    assert!(text(&output.stdout).ends_with(&format!("\nreport\n  {}\n", report.display())), "{}", text(&output.stdout));
    let page = fs::read_to_string(report).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n") && page.contains("<title>one tip</title>"));
    // With --json nothing but that is said.
    json_of(&["run", &file, "--json", "--out", &out, "--report"]);
    assert!(names(out.as_ref()).contains(&"report.html".to_owned()));
    assert_eq!(call(&["run", &file, "--report"]).status.code(), Some(2));
}

/// Traces are written only when they are asked for; those in Parquet have the rows of those in CSV,
/// and say where they come from.
#[test]
fn traces_are_written_in_the_format_asked_for() {
    let room = Room::new();
    let (tips, out) = (room.tips(), room.path("out"));
    json_of(&["compare", &tips, "--json", "--out", &out, "--no-check-suggestions"]);
    let written = names(out.as_ref());
    assert!(!written.iter().any(|name| name.contains("trace") || name.contains("events")), "{written:?}");
    json_of(&["compare", &tips, "--json", "--out", &out, "--no-check-suggestions", "--traces", "parquet"]);
    assert!(BACKENDS.iter().all(|backend| names(out.as_ref()).contains(&format!("trace-prescribed-{backend}.parquet"))));
    json_of(&["run", &tips, "--json", "--out", &out]);
    let rows = rows_in(&out, "trace.csv");
    json_of(&["run", &tips, "--json", "--out", &out, "--traces", "parquet"]);
    let file = fs::File::open(Path::new(&out).join("trace.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let read: Vec<Vec<f64>> = reader
        .get_row_iter(None)
        .unwrap()
        .map(|row| row.unwrap().get_column_iter().take(7).map(|(_, field)| field.to_string().parse().unwrap()).collect())
        .collect();
    assert_eq!(read, rows);
    assert_eq!(reader.metadata().file_metadata().schema_descr().column(7).name(), "n_transporting");
    let entries = reader.metadata().file_metadata().key_value_metadata().unwrap();
    let entry = |key: &str| entries.iter().find(|entry| entry.key == key).unwrap().value.clone().unwrap();
    let manifest: Value = serde_json::from_str(&fs::read_to_string(Path::new(&out).join("manifest.json")).unwrap()).unwrap();
    assert_eq!(entry("cohaul.scenario_sha256"), manifest["scenario_sha256"].as_str().unwrap());
    assert_eq!((entry("cohaul.seed").as_str(), entry("cohaul.version")), ("7", manifest["version"].as_str().unwrap().to_owned()));
    let units: Value = serde_json::from_str(&entry("cohaul.units")).unwrap();
    assert_eq!((&units["x_m"], &units["turn_rate_rad_per_s"], &units["n_transporting"]), (&json!("m"), &json!("rad/s"), &Value::Null));
    refused(&["run", &tips, "--traces", "csv"], &["--out"]);
}

/// A comparison that is killed continues from the seeds that are done, to the same result.
#[test]
fn a_comparison_over_seeds_survives_being_killed() {
    let room = Room::new();
    let (ants, out) = (room.four_ants(20.0), room.path("out"));
    let args = ["compare", &ants, "--tier", "closed-loop", "--seeds", "6", "--json", "--out", &out];
    let journal = room.path("out.journal");
    let mut child = root::cohaul().args(args).stdout(Stdio::null()).spawn().unwrap();
    let has_record = || fs::read_to_string(&journal).is_ok_and(|text| text.lines().count() > 1);
    while !has_record() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before a seed was kept");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let output = call(&args);
    assert!(text(&output.stderr).contains("continues after"), "{}", text(&output.stderr));
    let mut found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert!(!Path::new(&journal).exists(), "the journal is gone with the work");
    let mut whole = json_of(&args[..7]);
    [&mut found, &mut whole].into_iter().for_each(|value| value["wall_s"] = Value::Null);
    assert_eq!(found, whole);
}

#[test]
fn compare_finds_differences_and_writes_every_tier() {
    let room = Room::new();
    let (ants, tips, out) = (room.four_ants(4.0), room.tips(), room.path("out"));
    let value = json_of(&["compare", &tips, "--json", "--out", &out, "--traces", "csv"]);
    // A release under load parts a run with inertia from one without.
    assert!(number(&value, "/tiers/prescribed/inertia_effect/position_max_m") > 1e-4);
    assert!(["overview-prescribed.svg", "report.html"].iter().all(|name| names(out.as_ref()).contains(&(*name).to_owned())));
    // Paths are compared between ticks as well; the rows of each tick are among them.
    let between = number(&value, "/tiers/prescribed/sampled_every_s");
    assert!(between < 0.01 && (0.01 / between).fract().min(1.0 - (0.01 / between).fract()) < 1e-9, "{between}");
    for backend in BACKENDS {
        let times: Vec<f64> = rows_in(&out, &format!("trace-prescribed-{backend}.csv")).iter().map(|row| row[0]).collect();
        assert!(times.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] < 1.001 * between), "{times:?}");
        assert!((0..18).all(|tick| times.contains(&(f64::from(tick) * 0.01))) && times.last() == Some(&0.173), "{times:?}");
    }
    let value = json_of(&["compare", &ants, "--json", "--seeds", "2", "--out", &out, "--traces", "csv"]);
    assert_pathwise(&value["tiers"]["replayed"]);
    assert!(number(&value, "/tiers/replayed/inertia_effect/position_max_m") > 1e-6);
    for tier in ["replayed", "closed-loop"] {
        for backend in BACKENDS {
            assert_ticks(&rows_in(&out, &format!("trace-{tier}-{backend}.csv")), 0.0025, 4.0);
        }
    }
    assert!(!names(out.as_ref()).iter().any(|name| name.contains("prescribed")), "an earlier output is gone as a whole");
    let one = json_of(&["compare", &ants, "--json", "--seeds", "1", "--tier", "closed-loop"]);
    assert_eq!(one["tiers"].as_object().unwrap().len(), 1);
    assert_eq!(one["tiers"]["closed_loop"]["verdict"], "decorrelated", "one seed says nothing of means");
}

#[test]
fn a_tier_that_the_drive_does_not_have_is_refused() {
    let room = Room::new();
    let (ants, tips) = (room.four_ants(1.0), room.tips());
    refused(&["compare", &tips, "--tier", "replayed"], &["--tier"]);
    refused(&["compare", &tips, "--tier", "closed-loop"], &["--tier"]);
    refused(&["compare", &ants, "--tier", "prescribed"], &["--tier"]);
    refused(&["compare", &ants, "--tier", "replayed", "--tier", "prescribed"], &["--tier"]);
    refused(&["compare", &ants, "--tier", "best"], &["--tier", "replayed", "closed-loop"]);
}

#[test]
fn what_show_prints_is_the_same_scenario() {
    let room = Room::new();
    let schema = json_of(&["scenario", "schema"]);
    let validator = jsonschema::validator_for(&schema).unwrap();
    for file in every_scenario() {
        let path = file.to_str().unwrap();
        let hash = Scenario::read(&file).unwrap().hash();
        let shown = json_of(&["scenario", "show", path]);
        assert!(validator.is_valid(&shown), "{path}");
        let again = room.write("again.json", &shown.to_string());
        assert_eq!(Scenario::read(again.as_ref()).unwrap().hash(), hash, "{path}");
        assert_eq!(json_of(&["scenario", "show", &again]), shown, "{path}");
        let output = call(&["scenario", "check", path, "--verbose"]);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains(&hash));
        // Comparisons of ants among obstacles take half a minute and more.
        assert!(text(&output.stderr).lines().all(|line| line.contains("`cohaul compare` may take")), "{}", text(&output.stderr));
    }
}

/// Steps of a control period: four tips are held and drag the load along curves, so that nothing
/// but the slip's turn is left to second order.
#[test]
fn steps_of_second_order_are_nearer() {
    let file = scenarios().join("paper/four-tips-held.json");
    let end = |options: &[&str]| {
        let found = json_of(&[&["run", file.to_str().unwrap(), "--json", "--no-estimate"], options].concat());
        assert_eq!(found["steps"]["n_not_converged"], 0, "{options:?}");
        [0, 1].map(|axis| number(&found, &format!("/final/position_m/{axis}")))
    };
    let exact = end(&["--tolerance", "1e-7"]);
    let error = |options: &[&str]| {
        let found = end(options);
        (found[0] - exact[0]).hypot(found[1] - exact[1])
    };
    let (first, second) = (error(&[]), error(&["--second-order"]));
    assert!(second < 0.1 * first, "{second} {first}");
}

/// What was asked for stands beside what was found, and it holds; a rung that no strides reach is
/// said, with the exit code of a missed check.
#[test]
fn a_tolerance_is_kept_and_told_or_the_exit_code_says_so() {
    let room = Room::new();
    let file = room.tips();
    for backend in ["quasi-static", "inertial"] {
        let found = json_of(&["run", &file, "--json", "--backend", backend, "--tolerance", "1e-6", "--tolerance-rad", "1e-3"]);
        let accuracy = |key: &str| number(&found, &format!("/accuracy/{key}"));
        assert_eq!((accuracy("asked_m"), accuracy("asked_rad"), &found["accuracy"]["is_met"]), (1e-6, 1e-3, &Value::Bool(true)));
        assert!(accuracy("estimated_m") > 0.0 && accuracy("estimated_m") <= 1e-6 && accuracy("estimated_rad") <= 1e-3);
        assert_eq!(found["step_s"], Value::Null);
        // Below the rounding of places of 0.1 m.
        let output = call(&["run", &file, "--backend", backend, "--tolerance", "1e-20"]);
        assert_eq!(output.status.code(), Some(1), "{backend}");
        assert!(text(&output.stdout).contains("the error bound exceeds the tolerance"));
    }
    refused(&["run", &file, "--backend", "rapier", "--tolerance", "1e-6"], &["--tolerance", "rapier"]);
    refused(&["run", &file, "--tolerance", "1e-6", "--step-s", "1e-3"], &["--tolerance", "--step-s"]);
    refused(&["run", &file, "--tolerance", "0"], &["--tolerance", "must be positive"]);
    refused(&["run", &file, "--tolerance-rad", "1e-3"], &["--tolerance"]);
}

/// A tip is drawn through the spring's root, where the spring has no direction. No tolerance is met
/// there, whatever the run thinks of its own error, and nobody is left to believe that it is: the
/// table, a warning, the exit code and what is for programs all say so, and a comparison comes to
/// no verdict.
#[test]
fn what_did_not_converge_is_told_wherever_somebody_looks() {
    let room = Room::new();
    let file = room.write(
        "root.json",
        r#"{ "name": "through the root", "duration_s": 0.53, "control_period_s": 0.01,
            "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
            "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.0081333 } } },
            "springs": [{ "root_m": [0.0122, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
                          "torsional_stiffness_nm_per_rad": 4.52e-4 }],
            "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0, 0.0385, 0], [1, -0.0122, 0]] }] } }"#,
    );
    for options in [&["--tolerance", "1e-4"][..], &[]] {
        let args = [&["run", &file, "--backend", "inertial", "--json"], options].concat();
        let output = call(&args);
        let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
        assert_eq!(found["steps"]["status"], "not_converged");
        assert!(number(&found, "/steps/n_not_converged") > 0.0);
        // A fixed step promises nothing. Its run lost most of its energy at the root.
        let misses_a_promise = !options.is_empty();
        let warning =
            if misses_a_promise { "warning: the run failed: macro-steps did not converge" } else { "warning: the run is doubtful: energy" };
        assert!(text(&output.stderr).contains(warning), "{options:?}: {}", text(&output.stderr));
        assert_eq!(output.status.code(), Some(i32::from(misses_a_promise)), "{options:?}");
        assert_eq!(found["accuracy"]["is_met"] == Value::Bool(false), misses_a_promise);
    }
    // However large a tolerance, and however small the run's own error.
    let output = call(&["run", &file, "--backend", "inertial", "--tolerance", "1"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("some macro-steps did not converge"), "{}", text(&output.stdout));
    // In the last control period before, the tip comes as near to the root as to leave one stride
    // without an answer.
    let near = std::fs::read_to_string(&file).unwrap().replace("0.53", "0.52");
    let found = json_of(&["compare", &room.write("near.json", &near), "--tolerance", "1e-3", "--json"]);
    let tier = &found["tiers"]["prescribed"];
    assert!(number(tier, "/backends/quasi_static/steps/n_not_converged") > 0.0, "{tier}");
    // The inertia effect is more than three times the reference error.
    let largest = &tier["edge_displacement"];
    assert!(
        number(largest, "/inertia_effect_m") > 0.0 && number(largest, "/inertia_effect_m") > 3.0 * number(largest, "/reference_error_m"),
        "{tier}"
    );
    assert_eq!(tier["verdict"], "inconclusive");
    assert_eq!(tier["suggested_changes"], Value::Array(Vec::new()));
}

#[test]
fn a_table_is_for_people_and_stands_on_standard_output_alone() {
    let room = Room::new();
    let (ants, tips) = (room.four_ants(2.0), room.tips());
    for args in [&["run", &tips][..], &["run", &ants], &["compare", &tips], &["compare", &ants, "--seeds", "2"]] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(0));
        // Progress is for terminals; what is said beside the table is a warning.
        let others = |line: &&str| !line.starts_with("warning: inertia is not negligible here");
        assert_eq!(text(&output.stderr).lines().find(others), None, "{args:?}");
        assert!(serde_json::from_str::<Value>(text(&output.stdout)).is_err());
        assert!(text(&output.stdout).lines().count() > 8);
        assert!(!text(&output.stdout).contains("NaN") && !text(&output.stdout).contains("inf "));
    }
}

/// As `| head -1` does: more is printed than a pipe holds, and nobody reads on.
#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let many = scenarios().join("stress/thousand-springs.json");
    for args in [&["scenario", "show", many.to_str().unwrap()][..], &["run", many.to_str().unwrap(), "--json"]] {
        let mut child = root::cohaul().args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut first = [0];
        let mut out = child.stdout.take().unwrap();
        if args[0] == "scenario" {
            out.read_exact(&mut first).unwrap();
        }
        drop(out);
        let output = child.wait_with_output().unwrap();
        // 128 and SIGPIPE, as of other programs.
        assert_eq!(output.status.code(), Some(141), "{args:?}");
        assert_eq!(text(&output.stderr), "", "{args:?}");
    }
}

/// At this step the verdicts of this scene are inertia, and no engine error beyond a tolerance.
#[test]
fn a_verdict_can_fail_a_comparison() {
    let scene = "scenarios/analytic/ramp-and-hold.json";
    let code = |kinds: &[&str]| {
        let options: Vec<&str> = kinds.iter().flat_map(|kind| ["--fail-on", kind]).collect();
        let output = call(&[&["compare", scene, "--json", "--step-s", "2e-4"], options.as_slice()].concat());
        assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok(), "the result is printed all the same");
        (output.status.code(), text(&output.stderr).to_owned())
    };
    assert_eq!(code(&["engine", "inconclusive"]).0, Some(0));
    let (failed, told) = code(&["engine", "inertia"]);
    assert_eq!(failed, Some(1));
    assert!(told.contains("--fail-on: the verdict on path is \"inertia\""), "{told}");
    refused(&["compare", scene, "--fail-on", "friction"], &["--fail-on", "inconclusive"]);
}

/// The run of a backend, laid beside the three, lies on its own path and off the others by what
/// these differ by.
#[test]
fn a_recorded_path_is_laid_beside_the_three() {
    let (room, scene) = (Room::new(), "scenarios/analytic/ramp-and-hold.json");
    let (run, out) = (room.path("run"), room.path("compared"));
    json_of(&["run", scene, "--backend", "inertial", "--tolerance", "1e-7", "--json", "--out", &run]);
    let value = json_of(&["compare", scene, "--json", "--out", &out, "--beside", &format!("{run}/trace.csv")]);
    let beside = &value["beside"];
    assert_eq!((beside["n"].as_u64(), beside["differences"][1]["backend"].as_str()), (Some(1001), Some("inertial")));
    let largest = |at: usize| number(beside, &format!("/differences/{at}/position_max_m"));
    let inertia = number(&value, "/tiers/prescribed/inertia_effect/position_max_m");
    let reference = number(&value, "/tiers/prescribed/reference_error/position_max_m");
    assert!(largest(1) <= reference + 1e-7, "{} {reference}", largest(1));
    // Paths are compared between ticks too, where the recorded one has no rows.
    assert!((largest(0) / inertia - 1.0).abs() < 0.01, "{} {inertia}", largest(0));
    assert!(fs::read_to_string(format!("{out}/report.html")).unwrap().contains("Beside a recorded path"));
    let wrong = room.write("wrong.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n0,0,0,0\n");
    refused(&["compare", scene, "--beside", &wrong], &["wrong.csv", "line 3, time_s: must be later than in the row before, found 0"]);
    let late = room.write("late.csv", "time_s,x_m,y_m,heading_rad\n7,0,0,0\n");
    refused(&["compare", scene, "--beside", &late], &["late.csv", "must have a time within the runs, found 7 to 7 s"]);
}
