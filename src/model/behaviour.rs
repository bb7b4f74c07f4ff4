//! What an ant decides (Eq. 18-19, 21-23): grasp, release, and where to pull.
//!
//! Deviation: the paper gives probabilities per step of a step it does not print. Here decisions have rates: a probability p per decision
//! period D is the hazard -ln(1 - p) / D, so that results do not depend on the control period. The literal per-tick reading is [`Pace::PerTick`].

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::math::wrap_to_pi;

/// When an ant draws for a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pace {
    /// Every decision period after the grasp, with the printed probability.
    Aged,
    /// At every tick, with the hazard that the printed probability per decision period amounts to.
    Hazard,
    /// At every tick, with the printed probability: the literal reading, which depends on the control period.
    PerTick,
}

/// Probability that an event of constant `hazard` (1/s) happens within `duration` (s).
pub fn probability_within(hazard: f64, duration: f64) -> f64 {
    -(-hazard * duration).exp_m1()
}

/// Hazard (1/s) of an event with `probability` (1, below one) per `period` (s).
pub fn hazard_of(probability: f64, period: f64) -> f64 {
    -(-probability).ln_1p() / period
}

/// How a pull makes an ant let go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseLaw {
    /// F_m: the pull at twice the even odds (N).
    pub strong_pull: f64,
    /// zeta (1/N).
    pub steepness: f64,
    /// D_r: time between decisions (s).
    pub period: f64,
}

impl ReleaseLaw {
    /// Probability of letting go at one decision under a pull (N), Eq. (18): a logistic curve through 1/2 at half the strong pull.
    pub fn probability(&self, pull: f64) -> f64 {
        1.0 / (1.0 + (-self.steepness * (pull - 0.5 * self.strong_pull)).exp())
    }

    /// Hazard of letting go (1/s): softplus(zeta (F - F_m / 2)) / D_r, since -ln(1 - logistic z) = softplus z.
    pub fn hazard(&self, pull: f64) -> f64 {
        let z = self.steepness * (pull - 0.5 * self.strong_pull);
        // softplus without overflow.
        (z.max(0.0) + (-z.abs()).exp().ln_1p()) / self.period
    }
}

/// The direction in which an ant wants to pull (rad), Eq. (22): towards the nest, but at most `half_angle` (rad) off the direction in which
/// its spring leads away from the load. A nest exactly behind the spring counts as on its left.
pub fn pull_direction(spring_direction: f64, nest_direction: f64, half_angle: f64) -> f64 {
    spring_direction + wrap_to_pi(nest_direction - spring_direction).clamp(-half_angle, half_angle)
}

/// The heading of an ant that pulls in `pull_direction` (rad): it walks backwards, Eq. (21).
pub fn heading_for_pull(pull_direction: f64) -> f64 {
    pull_direction + PI
}

/// Signed difference from `heading` to `desired` in (-pi, pi] (rad), Eq. (19).
pub fn heading_error(desired: f64, heading: f64) -> f64 {
    wrap_to_pi(desired - heading)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: ReleaseLaw = ReleaseLaw { strong_pull: 0.020, steepness: 100.0, period: 0.25 };

    /// The six values for 0 ... 36.5 mN, printed with four digits.
    #[test]
    fn release_probabilities_in_newtons() {
        let table = [(0.0, 0.2689), (0.005, 0.3775), (0.010, 0.5), (0.020, 0.7311), (0.030, 0.8808), (0.0365, 0.9340)];
        for (pull, probability) in table {
            assert!((PAPER.probability(pull) - probability).abs() < 5e-5);
        }
    }

    #[test]
    fn the_hazard_over_one_period_is_the_printed_probability() {
        for pull in [0.0, 0.01, 0.05, 3.0] {
            let within = probability_within(PAPER.hazard(pull), PAPER.period);
            // Both are of order one; rounding of exp and ln_1p.
            assert!((within - PAPER.probability(pull)).abs() < 1e-14);
        }
        assert!(PAPER.hazard(1e6).is_finite());
        assert!((probability_within(hazard_of(0.2, 0.0025), 0.0025) - 0.2).abs() < 1e-16);
    }

    #[test]
    fn pulls_stay_within_the_half_angle_of_the_spring() {
        assert!((pull_direction(0.0, 0.3, 0.5) - 0.3).abs() < 1e-15);
        assert_eq!(pull_direction(0.0, 2.0, 0.5), 0.5);
        assert_eq!(pull_direction(0.0, -2.0, 0.5), -0.5);
        // Across the cut: the nest is 0.2 rad beyond the spring, not 2 pi - 0.2 behind it.
        assert!((pull_direction(3.1, -3.1, 0.5) - (2.0 * PI - 3.1)).abs() < 1e-14);
        // The tie is decided, and the same way every time.
        assert_eq!(pull_direction(0.0, PI, 0.5), 0.5);
        assert_eq!(pull_direction(0.0, -PI, 0.5), 0.5);
    }
}
