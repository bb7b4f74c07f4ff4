//! Bounds, examples and the name of the schema: what editors need beyond the shape of a file. The
//! rules themselves are in `validate`, and the program does not read these bounds.

use std::f64::consts::PI;

use serde_json::{Map, Value, json};

/// Name of the schema.
const ID: &str = concat!("urn:cohaul:scenario:", env!("CARGO_PKG_VERSION"));

/// Keys whose value must be positive.
const POSITIVE: [&str; 11] = [
    "duration_s",
    "control_period_s",
    "mass_kg",
    "density_kg_per_m2",
    "inertia_kg_m2",
    "gravity_m_per_s2",
    "release_s",
    "arrival_radius_m",
    "target_redraw_period_s",
    "grasp_decision_period_s",
    "release_decision_period_s",
];
/// Keys whose value must not be negative, in at least one of their places.
const NOT_NEGATIVE: [&str; 16] = [
    "radius_m",
    "friction_coefficient",
    "side_friction_coefficient",
    "normal_load_n",
    "rest_length_m",
    "radial_stiffness_n_per_m",
    "torsional_stiffness_nm_per_rad",
    "damping_ratio",
    "start_half_width_m",
    "search_speed_m_per_s",
    "pull_speed_m_per_s",
    "sensing_range_m",
    "target_variance_m2",
    "steering_gain_per_s",
    "control_offset_m",
    "strong_pull_n",
];
/// Examples by key, of a box of 1 kg that a robot tows.
fn example(key: &str) -> Option<Value> {
    Some(match key {
        "name" => json!("a box towed by one robot"),
        "duration_s" => json!(4.0),
        "control_period_s" => json!(0.01),
        "load" => json!({ "mass_kg": 1.0, "outline": { "rectangle": { "size_m": [0.3, 0.2] } } }),
        "mass_kg" => json!(1.0),
        "outline" => json!({ "rectangle": { "size_m": [0.3, 0.2] } }),
        "ground" => json!({ "friction_coefficient": 0.3, "supports": { "uniform": { "n": 16 } } }),
        "friction_coefficient" => json!(0.3),
        "supports" => json!({ "uniform": { "n": 16 } }),
        "springs" => json!([{ "root_m": [0.15, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.2,
            "radial_stiffness_n_per_m": 200.0, "torsional_stiffness_nm_per_rad": 0.1 }]),
        "drive" => json!({ "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0.0, 0.35, 0.0], [4.0, 0.55, 0.0]] }] }),
        "paths" => json!([{ "spring": 0, "waypoints": [[0.0, 0.35, 0.0], [4.0, 0.55, 0.0]] }]),
        "waypoints" => json!([[0.0, 0.35, 0.0], [4.0, 0.55, 0.0]]),
        "obstacles" => json!([{ "name": "wall", "outline": { "polyline": { "points_m": [[-1.0, 0.4], [1.0, 0.4]] } } }]),
        _ => return None,
    })
}

/// Adds them to the schema.
pub fn add(schema: &mut Value) {
    schema["$id"] = json!(ID);
    properties(schema);
    if let Some(definitions) = schema["$defs"].as_object_mut() {
        definitions.values_mut().for_each(properties);
        alternatives(definitions);
        let either = |keys: [&str; 2]| json!({ "oneOf": keys.map(|key| json!({ "required": [key] })) });
        definitions["LoadEntry"]["allOf"] = json!([either(["mass_kg", "density_kg_per_m2"]), either(["radius_m", "outline"])]);
        // Waypoints of an obstacle have a heading too.
        remove(&mut definitions["ObstaclePathEntry"]["properties"]["waypoints"], "examples");
    }
}

/// Exactly one branch of an alternative fits. The kind of a drive is a constant of its branch, from
/// which editors know the other keys.
fn alternatives(definitions: &mut Map<String, Value>) {
    for definition in definitions.values_mut().filter_map(Value::as_object_mut) {
        if let Some(branches) = definition.remove("anyOf") {
            definition.insert("oneOf".to_owned(), branches);
        }
    }
    for (branch, kind) in [("TipsEntry", "TipsKind"), ("AntsEntry", "AntsKind")] {
        let words = definitions.remove(kind).expect("each drive has a kind");
        let property = &mut definitions[branch]["properties"]["kind"];
        *property = json!({ "const": words["enum"][0], "type": "string", "description": property["description"] });
    }
    definitions["DriveEntry"]["discriminator"] = json!({ "propertyName": "kind" });
}

fn properties(definition: &mut Value) {
    let Some(properties) = definition.get_mut("properties").and_then(Value::as_object_mut) else { return };
    for (key, schema) in properties {
        let Value::Object(schema) = schema else { continue };
        for (bound, value) in bounds(key) {
            schema.insert(bound.to_owned(), value);
        }
        if let Some(example) = example(key) {
            schema.insert("examples".to_owned(), json!([example]));
        }
    }
}

/// Bounds of the number with this key.
fn bounds(key: &str) -> Vec<(&'static str, Value)> {
    match key {
        "restitution" | "grasp_probability" => vec![("minimum", json!(0)), ("maximum", json!(1))],
        "steering_half_angle_rad" => vec![("minimum", json!(0)), ("maximum", json!(PI))],
        "n" | "n_ants" => vec![("minimum", json!(1))],
        _ if POSITIVE.contains(&key) => vec![("exclusiveMinimum", json!(0))],
        _ if NOT_NEGATIVE.contains(&key) => vec![("minimum", json!(0))],
        _ => Vec::new(),
    }
}

fn remove(schema: &mut Value, key: &str) {
    schema.as_object_mut().map(|map: &mut Map<String, Value>| map.remove(key));
}
