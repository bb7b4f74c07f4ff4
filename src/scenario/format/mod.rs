//! The scenario file as data: what may be written, key by key. The types here are the JSON Schema too, so that the doc comment of a field is
//! the description that an editor shows for its key.
//!
//! Nothing here knows a rule beyond the shape; the rules are in `validate`.

mod drive;
mod ground;
mod spring;

pub use drive::{AntsEntry, AntsKind, DriveEntry, GraspPace, PathEntry, ReleasePace, TipsEntry, TipsKind};
pub use ground::{GroundEntry, RingOfSupports, RingOfSupportsForm, STANDARD_GRAVITY, SupportEntry, SupportsEntry, Tripod, TripodForm};
pub use spring::{RingOfSprings, RingOfSpringsForm, SpringEntry, SpringsEntry};

use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};

/// One run of collective transport. SI units throughout; angles in radians, counter-clockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "cohaul scenario")]
pub struct ScenarioFile {
    /// Where this schema is, for editors. Not read.
    #[serde(rename = "$schema", default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub schema: Option<String>,
    /// What the run is, in a few words.
    pub name: String,
    /// Longest simulated time (s). A run of ants ends earlier when the load arrives.
    pub duration_s: f64,
    /// Clock of behaviour and of the trace (s): every velocity that is commanded stays constant this long.
    pub control_period_s: f64,
    /// Key of all chance (1).
    #[serde(default = "first_seed")]
    pub seed: u64,
    /// The load and how it starts.
    pub load: LoadEntry,
    /// The level ground under the load.
    pub ground: GroundEntry,
    /// Springs of the load, in order: a spring is named by its index. A group takes as many indices as it has springs.
    pub springs: Vec<SpringsEntry>,
    /// What moves the tips of the springs.
    pub drive: DriveEntry,
}

/// A rigid disc in the plane. Its frame's origin is its centre of mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadEntry {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Moment of inertia about the centre of mass (kg m^2). Without it that of a uniform disc, m R^2 / 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub inertia_kg_m2: Option<f64>,
    /// Radius of the outline (m).
    pub radius_m: f64,
    /// Where the origin starts (m, world).
    #[serde(default)]
    pub position_m: [f64; 2],
    /// Heading at the start (rad).
    #[serde(default)]
    pub heading_rad: f64,
    /// Velocity of the origin at the start (m/s, world).
    #[serde(default)]
    pub velocity_m_per_s: [f64; 2],
    /// Turn rate at the start (rad/s).
    #[serde(default)]
    pub turn_rate_rad_per_s: f64,
}

/// The JSON Schema (2020-12) of [`ScenarioFile`].
pub fn schema() -> serde_json::Value {
    schema_for!(ScenarioFile).to_value()
}

fn first_seed() -> u64 {
    1
}
