//! Wrong input is told with place, rule and what was found, all of it at once; a hair inside of
//! each threshold is accepted.

#[path = "common/changes.rs"]
mod changes;

use std::path::Path;

use cohaul::analysis::Advice;
use cohaul::scenario::{Scenario, ScenarioError, format};
use cohaul_report::json;
use serde_json::{Value, json};

use changes::changed;

/// One change to a good scenario, and the one finding it must give: place, words of the rule, what
/// was found.
struct Bad {
    at: &'static str,
    put: Value,
    path: &'static str,
    rule: &'static str,
    found: &'static str,
}

fn bad(at: &'static str, put: Value, path: &'static str, rule: &'static str, found: &'static str) -> Bad {
    Bad { at, put, path, rule, found }
}

fn tips() -> Value {
    json!({
        "name": "a good one", "duration_s": 2.0, "control_period_s": 0.01, "seed": 3,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
        "ground": { "friction_coefficient": 1.4, "supports": [
            { "offset_m": [0.0, 0.008] }, { "offset_m": [-0.007, -0.004] }, { "offset_m": [0.007, -0.004] } ] },
        "springs": [
            { "root_m": [0.0122, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
              "torsional_stiffness_nm_per_rad": 4.52e-4 },
            { "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": 0.664,
              "torsional_stiffness_nm_per_rad": 0.0 },
            { "ring": { "n": 2, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
              "torsional_stiffness_nm_per_rad": 4.52e-4 } } ],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.5, 0.0385, 0.0], [1.0, 0.1, 0.0]], "release_s": 1.5 },
            { "spring": 1, "waypoints": [[0.0, 0.0, 0.0]] } ] }
    })
}

fn ants() -> Value {
    let mut file = tips();
    // Aged releases have a rule more than hazards.
    file["drive"] = json!({ "kind": "ants", "n_ants": 4, "release_pace": "aged" });
    file
}

/// A box between two obstacles, of which one moves.
fn world() -> Value {
    json!({
        "name": "a box", "duration_s": 2.0, "control_period_s": 0.01,
        "load": { "mass_kg": 0.0016, "outline": { "rectangle": { "size_m": [0.02, 0.01] } } },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.004 } } },
        "springs": [],
        "obstacles": [
            { "name": "wall", "outline": { "polyline": { "points_m": [[-1, 0], [1, 0]] } }, "position_m": [0, -0.005] },
            { "name": "post", "outline": { "disc": { "radius_m": 0.002 } }, "path": { "waypoints": [[0, 0, 1, 0], [1, 0, 2, 0]] } } ],
        "drive": { "kind": "tips", "paths": [] }
    })
}

fn error_of(file: &Value) -> String {
    Scenario::parse(&file.to_string(), "bad.json").expect_err(&file.to_string()).to_string()
}

fn assert_told(base: &Value, row: &Bad) {
    let file = changed(base.clone(), row.at, row.put.clone());
    let told = error_of(&file);
    // One wrong thing is one line: findings that only follow from another would bury it.
    assert_eq!(told.lines().count(), 1, "{} {}:\n{told}", row.at, row.put);
    let place = format!("bad.json: {}: ", row.path);
    assert!(told.starts_with(&place), "`{told}` does not start with `{place}`");
    assert!(told.contains(row.rule), "`{told}` lacks `{}`", row.rule);
    // What was found follows a question in brackets.
    let ends = [format!(", found {}", row.found), format!("? (found {})", row.found)];
    assert!(ends.iter().any(|end| told.ends_with(end)), "`{told}` does not end with one of {ends:?}");
}

/// Wrong shapes, which the schema refuses too.
fn shapes() -> Vec<Bad> {
    vec![
        bad("/name", Value::Null, "name", "is required", "nothing"),
        bad("/load", Value::Null, "load", "is required", "nothing"),
        bad("/ground/supports", Value::Null, "ground.supports", "is required", "nothing"),
        bad("/springs/1/rest_length_m", Value::Null, "springs[1].rest_length_m", "is required", "nothing"),
        bad("/springs/2/ring/n", Value::Null, "springs[2].ring.n", "is required", "nothing"),
        bad("/drive/kind", Value::Null, "drive.kind", "is required and must be one of \"tips\", \"ants\"", "nothing"),
        bad("/drive/paths/0/waypoints", Value::Null, "drive.paths[0].waypoints", "is required", "nothing"),
        bad("/drive/kind", json!("robots"), "drive.kind", "must be one of \"tips\", \"ants\"", "\"robots\""),
        bad("/drive/kind", json!(3), "drive.kind", "must be one of", "3"),
        bad("/drive", json!("tips"), "drive", "must be an object", "\"tips\""),
        bad("/durations", json!(2.0), "durations", "unknown key; did you mean `duration_s`?", "2.0"),
        bad("/load/masss_kg", json!(2), "load.masss_kg", "unknown key; did you mean `mass_kg`?", "2"),
        bad("/load/heading", json!(0.5), "load.heading", "unknown key; did you mean `heading_rad`?", "0.5"),
        bad(
            "/ground/supports/1/colour",
            json!("red"),
            "ground.supports[1].colour",
            "known keys are friction_coefficient, normal_load_n, offset_m",
            "\"red\"",
        ),
        bad("/springs/0/damping", json!(0.1), "springs[0].damping", "did you mean `damping_ratio`?", "0.1"),
        bad("/springs/2/ring/count", json!(2), "springs[2].ring.count", "is an unknown key", "2"),
        bad("/drive/paths/1/release", json!(1), "drive.paths[1].release", "did you mean `release_s`?", "1"),
        bad("/drive/n_ants", json!(4), "drive.n_ants", "is an unknown key; known keys are kind, paths", "4"),
        bad("/load/mass_kg", json!("heavy"), "load.mass_kg", "must be a number", "\"heavy\""),
        bad("/load/radius_m", json!([0.1]), "load.radius_m", "must be a number", "a list of 1"),
        bad("/load/position_m", json!([0.0, 0.0, 0.0]), "load.position_m", "must be a list of 2 numbers", "a list of 3"),
        bad("/load/position_m", json!([0.0, true]), "load.position_m[1]", "must be a number", "true"),
        bad("/load", json!([]), "load", "must be an object", "a list of 0"),
        bad("/seed", json!(-1), "seed", "must be a whole number", "-1"),
        bad("/seed", json!(0.5), "seed", "must be a whole number", "0.5"),
        bad("/name", json!(7), "name", "must be a text", "7"),
        bad("/springs", json!({}), "springs", "must be a list", "an object"),
        bad("/springs/0", json!(0.3), "springs[0]", "must be an object", "0.3"),
        bad("/ground/supports", json!(3), "ground.supports", "must be an object or a list", "3"),
        bad("/ground/supports", json!({ "tripd": {} }), "ground.supports.tripd", "did you mean `tripod`?", "an object"),
        bad("/ground/supports", json!({ "posts": 1 }), "ground.supports.posts", "known keys are ring, tripod, uniform", "1"),
        bad("/drive/paths/0/waypoints/1", json!([1.0, 2.0]), "drive.paths[0].waypoints[1]", "must be a list of 3", "a list of 2"),
        bad("/drive/paths/0/spring", json!(-1), "drive.paths[0].spring", "must be a whole number", "-1"),
    ]
}

/// Values that break a rule where the shape is right.
fn values() -> Vec<Bad> {
    let free = "must give normal_load_n: only three supports";
    let on_line = json!([{ "offset_m": [-1, 0] }, { "offset_m": [0, 0] }, { "offset_m": [1, 0] }]);
    let tipping = json!([{ "offset_m": [-1, 1e-9] }, { "offset_m": [1, 1e-9] }, { "offset_m": [0, 1] }]);
    let part = json!([{ "offset_m": [0, 1], "normal_load_n": 1 }, { "offset_m": [-1, -1] }, { "offset_m": [1, -1] }]);
    let ring_of = |n: usize| json!({ "ring": { "n": n, "radius_m": 0.01, "normal_load_n": 0.1 } });
    vec![
        bad("/duration_s", json!(0.0), "duration_s", "must be positive", "0.0"),
        bad("/duration_s", json!(-2), "duration_s", "must be positive", "-2.0"),
        bad("/duration_s", json!(1.0001e7), "duration_s", "must be at most 1e9 control periods", "10001000.0"),
        bad("/duration_s", json!(1e300), "duration_s", "must be at most 1e50 in size", "1e300"),
        bad("/control_period_s", json!(0), "control_period_s", "must be positive", "0.0"),
        bad("/control_period_s", json!(2.0000001), "control_period_s", "must not be longer than the duration", "2.0000001"),
        bad("/load/mass_kg", json!(-0.0016), "load.mass_kg", "must be positive", "-0.0016"),
        bad("/load/mass_kg", json!(0), "load.mass_kg", "must be positive", "0.0"),
        bad("/load/mass_kg", Value::Null, "load.mass_kg", "is required unless density_kg_per_m2 is given", "nothing"),
        bad("/load/density_kg_per_m2", json!(1), "load.density_kg_per_m2", "must not be given together with mass_kg", "both"),
        bad("/load/radius_m", Value::Null, "load.radius_m", "is required unless outline is given", "nothing"),
        bad("/load/outline", json!({ "disc": { "radius_m": 1 } }), "load.outline", "must not be given together with radius_m", "both"),
        bad("/name", json!("\u{1b}[31m"), "name", "must not contain control characters", "\"\\u{1b}[31m\""),
        bad("/name", json!("a\u{202e}b"), "name", "must not contain control characters", "\"a\\u{202e}b\""),
        bad("/load/position_m", json!([0, -1.1e50]), "load.position_m[1]", "must be at most 1e50 in size", "-1.1e50"),
        bad(
            "/ground/friction_coefficient",
            json!(f64::MAX),
            "ground.friction_coefficient",
            "must be at most 1e50 in size",
            "1.7976931348623157e308",
        ),
        bad(
            "/drive/paths/0/waypoints/1",
            json!([1.0, 1e154, 0]),
            "drive.paths[0].waypoints[1][1]",
            "must be at most 1e50 in size",
            "1e154",
        ),
        bad("/load/radius_m", json!(0), "load.radius_m", "must be positive", "0.0"),
        bad("/load/inertia_kg_m2", json!(0), "load.inertia_kg_m2", "must be positive", "0.0"),
        bad("/load/radius_m", json!(1e-200), "load.radius_m", "must be at least 1e-50", "1e-200"),
        bad("/load/radius_m", json!(9.9e-51), "load.radius_m", "must be at least 1e-50", "9.9e-51"),
        bad("/springs/0/rest_length_m", json!(5e-324), "springs[0].rest_length_m", "must be at least 1e-50", "5e-324"),
        bad("/control_period_s", json!(5e-324), "control_period_s", "must be at least 1e-50", "5e-324"),
        bad("/ground/friction_coefficient", json!(-1e-300), "ground.friction_coefficient", "must not be negative", "-1e-300"),
        bad("/ground/gravity_m_per_s2", json!(0), "ground.gravity_m_per_s2", "must be positive", "0.0"),
        bad("/ground/gravity_m_per_s2", json!(-9.81), "ground.gravity_m_per_s2", "must be positive", "-9.81"),
        bad(
            "/ground/gravity_m_per_s2",
            json!(5e-324),
            "ground.gravity_m_per_s2",
            "must give a weight in the range of floating-point numbers",
            "0.0 N",
        ),
        bad("/ground/supports", json!([]), "ground.supports", "must be from 1 to 100000", "0"),
        bad("/ground/supports", json!([{ "offset_m": [0, 0] }]), "ground.supports", free, "1 support without"),
        bad(
            "/ground/supports",
            json!({ "ring": { "n": 4, "radius_m": 1 } }),
            "ground.supports.ring.normal_load_n",
            free,
            "4 supports without",
        ),
        bad("/ground/supports", on_line, "ground.supports", "undetermined", "three supports on one line"),
        bad("/ground/supports", tipping, "ground.supports[2].normal_load_n", "the load would tip", "-1.5696000015696004e-11"),
        bad("/ground/supports", part, "ground.supports", "on all supports or on none", "it on 1 of 3"),
        bad("/ground/supports", ring_of(0), "ground.supports.ring.n", "must be from 1 to 100000", "0"),
        bad("/ground/supports", ring_of(100_001), "ground.supports.ring.n", "must be from 1 to 100000", "100001"),
        bad("/ground/supports", json!({ "tripod": { "radius_m": 0 } }), "ground.supports.tripod.radius_m", "must be positive", "0.0"),
        bad(
            "/ground/supports",
            json!([{ "offset_m": [0, 0], "normal_load_n": 0 }]),
            "ground.supports",
            "must have at least one positive normal load",
            "zero on every support",
        ),
        bad(
            "/ground/supports",
            json!([{ "offset_m": [0, 0], "normal_load_n": 1 }, { "offset_m": [1, 0], "normal_load_n": -1e-9 }]),
            "ground.supports[1].normal_load_n",
            "must not be negative",
            "-1e-9",
        ),
        bad("/springs/0/rest_length_m", json!(-0.01), "springs[0].rest_length_m", "must not be negative", "-0.01"),
        bad(
            "/springs/0/rest_length_m",
            json!(0),
            "springs[0].rest_length_m",
            "must be positive for a spring with torsional stiffness",
            "0.0",
        ),
        bad("/springs/1/torsional_stiffness_nm_per_rad", json!(1e-12), "springs[1].rest_length_m", "has no direction", "0.0"),
        bad("/springs/0/radial_stiffness_n_per_m", json!(-1), "springs[0].radial_stiffness_n_per_m", "must not be negative", "-1.0"),
        bad(
            "/springs/1/radial_stiffness_n_per_m",
            json!(0),
            "springs[1].radial_stiffness_n_per_m",
            "must be positive where the torsional stiffness is zero",
            "0.0",
        ),
        bad(
            "/springs/0/torsional_stiffness_nm_per_rad",
            json!(-1e-5),
            "springs[0].torsional_stiffness_nm_per_rad",
            "must not be negative",
            "-1e-5",
        ),
        bad("/springs/0/damping_ratio", json!(-0.1), "springs[0].damping_ratio", "must not be negative", "-0.1"),
        bad("/springs/2/ring/n", json!(0), "springs[2].ring.n", "must be from 1 to 100000", "0"),
        bad("/springs/2/ring/n", json!(u64::MAX), "springs[2].ring.n", "must be from 1 to 100000", "18446744073709551615"),
        bad("/springs/2/ring/n", json!(99_999), "springs", "must be at most 100000 in all", "100001"),
        bad("/springs/2/ring/radius_m", json!(-0.01), "springs[2].ring.radius_m", "must not be negative", "-0.01"),
        bad("/springs/2/ring/rest_length_m", json!(-0.01), "springs[2].ring.rest_length_m", "must not be negative", "-0.01"),
        bad("/drive/paths/1/spring", json!(4), "drive.paths[1].spring", "must be an index below the number of springs, 4", "4"),
        bad(
            "/drive/paths/1/spring",
            json!(0),
            "drive.paths[1].release_s",
            "is required and must not be later than 0.5, where drive.paths[0] attaches the same spring",
            "nothing",
        ),
        bad(
            "/drive/paths/1",
            json!({ "spring": 0, "waypoints": [[1.499, 0, 0]] }),
            "drive.paths[0].release_s",
            "must not be later than 1.499, where drive.paths[1] attaches the same spring",
            "1.5",
        ),
        bad("/drive/paths/1/waypoints", json!([]), "drive.paths[1].waypoints", "must have at least one waypoint", "none"),
        bad("/drive/paths/1/waypoints/0", json!([-1e-9, 0, 0]), "drive.paths[1].waypoints[0][0]", "must not be negative", "-1e-9"),
        bad(
            "/drive/paths/0/waypoints/1",
            json!([0.5, 0, 0]),
            "drive.paths[0].waypoints[1][0]",
            "must be later than the previous waypoint, 0.5",
            "0.5",
        ),
        // A run would take both for one instant, and move the tip over the control period before.
        bad(
            "/drive/paths/0/waypoints/1",
            json!([0.50000000001, 0, 0]),
            "drive.paths[0].waypoints[1][0]",
            "must be later than the previous waypoint by at least 2e-11 s, 2e-9 control periods",
            "0.50000000001",
        ),
        bad("/drive/paths/0/release_s", json!(0.5), "drive.paths[0].release_s", "must be later than the first waypoint, 0.5", "0.5"),
    ]
}

fn ant_values() -> Vec<Bad> {
    let text = "\"often\"";
    vec![
        bad("/drive/n_ants", json!(0), "drive.n_ants", "must be from 1 to 1000000", "0"),
        bad("/drive/n_ants", json!(1_000_001), "drive.n_ants", "must be from 1 to 1000000", "1000001"),
        bad("/springs", json!([]), "springs", "must have at least one spring", "none"),
        bad("/drive/arrival_radius_m", json!(0), "drive.arrival_radius_m", "must be positive", "0.0"),
        bad("/drive/start_half_width_m", json!(-0.1), "drive.start_half_width_m", "must not be negative", "-0.1"),
        bad("/drive/search_speed_m_per_s", json!(-0.08), "drive.search_speed_m_per_s", "must not be negative", "-0.08"),
        bad("/drive/pull_speed_m_per_s", json!(-0.03), "drive.pull_speed_m_per_s", "must not be negative", "-0.03"),
        bad("/drive/sensing_range_m", json!(-1), "drive.sensing_range_m", "must not be negative", "-1.0"),
        bad("/drive/target_variance_m2", json!(-1), "drive.target_variance_m2", "must not be negative", "-1.0"),
        bad("/drive/target_redraw_period_s", json!(0), "drive.target_redraw_period_s", "must be positive", "0.0"),
        bad("/drive/steering_gain_per_s", json!(-10), "drive.steering_gain_per_s", "must not be negative", "-10.0"),
        bad(
            "/drive/steering_half_angle_rad",
            json!(std::f64::consts::PI.next_up()),
            "drive.steering_half_angle_rad",
            "must be from 0 to pi",
            "3.1415926535897936",
        ),
        bad("/drive/steering_half_angle_rad", json!(-0.1), "drive.steering_half_angle_rad", "must be from 0 to pi", "-0.1"),
        bad("/drive/control_offset_m", json!(-0.1), "drive.control_offset_m", "must not be negative", "-0.1"),
        bad("/drive/grasp_probability", json!(1), "drive.grasp_probability", "must be at least 0 and below 1", "1.0"),
        bad("/drive/grasp_probability", json!(-0.2), "drive.grasp_probability", "must be at least 0", "-0.2"),
        bad("/drive/grasp_decision_period_s", json!(0), "drive.grasp_decision_period_s", "must be positive", "0.0"),
        bad("/drive/strong_pull_n", json!(-0.02), "drive.strong_pull_n", "must not be negative", "-0.02"),
        bad("/drive/release_steepness_per_n", json!(-1), "drive.release_steepness_per_n", "must not be negative", "-1.0"),
        bad("/drive/release_decision_period_s", json!(0), "drive.release_decision_period_s", "must be positive", "0.0"),
        bad(
            "/drive/release_decision_period_s",
            json!(0.0099),
            "drive.release_decision_period_s",
            "must not be shorter than the control period",
            "0.0099",
        ),
        bad("/drive/grasp_pace", json!("aged"), "drive.grasp_pace", "must be one of \"hazard\", \"per-tick\"", "\"aged\""),
        bad("/drive/release_pace", json!("often"), "drive.release_pace", "must be one of \"aged\", \"hazard\", \"per-tick\"", text),
        bad("/drive/avoidance", json!("swerve"), "drive.avoidance", "must be one of \"none\", \"sidestep\", \"turn\"", "\"swerve\""),
        bad("/drive/body_radius_m", json!(0), "drive.body_radius_m", "must be positive", "0.0"),
        bad("/drive/look_ahead_m", json!(-0.03), "drive.look_ahead_m", "must be positive", "-0.03"),
        bad("/drive/preset", json!("papers"), "drive.preset", "must be one of \"paper\", \"fitted\", \"paper-speed\"", "\"papers\""),
        bad("/drive/nest_position_m", json!(0.2), "drive.nest_position_m", "must be a list", "0.2"),
        bad("/drive/n_antz", json!(5), "drive.n_antz", "did you mean `n_ants`?", "5"),
    ]
}

/// Outlines that break a rule, with the place within the outline.
fn outlines() -> Vec<(Value, &'static str, &'static str, &'static str)> {
    let polygon = |points: Value| json!({ "polygon": { "points_m": points } });
    let polyline = |points: Value| json!({ "polyline": { "points_m": points } });
    let keys = "must have exactly one of the keys compound, disc, polygon, polyline, rectangle";
    let many: Vec<[f64; 2]> = (0..1001).map(|at| [at as f64, 0.0]).collect();
    vec![
        (json!({}), "", keys, "none"),
        (json!({ "disc": { "radius_m": 1 }, "rectangle": { "size_m": [1, 1] } }), "", keys, "disc, rectangle"),
        (json!({ "disc": { "radius_m": 0 } }), ".disc.radius_m", "must be positive", "0.0"),
        (json!({ "disc": {} }), ".disc.radius_m", "is required", "nothing"),
        (json!({ "rectangle": { "size_m": [1, -1] } }), ".rectangle.size_m[1]", "must be positive", "-1.0"),
        (json!({ "rectangle": { "size_m": 1 } }), ".rectangle.size_m", "must be a list", "1"),
        (json!({ "compound": { "parts": [] } }), ".compound.parts", "must have at least one part", "none"),
        (
            json!({ "compound": { "parts": [{ "outline": { "disc": { "radius_m": -1 } } }] } }),
            ".compound.parts[0].outline.disc.radius_m",
            "must be positive",
            "-1.0",
        ),
        (
            json!({ "compound": { "parts": [{ "outline": { "disc": { "radius_m": 1 } }, "position_m": [1e51, 0] }] } }),
            ".compound.parts[0].position_m[0]",
            "must be at most 1e50 in size",
            "1e51",
        ),
        (polygon(json!([[0, 0], [1, 0]])), ".polygon.points_m", "must have at least 3 corners", "2"),
        (polygon(json!([[0, 0], [1, 0], [1, 0], [0, 1]])), ".polygon.points_m[2]", "must not be the same point", "[1.0, 0.0]"),
        (polygon(json!([[0, 0], [1, 0], [0, 1], [0, 0]])), ".polygon.points_m[0]", "must not be the same point", "[0.0, 0.0]"),
        (polygon(json!([[0, 0], [1, 1], [1, 0], [0, 1]])), ".polygon.points_m", "must not cross", "the sides from corners 0 and 2 that do"),
        (polygon(json!([[0, 0], [2, 0], [1, 0]])), ".polygon.points_m", "must not cross", "the sides from corners 0 and 1 that do"),
        (
            json!({ "rectangle": { "size_m": [1e9, 0.9] } }),
            ".rectangle.size_m",
            "must have no side below 1e-9 of the other",
            "[1000000000.0, 0.9]",
        ),
        (polyline(json!([[0, 0]])), ".polyline.points_m", "must have at least 2 points", "1"),
        (polyline(json!([[0, 0], [0, 0]])), ".polyline.points_m[1]", "must not be the same point", "[0.0, 0.0]"),
        (polyline(json!(many)), "", "must have at most 1000 points and parts in all", "1001"),
    ]
}

/// Other rules of a load with an outline and of obstacles.
fn world_values() -> Vec<Bad> {
    let part = |at: f64| json!({ "outline": { "rectangle": { "size_m": [0.5, 0.5] } }, "position_m": [at, 4] });
    let parts = |at: f64| json!({ "compound": { "parts": [part(-at), part(at)] } });
    let corner = json!({ "polygon": { "points_m": [[0, 4], [3, 4], [0, 7]] } });
    let wall = json!({ "polyline": { "points_m": [[-1, 1], [1, 1]] } });
    let mixed = json!({ "compound": { "parts": [{ "outline": wall }, part(0.0)] } });
    let jump = "must be reached with at most 0.02236";
    vec![
        bad("/load/outline", wall.clone(), "load.outline", "must enclose an area", "a polyline"),
        bad("/load/outline", mixed, "load.outline", "must enclose an area", "a polyline"),
        bad(
            "/load/outline",
            parts(0.1875),
            "load.outline",
            "must have parts that do not overlap",
            "parts 0 and 1, which overlap by 1.250e-1 m",
        ),
        bad("/load/outline", parts(0.25), "load.outline", "must have its centroid at the origin", "the centroid [0.0, 4.0]"),
        bad("/load/outline", corner, "load.outline", "give mass_kg, inertia_kg_m2 and supports", "the centroid [1.0, 5.0]"),
        bad("/load/side_friction_coefficient", json!(-0.1), "load.side_friction_coefficient", "must not be negative", "-0.1"),
        bad("/load/restitution", json!(1.1), "load.restitution", "must be from 0 to 1", "1.1"),
        bad("/load/restitution", json!(-0.1), "load.restitution", "must be from 0 to 1", "-0.1"),
        bad("/ground/supports", json!({ "uniform": { "n": 2 } }), "ground.supports.uniform.n", "must be from 3 to 10000", "2"),
        bad("/ground/supports", json!({ "uniform": { "n": 10_001 } }), "ground.supports.uniform.n", "must be from 3 to 10000", "10001"),
        bad("/side_friction_rule", json!("median"), "side_friction_rule", "must be one of \"geometric-mean\", \"average\"", "\"median\""),
        bad("/obstacles/0/name", json!(" "), "obstacles[0].name", "must not be empty", "\" \""),
        bad("/obstacles/0/name", json!("\u{7}"), "obstacles[0].name", "must not contain control characters", "\"\\u{7}\""),
        bad("/obstacles/1/name", json!("wall"), "obstacles[1].name", "must not be the name of another obstacle, obstacles[0]", "\"wall\""),
        bad("/obstacles/0/outline", Value::Null, "obstacles[0].outline", "is required", "nothing"),
        bad("/obstacles/0/friction_coefficient", json!(-1), "obstacles[0].friction_coefficient", "must not be negative", "-1.0"),
        bad("/obstacles/0/restitution", json!(2), "obstacles[0].restitution", "must be from 0 to 1", "2.0"),
        bad(
            "/obstacles/0/position_m",
            json!([0, -0.004]),
            "obstacles[0]",
            "must not overlap the load at the start, as \"wall\" does",
            "a depth of 1.000e-3 m",
        ),
        bad("/obstacles/1/heading_rad", json!(0), "obstacles[1].path", "must not be given together with position_m", "both"),
        bad("/obstacles/1/path/waypoints", json!([]), "obstacles[1].path.waypoints", "must have at least one waypoint", "none"),
        bad("/obstacles/1/path/waypoints/0/0", json!(-1), "obstacles[1].path.waypoints[0][0]", "must not be negative", "-1.0"),
        bad("/obstacles/1/path/waypoints/1/0", json!(0), "obstacles[1].path.waypoints[1][0]", "must be later than the previous", "0.0"),
        bad("/obstacles/1/path/waypoints/1/2", json!(3.3), "obstacles[1].path.waypoints[1]", jump, "0.023 m"),
        bad(
            "/obstacles/1/path/waypoints/0",
            json!([0, 0, 0, 0]),
            "obstacles[1]",
            "must not overlap the load at the start",
            "a depth of 7.000e-3 m",
        ),
    ]
}

#[test]
fn a_wrong_outline_is_told_of_obstacles_and_loads() {
    for (outline, place, rule, found) in outlines() {
        for base in ["/load/outline", "/obstacles/0/outline"] {
            let told = error_of(&changed(world(), base, outline.clone()));
            let path = format!("bad.json: {}{place}: ", if base == "/load/outline" { "load.outline" } else { "obstacles[0].outline" });
            assert_eq!(told.lines().count(), 1, "{outline}:\n{told}");
            assert!(told.starts_with(&path) && told.contains(rule), "`{told}` lacks `{path}` or `{rule}`");
            assert!(told.ends_with(&format!(", found {found}")), "`{told}` does not end with `{found}`");
        }
    }
}

#[test]
fn a_wrong_world_is_told() {
    world_values().iter().for_each(|row| assert_told(&world(), row));
}

#[test]
fn a_world_a_hair_inside_of_each_threshold_is_accepted() {
    let square = |at: f64| json!({ "outline": { "rectangle": { "size_m": [0.01, 0.01] } }, "position_m": [at, 0] });
    let inside = [
        ("/load/restitution", json!(1)),
        ("/load/restitution", json!(0)),
        // Parts that share an edge, and a load that touches the wall.
        ("/load/outline", json!({ "compound": { "parts": [square(-0.005), square(0.005)] } })),
        // A centroid off by rounding.
        (
            "/load/outline",
            json!({ "polygon": { "points_m": [[-0.1, -0.0049], [0.1, -0.0049], [0.1, 0.004900000000001], [-0.1, 0.0049]] } }),
        ),
        // Clockwise corners.
        ("/load/outline", json!({ "polygon": { "points_m": [[-0.1, -0.004], [-0.1, 0.004], [0.1, 0.004], [0.1, -0.004]] } })),
        ("/ground/supports", json!({ "uniform": { "n": 3 } })),
        ("/ground/supports", json!({ "uniform": { "n": 10_000 } })),
        ("/side_friction_rule", json!("multiply")),
        ("/obstacles", json!([])),
        ("/obstacles/0/position_m", json!([0, -0.0050000001])),
        ("/obstacles/1/path/waypoints/1/2", json!(3.236)),
        ("/obstacles/1/path/waypoints", json!([[5, 0, 1, 0]])),
        ("/obstacles/0/heading_rad", json!(std::f64::consts::PI)),
    ];
    for (at, put) in inside {
        let file = changed(world(), at, put.clone());
        Scenario::parse(&file.to_string(), "good.json").unwrap_or_else(|error| panic!("{at} {put}: {error}"));
    }
}

#[test]
fn a_wrong_shape_is_told_and_the_schema_refuses_it_too() {
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    assert!(schema.is_valid(&tips()));
    for row in shapes() {
        assert_told(&tips(), &row);
        assert!(!schema.is_valid(&changed(tips(), row.at, row.put)), "the schema takes {}", row.at);
    }
}

/// Numbers that the schema bounds are those that the program refuses: beyond its bound, each number
/// of a file breaks a rule at its own key.
#[test]
fn bounds_of_the_schema_are_rules_of_the_program() {
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    let mut n = 0;
    for base in [tips(), ants(), world()] {
        let expanded = Scenario::parse(&base.to_string(), "base").unwrap().expanded();
        let file = serde_json::to_value(expanded).unwrap();
        assert!(schema.is_valid(&file));
        for pointer in numbers(&file, "") {
            let below = changed(file.clone(), &pointer, json!(-1));
            let key = pointer.rsplit('/').next().unwrap();
            if schema.is_valid(&below) {
                continue;
            }
            let told = error_of(&below);
            assert!(told.contains(key), "{pointer}: {told}");
            n += 1;
        }
    }
    assert!(n > 50, "{n}");
}

/// Pointers to all numbers under keys.
fn numbers(value: &Value, at: &str) -> Vec<String> {
    match value {
        Value::Number(_) => vec![at.to_owned()],
        Value::Object(map) => map.iter().flat_map(|(key, value)| numbers(value, &format!("{at}/{key}"))).collect(),
        Value::Array(list) if list.iter().any(Value::is_object) => {
            list.iter().enumerate().flat_map(|(index, value)| numbers(value, &format!("{at}/{index}"))).collect()
        }
        _ => Vec::new(),
    }
}

#[test]
fn a_wrong_value_is_told() {
    values().iter().for_each(|row| assert_told(&tips(), row));
}

#[test]
fn a_wrong_parameter_of_the_ants_is_told() {
    ant_values().iter().for_each(|row| assert_told(&ants(), row));
}

#[test]
fn a_hair_inside_of_each_threshold_is_accepted() {
    let on_edge = json!([{ "offset_m": [-1, 0] }, { "offset_m": [1, 0] }, { "offset_m": [0, 1] }]);
    let inside = [
        ("/duration_s", json!(1e7)),
        ("/duration_s", json!(0.01)),
        ("/control_period_s", json!(2.0)),
        ("/load/mass_kg", json!(1e-9)),
        ("/load/mass_kg", json!(1e3)),
        ("/load/position_m", json!([1e50, -1e50])),
        ("/ground/friction_coefficient", json!(1e50)),
        ("/load/radius_m", json!(1e-9)),
        ("/load/inertia_kg_m2", json!(1e-300)),
        ("/ground/friction_coefficient", json!(0)),
        ("/ground/gravity_m_per_s2", json!(1e-300)),
        ("/ground/supports", on_edge),
        ("/ground/supports", json!([{ "offset_m": [-1, -1e-9] }, { "offset_m": [1, -1e-9] }, { "offset_m": [0, 1] }])),
        ("/ground/supports", json!([{ "offset_m": [0, 0], "normal_load_n": 1e-300 }, { "offset_m": [1, 0], "normal_load_n": 0 }])),
        ("/ground/supports", json!({ "ring": { "n": 100_000, "radius_m": 0, "normal_load_n": 1 } })),
        ("/springs/0/rest_length_m", json!(1e-12)),
        ("/springs/0/radial_stiffness_n_per_m", json!(0)),
        ("/springs/0/damping_ratio", json!(0)),
        ("/springs/0/damping_ratio", json!(50)),
        ("/springs/2/ring/n", json!(99_998)),
        ("/springs/2/ring/n", json!(1)),
        ("/drive/paths/1/spring", json!(3)),
        ("/drive/paths/1/waypoints/0", json!([1e9, 0, 0])),
        ("/drive/paths/0/waypoints/1", json!([0.5000000001, 0, 0])),
        ("/drive/paths/0/waypoints/1", json!([0.50000000003, 0, 0])),
        ("/drive/paths/0/release_s", json!(0.5000000001)),
        ("/drive/paths", json!([])),
        ("/$schema", json!("scenario.schema.json")),
        ("/seed", json!(u64::MAX)),
    ];
    for (at, put) in inside {
        let file = changed(tips(), at, put.clone());
        assert!(Scenario::parse(&file.to_string(), "good.json").is_ok(), "{at} {put}: {}", error_of(&file));
    }
    let ants_inside = [
        ("/drive/n_ants", json!(1)),
        ("/drive/n_ants", json!(1_000_000)),
        ("/drive/grasp_probability", json!(0.999_999)),
        ("/drive/grasp_probability", json!(0)),
        ("/drive/steering_half_angle_rad", json!(std::f64::consts::PI)),
        ("/drive/steering_half_angle_rad", json!(0)),
        ("/drive/release_decision_period_s", json!(0.01)),
        ("/drive/pull_speed_m_per_s", json!(0)),
        ("/drive/target_variance_m2", json!(0)),
    ];
    for (at, put) in ants_inside {
        let file = changed(ants(), at, put.clone());
        assert!(Scenario::parse(&file.to_string(), "good.json").is_ok(), "{at} {put}: {}", error_of(&file));
    }
    // A certain grasp at every tick is a probability, not a hazard; a decision between ticks is no
    // matter for one.
    let certain = changed(changed(ants(), "/drive/grasp_pace", json!("per-tick")), "/drive/grasp_probability", json!(1));
    assert!(Scenario::parse(&certain.to_string(), "good.json").is_ok());
    let hasty = changed(changed(ants(), "/drive/release_pace", json!("hazard")), "/drive/release_decision_period_s", json!(1e-4));
    assert!(Scenario::parse(&hasty.to_string(), "good.json").is_ok());
}

#[test]
fn damping_without_radial_stiffness_is_told() {
    let limp = changed(changed(tips(), "/springs/0/radial_stiffness_n_per_m", json!(0)), "/springs/0/damping_ratio", json!(0.1));
    assert_eq!(
        error_of(&limp),
        "bad.json: springs[0].damping_ratio: must be zero where the radial stiffness is zero: critical damping is that of the radial \
         stiffness, found 0.1"
    );
}

#[test]
fn every_finding_is_told_at_once_across_shapes_and_values() {
    let changes = [
        ("/load/mass_kg", json!(-1)),
        ("/load/radius_m", json!(0)),
        ("/ground/friction_coeficient", json!(1)),
        ("/springs/0/bearing_rad", json!("east")),
        ("/control_period_s", json!(-1)),
        ("/drive/paths/0/release_s", json!(0)),
        ("/drive/paths/1/waypoints", json!([])),
        ("/nmae", json!("x")),
    ];
    let file = changes.iter().fold(tips(), |file, (at, put)| changed(file, at, put.clone()));
    let Err(ScenarioError::Invalid { findings, .. }) = Scenario::parse(&file.to_string(), "bad.json") else { panic!() };
    let mut paths: Vec<_> = findings.iter().map(|finding| finding.path.as_str()).collect();
    paths.sort_unstable();
    let expected = [
        "control_period_s",
        "drive.paths[0].release_s",
        "drive.paths[1].waypoints",
        "ground.friction_coeficient",
        "load.mass_kg",
        "load.radius_m",
        "nmae",
        "springs[0].bearing_rad",
    ];
    assert_eq!(paths, expected);
}

#[test]
fn text_that_is_not_json_is_told_by_line_and_column() {
    let told = |text: &str| Scenario::parse(text, "bad.json").unwrap_err().to_string();
    assert_eq!(told(""), "bad.json: line 1 column 0: must be JSON: EOF while parsing a value");
    assert_eq!(told("{\n  \"name\": \"x\",\n}"), "bad.json: line 3 column 1: must be JSON: trailing comma");
    assert!(told("{\"load\": NaN}").starts_with("bad.json: line 1 column 10: must be JSON: expected"));
    assert!(told("{\"duration_s\": 1e999}").contains("must be JSON: number out of range"));
    assert!(told("{} {}").contains("line 1 column 4: must be JSON: trailing characters"));
    // Deep nesting is refused before it can exhaust the stack.
    assert!(told(&"[".repeat(100_000)).contains("must be JSON: recursion limit exceeded"));
    assert_eq!(told("[1, 2]"), "bad.json: must be an object, found a list of 2");
    assert_eq!(told("null"), "bad.json: must be an object, found null");
}

#[test]
fn a_key_given_twice_is_told_and_not_dropped() {
    let text = tips().to_string().replacen("\"mass_kg\":", "\"mass_kg\":5,\"mass_kg\":", 1);
    let told = Scenario::parse(&text, "bad.json").unwrap_err().to_string();
    assert_eq!(told, "bad.json: load.mass_kg: must be given once, found it a second time");
}

#[test]
fn a_missing_file_and_a_folder_are_told_by_name() {
    let missing = Scenario::read(Path::new("/no/such/scenario.json")).unwrap_err().to_string();
    assert!(missing.starts_with("/no/such/scenario.json: cannot be read: "), "{missing}");
    let folder = tempfile::tempdir().unwrap();
    let told = Scenario::read(folder.path()).unwrap_err().to_string();
    assert!(told.starts_with(&folder.path().display().to_string()) && told.contains("cannot be read"), "{told}");
    let file = folder.path().join("latin.json");
    std::fs::write(&file, b"{\"name\": \"\xe9\"}").unwrap();
    assert!(Scenario::read(&file).unwrap_err().to_string().contains("UTF-8"));
}

/// JSON has no NaN, code has.
#[test]
fn numbers_that_are_not_finite_are_told_when_a_file_is_built_in_code() {
    let good = Scenario::parse(&tips().to_string(), "good.json").unwrap().expanded();
    let mut file = good.clone();
    file.load.mass_kg = Some(f64::NAN);
    file.load.position_m[1] = f64::INFINITY;
    file.duration_s = f64::INFINITY;
    file.ground.friction_coefficient = f64::NAN;
    let format::DriveEntry::Tips(tips) = &mut file.drive else { panic!() };
    tips.paths[0].waypoints[1][2] = f64::NAN;
    let told = file.checked("in code").unwrap_err().to_string();
    for line in [
        "in code: load.mass_kg: must be a finite number, found NaN",
        "in code: load.position_m[1]: must be a finite number, found inf",
        "in code: duration_s: must be a finite number, found inf",
        "in code: ground.friction_coefficient: must be a finite number, found NaN",
        "in code: drive.paths[0].waypoints[1][2]: must be a finite number, found NaN",
    ] {
        assert!(told.lines().any(|found| found == line), "{told}");
    }
    assert_eq!(told.lines().count(), 5, "{told}");
}

/// JSON pointers to everything in `value`.
fn pointers(value: &Value, at: &str) -> Vec<String> {
    let below = |key: String, value: &Value| pointers(value, &format!("{at}/{key}"));
    let inner: Vec<String> = match value {
        Value::Object(map) => map.iter().flat_map(|(key, value)| below(key.clone(), value)).collect(),
        Value::Array(list) => list.iter().enumerate().flat_map(|(index, value)| below(index.to_string(), value)).collect(),
        _ => Vec::new(),
    };
    [at.to_string()].into_iter().chain(inner).filter(|at| !at.is_empty()).collect()
}

/// Every value of a good file replaced by every odd one: there is an answer and no panic, and what
/// is accepted fits the schema and survives its expansion.
#[test]
fn odd_values_anywhere_are_answered() {
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    let odd = [
        json!(null),
        json!(true),
        json!("x"),
        json!(""),
        json!(0),
        json!(-0.0),
        json!(-1),
        json!(7),
        json!(1e308),
        json!(5e-324),
        json!(u64::MAX),
        json!([]),
        json!([1, 2]),
        json!([[1, 2, 3]]),
        json!({}),
        json!({ "ring": {} }),
    ];
    let (mut n_accepted, mut n_refused) = (0, 0);
    let mut shapes = world();
    let part = json!({ "outline": { "polygon": { "points_m": [[-1, -1], [1, -1], [0, 2]] } }, "position_m": [0, 9] });
    shapes["load"]["outline"] = json!({ "compound": { "parts": [part] } });
    shapes["load"]["inertia_kg_m2"] = json!(1);
    for base in [tips(), ants(), world(), shapes] {
        for at in pointers(&base, "") {
            for value in &odd {
                let mut file = base.clone();
                *file.pointer_mut(&at).unwrap() = value.clone();
                let Ok(scenario) = Scenario::parse(&file.to_string(), "odd.json") else {
                    n_refused += 1;
                    continue;
                };
                n_accepted += 1;
                assert!(schema.is_valid(&file), "{at} {value}");
                scenario.warnings();
                json::check(&Advice::of(&scenario)).unwrap_or_else(|error| panic!("{at} {value}: {error}"));
                let expansion = serde_json::to_string(&scenario.expanded()).unwrap();
                assert_eq!(Scenario::parse(&expansion, "expansion").unwrap(), scenario, "{at} {value}");
            }
        }
    }
    // Both answers must occur in numbers, or nothing was tried.
    assert!(n_accepted > 200 && n_refused > 500, "{n_accepted} {n_refused}");
}

/// Forty-two springs break the same rule: five are listed, the others are counted.
#[test]
fn long_lists_of_equal_faults_are_counted() {
    let mut file = tips();
    let mut spring = file["springs"][0].clone();
    spring["rest_length_m"] = json!(-1.0);
    file["springs"] = json!(vec![spring; 42]);
    let error = Scenario::parse(&file.to_string(), "bad.json").unwrap_err();
    assert_eq!(error.findings().len(), 42);
    let told = error.to_string();
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(lines.len(), 6, "{told}");
    assert_eq!(lines[0], "bad.json: springs[0].rest_length_m: must not be negative, found -1.0");
    assert_eq!(lines[5], "bad.json: springs[].rest_length_m: must not be negative: and 37 more");
}
