//! Outlines of the load and of obstacles, and the obstacles themselves.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Shape in the plane, in the frame of its body. It has exactly one of these keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(transform = one_key_of)]
pub enum OutlineEntry {
    /// A disc about the origin.
    Disc(DiscEntry),
    /// A rectangle about the origin, with its sides along the axes.
    Rectangle(RectangleEntry),
    /// A polygon that does not cross itself, convex or not.
    Polygon(PolygonEntry),
    /// An open chain of straight walls without thickness, for obstacles only. Both sides of a wall
    /// can be touched.
    Polyline(PolylineEntry),
    /// The union of several outlines.
    Compound(CompoundEntry),
}

/// A disc about the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscEntry {
    /// Radius (m).
    pub radius_m: f64,
}

/// A rectangle about the origin, with its sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RectangleEntry {
    /// Lengths of the sides along the x and the y axis (m).
    pub size_m: [f64; 2],
}

/// A polygon that does not cross itself, convex or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PolygonEntry {
    /// Corners in the frame of the body (m), one after another along the edge, in either direction.
    /// The last one is joined to the first.
    pub points_m: Vec<[f64; 2]>,
}

/// An open chain of straight walls without thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PolylineEntry {
    /// Ends of the walls in the frame of the body (m), one after another.
    pub points_m: Vec<[f64; 2]>,
}

/// The union of several outlines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompoundEntry {
    /// Parts. Those of a load must not overlap, since its mass would count twice there.
    pub parts: Vec<PartEntry>,
}

/// Part of a compound outline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartEntry {
    /// Outline in the frame of the part.
    pub outline: OutlineEntry,
    /// Position of the part's origin in the frame of the body (m). The default is [0, 0].
    #[serde(default)]
    pub position_m: [f64; 2],
    /// Heading of the part in the frame of the body (rad). The default is 0.
    #[serde(default)]
    pub heading_rad: f64,
}

/// A body that the load touches but cannot push away. It stands still, or moves along a given path
/// as a position-controlled pusher does. The ground has no effect on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleEntry {
    /// Name in reports. No other obstacle has the same.
    pub name: String,
    /// Outline in the obstacle's frame.
    pub outline: OutlineEntry,
    /// Position of the obstacle's origin (m, world axes). It excludes `path`. The default is
    /// [0, 0].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 2]", extend("default" = [0.0, 0.0]))]
    pub position_m: Option<[f64; 2]>,
    /// Heading of the obstacle (rad). It excludes `path`. The default is 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = 0.0))]
    pub heading_rad: Option<f64>,
    /// Coulomb's coefficient of side friction of the obstacle's edge (1). `side_friction_rule`
    /// combines it with that of the load. The default is 0.
    #[serde(default)]
    pub friction_coefficient: f64,
    /// Coefficient of restitution of the obstacle, from 0 for plastic impacts to 1 for elastic ones
    /// (1). Impacts have the larger one of this and that of the load. The default is 0.
    #[serde(default)]
    pub restitution: f64,
    /// Motion of a pusher. The default is an obstacle that stands still.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "ObstaclePathEntry")]
    pub path: Option<ObstaclePathEntry>,
}

/// Motion of an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstaclePathEntry {
    /// Waypoints [time (s), x (m), y (m), heading (rad)] of the obstacle's frame in world axes.
    /// Between two of them position and heading change at constant rates. The obstacle stands still
    /// before the first and after the last one. Within one control period no point of the obstacle
    /// may move farther than the load is wide, since it would pass through the load.
    pub waypoints: Vec<[f64; 4]>,
}

/// Turns the schema of an enum with one object per variant into that of one object which has
/// exactly one of the variants' keys. Every key can then be checked at its place.
fn one_key_of(schema: &mut Schema) {
    let mut properties = Map::new();
    for variant in schema.remove("oneOf").as_ref().and_then(Value::as_array).into_iter().flatten() {
        for (key, property) in variant["properties"].as_object().into_iter().flatten() {
            let mut property = property.clone();
            property["description"] = variant["description"].clone();
            properties.insert(key.clone(), property);
        }
    }
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("properties".to_owned(), properties.into());
    schema.insert("additionalProperties".to_owned(), json!(false));
    schema.insert("minProperties".to_owned(), json!(1));
    schema.insert("maxProperties".to_owned(), json!(1));
}
