//! `cohaul conformance` as its users meet it: what an engine refuses or does wrong is a row, and
//! the table goes on. Engines are scripts of the shell here.
#![cfg(unix)]

use std::process::Output;

use serde_json::Value;

#[path = "../common/root.rs"]
mod root;

fn call(args: &[&str]) -> Output {
    root::cohaul().arg("conformance").args(args).output().unwrap()
}

fn found(args: &[&str], code: i32) -> Value {
    let output = call(&[args, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Keys of the tests with this outcome.
fn keys(found: &Value, outcome: &str) -> Vec<String> {
    let tests = found["tests"].as_array().unwrap().iter();
    tests.filter(|test| test["outcome"] == outcome).map(|test| test["key"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn two_calls_print_the_same_and_the_files_are_whole() {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let [one, other] = [(), ()].map(|()| call(&["--engine", "inertial", "--out", out.to_str().unwrap()]));
    assert_eq!(one.status.code(), Some(0), "{}", String::from_utf8_lossy(&one.stderr));
    assert_eq!(one.stdout, other.stdout);
    let text = String::from_utf8(one.stdout).unwrap();
    assert!(text.contains("For a README:\ncohaul conformance: ") && text.contains("C1 slide"), "{text}");
    let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["conformance.md", "manifest.json", "report.html", "summary.json"]);
    let markdown = std::fs::read_to_string(out.join("conformance.md")).unwrap();
    assert!(markdown.starts_with("# Conformance of inertial") && markdown.contains("| C12 regrasp |"), "{markdown}");
}

/// Friction boxes are seen in the direction of slides, and the aligned model has none.
#[test]
fn a_friction_box_prefers_directions() {
    let spread = |args: &[&str]| {
        let found = found(args, 0);
        let tests = found["tests"].as_array().unwrap();
        tests.iter().find(|test| test["key"] == "C14").unwrap()["measures"][0]["relative_error"].as_f64().unwrap()
    };
    assert!(spread(&[]) < 1e-3 && spread(&["--friction", "box"]) > 0.1);
}

#[test]
fn an_engine_without_inertia_is_asked_what_does_not_need_it() {
    let found = found(&["--engine", "quasi-static"], 0);
    assert_eq!(keys(&found, "answered"), ["C3", "C8", "C9", "C13"]);
}

/// A still engine that takes no scene with obstacles and answers no number in one with a spin.
const STILL: &str = r#"while read -r line; do case "$line" in
*'"call":"start"'*'"obstacles":[{'*) echo '{"refused":"no obstacles"}';;
*'"call":"start"'*) case "$line" in *'"twist":[0.0,0.0,40.0]'*) pose='[NaN,0,0]';; *) pose='[0,0,0]';; esac; echo '{"name":"still"}';;
*'"call":"advance"'*) echo "{\"pose\":$pose}";;
*) echo '{}';; esac; done"#;

#[test]
fn refusals_and_faults_are_rows_and_the_table_goes_on() {
    let found = found(&["--engine", STILL, "--step-s", "0.01"], 1);
    assert_eq!(keys(&found, "refused"), ["C10a", "C10b", "C11a", "C11b"]);
    assert_eq!(keys(&found, "failed"), ["C2"]);
    let why = |key: &str| found["tests"].as_array().unwrap().iter().find(|test| test["key"] == key).unwrap()["why"].clone();
    assert_eq!(why("C10a"), "no obstacles");
    assert!(why("C2").as_str().unwrap().starts_with("still, at 0 s: advance: expected value"), "{}", why("C2"));
}

#[test]
fn an_engine_that_refuses_every_scene_has_a_table() {
    let found = found(&["--engine", r#"read -r line; echo '{"name":"shy","refused":"no scene at all"}'"#], 0);
    assert!(found["engine"]["name"] == "shy" && keys(&found, "refused").len() == found["tests"].as_array().unwrap().len(), "{found}");
}

/// A program that starts and then waits is ended in each test; one that never starts ends the call.
#[test]
fn engines_that_hang_are_named() {
    let hangs = r#"read -r line; echo '{"name":"slow"}'; sleep 600"#;
    let found = found(&["--engine", hangs, "--engine-timeout-s", "0.2"], 1);
    assert!(keys(&found, "failed").len() == found["tests"].as_array().unwrap().len(), "{found}");
    let output = call(&["--engine", "exit 3"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && error.contains("--engine: start: must answer each request"), "{error}");
}

#[test]
fn wrong_options_are_refused() {
    for (args, expected) in [
        (&["--step-s", "1"][..], "--step-s: must be from 1e-5 to 0.01, found 1"),
        (&["--engine", "inertial", "--friction", "box"], "--friction: applies to --engine rapier, found inertial"),
        (&["--engine", "inertial", "--engine-timeout-s", "1"], "--engine-timeout-s: applies to programs, found --engine inertial"),
    ] {
        let output = call(args);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(expected), "{error}");
    }
}
