//! Every number that the paper prints and this project uses, once, with its place in the paper.
//!
//! The paper is Berman, Lindsey, Sakar, Kumar, Pratt, "Study of group food retrieval by ants as a
//! model for multi-robot collective transport strategies", Robotics: Science and Systems VI, 2010.
//! Of its figures only form and captions are known, so no value that is drawn but not printed
//! stands here.

use super::SpringDesign;
use crate::math::Vec2;

/// Mass of structure 2, the load (kg). Section III-A.
pub const LOAD_MASS_KG: f64 = 1.6e-3;
/// Length of an unloaded spring from root to tip, l_1 + l_3 + l_5 (m). Section III-A.
pub const REST_LENGTH_M: f64 = 26.3e-3;
/// Radius of the load without springs (m): half the diameter less the rest length. The paper does
/// not print it.
pub const LOAD_RADIUS_M: f64 = 12.2e-3;
/// Coefficient of friction of the load on the ground, mu (1). Section IV-C.
pub const FRICTION_COEFFICIENT: f64 = 1.4;
/// Radial stiffness of a spring, kappa_rho (N/m). Section VII.
pub const RADIAL_STIFFNESS_N_PER_M: f64 = 0.664;
/// Torsional stiffness of a spring, kappa_tau (N m/rad). Section VII.
pub const TORSIONAL_STIFFNESS_NM_PER_RAD: f64 = 4.52e-4;

/// Shape and material of a spring. Sections III-A (l_1 ... l_5, h, sheet thickness b) and III-D (E,
/// gamma, K_theta); Fig. 2b.
pub const SPRING: SpringDesign = SpringDesign {
    youngs_modulus: 1.66e6,
    member_width: 0.8e-3,
    member_depth: 3.2e-3,
    short_member_length: 9.8e-3,
    folded_member_length: 11.9e-3,
    link_length: 16.5e-3,
    characteristic_radius_factor: 0.85,
    stiffness_coefficient: 2.68,
};

/// Position of the nest (m). Section VII.
pub const NEST_POSITION_M: Vec2 = Vec2::new(0.2, -0.17);
/// Walking speed of a searching ant, v_i (m/s). Section VII.
pub const SEARCH_SPEED_M_PER_S: f64 = 0.08;
/// Variance of the believed position of the load, sigma^2 (m^2). Section VII prints it without a
/// unit.
pub const TARGET_VARIANCE_M2: f64 = 0.01;
/// Gain of the steering, k (1/s). Section VII, for Eq. (19).
pub const STEERING_GAIN_PER_S: f64 = 10.0;
/// Probability of grasping a tip in reach, p_1 (1). Section VII.
pub const GRASP_PROBABILITY: f64 = 0.2;
/// Force close to the largest that an ant can apply, F_m (N). Section VII, for Eq. (18).
pub const STRONG_PULL_N: f64 = 20e-3;
/// Steepness of the release probability, zeta (1/N). Section VII prints it without a unit, for Eq.
/// (18).
pub const RELEASE_STEEPNESS_PER_N: f64 = 100.0;

/// Mean of the simulated pulls of the ants (N). Section VII.
pub const PULL_MEAN_N: f64 = 5.0e-3;
/// Standard deviation of the simulated pulls (N). Section VII.
pub const PULL_SD_N: f64 = 5.1e-3;
/// Largest simulated pull (N). Section VII.
pub const PULL_MAX_N: f64 = 36.5e-3;
/// Number of simulated pulls (1). Section VII.
pub const N_PULLS: u64 = 520_057;

/// Number of samples in which 6, 7, 8, 9 and 10 of ten simulated ants pulled (1). Caption of Fig.
/// 9.
pub const INSTANTS_BY_SIZE: [u64; 5] = [4956, 17_700, 38_777, 46_289, 19_234];
/// Smallest group of [`INSTANTS_BY_SIZE`] (1).
pub const SMALLEST_COUNTED: usize = 6;

/// Fraction of samples in which `size` of ten ants pulled, among those with six or more (1).
pub fn share_of_size(size: usize) -> f64 {
    INSTANTS_BY_SIZE[size - SMALLEST_COUNTED] as f64 / INSTANTS_BY_SIZE.iter().sum::<u64>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the printed groups is that of a binomial of ten with p = 0.84, cut below six.
    /// The tolerance is 0.01, since p has two digits.
    #[test]
    fn printed_groups_have_the_mean_of_a_binomial() {
        let choose = [210.0, 120.0, 45.0, 10.0, 1.0];
        let binomial = |size: usize| choose[size - 6] * 0.84f64.powi(size as i32) * 0.16f64.powi(10 - size as i32);
        let mean = |weight: &dyn Fn(usize) -> f64| {
            let total: f64 = (6..=10).map(weight).sum();
            (6..=10).map(|size| size as f64 * weight(size)).sum::<f64>() / total
        };
        assert!((mean(&share_of_size) - mean(&binomial)).abs() < 0.01);
    }
}
