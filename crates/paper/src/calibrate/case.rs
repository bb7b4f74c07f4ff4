//! Three directions of loading a spring, numbered as Eq. (1) to (3) and Table I of the paper.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use serde::{Deserialize, Serialize};

use cohaul::model::SpringDesign;
use cohaul_studies::variants::names;

/// Largest turn of a pivot for which one straight link describes a bent member (rad). Beyond it,
/// Eq. (1) diverges as the members become straight.
pub const MOST_TURN: f64 = FRAC_PI_3;

/// Direction in which a spring was loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Case {
    /// Along the spring, Eq. (1): the four folded pivots turn.
    Radial,
    /// Across the spring, Eq. (2): one folded pivot turns.
    #[serde(rename = "tangential-2")]
    TangentialTwo,
    /// Across the spring to its other side, Eq. (3): the short member's pivot turns.
    #[serde(rename = "tangential-3")]
    TangentialThree,
}

impl Case {
    pub const ALL: [Case; 3] = [Case::Radial, Case::TangentialTwo, Case::TangentialThree];

    pub fn name(self) -> &'static str {
        names::<Self>()[self as usize]
    }

    /// The case with this name, or with this number of its equation.
    pub fn named(text: &str) -> Option<Self> {
        Case::ALL.into_iter().zip(["1", "2", "3"]).find(|(case, number)| case.name() == text || *number == text).map(|(case, _)| case)
    }

    pub fn is_radial(self) -> bool {
        self == Case::Radial
    }

    /// Force of the pseudo-rigid-body model at a stretch (m) or a swing (rad) (N). It is
    /// proportional to Young's modulus.
    ///
    /// # Panics
    ///
    /// At or beyond [`Case::limit`].
    pub fn force(self, design: &SpringDesign, at: f64) -> f64 {
        match self {
            Case::Radial => design.radial_force(at),
            Case::TangentialTwo => design.tangential_case_2(folded_turn(design, at)).1,
            Case::TangentialThree => design.tangential_case_3(at),
        }
    }

    /// Displacement at which a pivot of the model has turned by 90 degrees (m, rad). A larger
    /// measured value has another unit or belongs to another spring.
    pub fn limit(self, design: &SpringDesign) -> f64 {
        match self {
            Case::Radial => 2.0 * design.folded_member_length,
            Case::TangentialTwo => design.link_length.atan2(design.short_member_length),
            Case::TangentialThree => FRAC_PI_2,
        }
    }

    /// Force of the linear law for a stiffness of 1 (N): r for kappa_rho (N/m), theta / l_0 for
    /// kappa_tau (N m/rad). Eq. (10) has the current length of the spring in place of l_0.
    pub fn linear(self, design: &SpringDesign, at: f64) -> f64 {
        if self.is_radial() { at } else { at / design.rest_length() }
    }

    pub fn unit(self) -> &'static str {
        if self.is_radial() { "m" } else { "rad" }
    }
}

/// Turn of the folded pivot at which the tip has the polar angle `swing` (rad). In the triangle of
/// root, pivot and tip, sin(turn - swing) / l_1 = sin(swing) / (l_3 + l_5).
fn folded_turn(design: &SpringDesign, swing: f64) -> f64 {
    swing + (design.short_member_length * swing.sin() / design.link_length).clamp(-1.0, 1.0).asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangle_inverts_eq_2_up_to_the_limit() {
        for (short, link) in [(9.8e-3, 16.5e-3), (16.5e-3, 9.8e-3)] {
            let design = SpringDesign { short_member_length: short, link_length: link, ..cohaul::model::paper::SPRING };
            for turn in [-1.5, -0.2, 0.0, 1e-6, 0.7, 1.57] {
                let (swing, force) = design.tangential_case_2(turn);
                assert!(swing.abs() < Case::TangentialTwo.limit(&design));
                // The arcsine loses half of the digits near its end, which these turns do not
                // reach.
                assert!((folded_turn(&design, swing) - turn).abs() < 1e-12, "{turn}");
                assert!((Case::TangentialTwo.force(&design, swing) - force).abs() <= 1e-12 * force.abs());
            }
        }
    }
}
