//! Stretch at which a linear stiffness equals that of the model.
//!
//! The spring of Eq. (1) stiffens with the stretch: its slope at zero is 8 % below the printed
//! 0.664 N/m. A single stiffness is exact at one stretch only. The printed number is the secant at
//! 8 mm. The printed kappa_tau of 4.52e-4 N m/rad is no slope of Eq. (2) or (3) but the sum of all
//! pivot stiffnesses.

use serde::{Deserialize, Serialize};

use super::case::Case;
use cohaul::math::bisected;
use cohaul::model::SpringDesign;
use cohaul::model::paper::CASE_3_FACTOR;

/// Stretch at which the secant stiffness is the paper's kappa_rho (m).
pub const PAPER_STRETCH: f64 = 8e-3;

/// Linear kappa_rho of the pseudo-rigid-body model by several definitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialEquivalents {
    pub tangent_at_zero_n_per_m: f64,
    pub tangent_at_end_n_per_m: f64,
    pub secant_at_end_n_per_m: f64,
    /// Secant at 8 mm; `null` if the members are straight before.
    pub secant_at_8_mm_n_per_m: Option<f64>,
    /// Least-squares line through the origin over the range.
    pub least_squares_n_per_m: f64,
    /// Stretch at which the secant is the fitted kappa_rho; `null` if there is none.
    pub stretch_of_secant_m: Option<f64>,
}

/// Linear kappa_tau of the model by several definitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwingEquivalents {
    /// Slope of Eq. (2) at zero, times the rest length.
    pub tangent_of_case_2_nm_per_rad: f64,
    /// Slope of Eq. (3), times the rest length: k_1.
    pub tangent_of_case_3_nm_per_rad: f64,
    /// The same with the paper's factor 5 on k_1, which it says is closer to the measured forces.
    pub corrected_case_3_nm_per_rad: f64,
    /// k_1 + ... + k_5, which is the printed 4.52e-4.
    pub sum_of_pivots_nm_per_rad: f64,
}

impl RadialEquivalents {
    pub fn of(design: &SpringDesign, range: [f64; 2], fitted: f64) -> Self {
        let limit = Case::Radial.limit(design);
        Self {
            tangent_at_zero_n_per_m: design.tangent_radial_stiffness(0.0),
            tangent_at_end_n_per_m: design.tangent_radial_stiffness(range[1]),
            secant_at_end_n_per_m: design.secant_radial_stiffness(range[1]),
            secant_at_8_mm_n_per_m: (PAPER_STRETCH < limit).then(|| design.secant_radial_stiffness(PAPER_STRETCH)),
            least_squares_n_per_m: least_squares_stiffness(design, range),
            stretch_of_secant_m: stretch_of_secant(design, fitted),
        }
    }
}

impl SwingEquivalents {
    pub fn of(design: &SpringDesign) -> Self {
        let pivots = design.pivot_stiffnesses();
        let lever = design.rest_length() / design.link_length;
        Self {
            tangent_of_case_2_nm_per_rad: pivots[1] * lever * lever,
            tangent_of_case_3_nm_per_rad: pivots[0],
            corrected_case_3_nm_per_rad: CASE_3_FACTOR * pivots[0],
            sum_of_pivots_nm_per_rad: design.torsional_stiffness(),
        }
    }
}

/// Slope of the least-squares line through the origin for Eq. (1) over [low, high] (N/m): the
/// integral of F r over the integral of r^2.
pub fn least_squares_stiffness(design: &SpringDesign, [low, high]: [f64; 2]) -> f64 {
    const N: usize = 2000;
    if high <= low {
        return design.secant_radial_stiffness(high);
    }
    let step = (high - low) / N as f64;
    // Simpson's rule; its relative error is about 1e-12 for this smooth curve.
    let weight = |i: usize| if i == 0 || i == N { 1.0 } else { 2.0 * (1 + i % 2) as f64 };
    let at = |i: usize| low + step * i as f64;
    let moment: f64 = (0..=N).map(|i| weight(i) * design.radial_force(at(i)) * at(i)).sum();
    let square: f64 = (0..=N).map(|i| weight(i) * at(i) * at(i)).sum();
    moment / square
}

/// By bisection: the secant grows with the stretch.
fn stretch_of_secant(design: &SpringDesign, stiffness: f64) -> Option<f64> {
    let range = [0.0, Case::Radial.limit(design) * (1.0 - 1e-9)];
    let [softest, stiffest] = range.map(|stretch| design.secant_radial_stiffness(stretch));
    let is_below = |stretch| design.secant_radial_stiffness(stretch) < stiffness;
    (softest..stiffest).contains(&stiffness).then(|| bisected(range, 60, is_below)[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The printed 0.664 N/m: as the secant, as a fit through the origin, and not as the tangent.
    #[test]
    fn the_printed_stiffness_is_the_secant_at_eight_millimetres() {
        let design = cohaul::model::paper::SPRING;
        let found = RadialEquivalents::of(&design, [0.0, 10.274e-3], 0.66354);
        // Half of the last printed digit.
        assert!((found.secant_at_8_mm_n_per_m.unwrap() - 0.664).abs() < 5e-4);
        // Half of the last digit of the range is 0.5 um, and the fit grows with it by 11.2 N/m^2.
        assert!((found.least_squares_n_per_m - 0.664).abs() < 6e-6, "{found:?}");
        // Slope of the secant there is 14 N/m^2: half of the last digit of 0.66354 makes 0.4 um.
        assert!((found.stretch_of_secant_m.unwrap() - 8e-3).abs() < 5e-7);
        assert!((found.tangent_at_zero_n_per_m / 0.664 - 1.0 + 0.077).abs() < 5e-4);
        assert_eq!(RadialEquivalents::of(&design, [0.0, 1e-2], 0.6).stretch_of_secant_m, None);
        let swing = SwingEquivalents::of(&design);
        assert!((swing.sum_of_pivots_nm_per_rad - 4.52e-4).abs() < 5e-7);
        // k_1 by hand: 4.556 * 1.66e6 * 1.365333e-13 / 9.8e-3 = 1.053669e-4 N m/rad.
        assert!((swing.corrected_case_3_nm_per_rad - 5.268345e-4).abs() < 1e-9, "{swing:?}");
        assert!((swing.tangent_of_case_2_nm_per_rad - 2.2046e-4).abs() < 5e-9);
        // A difference of Eq. (2) at a small angle; its next term is 1e-6 of it.
        let slope = Case::TangentialTwo.force(&design, 1e-3) * design.rest_length() / 1e-3;
        assert!((slope / swing.tangent_of_case_2_nm_per_rad - 1.0).abs() < 1e-5, "{slope}");
    }
}
