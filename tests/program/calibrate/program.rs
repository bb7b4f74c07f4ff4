//! `cohaul calibrate` as its users meet it.

use std::fs;
use std::process::Output;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

fn call(args: &[&str]) -> Output {
    crate::root::cohaul().args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn json_of(args: &[&str]) -> Value {
    let output = call(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Exit code 2, nothing on standard output, and a text with all of `words`.
fn refused(args: &[&str], words: &[&str]) {
    let output = call(args);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert_eq!(text(&output.stdout), "", "{args:?}");
    assert!(words.iter().all(|word| error.contains(word)), "{args:?}: {error}");
}

struct Room(TempDir);

impl Room {
    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, content: &str) -> String {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }
}

const EXAMPLE: &str = "data/spring-calibration.csv";

/// The commands of three pages of the book, one after the other, with their outputs in another
/// folder.
#[test]
fn the_commands_of_the_book_run_one_after_the_other() {
    for (page, n) in [("force-sensor", 6), ("behaviour", 6), ("colony", 3)] {
        let room = Room(tempdir().unwrap());
        let text_of_page = fs::read_to_string(crate::root::root().join(format!("docs/src/{page}.md"))).unwrap().replace("\\\n", " ");
        let of_program = |line| ["cargo run --release -- ", "cohaul "].iter().find_map(|start| str::strip_prefix(line, start));
        let commands: Vec<&str> = text_of_page.lines().filter_map(of_program).collect();
        assert_eq!(commands.len(), n, "{commands:?}");
        for command in commands {
            let words: Vec<String> =
                command.split_whitespace().map(|word| word.strip_prefix("out/").map_or(word.to_owned(), |name| room.path(name))).collect();
            let output = call(&words.iter().map(String::as_str).collect::<Vec<_>>());
            assert_eq!(output.status.code(), Some(0), "{command}: {}", text(&output.stderr));
        }
    }
}

#[test]
fn a_spring_is_fitted_and_its_fit_reads_the_forces_of_a_run() {
    let room = Room(tempdir().unwrap());
    let (spring, run, forces) = (room.path("spring"), room.path("run"), room.path("forces"));
    let output = call(&["calibrate", "fit", EXAMPLE, "--range-m", "0", "0.008", "--out", &spring]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    assert!(["kappa_rho", "kappa_tau", "secant at 8 mm", "over 0 m to 8.000 mm"].iter().all(|word| printed.contains(word)), "{printed}");
    let mut names: Vec<String> = fs::read_dir(&spring).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["calibration.json", "calibration.svg", "calibration.txt", "manifest.json", "residuals.csv"]);
    assert_eq!(fs::read_to_string(format!("{spring}/calibration.txt")).unwrap(), printed);
    let svg = fs::read_to_string(format!("{spring}/calibration.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>") && !svg.contains("NaN") && !svg.contains("inf"));
    assert!(["radial", "tangential-2", "tangential-3", "trial 5", "95 % intervals"].iter().all(|word| svg.contains(word)));
    let residuals = fs::read_to_string(format!("{spring}/residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 151);
    assert_eq!(residuals.matches(",false").count(), 10, "5 trials with two radial points beyond 8 mm");

    let scenario = short_scenario(&room);
    assert_eq!(call(&["run", &scenario, "--tips", "--out", &run]).status.code(), Some(0));
    let calibration = format!("{spring}/calibration.json");
    let found = json_of(&["calibrate", "forces", &run, "--calibration", &calibration, "--tip-noise-m", "1e-4", "--out", &forces, "--json"]);
    let all = found["springs"].as_array().unwrap().last().unwrap();
    assert!(all["spring"].is_null() && all["mean_error_n"].as_f64().unwrap() > 0.0, "{found}");
    // Ants stretch springs to 44 mm, far beyond the 8 mm of the fit.
    let warnings = found["warnings"].as_array().unwrap();
    assert!(
        warnings.iter().any(|warning| warning.as_str().unwrap().contains(" tips are beyond the range of the fit, 8.000 mm or ")),
        "{found}"
    );
    let table = fs::read_to_string(format!("{forces}/forces.csv")).unwrap();
    assert_eq!(table.lines().count() as u64 - 1, all["n"].as_u64().unwrap());
    assert!(fs::read_to_string(format!("{forces}/forces.svg")).unwrap().contains("force on tip (mN)"));
}

fn short_scenario(room: &Room) -> String {
    let file = crate::root::root().join("scenarios/paper/four-ants-four-springs.json");
    let mut scenario: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    scenario["duration_s"] = 4.0.into();
    room.write("scenario.json", &scenario.to_string())
}

/// From a run to the behaviour of its ants and back to their pulls, through files.
#[test]
fn the_behaviour_of_a_run_is_fitted_and_its_pulls_are_compared() {
    let room = Room(tempdir().unwrap());
    let (run, behaviour, forces) = (room.path("run"), room.path("behaviour"), room.path("forces"));
    assert_eq!(call(&["run", &short_scenario(&room), "--tips", "--out", &run]).status.code(), Some(0));
    let found = json_of(&["calibrate", "behaviour", &run, "--tip-noise-m", "1e-6", "--out", &behaviour, "--json"]);
    // The noise is overstated: exact tips are nearer to the fit.
    assert!(found["steering"]["residual_rms_m"].as_f64().unwrap() < 1e-9, "{found}");
    let speed = found["steering"]["pull_speed_m_per_s"]["value"].as_f64().unwrap();
    assert!((speed - 0.0252).abs() < 1e-6, "the speed of the default preset: {found}");
    assert!(found["n_releases"].as_u64().unwrap() > 5 && found["release"]["bins"].is_array(), "{found}");
    let printed = fs::read_to_string(format!("{behaviour}/behaviour.txt")).unwrap();
    assert!(["zeta", "F_m", "D_r", "beta", "speed in Search"].iter().all(|word| printed.contains(word)), "{printed}");
    let svg = fs::read_to_string(format!("{behaviour}/releases.svg")).unwrap();
    assert!(svg.contains("release rate (1/s)") && !svg.contains("NaN"));
    let bins = fs::read_to_string(format!("{behaviour}/releases.csv")).unwrap();
    assert!(bins.starts_with("pull_low_n,pull_high_n,mean_pull_n,duration_s,releases,expected_releases"), "{bins}");

    assert_eq!(call(&["calibrate", "forces", &run, "--out", &forces]).status.code(), Some(0));
    let same = json_of(&["calibrate", "pulls", &forces, "--against", &forces, "--block-s", "0.5", "--permutations", "99", "--json"]);
    assert!(same["distance"] == 0.0 && same["p_value"] == 1.0, "{same}");
    let cut = call(&["calibrate", "pulls", &forces, "--against", &forces, "--permutations", "99"]);
    assert!(cut.status.success() && text(&cut.stderr).contains("the tables are cut into blocks of"), "{}", text(&cut.stderr));
    refused(&["calibrate", "pulls", &forces, "--against", &forces, "--block-s", "1000"], &["assignments", "found 1 and 1"]);
    refused(&["calibrate", "behaviour", &run, "--pace", "aged"], &["--decision-period-s", "found none"]);
    let tips = format!("{run}/tips.csv");
    refused(&["calibrate", "behaviour", &tips], &["tips in world axes need --scenario"]);
}

/// Pulls of dashpots go with speeds, which tips do not tell.
#[test]
fn forces_of_damped_springs_are_told_to_lack_their_dashpots() {
    let room = Room(tempdir().unwrap());
    let run = room.path("run");
    let damped: String =
        fs::read_to_string(short_scenario(&room)).unwrap().replace("\"radial_stiffness", "\"damping_ratio\": 0.5, \"radial_stiffness");
    let damped = room.write("damped.json", &damped);
    for backend in ["inertial", "quasi-static"] {
        assert_eq!(call(&["run", &damped, "--backend", backend, "--tips", "--out", &run]).status.code(), Some(0));
        let output = call(&["calibrate", "forces", &run]);
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stderr).contains("warning: the forces of the springs' dashpots are missing"), "{}", text(&output.stderr));
    }
    // The rate-independent run has left them out as well.
    assert_eq!(call(&["run", &damped, "--rate-independent", "--tips", "--out", &run]).status.code(), Some(0));
    assert!(!text(&call(&["calibrate", "forces", &run]).stderr).contains("dashpots"));
}

/// Through files, against the pulls of `trace.csv`.
#[test]
fn forces_of_a_run_folder_are_those_of_its_trace() {
    let room = Room(tempdir().unwrap());
    let (run, forces) = (room.path("run"), room.path("forces"));
    assert_eq!(call(&["run", &short_scenario(&room), "--tips", "--full-trace", "--out", &run]).status.code(), Some(0));
    assert_eq!(call(&["calibrate", "forces", &run, "--out", &forces]).status.code(), Some(0));
    let mut trace = csv::Reader::from_path(format!("{run}/trace.csv")).unwrap();
    let names = trace.headers().unwrap().clone();
    let column = |name: &str| names.iter().position(|other| other == name).unwrap();
    let mut pulls = std::collections::BTreeMap::new();
    for row in trace.records().map(Result::unwrap) {
        for spring in 0..4 {
            if let Ok(x) = row[column(&format!("pull_x_{spring}_n"))].parse::<f64>() {
                let y: f64 = row[column(&format!("pull_y_{spring}_n"))].parse().unwrap();
                pulls.insert((row[0].to_owned(), spring), [x, y]);
            }
        }
    }
    let mut n = 0;
    for row in csv::Reader::from_path(format!("{forces}/forces.csv")).unwrap().records().map(Result::unwrap) {
        let [x, y] = pulls[&(row[0].to_owned(), row[1].parse::<i32>().unwrap())];
        let found: Vec<f64> = row.iter().rev().take(2).map(|field| field.parse().unwrap()).collect();
        // Rounding of positions of order 0.1 m times 0.7 N/m; numbers are written with all their
        // digits.
        assert!((found[1] - x).abs() < 1e-15 && (found[0] - y).abs() < 1e-15, "{row:?}: {x} {y}");
        n += 1;
    }
    assert!(n > 500 && n == pulls.len(), "{n} of {}", pulls.len());
}

#[test]
fn bad_measurements_are_named_line_by_line() {
    let room = Room(tempdir().unwrap());
    let head = "case,trial,displacement_m,swing_rad,force_n,force_sd_n\n";
    let fit = |name: &str, content: &str, words: &[&str]| {
        let file = room.write(name, content);
        refused(&["calibrate", "fit", &file, "--json"], &[&[&*file], words].concat());
    };
    let rows = |rows: &str| format!("{head}{rows}");
    fit("nan.csv", &rows("radial,1,0.001,,NaN,1e-4\n"), &["line 2, force_n: must be a finite number, found NaN"]);
    fit(
        "sd.csv",
        &rows("radial,1,0.001,,1e-3,-1e-4\nradial,1,0.002,,1e-3,0\n"),
        &["line 2, force_sd_n: must be positive", "line 3, force_sd_n"],
    );
    fit(
        "mm.csv",
        &rows("1,1,0.001,,1e-3,1e-4\n1,1,8,,5e-3,1e-4\n"),
        &["line 3, displacement_m: must be below 0.0238 m", "in millimetres?", "found 8"],
    );
    fit(
        "degrees.csv",
        &rows("2,1,,30,1e-3,1e-4\n3,1,,-30,1e-3,1e-4\n"),
        &["below 1.0348 rad", "below 1.5708 rad", "in degrees?), found -30"],
    );
    fit(
        "case.csv",
        &rows("sideways,1,0.001,,1e-3,1e-4\n"),
        &["line 2, case: must be radial, tangential-2 or tangential-3", "found sideways"],
    );
    fit("both.csv", &rows("radial,1,0.001,0.1,1e-3,1e-4\n"), &["line 2, swing_rad: must be empty in a row of case radial"]);
    fit("few.csv", &rows("radial,1,0.001,,1e-3,1e-4\nradial,1,0,,0,1e-4\n"), &["case radial: must have two points or more", "found 1"]);
    fit("none.csv", head, &["must hold measurements, found none"]);
    fit("short.csv", &rows("radial,1,0.001\n"), &["line 2: must have 6 fields, as the header, found 3"]);
    fit("trial.csv", &rows("radial,,0.001,,1e-3,1e-4\n"), &["line 2, trial: must have a name"]);
    fit("column.csv", "case,trial,displacement_mm,force_n\n", &["found displacement_mm"]);
    fit("missing.csv", "case,trial,displacement_m\n", &["must have columns force_n"]);
    fit("empty.csv", "", &["must have columns case, trial, force_n"]);
    refused(&["calibrate", "fit", "no-such.csv"], &["no-such.csv: cannot be read"]);
    refused(&["calibrate", "fit", EXAMPLE, "--confidence", "1"], &["--confidence: must be between 0 and 1, found 1"]);
    refused(&["calibrate", "fit", EXAMPLE, "--range-m", "0.01", "0.002"], &["--range-m: LOW must be below HIGH"]);
    refused(
        &["calibrate", "fit", EXAMPLE, "--folded-member-length-m", "11.9"],
        &["folded_member_length_m: must be below 1 m (is it in millimetres?), found 11.9"],
    );
    let unknown = room.write("dimensions.json", "{\"member_width_mm\": 0.8}");
    refused(&["calibrate", "fit", EXAMPLE, "--dimensions", &unknown], &["dimensions.json", "member_width_mm"]);
}

#[test]
fn bad_recordings_are_named_line_by_line() {
    let room = Room(tempdir().unwrap());
    let forces = |content: &str, words: &[&str]| {
        let file = room.write("tips.csv", content);
        refused(&["calibrate", "forces", &file], words);
    };
    let root = "time_s,spring,tip_in_root_x_m,tip_in_root_y_m\n";
    forces(&format!("{root}0,0,28.0,0\n"), &["line 2, tip_in_root_x_m: must lie within 100 rest lengths", "in millimetres?"]);
    forces(&format!("{root}0,0,0.028,0\n1,0,0.028,0\n0.5,0,0.028,0\n"), &["line 4, time_s: must not go back, found 0.5"]);
    forces(&format!("{root}0,0,0.028,0\n0,0,0.029,0\n"), &["line 3, spring: must stand once in a frame"]);
    forces(
        &format!("{root}0,-1,0.028,inf\n"),
        &["line 2, spring: must be a whole number", "line 2, tip_in_root_y_m: must be a finite number, found inf"],
    );
    forces(root, &["must hold tips, found none"]);
    let world = "time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m\n0,7,0,0,0,0.04,0\n";
    forces(world, &["tips in world axes need --scenario"]);
    let file = room.write("world.csv", world);
    refused(
        &["calibrate", "forces", &file, "--scenario", "scenarios/paper/four-ants-four-springs.json"],
        &["line 2, spring: must be below 4"],
    );
    let run = room.path("run");
    assert_eq!(call(&["run", "scenarios/analytic/qs-ref-1.json", "--out", &run]).status.code(), Some(0));
    refused(&["calibrate", "forces", &run], &["must contain tips.csv", "--tips"]);
    refused(
        &["calibrate", "forces", &file, "--calibration", EXAMPLE],
        &["spring-calibration.csv: must be what `cohaul calibrate fit --json` prints"],
    );
}

#[test]
fn a_design_is_one_object_and_what_cannot_be_built_is_refused() {
    let wanted = ["calibrate", "design", "--radial-stiffness-n-per-m", "0.664", "--torsional-stiffness-nm-per-rad", "4.52e-4"];
    let found = json_of(&[&wanted[..], &["--grid-m", "1e-4", "--json"]].concat());
    // A width of 0.8 mm, as printed.
    assert!((found["on_grid"]["dimensions"]["member_width_m"].as_f64().unwrap() - 8e-4).abs() < 1e-12, "{found}");
    assert!(found["exact"]["radial_error_share"].as_f64().unwrap().abs() < 1e-12);
    refused(&[&wanted[..], &["--member-width-m", "2e-3"]].concat(), &["cannot be built: "]);
    refused(&[&wanted[..], &["--member-width-m", "8e-4", "--short-member-length-m", "0.01"]].concat(), &["cannot be used with"]);
    refused(&[&wanted[..4], &["--torsional-stiffness-nm-per-rad=-1"]].concat(), &["must be positive"]);
}
