//! What every command has in common: standard input, quiet and verbose
//! output, colour, completions, man pages and explanations of terms.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::process::Output;

use assert_cmd::Command;
use cohaul_report::glossary::entries;
use tempfile::tempdir;

#[path = "../common/help.rs"]
mod help;

use help::subcommands;

const SCENE: &str = "scenarios/analytic/release-jump.json";

fn program(args: &[&str]) -> Command {
    let mut program = Command::from_std(root::cohaul());
    program.args(args).env("COLUMNS", "80");
    program
}

fn call(args: &[&str]) -> Output {
    program(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Standard output of a call that succeeds.
fn printed(args: &[&str]) -> String {
    let output = call(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

#[test]
fn a_dash_is_standard_input() {
    let scene = fs::read_to_string(root::root().join(SCENE)).unwrap();
    let given = |args: &[&str], input: &str| {
        let output = program(args).write_stdin(input).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
        text(&output.stdout).to_owned()
    };
    assert_eq!(given(&["scenario", "show", "-"], &scene), printed(&["scenario", "show", SCENE]));
    assert!(given(&["scenario", "check", "-"], &scene).starts_with("standard input: ok"));
    let end = |json: String| serde_json::from_str::<serde_json::Value>(&json).unwrap()["final"].clone();
    assert_eq!(end(given(&["run", "-", "--json"], &scene)), end(printed(&["run", SCENE, "--json"])));
    let readings = "data/spring-calibration.csv";
    let table = fs::read_to_string(root::root().join(readings)).unwrap();
    assert_eq!(given(&["calibrate", "fit", "-", "--json"], &table), printed(&["calibrate", "fit", readings, "--json"]));
    let output = program(&["run", "-"]).write_stdin("{").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("standard input: line 1"), "{}", text(&output.stderr));
}

#[test]
fn quiet_commands_print_errors_only_and_colour_is_as_asked() {
    let warned = call(&["run", SCENE, "--integrator", "euler"]);
    assert!(text(&warned.stderr).contains("warning: --integrator"), "{}", text(&warned.stderr));
    let quiet = call(&["run", SCENE, "--integrator", "euler", "--quiet"]);
    assert_eq!((text(&quiet.stderr), text(&quiet.stdout).lines().count()), ("", text(&warned.stdout).lines().count()));
    let wrong = call(&["--quiet", "run", "no-such-file.json"]);
    assert!(text(&wrong.stderr).starts_with("error: no-such-file.json"), "{}", text(&wrong.stderr));
    assert_eq!(call(&["run", SCENE, "--quiet", "--verbose"]).status.code(), Some(2));

    let is_coloured = |args: &[&str]| {
        let output = call(args);
        (text(&output.stdout).contains('\u{1b}'), text(&output.stderr).contains('\u{1b}'))
    };
    assert_eq!(is_coloured(&["run", SCENE, "--integrator", "euler"]), (false, false));
    assert_eq!(is_coloured(&["run", SCENE, "--integrator", "euler", "--color", "always"]), (true, true));
    assert_eq!(is_coloured(&["--color=always", "run", "--help"]), (true, false));
    assert!(!is_coloured(&["run", SCENE, "--json", "--color", "always"]).0);
    assert_eq!(call(&["run", SCENE, "--color", "sometimes"]).status.code(), Some(2));
}

#[test]
fn completions_and_man_pages_name_every_command() {
    let names = subcommands(&printed(&["--help"]));
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(&["completions", shell]);
        assert!(names.iter().all(|name| script.contains(name.as_str())), "{shell}");
    }
    assert!(printed(&["man"]).contains(".TH cohaul 1"));
    let folder = tempdir().unwrap();
    printed(&["man", folder.path().to_str().unwrap()]);
    for name in names {
        let page = fs::read_to_string(folder.path().join(format!("cohaul-{name}.1"))).unwrap();
        assert!(page.contains(".TH cohaul-"), "{name}");
    }
}

#[test]
fn terms_are_explained_and_close_ones_suggested() {
    let all = printed(&["explain"]);
    for entry in entries() {
        assert!(all.replace('\n', " ").contains(entry.term), "{}", entry.term);
        let shown = printed(&["explain", entry.term]);
        assert!(shown.starts_with(entry.term) && shown.lines().all(|line| line.chars().count() <= 80), "{shown}");
    }
    assert_eq!(printed(&["explain", "ENGINE", "error"]), printed(&["explain", "engine error"]));
    let unknown = call(&["explain", "engine-eror"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("did you mean engine error"), "{}", text(&unknown.stderr));
    assert!(text(&call(&["explain", "xyzzy"]).stderr).contains("lists all terms"));
}
