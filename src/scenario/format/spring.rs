//! The springs: one by one, or as a ring of equal springs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A spring, or a group of equal springs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SpringsEntry {
    /// Short form for equal springs on a circle.
    Ring(RingOfSpringsForm),
    /// One spring.
    One(SpringEntry),
}

/// One spring. A spring without rest length and torsional stiffness is isotropic: its force is
/// linear in the position of its tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringEntry {
    /// Position of the root in the load's frame (m).
    pub root_m: [f64; 2],
    /// Direction of the undeformed spring in the load's frame (rad).
    pub bearing_rad: f64,
    /// Length of the spring without force (m).
    pub rest_length_m: f64,
    /// Stiffness against a change of length (N/m).
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness against a swing about the root (N m/rad).
    pub torsional_stiffness_nm_per_rad: f64,
    /// Damping over the critical damping of the load's mass on this spring (1). The default is 0:
    /// no damping. The quasi-static method ignores it.
    #[serde(default)]
    pub damping_ratio: f64,
}

/// Short form for equal springs on a circle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSpringsForm {
    /// The springs on the circle.
    pub ring: RingOfSprings,
}

/// Equal springs at equal angles about the centre of mass. Each points outwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingOfSprings {
    /// Number of springs (1).
    pub n: usize,
    /// Distance of the roots from the centre of mass (m).
    pub radius_m: f64,
    /// Direction of the first spring in the load's frame (rad). The default is 0: along the x axis.
    #[serde(default)]
    pub first_bearing_rad: f64,
    /// Length of the spring without force (m).
    pub rest_length_m: f64,
    /// Stiffness against a change of length (N/m).
    pub radial_stiffness_n_per_m: f64,
    /// Stiffness against a swing about the root (N m/rad).
    pub torsional_stiffness_nm_per_rad: f64,
    /// Damping over the critical damping of the load's mass on one spring (1). The default is 0: no
    /// damping. The quasi-static method ignores it.
    #[serde(default)]
    pub damping_ratio: f64,
}
