//! `cohaul gate` as its users meet it: variants of rapier that are known to be better, worse and
//! neither.

use std::fs;
use std::process::Output;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

#[path = "../common/root.rs"]
mod root;

/// Scenes in which the error falls with the step.
const SCENES: [&str; 3] =
    ["scenarios/analytic/slide-spin.json", "scenarios/analytic/ramp-and-hold.json", "scenarios/contact/oblique-impact.json"];

fn gate(folder: &TempDir, args: &[&str]) -> Output {
    root::cohaul().arg("gate").arg(folder.path()).args(args).output().unwrap()
}

/// A folder with the errors of rapier at 0.5 ms.
fn recorded() -> TempDir {
    let folder = tempdir().unwrap();
    let output = gate(&folder, &[&SCENES[..], &["--record", "--step-s", "5e-4"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("rapier.json: stored, rapier "), "{output:?}");
    folder
}

#[test]
fn a_smaller_step_is_better_a_larger_one_worse_and_the_same_one_the_same() {
    let folder = recorded();
    for (step, code, [better, same, worse]) in [("2.5e-4", 0, [3, 0, 0]), ("5e-4", 0, [0, 3, 0]), ("1e-3", 1, [0, 0, 3])] {
        let output = gate(&folder, &["--step-s", step, "--json"]);
        assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stdout));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!([&found["n_better"], &found["n_same"], &found["n_worse"]], [better, same, worse], "{step}: {found:#}");
    }
    // The stored step counts where none is asked for.
    assert_eq!(gate(&folder, &[]).status.code(), Some(0));
}

#[test]
fn a_pull_request_and_its_checks_get_the_result() {
    let folder = recorded();
    let [markdown, junit] = ["gate.md", "gate.xml"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let output = gate(&folder, &["--step-s", "1e-3", "--markdown", &markdown, "--junit", &junit]);
    assert_eq!(output.status.code(), Some(1));
    let [markdown, junit] = [markdown, junit].map(|path| fs::read_to_string(path).unwrap());
    assert!(markdown.starts_with("## cohaul gate\n\n**rapier ") && markdown.contains("| slide-spin | worse |"), "{markdown}");
    assert!(junit.contains("<testcase classname=\"gate.rapier\" name=\"slide-spin: path\">\n      <failure"), "{junit}");
}

#[test]
fn what_is_not_there_is_named() {
    let folder = tempdir().unwrap();
    let refused = |args: &[&str], code: i32, expected: &str| {
        let output = gate(&folder, args);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && error.contains(expected), "{expected}: {error}");
    };
    refused(&[], 2, "rapier.json: must hold stored errors of rapier, found no file; --record stores them");
    refused(&["scenarios/analytic/slide.json"], 2, "--record");
    refused(&["--engine", "exit 3"], 1, "--engine: start: must answer each request");
    fs::write(folder.path().join("rapier.json"), "{}").unwrap();
    refused(&[], 2, "must be a file of `cohaul gate --record`");
    let twice = [SCENES[0], SCENES[0], "--record"];
    refused(&twice, 2, "SCENARIO: must have names of their own, found slide-spin again");
}

/// An engine that fails is not stored, and is worse than any that does not.
#[cfg(unix)]
#[test]
fn an_engine_that_fails_is_not_stored() {
    let folder = tempdir().unwrap();
    let fails = r#"while read -r line; do case "$line" in *'"call":"start"'*) echo '{"name":"broken"}';; *) echo no;; esac; done"#;
    let output = gate(&folder, &[SCENES[0], "--engine", fails, "--record"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && error.contains("not stored: the engine must not fail on a scene"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
