//! The ground: friction, and where the load stands on it.

use std::f64::consts::FRAC_PI_2;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Level ground with Coulomb friction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundEntry {
    /// Coulomb's mu, the same for sticking and slipping (1).
    pub friction_coefficient: f64,
    /// Gravity (m/s^2), for normal loads that are left out; it has no other use.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = STANDARD_GRAVITY))]
    pub gravity_m_per_s2: Option<f64>,
    /// Points of the load that stand on the ground: a list, or a short form for points at equal angles.
    pub supports: SupportsEntry,
}

/// (m/s^2)
pub const STANDARD_GRAVITY: f64 = 9.81;

/// Points of the load that stand on the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SupportsEntry {
    Tripod(TripodForm),
    Ring(RingOfSupportsForm),
    List(Vec<SupportEntry>),
}

/// One point that stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportEntry {
    /// Position in the load's frame (m).
    pub offset_m: [f64; 2],
    /// Normal load (N). May be left out of all of exactly three supports: then it follows from the centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub normal_load_n: Option<f64>,
}

/// Short form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TripodForm {
    pub tripod: Tripod,
}

/// Three supports at equal angles about the centre of mass, each with a third of the weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tripod {
    /// Distance from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first support in the load's frame (rad).
    #[serde(default = "quarter_turn")]
    pub first_bearing_rad: f64,
}

/// Short form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSupportsForm {
    pub ring: RingOfSupports,
}

/// Supports at equal angles about the centre of mass, all with the same normal load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSupports {
    /// How many (1).
    pub n: usize,
    /// Distance from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first support in the load's frame (rad).
    #[serde(default)]
    pub first_bearing_rad: f64,
    /// Normal load of each (N). May be left out for three: then a third of the weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub normal_load_n: Option<f64>,
}

fn quarter_turn() -> f64 {
    FRAC_PI_2
}
