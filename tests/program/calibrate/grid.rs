//! Readings of a load cell: transform, circles and lookup table against the spring that made them.

use std::fs;

use cohaul_paper::calibrate::{Case, Dimensions, LoadCell};
use serde_json::Value;
use tempfile::tempdir;

use crate::TRUTH;
use crate::generated_grid::{GRID_COMMENT, TRUE_SPRING, load_cell, true_force};
use crate::root;

/// Without noise, each reading of a case is the force of the spring at its place on its circle.
/// Between nodes 2 mm apart, a force that bends by its size over the length of the spring is off by
/// (2 mm / 26.3 mm)^2 / 8 of it, 0.1 %; 2 % are allowed, and rounding of 0.05 uN.
#[test]
fn readings_lie_on_the_circles_of_the_paper() {
    let readings = LoadCell::parse(&load_cell(1, 0.0, 0.0, ""), "grid.csv").unwrap();
    let found = readings.measurements(&Dimensions::default());
    let [_, _, rest] = TRUE_SPRING;
    let (short, link) = (TRUTH.short_member_length, TRUTH.link_length);
    for case in Case::ALL {
        let points: Vec<_> = found.of_case(case).flat_map(|trial| &trial.points).collect();
        assert!(points.len() >= 8, "{case:?}: {}", points.len());
        for point in points {
            // Law of sines in the triangle of root, pivot and tip.
            let length = short * point.at.cos() + (link * link - (short * point.at.sin()).powi(2)).sqrt();
            let known = match case {
                Case::Radial => true_force(rest + point.at, 0.0)[0],
                Case::TangentialTwo => TRUE_SPRING[1] * point.at / length,
                Case::TangentialThree => TRUE_SPRING[1] * point.at / rest,
            };
            assert!((point.force - known).abs() < 0.02 * known.abs() + 1e-7, "{case:?} at {}: {} {known}", point.at, point.force);
            let is_right_side = match case {
                Case::Radial => true,
                Case::TangentialTwo => point.at > 0.0,
                Case::TangentialThree => point.at < 0.0,
            };
            assert!(is_right_side, "{case:?} {}", point.at);
        }
    }
}

/// The shipped file is what its generator prints. Seven trials give the lookup table, whose means
/// are off by the scatter of the trials, 3 % over the root of seven; four of these and of the
/// noise.
#[test]
fn seven_trials_give_the_lookup_table() {
    let text = load_cell(7, 0.03, 5e-5, GRID_COMMENT);
    assert_eq!(fs::read_to_string(root::root().join("data/load-cell.csv")).unwrap(), text);
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let call = |args: &[&str]| root::cohaul().current_dir(root::root()).arg("calibrate").args(args).output().unwrap();
    let output = call(&["grid", "data/load-cell.csv", "--json", "--out", out.to_str().unwrap()]);
    assert_eq!((output.status.code(), output.stderr), (Some(0), Vec::new()));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["n_trials"], &report["n_x"], &report["n_y"]), (&7.into(), &14.into(), &17.into()));
    let mut table = csv::Reader::from_path(out.join("lookup.csv")).unwrap();
    let rows: Vec<Vec<f64>> = table.records().map(|row| row.unwrap().iter().map(|field| field.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 14 * 17);
    let allowed = |force: f64| 4.0 * (0.03 * force.abs() + 5e-5) / 7f64.sqrt();
    for row in &rows {
        let [along, across] = true_force(row[0], row[1]);
        assert!((row[2] - along).abs() < allowed(along) && (row[4] - across).abs() < allowed(across), "{row:?} {along} {across}");
        assert!(row[3] > 0.0 && row[5] > 0.0 && row[6] == 7.0, "{row:?}");
    }
    // The other table is one that `fit` reads. The stiffness along the spring is found again.
    let fit = call(&["fit", out.join("measurements.csv").to_str().unwrap(), "--json"]);
    let fit: Value = serde_json::from_slice(&fit.stdout).unwrap();
    let radial = &fit["linear"].as_array().unwrap().iter().find(|line| line["case"] == "radial").unwrap()["stiffness"];
    let (value, error) = (radial["value"].as_f64().unwrap(), radial["standard_error"].as_f64().unwrap());
    assert!((value - TRUE_SPRING[0]).abs() < 4.0 * error && radial["n_trials"] == 7, "{value} {error}");
}

#[test]
fn faults_of_readings_are_named() {
    let head = "trial,x_m,y_m,force_x_n,force_y_n\n";
    for (rows, words) in [
        ("1,0,0,1e-3,0\n", "x_m: must not be on the root"),
        ("1,0.02,0,1e-3,0\n1,0.02,0,1e-3,0\n", "must be read once"),
        ("1,far,0,1e-3,0\n", "x_m"),
        ("", "must hold readings"),
    ] {
        let error = LoadCell::parse(&format!("{head}{rows}"), "grid.csv").unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("grid.csv"), "{error}");
    }
    let scattered: String = (1..30).map(|at| format!("1,{},{},1e-3,0\n", 0.001 * f64::from(at), 0.0013 * f64::from(at))).collect();
    let error = LoadCell::parse(&format!("{head}{scattered}"), "grid.csv").unwrap_err().to_string();
    assert!(error.contains("must lie on a grid") && error.contains("29 x 29"), "{error}");
}
