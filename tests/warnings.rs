//! Warnings about valid scenarios: none about those that ship, and each on both sides of its
//! threshold.

#[path = "common/changes.rs"]
mod changes;

use std::path::PathBuf;

use cohaul::scenario::Scenario;
use serde_json::{Value, json};

use changes::changed;

/// A box of 2 kg that a robot tows: slip limit 7.848 N, radius 0.25 m.
fn tow() -> Value {
    json!({
        "name": "a box", "duration_s": 8.0, "control_period_s": 0.01,
        "load": { "mass_kg": 2.0, "radius_m": 0.25 },
        "ground": { "friction_coefficient": 0.4, "supports": [
            { "offset_m": [0.2, 0.0] }, { "offset_m": [-0.1, 0.15] }, { "offset_m": [-0.1, -0.15] } ] },
        "springs": [{ "root_m": [0.25, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.2, "radial_stiffness_n_per_m": 100.0,
            "torsional_stiffness_nm_per_rad": 1.0, "damping_ratio": 0.1 }],
        "obstacles": [
            { "name": "post", "outline": { "disc": { "radius_m": 0.1 } }, "position_m": [0.0, 2.0] },
            { "name": "pusher", "outline": { "disc": { "radius_m": 0.1 } }, "path": { "waypoints": [[0, 0, -2, 0], [1, 0, -2, 1]] } } ],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.0, 0.45, 0.0], [4.0, 1.0, 0.0]], "release_s": 5.0 } ] }
    })
}

/// A box on springs alone, that nothing pushes.
fn alone() -> Value {
    changed(tow(), "/obstacles", json!([]))
}

/// Ten ants: slip limit 0.0219744 N, radius 12.2 mm.
fn ants() -> Value {
    json!({
        "name": "ants", "duration_s": 300.0, "control_period_s": 0.01,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.0081 } } },
        "springs": [{ "ring": { "n": 4, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
        "drive": { "kind": "ants", "n_ants": 10 }
    })
}

fn warnings(file: &Value) -> Vec<String> {
    let scenario = Scenario::parse(&file.to_string(), "scene.json").unwrap_or_else(|error| panic!("{error}"));
    scenario.warnings().iter().map(ToString::to_string).collect()
}

/// A value inside of a threshold gives no warning; one beyond it gives exactly this one.
fn assert_threshold(base: &Value, at: &str, [inside, beyond]: [Value; 2], warning: &[&str]) {
    let quiet = warnings(&changed(base.clone(), at, inside.clone()));
    assert!(quiet.is_empty(), "{at} {inside}: {quiet:?}");
    let told = warnings(&changed(base.clone(), at, beyond.clone()));
    assert_eq!(told.len(), 1, "{at} {beyond}: {told:?}");
    assert!(warning.iter().all(|part| told[0].contains(part)), "{at} {beyond}: {told:?} lacks one of {warning:?}");
}

#[test]
fn no_shipped_scenario_has_a_warning() {
    let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios"));
    let mut n = 0;
    for folder in std::fs::read_dir(root).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap().map(|file| file.unwrap().path()) {
            let warnings = Scenario::read(&file).unwrap().warnings();
            assert!(warnings.is_empty(), "{}: {warnings:?}", file.display());
            n += 1;
        }
    }
    assert!(n >= 56, "{n} scenarios");
    [tow(), alone(), ants()].iter().for_each(|scene| assert_eq!(warnings(scene), [""; 0]));
}

#[test]
fn weights_that_do_not_fit_the_size_are_told() {
    // 1e4 kg/m^2 on a disc of a quarter of a metre are 1963.5 kg, 1e-3 kg/m^2 are 0.19635 g.
    let strong = changed(tow(), "/springs/0/radial_stiffness_n_per_m", json!(1e5));
    assert_threshold(&strong, "/load/mass_kg", [json!(1963.0), json!(1964.0)], &["load: should be in kilograms and metres", "1960 kg"]);
    assert_threshold(&tow(), "/load/mass_kg", [json!(1.97e-4), json!(1.96e-4)], &["load: should be", "kg/m^2"]);
    let loads = |load: f64| json!([0.2, -0.1, -0.1].map(|x| json!({ "offset_m": [x, 0.0], "normal_load_n": load / 3.0 })));
    let rule = "ground.supports: should be in newtons";
    assert_threshold(&tow(), "/ground/supports", [loads(0.201), loads(0.199)], &[rule, "0.0995 N/kg"]);
    let rule = "ground.gravity_m_per_s2: should be in m/s^2, found 9810, gravity on Earth in mm/s^2";
    let light = changed(tow(), "/load/mass_kg", json!(1.0));
    assert_threshold(&light, "/ground/gravity_m_per_s2", [json!(10_010.0), json!(9810.0)], &[rule]);
    assert_threshold(&light, "/ground/gravity_m_per_s2", [json!(960.0), json!(981.0)], &["in cm/s^2"]);
}

#[test]
fn percent_is_told() {
    assert_threshold(&tow(), "/ground/friction_coefficient", [json!(5.0), json!(5.001)], &["ground.friction_coefficient", "not percent"]);
    let both = changed(tow(), "/load/side_friction_coefficient", json!(5.0));
    let rule = ["obstacles[0].friction_coefficient", "should be at most 5"];
    assert_threshold(&both, "/obstacles/0/friction_coefficient", [json!(5.0), json!(5.1)], &rule);
    assert_threshold(&tow(), "/springs/0/damping_ratio", [json!(25.0), json!(26.0)], &["springs[0].damping_ratio", "found 26"]);
}

#[test]
fn lengths_that_do_not_fit_the_load_are_told() {
    let supports = |x: f64| {
        let at = |x: f64, y: f64| json!({ "offset_m": [x, y], "normal_load_n": 6.54 });
        json!([at(x, 0.0), at(-0.1, 0.1), at(-0.1, -0.1)])
    };
    assert_threshold(&tow(), "/ground/supports", [supports(0.5), supports(0.501)], &["ground.supports[0].offset_m", "found 0.501 m"]);
    let path = json!([[0.0, 0.7, 0.0], [4.0, 1.2, 0.0]]);
    let far = changed(tow(), "/drive/paths/0/waypoints", path);
    assert_threshold(&far, "/springs/0/root_m", [json!([0.5, 0.0]), json!([0.501, 0.0])], &["springs[0].root_m", "found 0.501 m"]);
    let long = changed(tow(), "/drive/paths/0/waypoints", json!([[0.0, 12.0, 0.0], [4.0, 13.0, 0.0]]));
    let long = changed(long, "/springs/0/torsional_stiffness_nm_per_rad", json!(0));
    assert_threshold(
        &long,
        "/springs/0/rest_length_m",
        [json!(12.5), json!(12.6)],
        &["springs[0].rest_length_m: should be at most 50 radii"],
    );
    // Across, 1 N m/rad over the square of 0.2 m is a quarter of 100 N/m: 400 N m/rad are 100 times
    // as stiff.
    let rule = ["springs[0].torsional_stiffness_nm_per_rad: should be in N m/rad", "across"];
    assert_threshold(&tow(), "/springs/0/torsional_stiffness_nm_per_rad", [json!(399.0), json!(401.0)], &rule);
}

#[test]
fn degrees_are_told() {
    let turn = std::f64::consts::TAU;
    let loose = changed(tow(), "/drive/paths", json!([]));
    assert_threshold(&loose, "/load/heading_rad", [json!(-turn), json!(-turn - 1e-9)], &["load.heading_rad", "in radians"]);
    assert_threshold(&loose, "/springs/0/bearing_rad", [json!(turn), json!(90)], &["springs[0].bearing_rad", "found 90"]);
    assert_threshold(&tow(), "/obstacles/0/heading_rad", [json!(turn), json!(45)], &["obstacles[0].heading_rad", "found 45"]);
    let rule = ["obstacles[1].path.waypoints[1][3]", "at most one turn"];
    assert_threshold(&tow(), "/obstacles/1/path/waypoints/1/3", [json!(turn), json!(90)], &rule);
    // Later bearings of a ring pass a turn; a ring in degrees is told once.
    assert_threshold(&ants(), "/springs/0/ring/first_bearing_rad", [json!(turn), json!(90)], &["springs[0].bearing_rad"]);
}

#[test]
fn speeds_in_millimetres_are_told() {
    // Half a metre within a control period of 10 ms is 50 m/s, for ten periods.
    let fast = |x: f64| json!([[0.0, 0.45, 0.0], [0.1, 0.45 + x, 0.0]]);
    let rule = ["drive.paths[0].waypoints[1]: should be reached at most at 50 m/s", "found 51 m/s"];
    assert_threshold(&tow(), "/drive/paths/0/waypoints", [fast(4.99), fast(5.1)], &rule);
    // A jump of the tip is no speed.
    assert_threshold(&tow(), "/drive/paths/0/waypoints/1", [json!([0.05, 5.0, 0.0]), json!([0.1, 5.5, 0.0])], &["50.5 m/s"]);
    // Friction stops 44.2 m/s within 250 m at 0.4 g.
    let rule = ["load.velocity_m_per_s: should be in m/s", "found 45 m/s"];
    assert_threshold(&tow(), "/load/velocity_m_per_s", [json!([0.0, 44.0]), json!([45.0, 0.0])], &rule);
    // 19 mm within 10 ms.
    for key in ["search_speed_m_per_s", "pull_speed_m_per_s"] {
        assert_threshold(&ants(), &format!("/drive/{key}"), [json!(2.13), json!(2.15)], &[key, "the sensing range per control period"]);
    }
    assert_threshold(&ants(), "/drive/sensing_range_m", [json!(1.22), json!(1.23)], &["drive.sensing_range_m", "radii of the load"]);
    assert_threshold(&ants(), "/drive/strong_pull_n", [json!(2.19), json!(2.2)], &["drive.strong_pull_n: should be in newtons"]);
}

#[test]
fn tips_far_from_their_springs_are_told() {
    let rule = ["drive.paths[0].waypoints[0]: should be near the tip of the undeformed spring 0: within 0.1 m", "0.101 m"];
    assert_threshold(&tow(), "/drive/paths/0/waypoints/0", [json!([0.0, 0.549, 0.0]), json!([0.0, 0.45, 0.101])], &rule);
    // A spring without rest length may be stretched to 20 radii.
    let isotropic = changed(changed(tow(), "/springs/0/rest_length_m", json!(0)), "/springs/0/torsional_stiffness_nm_per_rad", json!(0));
    assert_threshold(&isotropic, "/drive/paths/0/waypoints/0", [json!([0.0, 5.2, 0.0]), json!([0.0, 5.3, 0.0])], &["within 5 m"]);
    // The first tip may have moved the load by 0.55 m before the second is attached.
    let second = |x: f64| json!({ "spring": 1, "waypoints": [[4.0, x, 0.0]] });
    let spring = alone()["springs"][0].clone();
    let mut two = changed(alone(), "/springs", json!([spring, spring]));
    two["drive"]["paths"].as_array_mut().unwrap().push(second(0.45));
    assert_threshold(&two, "/drive/paths/1", [second(1.09), second(1.2)], &["drive.paths[1].waypoints[0]", "spring 1"]);
    let at_once = |x: f64| json!({ "spring": 1, "waypoints": [[0.0, x, 0.0]] });
    assert_threshold(&two, "/drive/paths/1", [at_once(0.54), at_once(0.56)], &["drive.paths[1].waypoints[0]", "within 0.1 m"]);
}

#[test]
fn places_far_away_are_told() {
    // A thousand times 0.25 m and 0.2 m.
    let rule = ["should be in metres, and within 450 m of the load's start"];
    let wait = changed(tow(), "/duration_s", json!(100.0));
    assert_threshold(&wait, "/drive/paths/0/waypoints/1", [json!([99.0, 449.0, 0.0]), json!([99.0, 451.0, 0.0])], &rule);
    assert_threshold(&tow(), "/obstacles/0/position_m", [json!([0.0, 450.0]), json!([0.0, 451.0])], &rule);
    assert_threshold(&ants(), "/drive/nest_position_m", [json!([38.4, 0.0]), json!([38.6, 0.0])], &["drive.nest_position_m"]);
}

#[test]
fn springs_that_cannot_move_the_load_are_told() {
    // 100 N/m stretched by 7.8 mm are a tenth of the slip limit. The torque about the centre, with
    // an arm of 0.45 m, reaches a tenth of its limit at 3.3 mm.
    let short = |x: f64| json!([[0.0, 0.45, 0.0], [4.0, 0.45 + x, 0.0]]);
    let rule = ["load: should be light enough to be moved", "of the slip limit, 7.85 N"];
    let soft = changed(alone(), "/springs/0/torsional_stiffness_nm_per_rad", json!(0));
    assert_threshold(&soft, "/drive/paths/0/waypoints", [short(0.004), short(0.002)], &rule);
    let weak = changed(ants(), "/drive/n_ants", json!(1));
    assert_threshold(&weak, "/drive/strong_pull_n", [json!(0.001), json!(1e-4)], &["load: should be light enough"]);
    // A pusher moves the load too, and a load that slides need not be moved.
    assert_eq!(warnings(&changed(tow(), "/drive/paths/0/waypoints", short(0.002))), [""; 0]);
    let sliding = changed(soft, "/load/velocity_m_per_s", json!([0.1, 0.0]));
    assert_eq!(warnings(&changed(sliding, "/drive/paths/0/waypoints", short(0.002))), [""; 0]);
}

#[test]
fn what_happens_after_the_end_is_told() {
    let rule = ["drive.paths[0].release_s: the release should not be after the end of the run, 8 s", "found 8.1 s"];
    assert_threshold(&tow(), "/drive/paths/0/release_s", [json!(8.0), json!(8.1)], &rule);
    let rule = ["drive.paths[0].waypoints[1][0]: a waypoint should not be after the end of the run"];
    assert_threshold(&tow(), "/drive/paths/0/waypoints/1/0", [json!(8.0), json!(8.1)], &rule);
    let late = |time: f64| json!([{ "spring": 0, "waypoints": [[time, 0.45, 0.0]] }]);
    let rule = ["drive.paths[0].waypoints[0][0]: the start of the path should not be after"];
    assert_threshold(&tow(), "/drive/paths", [late(8.0), late(8.1)], &rule);
    let rule = ["obstacles[1].path.waypoints[1][0]: a waypoint"];
    assert_threshold(&tow(), "/obstacles/1/path/waypoints/1/0", [json!(8.0), json!(8.1)], &rule);
}

#[test]
fn durations_that_do_not_fit_are_told() {
    let idle = changed(changed(alone(), "/drive/paths", json!([])), "/load/velocity_m_per_s", json!([0.1, 0.0]));
    assert_threshold(&idle, "/duration_s", [json!(0.1), json!(0.099)], &["duration_s: should be at least 10 control periods, 0.1 s"]);
    assert_threshold(&tow(), "/duration_s", [json!(500.0), json!(501.0)], &["duration_s: should be in seconds", "found 501 s"]);
    // Ants may run for a short time only.
    assert_eq!(warnings(&changed(ants(), "/duration_s", json!(0.1))), [""; 0]);
    let rule = ["drive.arrival_radius_m: should be below the distance of the nest", "ends at once"];
    assert_threshold(&ants(), "/drive/arrival_radius_m", [json!(0.26), json!(0.27)], &rule);
}
