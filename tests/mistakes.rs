//! Thirty-six mistakes of a first scene. Each is an error that names its place, the rule and what
//! was found, or a warning; the schema refuses those that are a matter of shape or bounds.

#[path = "common/changes.rs"]
mod changes;

use cohaul::scenario::{Scenario, format};
use serde_json::{Value, json};

use changes::changed;

/// How a mistake is answered.
enum Answer {
    /// An error that begins and ends like this.
    Error(&'static str, &'static str),
    /// The same, and editors see it.
    AlsoInSchema(&'static str, &'static str),
    /// A warning that begins like this.
    Warning(&'static str),
}

use Answer::{AlsoInSchema, Error, Warning};

struct Mistake {
    what: &'static str,
    changes: Vec<(&'static str, Value)>,
    answer: Answer,
}

fn mistake(what: &'static str, at: &'static str, put: Value, answer: Answer) -> Mistake {
    Mistake { what, changes: vec![(at, put)], answer }
}

/// Two robots tow a box of 2 kg.
fn first_scene() -> Value {
    let spring = |y: f64| {
        json!({ "root_m": [0.2, y], "bearing_rad": 0.0, "rest_length_m": 0.2, "radial_stiffness_n_per_m": 100.0,
            "torsional_stiffness_nm_per_rad": 0.2, "damping_ratio": 0.3 })
    };
    json!({
        "$schema": "scenario.schema.json",
        "name": "a first scene", "duration_s": 10.0, "control_period_s": 0.01,
        "load": { "mass_kg": 2.0, "outline": { "rectangle": { "size_m": [0.4, 0.3] } } },
        "ground": { "friction_coefficient": 0.5, "supports": { "uniform": { "n": 16 } } },
        "springs": [spring(0.1), spring(-0.1)],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.0, 0.4, 0.1], [8.0, 1.2, 0.1]], "release_s": 9.0 },
            { "spring": 1, "waypoints": [[0.0, 0.4, -0.1], [8.0, 1.2, -0.1]] } ] }
    })
}

/// A number in another unit.
fn units() -> Vec<Mistake> {
    let in_mm = json!([[0.0, 400.0, 100.0], [8.0, 1200.0, 100.0]]);
    let in_ms = json!([[0.0, 0.4, 0.1], [8000.0, 1.2, 0.1]]);
    let soft = |what, unit: f64| Mistake {
        what,
        changes: vec![
            ("/springs/0/radial_stiffness_n_per_m", json!(100.0 * unit)),
            ("/springs/1/radial_stiffness_n_per_m", json!(100.0 * unit)),
            ("/springs/0/torsional_stiffness_nm_per_rad", json!(0.2 * unit)),
            ("/springs/1/torsional_stiffness_nm_per_rad", json!(0.2 * unit)),
        ],
        answer: Warning("load: should be light enough to be moved: masses are in kilograms, stiffnesses in N/m"),
    };
    let ants =
        |key: &str, value: Value| json!({ "kind": "ants", "n_ants": 4, "nest_position_m": [2.0, 0.0], "strong_pull_n": 10.0, key: value });
    vec![
        mistake("duration in ms", "/duration_s", json!(10_000), Warning("duration_s: should be in seconds")),
        mistake("control period in ms", "/control_period_s", json!(10.5), Error("control_period_s: must not be longer", "found 10.5")),
        mistake("mass in g", "/load/mass_kg", json!(2000), Warning("load: should be in kilograms and metres")),
        mistake(
            "outline in mm",
            "/load/outline",
            json!({ "rectangle": { "size_m": [400, 300] } }),
            Warning("load: should be in kilograms and metres"),
        ),
        mistake("root in mm", "/springs/0/root_m", json!([200, 100]), Warning("springs[0].root_m: should be at most 2 radii of the load")),
        mistake(
            "rest length in mm",
            "/springs/1/rest_length_m",
            json!(200),
            Warning("springs[1].rest_length_m: should be at most 50 radii"),
        ),
        mistake("waypoints in mm", "/drive/paths/0/waypoints", in_mm, Warning("drive.paths[0].waypoints[0]: should be near the tip")),
        mistake(
            "times in ms",
            "/drive/paths/0/waypoints",
            in_ms,
            // The release at 9 s does not wait for the waypoint.
            Warning("drive.paths[0].waypoints[1][0]: a waypoint should not be after the end of the run, 10 s, found 8000 s"),
        ),
        mistake("release in ms", "/drive/paths/0/release_s", json!(9000), Warning("drive.paths[0].release_s: the release should not be")),
        mistake("bearing in degrees", "/springs/0/bearing_rad", json!(90), Warning("springs[0].bearing_rad: should be at most one turn")),
        mistake("heading in degrees", "/load/heading_rad", json!(30), Warning("load.heading_rad: should be at most one turn, 2 pi")),
        mistake(
            "friction in percent",
            "/ground/friction_coefficient",
            json!(50),
            Warning("ground.friction_coefficient: should be at most 5"),
        ),
        mistake(
            "gravity in cm/s^2",
            "/ground/gravity_m_per_s2",
            json!(981),
            Warning("ground.gravity_m_per_s2: should be in m/s^2, found 981"),
        ),
        soft("stiffness in N/mm", 1e-3),
        mistake(
            "speed of ants in mm/s",
            "/drive",
            ants("pull_speed_m_per_s", json!(50)),
            Warning("drive.pull_speed_m_per_s: should be at most 2.14 m/s, the sensing range per control period, found 50 m/s"),
        ),
        mistake(
            "nest in mm",
            "/drive",
            ants("nest_position_m", json!([2000.0, 0.0])),
            Warning("drive.nest_position_m: should be in metres"),
        ),
    ]
}

/// A number that is right elsewhere.
fn indices_and_order() -> Vec<Mistake> {
    let twice = json!([{ "spring": 0, "waypoints": [[0, 0.4, 0.1]] }, { "spring": 0, "waypoints": [[1, 0.4, 0.1]] }]);
    let time_last = json!([[0.4, 0.1, 0.0], [1.2, 0.1, 8.0]]);
    vec![
        mistake(
            "springs counted from 1",
            "/drive/paths/1/spring",
            json!(2),
            Error("drive.paths[1].spring: must be an index below the number of springs, 2", "found 2"),
        ),
        mistake(
            "a negative index",
            "/drive/paths/1/spring",
            json!(-1),
            AlsoInSchema("drive.paths[1].spring: must be a whole number", "-1"),
        ),
        mistake(
            "the tip of the other spring",
            "/drive/paths/0/spring",
            json!(1),
            Error("drive.paths[0].release_s: must not be later", "9.0"),
        ),
        Mistake {
            what: "springs swapped",
            changes: vec![("/drive/paths/0/spring", json!(1)), ("/drive/paths/1/spring", json!(0))],
            answer: Warning("drive.paths[0].waypoints[0]: should be near the tip of the undeformed spring 1"),
        },
        mistake("a spring attached twice", "/drive/paths", twice, Error("drive.paths[0].release_s: is required", "found nothing")),
        mistake("time after the position", "/drive/paths/0/waypoints", time_last, Warning("drive.paths[0].waypoints[0]: should be near")),
        mistake(
            "times in the wrong order",
            "/drive/paths/0/waypoints",
            json!([[0, 0.4, 0.1], [8, 1.2, 0.1], [4, 0.8, 0.1]]),
            Error("drive.paths[0].waypoints[2][0]: must be later than the previous waypoint, 8.0", "found 4.0"),
        ),
        mistake(
            "released before it is attached",
            "/drive/paths/0",
            json!({ "spring": 0, "waypoints": [[2.0, 0.4, 0.1]], "release_s": 1.0 }),
            Error("drive.paths[0].release_s: must be later than the first waypoint, 2.0", "found 1.0"),
        ),
        mistake(
            "a turned load with the old tips",
            "/load/heading_rad",
            json!(0.6),
            Warning("drive.paths[0].waypoints[0]: should be near the tip of the undeformed spring 0: within 0.1 m"),
        ),
    ]
}

/// Keys, types, and what is missing.
fn keys_and_types() -> Vec<Mistake> {
    vec![
        mistake(
            "a key without its unit",
            "/load/heading",
            json!(0.5),
            AlsoInSchema("load.heading: is an unknown key; did you mean `heading_rad`?", "found 0.5"),
        ),
        mistake(
            "a misspelt key",
            "/springs/0/damping_ration",
            json!(0.5),
            AlsoInSchema("springs[0].damping_ration: is an unknown key; did you mean `damping_ratio`?", "found 0.5"),
        ),
        mistake(
            "friction on the load",
            "/load/friction_coefficient",
            json!(0.5),
            AlsoInSchema("load.friction_coefficient: is an unknown key", "found 0.5"),
        ),
        mistake(
            "a kind that is none",
            "/drive/kind",
            json!("robots"),
            AlsoInSchema("drive.kind: must be one of \"tips\", \"ants\"", "\"robots\""),
        ),
        mistake(
            "no friction",
            "/ground/friction_coefficient",
            Value::Null,
            AlsoInSchema("ground.friction_coefficient: is required", "found nothing"),
        ),
        mistake("no mass", "/load/mass_kg", Value::Null, AlsoInSchema("load.mass_kg: is required unless", "found nothing")),
        mistake("two outlines", "/load/radius_m", json!(0.25), AlsoInSchema("load.outline: must not be given together", "found both")),
        mistake("a mass with its unit", "/load/mass_kg", json!("2 kg"), AlsoInSchema("load.mass_kg: must be a number", "found \"2 kg\"")),
        mistake(
            "a waypoint without time",
            "/drive/paths/0/waypoints/0",
            json!([0.4, 0.1]),
            AlsoInSchema("drive.paths[0].waypoints[0]: must be a list of 3 numbers", "found a list of 2"),
        ),
        mistake("a negative mass", "/load/mass_kg", json!(-2), AlsoInSchema("load.mass_kg: must be positive", "found -2.0")),
        mistake(
            "gravity downwards",
            "/ground/gravity_m_per_s2",
            json!(-9.81),
            AlsoInSchema("ground.gravity_m_per_s2: must be positive", "-9.81"),
        ),
    ]
}

fn all() -> Vec<Mistake> {
    [units(), indices_and_order(), keys_and_types()].into_iter().flatten().collect()
}

fn file_of(mistake: &Mistake) -> Value {
    mistake.changes.iter().fold(first_scene(), |file, (at, put)| changed(file, at, put.clone()))
}

#[test]
fn every_mistake_is_an_error_or_a_warning_at_its_place() {
    let mistakes = all();
    assert_eq!(mistakes.len(), 36);
    let sound = Scenario::parse(&first_scene().to_string(), "first.json").unwrap();
    assert_eq!(sound.warnings(), []);
    for mistake in &mistakes {
        let found = Scenario::parse(&file_of(mistake).to_string(), "first.json");
        let what = mistake.what;
        match (&mistake.answer, found) {
            (Error(start, end) | AlsoInSchema(start, end), Err(error)) => {
                let told = error.to_string();
                // What was found follows a question in brackets.
                let has_end = |line: &str| line.ends_with(end) || line.ends_with(&format!("({end})"));
                assert!(told.lines().any(|line| line.starts_with(&format!("first.json: {start}")) && has_end(line)), "{what}: {told}");
            }
            (Warning(start), Ok(scenario)) => {
                let told: Vec<String> = scenario.warnings().iter().map(ToString::to_string).collect();
                assert!(told.iter().any(|warning| warning.starts_with(start)), "{what}: {told:?}");
            }
            (_, Ok(scenario)) => panic!("{what}: must be an error, found {:?}", scenario.warnings()),
            (_, Err(error)) => panic!("{what}: must be a warning, found {error}"),
        }
    }
}

#[test]
fn the_schema_refuses_what_it_can_see() {
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    assert!(schema.is_valid(&first_scene()));
    for mistake in all() {
        let is_refused = !schema.is_valid(&file_of(&mistake));
        assert_eq!(is_refused, matches!(mistake.answer, AlsoInSchema(..)), "{}", mistake.what);
    }
}
