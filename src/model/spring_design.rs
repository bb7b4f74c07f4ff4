//! Pseudo-rigid-body design of the paper's planar springs (Section III, Eq. 1-3).
//!
//! A spring is one short member, two folded members and stiff links between them, cut from a sheet.
//! Each member bends at characteristic pivots: one at the short member (k_1) and one at either end
//! of both folded members (k_2 ... k_5), each with `k_i = 2 gamma K_theta E I / l_i`.
//!
//! * A radial displacement r turns the four folded pivots by phi, with r = 2 l_2 sin phi (Eq. 1).
//! * A tangential displacement turns either one folded pivot by phi (case 2, Eq. 2) or the pivot of
//!   the short member (case 3, Eq. 3).
//!
//! The forces below follow from virtual work on these mechanisms, which reproduces Eq. (1)-(3) as
//! printed.

/// Dimensions and material of one spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDesign {
    /// Young's modulus E (Pa).
    pub youngs_modulus: f64,
    /// Width h of a member in the plane of bending (m).
    pub member_width: f64,
    /// Depth b of the sheet across that plane (m).
    pub member_depth: f64,
    /// Length l_1 of the short member, whose pivot is at the root (m).
    pub short_member_length: f64,
    /// Length l_2 = l_4 of the folded members (m).
    pub folded_member_length: f64,
    /// Length l_3 + l_5 of the stiff links beyond the short member (m).
    pub link_length: f64,
    /// Characteristic radius factor gamma (1).
    pub characteristic_radius_factor: f64,
    /// Stiffness coefficient K_theta (1).
    pub stiffness_coefficient: f64,
}

impl SpringDesign {
    /// Second moment of area of a member, I = h^3 b / 12 (m^4).
    pub fn second_moment_of_area(&self) -> f64 {
        self.member_width.powi(3) * self.member_depth / 12.0
    }

    /// Length from root to tip without force, l_1 + l_3 + l_5 (m).
    pub fn rest_length(&self) -> f64 {
        self.short_member_length + self.link_length
    }

    /// Stiffnesses of the pivots, k_1 ... k_5 (N m/rad).
    pub fn pivot_stiffnesses(&self) -> [f64; 5] {
        let bending =
            2.0 * self.characteristic_radius_factor * self.stiffness_coefficient * self.youngs_modulus * self.second_moment_of_area();
        let (short, folded) = (bending / self.short_member_length, bending / self.folded_member_length);
        [short, folded, folded, folded, folded]
    }

    /// Torsional stiffness kappa_tau as the sum of all pivot stiffnesses, which gives the printed
    /// 4.52e-4 (N m/rad).
    pub fn torsional_stiffness(&self) -> f64 {
        self.pivot_stiffnesses().iter().sum()
    }

    /// Radial force F_r at a radial stretch (m), Eq. (1) (N).
    ///
    /// # Panics
    /// When the stretch is at least twice the folded length, where the members are straight.
    pub fn radial_force(&self, stretch: f64) -> f64 {
        let span = 2.0 * self.folded_member_length;
        assert!(stretch.abs() < span, "a stretch of {stretch} m would straighten members that span {span} m");
        let turn = (stretch / span).asin();
        self.folded_stiffness() * turn / (span * turn.cos())
    }

    /// Secant stiffness F_r / r at a stretch (m): kappa_rho of a linear law that agrees at that
    /// stretch (N/m). At zero it is the tangent.
    pub fn secant_radial_stiffness(&self, stretch: f64) -> f64 {
        if stretch == 0.0 { self.initial_radial_stiffness() } else { self.radial_force(stretch) / stretch }
    }

    /// Tangent stiffness dF_r / dr at a stretch (m) (N/m).
    pub fn tangent_radial_stiffness(&self, stretch: f64) -> f64 {
        let turn = (stretch / (2.0 * self.folded_member_length)).asin();
        let cos = turn.cos();
        self.initial_radial_stiffness() * (1.0 + turn * turn.tan()) / (cos * cos)
    }

    /// Polar angle of the tip about the root and force across the spring in case 2, Eq. (2), when
    /// the folded pivot at the end of the short member has turned by `turn` (rad) (rad, N).
    pub fn tangential_case_2(&self, turn: f64) -> (f64, f64) {
        let (short, link) = (self.short_member_length, self.link_length);
        let (sin, cos) = turn.sin_cos();
        let (along, across) = (short + link * cos, link * sin);
        let length = along.hypot(across);
        let angle_per_turn = (link * link + short * link * cos) / (length * length);
        let couple = self.pivot_stiffnesses()[1] * turn;
        (across.atan2(along), couple / (length * angle_per_turn))
    }

    /// Force across the spring in case 3, Eq. (3), when the whole spring has swung by `swing` (rad)
    /// about the pivot of the short member (N). The paper measures about five times this force,
    /// and proposes that factor on k_1.
    pub fn tangential_case_3(&self, swing: f64) -> f64 {
        self.pivot_stiffnesses()[0] * swing / self.rest_length()
    }

    fn folded_stiffness(&self) -> f64 {
        self.pivot_stiffnesses()[1..].iter().sum()
    }

    fn initial_radial_stiffness(&self) -> f64 {
        self.folded_stiffness() / (2.0 * self.folded_member_length).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::paper;
    use approx::assert_relative_eq;

    const DESIGN: SpringDesign = paper::SPRING;

    /// Values of an independent derivation with six or seven digits. The tolerances are half of the
    /// last digit.
    #[test]
    fn pivots_and_torsional_stiffness() {
        assert_relative_eq!(DESIGN.second_moment_of_area(), 1.36533e-13, max_relative = 4e-6);
        let pivots = DESIGN.pivot_stiffnesses();
        assert_relative_eq!(pivots[0], 1.053670e-4, max_relative = 5e-7);
        assert_relative_eq!(pivots[4], 8.677278e-5, max_relative = 1e-7);
        assert_relative_eq!(DESIGN.torsional_stiffness(), 4.524581e-4, max_relative = 2e-7);
    }

    #[test]
    fn radial_force_and_its_secant_at_eight_millimetres() {
        assert_relative_eq!(DESIGN.secant_radial_stiffness(8e-3), 0.66354, max_relative = 8e-6);
        assert_relative_eq!(DESIGN.secant_radial_stiffness(0.0), 0.612759, max_relative = 1e-6);
        for (stretch, force, tangent) in [(2e-3, 1.23132e-3, 0.62150), (6e-3, 3.84071e-3, 0.69779), (12e-3, 8.92423e-3, 1.07514)] {
            assert_relative_eq!(DESIGN.radial_force(stretch), force, max_relative = 5e-6);
            assert_relative_eq!(DESIGN.tangent_radial_stiffness(stretch), tangent, max_relative = 1e-5);
        }
    }

    #[test]
    fn tangential_forces_of_both_cases() {
        for (turn, angle, force) in [(0.2, 0.1256, 1.05471e-3), (0.6, 0.3786, 3.23429e-3), (1.2, 0.7726, 6.93468e-3)] {
            let (swing, across) = DESIGN.tangential_case_2(turn);
            assert_relative_eq!(swing, angle, epsilon = 5e-5);
            assert_relative_eq!(across, force, max_relative = 5e-6);
        }
        assert_relative_eq!(DESIGN.tangential_case_3(-0.4), -1.60254e-3, max_relative = 5e-6);
    }
}
