//! Every way in which the program ends, and input that once ended it in other ways: by a panic,
//! without memory, or never.

#![cfg(unix)]

#[path = "../common/root.rs"]
mod root;

use std::collections::BTreeSet;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use cohaul_app::cli::EXIT_CODES;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

const SCENE: &str = "scenarios/analytic/centre-pull.json";
const ANTS: &str = "scenarios/paper/four-ants-four-springs.json";

fn program(args: &[&str]) -> Command {
    let mut command = root::cohaul();
    command.args(args);
    command
}

fn call(args: &[&str]) -> Output {
    program(args).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Exit code 2, nothing on standard output, and a message with all of `words`.
fn refused(args: &[&str], words: &[&str]) {
    let output = call(args);
    let error = told(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert!(output.stdout.is_empty(), "{args:?}");
    assert!(words.iter().all(|word| error.contains(word)), "{args:?}: {error}");
}

fn path(room: &TempDir, name: &str) -> String {
    room.path().join(name).to_str().unwrap().to_owned()
}

/// The scene with one value put in another's place.
fn changed(room: &TempDir, scene: &str, at: &str, put: Value) -> String {
    let mut file: Value = serde_json::from_str(&fs::read_to_string(root::root().join(scene)).unwrap()).unwrap();
    *file.pointer_mut(at).unwrap_or_else(|| panic!("{at}")) = put;
    let name = path(room, "changed.json");
    fs::write(&name, file.to_string()).unwrap();
    name
}

/// Ends of the program with everything that it takes for them. An internal error is a defect, so
/// that no command line ends in one: a unit test of `cli` has it.
#[test]
fn every_exit_code_occurs() {
    let room = tempdir().unwrap();
    let state = path(&room, "state");
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let ends = [
        (0, program(&["run", SCENE]).output()),
        (1, program(&["compare", "scenarios/analytic/release-jump.json", "--fail-on", "inertia"]).output()),
        (2, program(&["run", "missing.json"]).output()),
        (2, program(&["fly"]).output()),
        // Nobody can write below this folder.
        (5, program(&["run", SCENE, "--out", "/proc/nowhere/out"]).output()),
        (5, program(&["scenario", "new", "/proc/nowhere/scene.json"]).output()),
        (5, program(&["run", SCENE, "--state", "/proc/nowhere/state", "--stop-s", "0.1"]).output()),
        (5, program(&["run", SCENE]).stdout(full()).output()),
        (5, program(&["--help"]).stdout(full()).output()),
        (130, program(&["run", SCENE, "--state", &state, "--stop-s", "0.1"]).output()),
        (141, program(&["scenario", "schema"]).stdout(writer.try_clone().unwrap()).output()),
        (141, program(&["--help"]).stdout(writer).output()),
    ];
    let mut seen = BTreeSet::from([3]);
    for (code, output) in ends {
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(i32::from(code)), "{}", told(&output));
        assert_eq!(told(&output).is_empty(), [0, 141].contains(&code), "{code}: {}", told(&output));
        seen.insert(code);
    }
    assert!(EXIT_CODES.iter().all(|(code, _)| seen.contains(code)), "{seen:?}");
    assert_eq!(EXIT_CODES.len(), seen.len());
    let help = String::from_utf8(call(&["--help"]).stdout).unwrap();
    assert!(EXIT_CODES.iter().all(|(code, meaning)| help.contains(&format!("  {code:<4} {meaning}"))), "{help}");
}

#[test]
fn a_comparison_whose_report_cannot_be_written_is_printed() {
    let output = call(&["compare", SCENE, "--out", "/proc/nowhere/out"]);
    assert_eq!(output.status.code(), Some(5));
    assert!(told(&output).contains("/proc/nowhere"), "{}", told(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("within all tolerances"), "{output:?}");
}

#[test]
fn numbers_that_nothing_finite_follows_from_are_refused() {
    let room = tempdir().unwrap();
    for tolerance in ["--tolerance", "--tolerance-path", "--tolerance-heading", "--tolerance-pull"] {
        for size in ["5e-324", "1e308"] {
            refused(&["compare", SCENE, tolerance, size], &[tolerance, "must be from 1e-50 to 1e50", size]);
        }
    }
    refused(&["run", SCENE, "--tolerance", "5e-324"], &["--tolerance", "must be from 1e-50"]);
    for seeds in ["1000000000000", "9223372036854775808"] {
        refused(&["compare", ANTS, "--seeds", seeds], &["--seeds: must be at most 100000", seeds]);
    }
    let length = changed(&room, SCENE, "/springs/0/rest_length_m", json!(5e-324));
    refused(&["run", &length], &["springs[0].rest_length_m: must be at least 1e-50, found 5e-324"]);
}

/// The bound of a size is asked for before the load and the wall are laid over each other.
#[test]
fn a_load_without_bounds_is_refused_beside_a_wall() {
    let room = tempdir().unwrap();
    let mut file: Value = serde_json::from_str(&fs::read_to_string(root::root().join(SCENE)).unwrap()).unwrap();
    let wall = json!({ "name": "wall", "outline": { "polyline": { "points_m": [[1, -1], [1, 1]] } } });
    file["obstacles"] = json!([wall]);
    for radius in [1e200, 1e300] {
        file["load"]["radius_m"] = json!(radius);
        file["load"]["inertia_kg_m2"] = json!(1);
        let name = path(&room, "huge.json");
        fs::write(&name, file.to_string()).unwrap();
        refused(&["scenario", "check", &name], &["load.radius_m: must be at most 1e50 in size", &format!("{radius:?}")]);
    }
}

#[test]
fn an_obstacle_does_not_set_off_within_rounding_of_the_start() {
    let room = tempdir().unwrap();
    let mut file: Value = serde_json::from_str(&fs::read_to_string(root::root().join(SCENE)).unwrap()).unwrap();
    let path_of = |first: f64| json!({ "waypoints": [[first, 9, 9, 0], [1, 9, 9.1, 0]] });
    file["obstacles"] = json!([{ "name": "pusher", "outline": { "disc": { "radius_m": 0.01 } }, "path": path_of(5e-324) }]);
    let name = path(&room, "early.json");
    fs::write(&name, file.to_string()).unwrap();
    refused(&["run", &name, "--backend", "rapier"], &["obstacles[0].path.waypoints[0][0]: must be zero or at least", "found 5e-324"]);
    file["obstacles"][0]["path"] = path_of(0.0);
    fs::write(&name, file.to_string()).unwrap();
    assert_eq!(call(&["run", &name, "--backend", "rapier"]).status.code(), Some(0));
}

/// A pipe that never ends is read as far as the largest scenario, and no further.
#[test]
fn endless_input_is_read_up_to_a_bound() {
    for command in [&["run", "-"][..], &["sweep", "-", "--out", "/proc/nowhere"]] {
        let mut child = program(command).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        let zeros = [0_u8; 1 << 16];
        let mut sent = 0;
        while input.write_all(&zeros).is_ok() {
            sent += zeros.len();
            assert!(sent < 1 << 30, "it is read without an end");
        }
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(told(&output).contains("standard input: cannot be read: must have at most 64 MiB"), "{}", told(&output));
    }
    refused(&["run", "/dev/zero"], &["/dev/zero: cannot be read: must have at most 64 MiB, found more"]);
    refused(&["run", SCENE, "--state", "/dev/zero"], &["/dev/zero: is not a saved run"]);
}

#[test]
fn messages_are_of_a_length_to_read() {
    let room = tempdir().unwrap();
    let mut file: Value = serde_json::from_str(&fs::read_to_string(root::root().join(SCENE)).unwrap()).unwrap();
    for key in 0..10_000 {
        file["load"][format!("{}{key}", "abc".repeat(key % 40))] = json!("x".repeat(key));
    }
    file["k".repeat(100_000)] = json!("v".repeat(100_000));
    let name = path(&room, "faults.json");
    fs::write(&name, file.to_string()).unwrap();
    let output = call(&["run", &name]);
    let error = told(&output);
    assert_eq!(output.status.code(), Some(2));
    assert!(error.lines().count() < 60 && error.len() < 40_000, "{} lines, {} bytes", error.lines().count(), error.len());
    assert!(error.lines().last().unwrap().contains("more"), "{error}");
}

#[test]
fn threads_are_bounded_whatever_the_environment_asks_for() {
    let output = program(&["explain", "slipping"]).env("RAYON_NUM_THREADS", "100000").output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let n = std::thread::available_parallelism().unwrap().get();
    let warning = format!("RAYON_NUM_THREADS: {} threads are used, 8 for each of {n} processors, found 100000", 8 * n);
    assert!(told(&output).contains(&warning), "{}", told(&output));
    // As many threads as are asked for would take minutes to start, and gigabytes.
    let mut child = program(&["check", "tests/baselines"])
        .env("RAYON_NUM_THREADS", "100000")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let tasks = || fs::read_dir(Path::new("/proc").join(child.id().to_string()).join("task")).map_or(0, Iterator::count);
    let mut most = 0;
    for _ in 0..20 {
        most = most.max(tasks());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.stdout.take().unwrap().read_to_end(&mut Vec::new()).unwrap();
    child.wait().unwrap();
    assert!(most <= 8 * n + 8, "{most}");
}
