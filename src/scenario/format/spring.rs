//! The springs: one by one, or as a ring of equal springs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::{PolarSpring, SpringLaw};
use crate::scenario::json::plain;

/// A spring, or a group of equal springs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SpringsEntry {
    /// Short form for equal springs on a circle.
    Ring(RingOfSpringsForm),
    /// One spring.
    One(SpringEntry),
}

/// One spring, or a rope. A spring without rest length and torsional stiffness is isotropic: its
/// force is linear in the position of its tip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// no damping.
    #[serde(default)]
    pub damping_ratio: f64,
    /// Law of the spring. The default is "polar".
    #[serde(default, skip_serializing_if = "is_polar")]
    pub law: SpringLaw,
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
    /// damping.
    #[serde(default)]
    pub damping_ratio: f64,
    /// Law of the springs. The default is "polar".
    #[serde(default, skip_serializing_if = "is_polar")]
    pub law: SpringLaw,
}

fn is_polar(law: &SpringLaw) -> bool {
    *law == SpringLaw::Polar
}

impl SpringEntry {
    /// Entry of a spring of the model.
    pub fn of(spring: &PolarSpring) -> Self {
        Self {
            root_m: [plain(spring.root.x), plain(spring.root.y)],
            bearing_rad: plain(spring.bearing),
            rest_length_m: plain(spring.rest_length),
            radial_stiffness_n_per_m: plain(spring.radial_stiffness),
            torsional_stiffness_nm_per_rad: plain(spring.torsional_stiffness),
            damping_ratio: plain(spring.damping_ratio),
            law: spring.law,
        }
    }

    /// Spring of the model.
    pub fn spring(&self) -> PolarSpring {
        PolarSpring {
            root: self.root_m.into(),
            bearing: self.bearing_rad,
            rest_length: self.rest_length_m,
            radial_stiffness: self.radial_stiffness_n_per_m,
            torsional_stiffness: self.torsional_stiffness_nm_per_rad,
            damping_ratio: self.damping_ratio,
            law: self.law,
        }
    }
}
