//! Files as other people have sent them: tips with lost frames, NaN, in the order of tracks, with a
//! likelihood, and outlines that close twice, lie off their centroid or overlap. They are made anew
//! here; where the sent files are at hand they are read too.

use std::path::PathBuf;

use cohaul::model::geometry::area_moments;
use cohaul::scenario::format::ScenarioFile;
use cohaul::scenario::{Drive, Scenario};
use cohaul_recordings::account::{Account, Kind};
use cohaul_recordings::drawings::repaired;
use cohaul_recordings::repair::Bounds;
use serde_json::{Value, json};

use crate::draws::Draws;
use crate::{imported, n_releases, paths, scene};

/// The complete table of both tips at 100 frames a second, and the same as trackers deliver it.
fn tables() -> [(&'static str, String); 5] {
    let header = "time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m";
    let mut draws = Draws::new(3);
    let row = |k: usize, spring: usize| {
        let time = 0.01 * k as f64;
        let place = [[0.05 + 0.07 * time / 3.0, 0.02 * time / 3.0], [0.06 * time / 3.0, 0.05 + 0.01 * time / 3.0]][spring];
        format!("{time},{spring},0,0,0,{},{}", place[0], place[1])
    };
    let by_time: Vec<String> = (0..=300).flat_map(|k| [row(k, 0), row(k, 1)]).collect();
    let by_track: Vec<String> = (0..2).flat_map(|spring| (0..=300).map(move |k| (k, spring))).map(|(k, spring)| row(k, spring)).collect();
    let is_lost: Vec<bool> = by_time.iter().map(|_| draws.is(0.03)).collect();
    let missed: Vec<String> = by_time.iter().zip(&is_lost).filter(|(_, lost)| !**lost).map(|(row, _)| row.clone()).collect();
    let nan = |(row, lost): (&String, &bool)| {
        let cells: Vec<&str> = row.split(',').collect();
        if *lost { format!("{},{},0,0,0,nan,nan", cells[0], cells[1]) } else { row.clone() }
    };
    let nan: Vec<String> = by_time.iter().zip(&is_lost).map(nan).collect();
    let likelihood: Vec<String> = by_time.iter().map(|row| format!("{row},0.97")).collect();
    let table = |rows: &[String]| format!("{header}\n{}\n", rows.join("\n"));
    [
        ("complete", table(&by_time)),
        ("missed-frames", table(&missed)),
        ("nan", table(&nan)),
        ("by-track", table(&by_track)),
        ("likelihood", format!("{header},likelihood\n{}\n", likelihood.join("\n"))),
    ]
}

fn check_tips(name: &str, table: &str, like: &Scenario, whole: &Scenario) {
    let (made, account) = imported(table, like, &Bounds::default());
    assert_eq!((n_releases(&made), paths(&made).len(), made.duration), (0, 2, 3.0), "{name}: {}", account.text());
    let is_lossy = name.contains("missed") || name.contains("nan");
    assert_eq!(account.count(Kind::Bridged) > 5, is_lossy, "{name}: {}", account.text());
    for (path, wanted) in paths(&made).iter().zip(paths(whole)) {
        for point in &path.waypoints {
            let at = wanted.waypoints.iter().find(|other| (other.time - point.time).abs() < 1e-9).unwrap();
            // Straight paths are the same over gaps, to rounding.
            assert!((at.position - point.position).norm() < 1e-12, "{name}: {} s", point.time);
        }
    }
    if !is_lossy {
        assert_eq!(made.drive, whole.drive, "{name}");
    }
}

#[test]
fn tips_of_every_tracker_are_the_complete_ones() {
    let like = scene("examples/recordings/ants.json");
    let like = Scenario { control_period: 0.01, ..like };
    let tables = tables();
    let (whole, account) = imported(&tables[0].1, &like, &Bounds::default());
    assert!(account.count(Kind::Bridged) + account.count(Kind::ReleasesInferred) == 0 && matches!(whole.drive, Drive::Tips(_)));
    for (name, table) in &tables {
        check_tips(name, table, &like, &whole);
    }
}

/// The same on the tables that came with reports, and their outlines.
#[test]
#[ignore = "needs COHAUL_REPORTS, the folder of the tables; tips_of_every_tracker_are_the_complete_ones runs always, on generated ones"]
fn tables_and_outlines_of_reports_are_put_right() {
    let folder = PathBuf::from(std::env::var_os("COHAUL_REPORTS").unwrap());
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let like = Scenario::parse(&read("tips-scene.json").unwrap(), "tips-scene.json").unwrap();
    let (whole, _) = imported(&read("tips-complete.csv").unwrap(), &like, &Bounds::default());
    for name in ["tips-complete.csv", "tips-missed-frames.csv", "tips-nan.csv", "tips-by-track.csv", "tips-likelihood.csv"] {
        check_tips(name, &read(name).unwrap(), &like, &whole);
    }
    for name in ["outline-closed-ring", "outline-off-centre", "outline-overlapping-bars"] {
        put_right(serde_json::from_str(&read(&format!("{name}.json")).unwrap()).unwrap());
    }
}

/// A scenario whose load has this outline, about which nothing is checked.
fn with_outline(outline: &Value) -> ScenarioFile {
    let file = json!({
        "name": "outline", "duration_s": 1.0, "control_period_s": 0.002, "load": { "mass_kg": 1.0, "outline": outline },
        "ground": { "friction_coefficient": 0.4, "supports": { "uniform": { "n": 16 } } },
        "springs": [{ "root_m": [0.0, 0.02], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": 10.0,
                      "torsional_stiffness_nm_per_rad": 0.0 }],
        "drive": { "kind": "tips", "paths": [] }
    });
    serde_json::from_value(file).unwrap()
}

fn put_right(file: ScenarioFile) -> (Scenario, Account) {
    let mut account = Account::default();
    let made = repaired("outline.json", file, &mut account).unwrap_or_else(|error| panic!("{error}"));
    (made.checked("outline.json").unwrap_or_else(|error| panic!("{error}")), account)
}

fn rectangle(size: [f64; 2], position: [f64; 2]) -> Value {
    json!({ "outline": { "rectangle": { "size_m": size } }, "position_m": position })
}

/// Known answers: areas, centroids and moments of inertia of rectangles.
#[test]
fn outlines_of_drawings_are_put_right() {
    let ring = json!({ "polygon": { "points_m": [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05], [-0.1, -0.05]] } });
    let off = json!({ "compound": { "parts": [rectangle([0.12, 0.03], [0.0, 0.015]), rectangle([0.03, 0.09], [0.0, 0.075])] } });
    let cross = json!({ "compound": { "parts": [rectangle([0.3, 0.1], [0.0, 0.0]), rectangle([0.1, 0.3], [0.0, 0.0])] } });
    for (name, outline, area, inertia, centroid) in [
        ("closed ring", &ring, 0.02, (0.04 + 0.01) / 12.0, 0.0),
        ("off centre", &off, 0.12 * 0.03 + 0.03 * 0.09, 0.001_931_632_653, 0.040_714_286),
        ("overlapping bars", &cross, 0.05, (2.0 * 0.03 * 0.1 / 12.0 - 0.01 * 0.02 / 12.0) / 0.05, 0.0),
    ] {
        assert!(with_outline(outline).checked(name).is_err(), "{name}: the rules refuse it as it is");
        let (made, account) = put_right(with_outline(outline));
        let found = area_moments(&made.system.world.outline);
        assert!((found.area / area - 1.0).abs() < 1e-9, "{name}: {}", found.area);
        assert!((made.system.load.inertia / inertia - 1.0).abs() < 1e-6, "{name}: {}", made.system.load.inertia);
        assert!((made.start.pose.position.y - centroid).abs() < 1e-8, "{name}: {:?}", made.start.pose);
        // The spring keeps its place in the world.
        let root = made.start.pose.to_world(&made.system.springs[0].root);
        assert!((root - cohaul::math::Vec2::new(0.0, 0.02)).norm() < 1e-12, "{name}: {root}");
        assert!(!account.notes.is_empty(), "{name}");
    }
}
