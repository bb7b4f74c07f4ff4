//! Dimensions of a spring, without its material.

use serde::{Deserialize, Serialize};

use cohaul::model::{SpringDesign, paper};
use cohaul::scenario::Finding;

/// Dimensions of a spring, and the two factors of the pseudo-rigid-body model. Keys that a file
/// leaves out have the value of the paper (Fig. 2, Table I).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Dimensions {
    /// h, in the plane of bending.
    pub member_width_m: f64,
    /// b, across that plane.
    pub member_depth_m: f64,
    /// l_1
    pub short_member_length_m: f64,
    /// l_2 = l_4
    pub folded_member_length_m: f64,
    /// l_3 + l_5
    pub link_length_m: f64,
    /// gamma
    pub characteristic_radius_factor: f64,
    /// K_Theta
    pub stiffness_coefficient: f64,
}

impl Default for Dimensions {
    fn default() -> Self {
        Self::of(&paper::SPRING)
    }
}

impl Dimensions {
    pub fn of(design: &SpringDesign) -> Self {
        Self {
            member_width_m: design.member_width,
            member_depth_m: design.member_depth,
            short_member_length_m: design.short_member_length,
            folded_member_length_m: design.folded_member_length,
            link_length_m: design.link_length,
            characteristic_radius_factor: design.characteristic_radius_factor,
            stiffness_coefficient: design.stiffness_coefficient,
        }
    }

    /// The spring of a material with this Young's modulus (Pa).
    pub fn of_material(&self, youngs_modulus: f64) -> SpringDesign {
        SpringDesign {
            youngs_modulus,
            member_width: self.member_width_m,
            member_depth: self.member_depth_m,
            short_member_length: self.short_member_length_m,
            folded_member_length: self.folded_member_length_m,
            link_length: self.link_length_m,
            characteristic_radius_factor: self.characteristic_radius_factor,
            stiffness_coefficient: self.stiffness_coefficient,
        }
    }

    /// Faults of the dimensions, one finding each.
    pub fn faults(&self) -> Vec<Finding> {
        let named = [
            ("member_width_m", self.member_width_m),
            ("member_depth_m", self.member_depth_m),
            ("short_member_length_m", self.short_member_length_m),
            ("folded_member_length_m", self.folded_member_length_m),
            ("link_length_m", self.link_length_m),
            ("characteristic_radius_factor", self.characteristic_radius_factor),
            ("stiffness_coefficient", self.stiffness_coefficient),
        ];
        let is_wrong = |value: f64| !(value.is_finite() && value > 0.0);
        // A force sensor for ants is smaller than a metre.
        let is_long = |name: &str, value: f64| name.ends_with("_m") && value > 1.0;
        let finding = |(name, value): (&str, f64)| {
            let rule = match () {
                () if is_wrong(value) => "must be positive and finite",
                () if is_long(name, value) => "must be below 1 m (is it in millimetres?)",
                () => return None,
            };
            Some(Finding { path: name.to_owned(), rule: rule.to_owned(), found: value.to_string() })
        };
        named.into_iter().filter_map(finding).collect()
    }
}
