//! The ground: friction, and where the load stands on it.

use std::f64::consts::FRAC_PI_2;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Level ground with Coulomb friction under the load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundEntry {
    /// Coulomb's coefficient of friction of all supports without one of their own, the same for
    /// sticking and slipping (1).
    pub friction_coefficient: f64,
    /// Gravity, from which normal loads follow that are left out (m/s^2). It has no other effect.
    /// The default is 9.81.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = STANDARD_GRAVITY))]
    pub gravity_m_per_s2: Option<f64>,
    /// Points at which the load stands on the ground: a list, or a short form for points at equal
    /// angles or under a uniform pressure.
    pub supports: SupportsEntry,
}

/// Gravity where a file gives none (m/s^2).
pub const STANDARD_GRAVITY: f64 = 9.81;

/// Points at which the load stands on the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SupportsEntry {
    /// Short form for three equal supports.
    Tripod(TripodForm),
    /// Short form for equal supports on a circle.
    Ring(RingOfSupportsForm),
    /// Short form for a weight that is spread over the outline.
    Uniform(UniformSupportsForm),
    /// Supports one by one.
    List(Vec<SupportEntry>),
}

/// One point at which the load stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportEntry {
    /// Position in the load's frame (m).
    pub offset_m: [f64; 2],
    /// Normal load (N). It may be left out for all of exactly three supports: it then follows from
    /// the weight and the centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub normal_load_n: Option<f64>,
    /// Coulomb's coefficient of friction of this support (1), as of a foot of another material. The
    /// default is that of the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub friction_coefficient: Option<f64>,
}

/// Short form for three equal supports.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TripodForm {
    /// The three supports.
    pub tripod: Tripod,
}

/// Three supports at equal angles about the centre of mass, each with a third of the weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tripod {
    /// Distance of the supports from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first support in the load's frame (rad). The default is a quarter turn: the
    /// first support is on the y axis.
    #[serde(default = "quarter_turn")]
    pub first_bearing_rad: f64,
}

/// Short form for equal supports on a circle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSupportsForm {
    /// The supports on the circle.
    pub ring: RingOfSupports,
}

/// Supports at equal angles about the centre of mass, all with the same normal load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSupports {
    /// Number of supports (1).
    pub n: usize,
    /// Distance of the supports from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first support in the load's frame (rad). The default is 0: the first
    /// support is on the x axis.
    #[serde(default)]
    pub first_bearing_rad: f64,
    /// Normal load of each support (N). It may be left out for three supports: each then carries a
    /// third of the weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub normal_load_n: Option<f64>,
}

/// Short form for a weight that is spread over the outline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UniformSupportsForm {
    /// The weight, spread uniformly over the outline.
    pub uniform: UniformSupports,
}

/// Supports that stand for a uniform pressure on the whole outline. They carry the weight, with its
/// centre below the centre of mass. The centroid of the outline must be the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UniformSupports {
    /// Number of supports, at least 3 (1). The program takes a number near it that fills the
    /// outline evenly. The error of friction is about 1.5 / n of the weight's at worst. Either this
    /// or `tolerance` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize")]
    pub n: Option<usize>,
    /// Largest error of friction force or torque, over that of the whole weight (1). The number of
    /// supports follows from it, and is 2 / `tolerance`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub tolerance: Option<f64>,
}

fn quarter_turn() -> f64 {
    FRAC_PI_2
}
