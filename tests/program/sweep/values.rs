//! What stands in the table.

use serde_json::Value;
use tempfile::tempdir;

use crate::common::{done, rows, scene, sweep};

/// A row is the run: every number of `run --json` to the last bit.
#[test]
fn a_row_holds_what_a_single_run_says() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    done(&sweep(&scene, &["--seeds", "3", "--seed", "4", "--backend", "inertial", "--backend", "rapier"], &out));
    for row in rows(&out.join("runs.csv")) {
        let args = ["run", scene.to_str().unwrap(), "--backend", &row["backend"], "--seed", &row["seed"], "--json"];
        let run: Value = serde_json::from_str(&done(&crate::root::cohaul().args(args).output().unwrap())).unwrap();
        let mut n_compared = 0;
        for (column, path) in [
            ("step_s", "/step_s"),
            ("time_to_nest_s", "/time_to_nest_s"),
            ("time_s", "/final/time_s"),
            ("x_m", "/final/position_m/0"),
            ("y_m", "/final/position_m/1"),
            ("heading_rad", "/final/heading_rad"),
            ("turn_rate_rad_per_s", "/final/turn_rate_rad_per_s"),
            ("pull_mean_n", "/pull_force_n/mean"),
            ("pull_sd_n", "/pull_force_n/sd"),
            ("n_pulls", "/pull_force_n/n"),
            ("friction_j", "/energy/friction_j"),
            ("tip_work_j", "/energy/tip_work_j"),
            ("defect_j", "/energy/defect_j"),
            ("residual", "/steps/residual"),
            ("n_steps", "/steps/n_steps"),
            ("n_skipped", "/steps/n_skipped"),
            ("n_slip_onset", "/transitions/n_slip_onset"),
        ] {
            let (found, expected) = (row[column].parse::<f64>().ok(), run.pointer(path).and_then(Value::as_f64));
            // No pull, no mean: there a summary has zeros.
            if !(row["n_pulls"] == "0" && column.starts_with("pull")) {
                assert_eq!(found, expected, "{column} of {row:?}");
                n_compared += usize::from(found.is_some());
            }
        }
        assert!(n_compared > 10, "{n_compared}");
        assert_eq!(row["arrived"], run["arrived"].to_string());
        let shares: f64 = (0..=4).map(|n| row[&format!("time_share_{n}_attached")].parse::<f64>().unwrap()).sum();
        // Five shares of a sum of some thousand periods.
        assert!((shares - 1.0).abs() < 1e-10, "{shares}");
    }
}

/// Of three numbers and five, the five stand to the right whichever comes first, so that three
/// curves are left and none is not shown.
#[test]
fn a_figure_has_the_parameter_with_most_values_to_the_right() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    let (three, five) = ("ground.friction_coefficient=1,1.2,1.4", "drive.pull_speed_m_per_s=0.03:0.07:5");
    for (at, [first, second]) in [[three, five], [five, three]].iter().enumerate() {
        let out = out.with_extension(at.to_string());
        done(&sweep(&scene, &["--seeds", "2", "--vary", first, "--vary", second], &out));
        let figure = std::fs::read_to_string(out.join("figure.svg")).unwrap();
        assert!(figure.contains(">drive.pull_speed_m_per_s<") && !figure.contains("combinations"), "{first} {second}");
        assert_eq!(figure.matches(">quasi-static, ground.friction_coefficient ").count(), 3, "{first} {second}");
    }
}

/// Means and intervals of a group are those of its rows, by formulas written down once more;
/// t(0.975; 11) = 2.200985 (tables).
#[test]
fn groups_are_the_statistics_of_their_rows() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    done(&sweep(&scene, &["--seeds", "12", "--vary", "ground.friction_coefficient=0.7,1.4"], &out));
    let (rows, groups) = (rows(&out.join("runs.csv")), rows(&out.join("groups.csv")));
    assert_eq!(groups.len(), 2);
    for group in &groups {
        let members: Vec<_> = rows.iter().filter(|row| row["point"] == group["point"]).collect();
        assert_eq!(members.len(), 12);
        assert!(members.iter().all(|row| row["ground.friction_coefficient"] == group["ground.friction_coefficient"]));
        let n_arrived = members.iter().filter(|row| row["arrived"] == "true").count();
        assert_eq!(group["n_arrived"], n_arrived.to_string());
        let lengths: Vec<f64> = members.iter().map(|row| row["path_length_m"].parse().unwrap()).collect();
        let mean = lengths.iter().sum::<f64>() / 12.0;
        let sd = (lengths.iter().map(|length| (length - mean).powi(2)).sum::<f64>() / 11.0).sqrt();
        let number = |name: &str| group[name].parse::<f64>().unwrap();
        // Sums in another order; the table of t has seven digits.
        assert!((number("path_length_m_mean") / mean - 1.0).abs() < 1e-12);
        assert!((number("path_length_m_sd") / sd - 1.0).abs() < 1e-12);
        let half = 0.5 * (number("path_length_m_high_95") - number("path_length_m_low_95"));
        assert!((half / (2.200_985 * sd / 12f64.sqrt()) - 1.0).abs() < 1e-6);
    }
    // Some arrive and some do not: the empty field has been put to the test.
    let times = rows.iter().filter(|row| row["time_to_nest_s"].is_empty()).count();
    assert!((1..24).contains(&times), "{times}");
    assert!(rows.iter().all(|row| row.values().all(|value| value != "NaN")));
}

#[test]
fn samples_and_words_and_whole_numbers_are_columns() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    let args = ["--sample", "latin-hypercube", "8", "--vary", "load.mass_kg=log:1e-4..1e-2", "--vary", "drive.n_ants=1..4"];
    done(&sweep(&scene, &[&args[..], &["--vary", "drive.preset=paper,aged"]].concat(), &out));
    let rows = rows(&out.join("runs.csv"));
    assert_eq!(rows.len(), 16);
    let of = |name: &str| rows[..8].iter().map(|row| row[name].clone()).collect::<Vec<_>>();
    let mut masses: Vec<f64> = of("load.mass_kg").iter().map(|mass| mass.parse::<f64>().unwrap().log10()).collect();
    masses.sort_by(f64::total_cmp);
    // Two decades in eight parts, one point in each.
    assert!(masses.iter().enumerate().all(|(at, mass)| ((mass + 4.0) * 4.0).floor() == at as f64), "{masses:?}");
    let mut ants = of("drive.n_ants");
    ants.sort_unstable();
    assert_eq!(ants, ["1", "1", "2", "2", "3", "3", "4", "4"]);
    assert_eq!((&rows[0]["drive.preset"], &rows[8]["drive.preset"]), (&"paper".to_owned(), &"aged".to_owned()));
}

/// At a hundredth of the inertia with the same friction a load that tips drag about ends much
/// nearer to where one without inertia does. Deviations of a load that settles shrink in proportion
/// to its mass; a third of that is kept for what is not settled yet.
#[test]
fn less_inertia_at_the_same_friction_is_nearer_to_none() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let args = ["--scale-inertia", "0.01,1", "--backend", "quasi-static", "--backend", "inertial"];
    done(&sweep(&crate::root::root().join("scenarios/analytic/qs-ref-1.json"), &args, &out));
    let headings: Vec<f64> = rows(&out.join("runs.csv")).iter().map(|row| row["heading_rad"].parse().unwrap()).collect();
    // Cells run through points, then backends.
    let [light, heavy] = [headings[1] - headings[0], headings[3] - headings[2]].map(f64::abs);
    assert!(light < heavy / 30.0 && heavy > 1e-4, "{light} rad of {heavy} rad");
    assert_eq!(headings[0], headings[2], "a step without inertia knows no mass");
}
