//! Every number that the paper prints and this project uses, once, with its place in the paper.
//!
//! The paper is Berman, Lindsey, Sakar, Kumar, Pratt, "Study of group food retrieval by ants as a
//! model for multi-robot collective transport strategies", Robotics: Science and Systems VI, 2010.
//! Of its figures only form and captions are known, so no value that is drawn but not printed
//! stands here.

use std::f64::consts::FRAC_PI_3;

use super::SpringDesign;
use crate::math::Vec2;

/// Mass of structure 2, the load of the simulations (kg). Section III-A.
pub const LOAD_MASS_KG: f64 = 1.6e-3;
/// Diameter of structure 2 with its springs (m). Section III-A.
pub const DIAMETER_M: f64 = 77e-3;
/// Mass of structure 1 (kg). Section III-A. Its springs deform mainly across their length.
pub const STRUCTURE_1_MASS_KG: f64 = 2.3e-3;
/// Diameter of structure 1 with its springs (m). Section III-A.
pub const STRUCTURE_1_DIAMETER_M: f64 = 61e-3;
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
/// Factor on the stiffness k_1 of the short member that brings Eq. (3) close to the measured forces
/// of case 3 (1). Section III-D.3.
pub const CASE_3_FACTOR: f64 = 5.0;

/// Position of the nest (m). Section VII.
pub const NEST_POSITION_M: Vec2 = Vec2::new(0.2, -0.17);
/// Walking speed of a searching ant, v_i (m/s). Section VII.
pub const SEARCH_SPEED_M_PER_S: f64 = 0.08;
/// Variance of the believed position of the load, sigma^2 (m^2). Section VII prints it without a
/// unit.
pub const TARGET_VARIANCE_M2: f64 = 0.01;
/// Gain of the steering, k (1/s). Section VII, for Eq. (19) and (21).
pub const STEERING_GAIN_PER_S: f64 = 10.0;
/// Largest angle between a pull and its spring, beta (rad): 60 degrees. Section VII, for Eq. (22).
pub const STEERING_HALF_ANGLE_RAD: f64 = FRAC_PI_3;
/// Distance along a searching ant from its position to the point about which it turns, r (m).
/// Section VII, for Eq. (20). Eq. (23) of a pulling ant has no such distance.
pub const CONTROL_OFFSET_M: f64 = 2e-3;
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

/// Mean of the measured pulls of the ants (N). Section IV-C.1.
pub const MEASURED_PULL_MEAN_N: f64 = 10.5e-3;
/// Standard deviation of the measured pulls (N). Section IV-C.1.
pub const MEASURED_PULL_SD_N: f64 = 5.0e-3;
/// Number of measured pulls (1). Section IV-C.1.
pub const N_MEASURED_PULLS: u64 = 10_906;
/// Pull that [`MEASURED_SHARE_BELOW`] of the measured pulls did not exceed (N). Section IV-C.1.
pub const MEASURED_LIMIT_N: f64 = 30e-3;
/// Fraction of the measured pulls that did not exceed [`MEASURED_LIMIT_N`] (1). Section IV-C.1.
pub const MEASURED_SHARE_BELOW: f64 = 0.991;
/// Order of the inertial force on a structure (N): 1e-4 mN. Section IV-C.1.
pub const INERTIAL_FORCE_N: f64 = 1e-7;
/// Friction force mu m g on structure 2 (N). Section IV-C.1.
pub const FRICTION_FORCE_N: f64 = 22e-3;

/// Time of the phase change in the simulated run of four ants (s). Section VII, for Fig. 11.
pub const PHASE_CHANGE_S: f64 = 83.0;

/// Number of simulated samples in which 1 to 10 ants pulled (1). Caption of Fig. 9.
pub const SIMULATED_SAMPLES: [u64; 10] = [1_186_594, 19_971, 50_522, 36_362, 35_459, 4956, 17_700, 38_777, 46_289, 19_234];
/// Number of measured samples in which 4 to 9 ants pulled (1). Caption of Fig. 9. The paper counts
/// the samples of 1 to 3 ants by hand, and prints no number of them.
pub const MEASURED_SAMPLES: [u64; 6] = [561, 453, 4154, 2448, 1866, 182];
/// Smallest group of [`MEASURED_SAMPLES`] (1).
pub const SMALLEST_MEASURED: usize = 4;
/// Smallest group that only the trial of ten ants can have (1).
pub const SMALLEST_OF_TEN: usize = 6;

/// Fraction of all samples in which one ant pulled (1).
pub fn share_of_one() -> f64 {
    SIMULATED_SAMPLES[0] as f64 / SIMULATED_SAMPLES.iter().sum::<u64>() as f64
}

/// Fraction of samples in which `size` of ten ants pulled, among those with six or more (1).
pub fn share_of_size(size: usize) -> f64 {
    let of_ten = &SIMULATED_SAMPLES[SMALLEST_OF_TEN - 1..];
    SIMULATED_SAMPLES[size - 1] as f64 / of_ten.iter().sum::<u64>() as f64
}

/// A parameter of the ants whose value the paper prints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintedParameter {
    /// Key of the ants' drive in a scenario.
    pub key: &'static str,
    /// The paper's symbol.
    pub symbol: &'static str,
    pub value: f64,
    pub unit: &'static str,
    /// Where it acts in the paper's equations.
    pub acts_in: &'static str,
}

/// Every parameter of the ants whose value Section VII prints.
pub const ANTS: [PrintedParameter; 8] = [
    of_ants("search_speed_m_per_s", "v_i", SEARCH_SPEED_M_PER_S, "m/s", "Eq. 20 (Search)"),
    of_ants("target_variance_m2", "sigma^2", TARGET_VARIANCE_M2, "m^2", "Search"),
    of_ants("steering_gain_per_s", "k", STEERING_GAIN_PER_S, "1/s", "Eq. 19 and 21"),
    of_ants("steering_half_angle_rad", "beta", STEERING_HALF_ANGLE_RAD, "rad", "Eq. 22 (Transport)"),
    of_ants("control_offset_m", "r", CONTROL_OFFSET_M, "m", "Eq. 20 (Search)"),
    of_ants("grasp_probability", "p_1", GRASP_PROBABILITY, "", "Search to Transport"),
    of_ants("strong_pull_n", "F_m", STRONG_PULL_N, "N", "Eq. 18"),
    of_ants("release_steepness_per_n", "zeta", RELEASE_STEEPNESS_PER_N, "1/N", "Eq. 18"),
];

const fn of_ants(key: &'static str, symbol: &'static str, value: f64, unit: &'static str, acts_in: &'static str) -> PrintedParameter {
    PrintedParameter { key, symbol, value, unit, acts_in }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::behaviour::ReleaseLaw;

    /// mu m g of the printed mass is the printed friction force, to its two digits; diameter and
    /// rest length give the radius of the load.
    #[test]
    fn printed_numbers_agree_with_each_other() {
        assert!((FRICTION_COEFFICIENT * LOAD_MASS_KG * 9.81 - FRICTION_FORCE_N).abs() < 0.5e-3);
        assert!((0.5 * DIAMETER_M - REST_LENGTH_M - LOAD_RADIUS_M).abs() < 1e-12);
        assert!((SPRING.rest_length() - REST_LENGTH_M).abs() < 1e-12);
        // Groups of two to five ants, each with its ants, make up the printed sample of pulls to
        // 1.2 %.
        let pulls: u64 = (2..=5).map(|size| size * SIMULATED_SAMPLES[size as usize - 1]).sum();
        assert!((pulls as f64 / N_PULLS as f64 - 1.0).abs() < 0.012, "{pulls}");
    }

    /// No single time step gives pulls and group sizes together, with forces in newtons. If all
    /// ants decide once in a step, and as many leave as come, p_2 is at most 0.07 on average, even
    /// if every free tip is in the reach of every searching ant. Eq. (18) is four times that
    /// without a pull.
    #[test]
    fn printed_groups_exclude_one_time_step_in_newtons() {
        let sizes = SMALLEST_OF_TEN..=10;
        let attached: f64 = sizes.clone().map(|size| size as f64 * share_of_size(size)).sum();
        let coming: f64 = sizes
            .map(|size| {
                let n_free = (10 - size) as f64;
                share_of_size(size) * n_free * (1.0 - (1.0 - GRASP_PROBABILITY).powf(n_free))
            })
            .sum();
        let most = coming / attached;
        let release = ReleaseLaw { strong_pull: STRONG_PULL_N, steepness: RELEASE_STEEPNESS_PER_N, period: 1.0 };
        assert!((0.069..0.071).contains(&most), "{most}");
        assert!(release.probability(0.0) > 3.8 * most);
    }

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
