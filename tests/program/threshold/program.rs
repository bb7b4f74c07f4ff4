//! The command: its output, its files, and what it refuses.

use std::process::Output;

use serde_json::Value;

const TOW: &str = "scenarios/analytic/ramp-and-hold.json";

fn cohaul(args: &[&str]) -> Output {
    let mut command = crate::root::cohaul();
    command.args(args).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn the_answer_comes_first_and_the_folder_has_table_figure_and_summary() {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let asked = ["compare", TOW, "--threshold", "speed=0.1:2", "--tolerance-path", "0.2", "--out", out.to_str().unwrap()];
    let done = cohaul(&asked);
    let (said, why) = (text(&done.stdout), text(&done.stderr));
    assert!(done.status.success(), "{why}");
    assert!(said.starts_with("Quasi-static is valid "), "{said}");
    assert!(said.lines().all(|line| line.chars().count() <= 80 || line.contains("report.html")), "{said}");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    assert_eq!(summary["format"]["name"], "cohaul threshold");
    assert_eq!(summary["parameter"]["speed_m_per_s"], 0.08);
    let points = read("points.csv");
    let n_points = summary["points"].as_array().unwrap().len();
    assert_eq!(points.lines().count(), n_points + 1);
    assert!(points.starts_with("speed,drive_speed_m_per_s,"), "{points}");
    let svg = read("threshold.svg");
    assert!(svg.contains("inertia effect / tolerance") && svg.contains("largest speed of what drives the load (m/s)"), "{svg}");
    assert!(read("report.html").contains("Quasi-static is valid "));
    assert!(!room.path().join("out.journal").exists());
    let printed = cohaul(&["compare", TOW, "--threshold", "speed=0.1:2", "--tolerance-path", "0.2", "--json"]);
    let printed: Value = serde_json::from_slice(&printed.stdout).unwrap();
    assert_eq!(printed["quantities"], summary["quantities"]);
}

#[test]
fn what_makes_no_sense_is_refused_with_place_rule_and_what_was_found() {
    for (args, why) in [
        (&["--threshold", "speed", "--vary", "speed=1,2"][..], "cannot be used with"),
        (&["--threshold", "speed", "--fail-on", "engine"], "--fail-on: must be left out with --threshold, found both"),
        (&["--threshold", "speed", "--step-s", "0.001"], "--step-s: must be left out with --threshold, found both"),
        (&["--threshold", "speed", "--precision", "f32"], "--precision: must be left out with --threshold, found both"),
        (&["--threshold", "speed", "--everywhere"], "--everywhere: must be left out with --threshold, found both"),
        (&["--threshold", "speed=2:1"], "speed: must be a range from low to high, found 2:1"),
        (&["--threshold", "speed=-1:1"], "speed: must be positive to have a logarithm, found -1"),
        (&["--threshold", "load.mas_kg"], "load.mas_kg: must be a parameter of the scenario"),
        (&["--threshold", "drive.kind"], "drive.kind: must be a positive number, found \"tips\""),
        (&["--threshold", "springs[0].damping_ratio"], "springs[0].damping_ratio: must be a positive number, found 0"),
        (&["--threshold", "load.mass_kg=0.001:1e300"], "with load.mass_kg = "),
        (&["--vary", "speed=0,1"], "speed: must be a positive number, found 0"),
        (&["--vary", "inertia=1,2", "--vary", "inertia_scale=1,2"], "inertia_scale: must be varied once, found it again as inertia"),
    ] {
        let done = cohaul(&[&["compare", TOW], args].concat());
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{args:?}: {said}");
        assert!(said.contains(why), "{args:?}: {said}");
    }
    let done = cohaul(&["compare", "scenarios/stress/hold-below-limit.json", "--threshold", "speed"]);
    let said = text(&done.stderr);
    assert!(said.contains("speed: must have a tip, an obstacle or a start with a speed, found all at rest"), "{said}");
}

#[test]
fn a_map_and_a_sweep_take_the_factors() {
    let map = cohaul(&["compare", TOW, "--vary", "speed=0.5,1", "--vary", "size=1,2", "--json"]);
    let map: Value = serde_json::from_slice(&map.stdout).unwrap();
    let of = |at: usize| map["cells"][at]["compared"][0]["inertia_effect"].as_f64().unwrap();
    // A scene of twice the size is one at the root of half the speed: v / omega goes by the size
    // and the speed.
    assert!(of(2) > of(0), "{map}");
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let args = ["sweep", TOW, "--vary", "speed=1,2", "--vary", "inertia=0.5,1", "--backend", "inertial"];
    let done = cohaul(&[&args[..], &["--out", out.to_str().unwrap()]].concat());
    assert!(done.status.success(), "{}", text(&done.stderr));
    let runs = std::fs::read_to_string(out.join("runs.csv")).unwrap();
    assert!(runs.lines().next().unwrap().contains("speed,inertia") && runs.lines().count() == 5, "{runs}");
}
