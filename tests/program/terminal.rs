//! Help and results fit a terminal of 80 columns, and the pages of `-h` have at most 60 lines.

#[path = "../common/root.rs"]
mod root;

use std::process::Output;

use tempfile::tempdir;

#[path = "../common/help.rs"]
mod help;

use help::subcommands;

/// Columns of a terminal.
const WIDTH: usize = 80;
/// Most lines of a page that `-h` prints.
const MOST_LINES: usize = 60;
/// Most commands in the first list.
const MOST_FIRST: usize = 6;

const SCENE: &str = "scenarios/analytic/release-jump.json";
const ANTS: &str = "scenarios/paper/four-ants-four-springs.json";

fn call(args: &[&str]) -> Output {
    let mut program = root::cohaul();
    program.args(args).env_remove("COLUMNS").output().unwrap()
}

/// Standard output of a call that succeeds.
fn printed(args: &[&str]) -> String {
    let output = call(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Every command and subcommand, the program first.
fn all_commands() -> Vec<Vec<String>> {
    let mut commands = vec![Vec::new()];
    let mut at = 0;
    while at < commands.len() {
        let words: Vec<&str> = commands[at].iter().map(String::as_str).collect();
        let inner = subcommands(&printed(&[&words[..], &["--help"]].concat()));
        let nested: Vec<Vec<String>> = inner.into_iter().map(|name| [&commands[at][..], &[name]].concat()).collect();
        commands.extend(nested);
        at += 1;
    }
    assert!(commands.len() >= 25, "{commands:?}");
    commands
}

fn assert_fits(args: &[&str], text: &str) {
    let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > WIDTH).collect();
    assert!(long.is_empty(), "{args:?} prints lines beyond {WIDTH} columns:\n{}", long.join("\n"));
}

#[test]
fn every_help_fits_a_terminal_and_shows_an_example() {
    for command in all_commands() {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        for flag in ["-h", "--help"] {
            let args = [&words[..], &[flag]].concat();
            let help = printed(&args);
            assert!(help.starts_with(|first: char| first.is_uppercase()), "{args:?}: {help}");
            assert!(help.contains("Example") || !subcommands(&help).is_empty(), "{args:?} shows no example");
            assert_fits(&args, &help);
            let n_lines = help.lines().count();
            assert!(flag == "--help" || n_lines <= MOST_LINES, "{args:?} prints {n_lines} lines");
        }
    }
}

/// What `-h` leaves out, it names.
#[test]
fn short_help_names_every_option() {
    let options = |help: &str| -> Vec<String> {
        let words = help.split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '-');
        words.filter(|word| word.starts_with("--") && word.len() > 2).map(str::to_owned).collect()
    };
    for command in all_commands() {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let (short, long) = (printed(&[&words[..], &["-h"]].concat()), printed(&[&words[..], &["--help"]].concat()));
        let known = options(&short);
        let declared = long.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(options);
        for option in declared {
            assert!(known.contains(&option), "cohaul {} -h does not name {option}", command.join(" "));
        }
    }
}

#[test]
fn the_first_list_has_what_a_newcomer_needs() {
    let help = printed(&["-h"]);
    let first = help.split("\nCommands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
    let names: Vec<&str> = first.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.len() <= MOST_FIRST && ["run", "compare", "view"].iter().all(|name| names.contains(name)), "{names:?}");
    // The completions of the shell come from the commands themselves.
    let script = printed(&["completions", "fish"]);
    let listed = subcommands(&help);
    let completed = script.lines().filter_map(|line| line.split_once("__fish_cohaul_needs_command\" -f -a \"")?.1.split('"').next());
    let unlisted: Vec<&str> = completed.filter(|name| *name != "help" && !listed.iter().any(|known| known == name)).collect();
    assert!(unlisted.is_empty() && script.contains("-a \"merge\""), "{unlisted:?}");
    assert!(help.find("  sweep").unwrap() < help.find("  merge").unwrap() && !help.contains("sweep\n\n"), "{help}");
}

#[test]
fn printed_results_fit_a_terminal() {
    let room = tempdir().unwrap();
    let path = |name: &str| room.path().join(name).display().to_string();
    let [run, sweep, wide, forces, pulls] = ["run", "sweep", "wide", "forces", "new.json"].map(path);
    let readings = "data/spring-calibration.csv";
    let masses = "load.mass_kg=1e-3,2e-3";
    let teams = "drive.n_ants=2,4";
    let calls: &[&[&str]] = &[
        &["run", SCENE],
        &["run", SCENE, "--verbose"],
        &["run", ANTS, "--tips", "--out", &run],
        &["sweep", ANTS, "--vary", masses, "--vary", teams, "--seeds", "2", "--out", &sweep],
        &["sweep", ANTS, "--vary", masses, "--vary", teams, "--seeds", "2", "--out", &sweep, "--verbose"],
        &[
            "sweep",
            ANTS,
            "--vary",
            "load.mass_kg=1e-3",
            "--vary",
            "drive.pull_speed_m_per_s=0.05,0.06",
            "--vary",
            "ground.friction_coefficient=1.4",
            "--vary",
            "springs.*.damping_ratio=0.1",
            "--out",
            &wide,
        ],
        &["calibrate", "fit", readings],
        &["calibrate", "design", "--radial-stiffness-n-per-m", "0.664", "--torsional-stiffness-nm-per-rad", "4.52e-4"],
        &["calibrate", "forces", &run, "--tip-noise-m", "1e-4", "--out", &forces],
        &["calibrate", "behaviour", &run],
        &["colony", &run, "--like", ANTS, "--seeds", "2", "--backend", "quasi-static"],
        &["calibrate", "pulls", &forces, "--against", &forces, "--block-s", "5"],
        &["scenario", "check", SCENE, ANTS],
        &["scenario", "check", SCENE, "--verbose"],
        &["scenario", "new", &pulls],
        &["verify", "slide", "--quick"],
        &["verify", "slide", "--quick", "--verbose"],
        &["verify", "--list"],
        &["conformance"],
        &["conformance", "--engine", "quasi-static", "--verbose"],
        &["stress", "--list"],
        &["stress", "--quick", "--map", "step-stiffness"],
        &["check", "tests/baselines", "slide-spin-inertial"],
        &["regime", "--quick", "--scene", "excursion"],
        &["bench", SCENE, "--quick", "--repeats", "1"],
        &["paper", "--seeds", "2", "--backend", "quasi-static"],
        &["explain"],
        &["explain", "engine error"],
        &["explain", "formats"],
    ];
    for args in calls {
        let text = printed(args);
        // Paths are as long as they are.
        let without_paths: String =
            text.lines().filter(|line| !line.contains(room.path().to_str().unwrap())).map(|line| format!("{line}\n")).collect();
        assert_fits(args, &without_paths);
    }
}

#[test]
fn a_hash_is_printed_where_it_is_asked_for() {
    let has_hash =
        |text: &str| text.split_whitespace().any(|word| word.len() == 64 && word.chars().all(|letter| letter.is_ascii_hexdigit()));
    assert!(!has_hash(&printed(&["scenario", "check", SCENE])));
    assert!(has_hash(&printed(&["scenario", "check", SCENE, "--verbose"])));
}
