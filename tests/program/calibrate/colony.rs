//! `cohaul colony` as its users meet it, on the recording that ships.

use std::fs;
use std::process::Output;

use cohaul::scenario::{Drive, Scenario};
use cohaul_paper::calibrate::{Recording, Sensor, tip_forces};
use cohaul_paper::colony::{Measures, recorded};
use serde_json::Value;
use tempfile::tempdir;

use super::observed::{COLONY_COMMENT, colony};

const RECORDING: &str = "data/colony-tips.csv";
const LIKE: &str = "scenarios/paper/four-ants-four-springs.json";

fn call(args: &[&str]) -> Output {
    crate::root::cohaul().args(args).output().unwrap()
}

fn refused(args: &[&str], words: &[&str]) {
    let output = call(args);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {error}");
    assert!(words.iter().all(|word| error.contains(word)), "{args:?}: {error}");
}

fn recording() -> String {
    fs::read_to_string(crate::root::root().join(RECORDING)).unwrap()
}

#[test]
fn the_recording_that_ships_is_what_its_command_generates() {
    let stored = recording();
    let rows = stored.strip_prefix(COLONY_COMMENT).expect("the file says that it is generated");
    let numbers = |text: &str| -> Vec<f64> { text.split([',', '\n']).filter_map(|field| field.parse().ok()).collect() };
    let (stored, again) = (numbers(rows), numbers(&colony()));
    assert_eq!(stored.len(), again.len());
    // Another machine's sines may turn the last printed digit.
    assert!(stored.iter().zip(&again).all(|(one, other)| (one - other).abs() < 1.5e-5));
}

/// The scenario that is written has the fitted ants under its own keys, loads, and runs on every
/// backend; the truth is within all intervals of this recording.
#[test]
fn the_fitted_ants_are_a_scenario_that_runs_on_all_backends() {
    let room = tempdir().unwrap();
    let out = room.path().join("colony");
    let args = ["colony", RECORDING, "--like", LIKE, "--tip-noise-m", "1e-4", "--seeds", "2", "--json", "--out", out.to_str().unwrap()];
    let output = call(&args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["format"]["name"], "cohaul colony");
    let scenario = Scenario::read(&out.join("scenario.json")).unwrap();
    let Drive::Ants(ants) = &scenario.drive else { panic!("{scenario:?}") };
    let truth = [300.0, 0.018, 0.15, 8.0, 0.9, 0.03];
    let keys = found["keys"].as_array().unwrap();
    for (key, truth) in keys.iter().zip(truth) {
        let within = key["low"].as_f64().is_none_or(|low| low <= truth) && key["high"].as_f64().is_none_or(|high| truth <= high);
        assert!(within, "{key} {truth}");
    }
    assert_eq!(keys[3]["value"].as_f64(), Some(ants.steering_gain));
    assert_eq!(keys[5]["value"].as_f64(), Some(ants.pull_speed));
    let backends = found["backends"].as_array().unwrap();
    assert!(backends.len() == 3 && backends.iter().all(|of| of["n_failed"] == 0 && of["pull_mean_n"].as_f64().unwrap() > 1e-3), "{found}");
    for name in
        ["report.html", "colony.json", "group-size.svg", "series.svg", "snapshots.svg", "path.svg", "series-88mm.svg", "manifest.json"]
    {
        let text = fs::read_to_string(out.join(name)).unwrap();
        assert!(!text.is_empty() && (name.ends_with("html") || !text.contains("NaN")), "{name}");
    }
}

/// A load that moves at 2 mm/s and turns at 0.1 rad/s, with a tip 5 mm beyond its place at rest for
/// half of the time, and no frames while no ant pulls. Its place has 0.1 mm of noise.
#[test]
fn measures_of_a_known_motion_are_known() {
    let like = Scenario::read(&crate::root::root().join(LIKE)).unwrap();
    let mut table = "time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m,event\n".to_owned();
    for frame in (0..=400).filter(|frame| !(100..300).contains(frame)) {
        let time = 0.05 * f64::from(frame);
        let heading = 0.1 * time;
        let (sin, cos) = heading.sin_cos();
        let noise = 1e-4 * if frame % 2 == 0 { 1.0 } else { -1.0 };
        let (x, reach) = (2e-3 * time + noise, 0.0122 + 0.0263 + 5e-3);
        table += &format!("{time},0,{x},0,{heading},{},{},\n", x + reach * cos, reach * sin);
    }
    let (recording, _) = Recording::with_releases(&table, "known", Some(4), 0.0263).unwrap();
    let forces = tip_forces(&recording, &Sensor::exact(like.system.springs.clone()));
    let seen = recorded(&recording, &forces).unwrap();
    assert_eq!((seen.n_frames, seen.n_filled, seen.rows.len()), (201, 200, 401));
    let found = Measures::of(&seen.rows, seen.period, None, 1);
    let near = |value: f64, truth: f64, tolerance: f64| assert!((value - truth).abs() < tolerance, "{value} {truth}");
    // Eq. (10): 0.664 N/m times 5 mm.
    near(found.pulls.mean(), 3.32e-3, 1e-12);
    near(found.turn_rate.mean(), 0.1, 1e-9);
    // Windows of ten frames begin and end with the same noise; the two at the gap do not. From
    // frame to frame the noise would count as 4 mm/s.
    near(found.speed.mean(), 2e-3, 2e-5);
    near(found.speed_of_size(0).unwrap(), 2e-3, 5e-5);
    near(found.speed_of_size(1).unwrap(), 2e-3, 5e-5);
    near(found.share_of_size(1).unwrap(), 1.0, 1e-12);
    near(found.interaction.mean(), 0.0, 1e-12);
}

#[test]
fn units_and_scenes_that_cannot_be_are_refused_with_the_cure() {
    let room = tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = room.path().join(name);
        fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let changed = |columns: &[usize], factor: f64| -> String {
        let field = |(at, field): (usize, &str)| match field.parse::<f64>() {
            Ok(number) if columns.contains(&at) => (factor * number).to_string(),
            _ => field.to_owned(),
        };
        recording()
            .lines()
            .map(|line| {
                if line.starts_with('#') {
                    String::new()
                } else {
                    line.split(',').enumerate().map(field).collect::<Vec<_>>().join(",") + "\n"
                }
            })
            .collect()
    };
    let degrees = write("degrees.csv", &changed(&[4], 180.0 / std::f64::consts::PI));
    for command in [&["calibrate", "behaviour", &degrees, "--scenario", LIKE][..], &["colony", &degrees, "--like", LIKE]] {
        refused(command, &["heading_rad: must be in radians (multiply by pi / 180)"]);
    }
    let millimetres = write("mm.csv", &changed(&[2, 3, 5, 6], 1000.0));
    refused(&["colony", &millimetres, "--like", LIKE], &["is it in millimetres? divide by 1000"]);
    refused(&["colony", RECORDING, "--like", LIKE, "--tip-noise-m", "0.1"], &["--tip-noise-m: must be below the rest length"]);
    refused(&["calibrate", "behaviour", RECORDING, "--scenario", LIKE, "--nest-m", "200", "-170"], &["--nest-m", "millimetres"]);
    refused(&["colony", RECORDING, "--like", "scenarios/paper/four-tips-held.json"], &["drive.kind: must be \"ants\""]);
    let in_root = write("root.csv", "time_s,spring,tip_in_root_x_m,tip_in_root_y_m\n0,0,0.03,0\n0.1,0,0.03,0\n");
    refused(&["colony", &in_root, "--like", LIKE], &["must have tips in world axes"]);
}
