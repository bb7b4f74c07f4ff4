//! The scenario file as data, key by key. The JSON Schema is made from these types: the doc comment
//! of a field is the description of its key in editors and in the book.
//!
//! The types state the shape of a file. All other rules are in `validate`.

mod drive;
mod ground;
mod hints;
mod spring;
mod world;

pub use drive::{AntsEntry, AntsKind, DriveEntry, PathEntry, TipsEntry, TipsKind};
pub use ground::{
    GroundEntry, RingOfSupports, RingOfSupportsForm, STANDARD_GRAVITY, SupportEntry, SupportsEntry, Tripod, TripodForm, UniformSupports,
    UniformSupportsForm,
};
pub use spring::{RingOfSprings, RingOfSpringsForm, SpringEntry, SpringsEntry};
pub use world::{
    CompoundEntry, DiscEntry, ObstacleEntry, ObstaclePathEntry, OutlineEntry, PartEntry, PolygonEntry, PolylineEntry, RectangleEntry,
};

use std::sync::LazyLock;

use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::formats::SCENARIO;
use crate::model::SideFrictionRule;

/// One run of collective transport. All units are SI units. Angles are in radians and
/// counter-clockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "cohaul scenario")]
pub struct ScenarioFile {
    /// Location of this schema, for editors. The program does not read it.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub schema: Option<String>,
    /// Version of the scenario format (1). The default is 1, the first one. A newer version than
    /// the program reads is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32", range(min = 1, max = SCENARIO.version), extend("default" = 1))]
    pub format: Option<u32>,
    /// Name of the run, in a few words.
    pub name: String,
    /// Longest simulated time (s). A run with ants ends earlier when the load arrives at the nest.
    pub duration_s: f64,
    /// Control period, the time between two decisions of the ants and two rows of the trace (s).
    /// Every commanded velocity is constant within it.
    pub control_period_s: f64,
    /// Seed of all random streams (1). The default is 1.
    #[serde(default = "first_seed")]
    pub seed: u64,
    /// The load and its start.
    pub load: LoadEntry,
    /// The ground under the load.
    pub ground: GroundEntry,
    /// Springs of the load. A spring is named by its index, from 0. A group takes as many indices
    /// as it has springs.
    pub springs: Vec<SpringsEntry>,
    /// Bodies that the load can touch but not push away. The default is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("default" = []))]
    pub obstacles: Vec<ObstacleEntry>,
    /// Rule that combines the coefficients of side friction of the load and an obstacle. The
    /// default is "geometric-mean".
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("default" = SideFrictionRule::default()))]
    pub side_friction_rule: SideFrictionRule,
    /// The motion of the tips: prescribed paths, or ants.
    pub drive: DriveEntry,
}

/// The load, a rigid body in the plane. The origin of its frame is its centre of mass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadEntry {
    /// Mass (kg). Either this or `density_kg_per_m2` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub mass_kg: Option<f64>,
    /// Mass per area of the outline (kg/m^2), in place of `mass_kg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub density_kg_per_m2: Option<f64>,
    /// Moment of inertia about the centre of mass (kg m^2). The default is that of a mass spread
    /// uniformly over the outline, m R^2 / 2 for a disc. The centroid of the outline must then be
    /// the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub inertia_kg_m2: Option<f64>,
    /// Radius of a disc about the origin (m), the short form of such an `outline`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub radius_m: Option<f64>,
    /// Outline in the load's frame, which obstacles touch. Either this or `radius_m` is given. Its
    /// centroid must be the origin unless mass, inertia and supports say where the mass is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "OutlineEntry")]
    pub outline: Option<OutlineEntry>,
    /// Coulomb's coefficient of side friction of the load's edge (1). `side_friction_rule` combines
    /// it with that of an obstacle. The default is 0.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("default" = 0.0))]
    pub side_friction_coefficient: f64,
    /// Coefficient of restitution of the load, from 0 for plastic impacts to 1 for elastic ones
    /// (1). Impacts have the larger one of this and that of the obstacle. The default is 0.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("default" = 0.0))]
    pub restitution: f64,
    /// Position of the origin at the start (m, world axes). The default is [0, 0].
    #[serde(default)]
    pub position_m: [f64; 2],
    /// Heading at the start (rad). The default is 0.
    #[serde(default)]
    pub heading_rad: f64,
    /// Velocity of the origin at the start (m/s, world axes). The default is [0, 0].
    #[serde(default)]
    pub velocity_m_per_s: [f64; 2],
    /// Turn rate at the start (rad/s). The default is 0.
    #[serde(default)]
    pub turn_rate_rad_per_s: f64,
}

/// The JSON Schema (2020-12) of [`ScenarioFile`].
pub fn schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
        let mut schema = schema_for!(ScenarioFile).to_value();
        join_lines(&mut schema);
        hints::add(&mut schema);
        schema
    });
    &SCHEMA
}

/// Joins the lines of every description, which are wrapped in the source.
fn join_lines(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::String(text)) = map.get_mut("description") {
                *text = text.replace('\n', " ");
            }
            map.values_mut().for_each(join_lines);
        }
        Value::Array(list) => list.iter_mut().for_each(join_lines),
        _ => {}
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn first_seed() -> u64 {
    1
}
