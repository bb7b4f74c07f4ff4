//! The springs: one by one, or as a ring of equal ones.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A spring, or a group of equal springs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SpringsEntry {
    Ring(RingOfSpringsForm),
    One(SpringEntry),
}

/// One spring. Without rest length and torsional stiffness it is isotropic: linear in the position of its tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringEntry {
    /// Root in the load's frame (m).
    pub root_m: [f64; 2],
    /// Direction of the undeformed spring in the load's frame (rad).
    pub bearing_rad: f64,
    /// Length without force (m).
    pub rest_length_m: f64,
    /// Stiffness against change of length (N/m).
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness against swing about the root (N m/rad).
    pub torsional_stiffness_nm_per_rad: f64,
    /// Damping over critical damping of the load's mass on this spring (1).
    #[serde(default)]
    pub damping_ratio: f64,
}

/// Short form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSpringsForm {
    pub ring: RingOfSprings,
}

/// Equal springs at equal angles about the centre of mass, each pointing outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSprings {
    /// How many (1).
    pub n: usize,
    /// Distance of the roots from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first spring in the load's frame (rad).
    #[serde(default)]
    pub first_bearing_rad: f64,
    /// Length without force (m).
    pub rest_length_m: f64,
    /// Stiffness against change of length (N/m).
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness against swing about the root (N m/rad).
    pub torsional_stiffness_nm_per_rad: f64,
    /// Damping over critical damping of the load's mass on one spring (1).
    #[serde(default)]
    pub damping_ratio: f64,
}
