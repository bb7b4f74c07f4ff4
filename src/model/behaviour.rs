//! Decisions of an ant (Eq. 18-19, 21-23): grasp, release, and direction of the pull.
//!
//! Deviation: the paper states probabilities per time step, and does not print the step. Here
//! decisions have rates: a probability p per decision period D is the hazard -ln(1 - p) / D, so
//! that rates do not depend on the control period. An attachment ends at a tick, on average half a
//! period late. The literal reading per tick is [`ReleasePace::PerTick`].

use std::f64::consts::LN_2;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::{Numbers, SMALL_TANGENT, Vec2, Vectors, small_arctangent};

/// Times at which an ant decides to grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GraspPace {
    /// The ant decides at every tick, with the hazard that gives the probability within one
    /// decision period.
    Hazard,
    /// The ant decides at every tick, with the probability itself. Rates then depend on the control
    /// period.
    PerTick,
}

/// Times at which an ant decides to release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReleasePace {
    /// The ant decides once per decision period after its grasp, with the printed probability.
    Aged,
    /// The ant decides at every tick, with the hazard that gives the printed probability within one
    /// decision period.
    Hazard,
    /// The ant decides at every tick, with the printed probability. Rates then depend on the
    /// control period.
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

/// Dependence of a release on the pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleaseLaw {
    /// F_m (N): the release probability is 1/2 at half this pull.
    pub strong_pull: f64,
    /// Steepness zeta of the release probability over the pull (1/N).
    pub steepness: f64,
    /// Time between decisions, D_r (s).
    pub period: f64,
}

impl ReleaseLaw {
    /// Probability of a release at one decision under a pull (N), Eq. (18).
    pub fn probability(&self, pull: f64) -> f64 {
        1.0 / (1.0 + (-self.steepness * (pull - 0.5 * self.strong_pull)).exp())
    }

    /// Hazard of a release under a pull F (N): softplus(zeta (F - F_m / 2)) / D_r, since -ln(1 -
    /// logistic z) = softplus z (1/s).
    pub fn hazard(&self, pull: f64) -> f64 {
        let z = self.steepness * (pull - 0.5 * self.strong_pull);
        // This form of softplus does not overflow.
        (z.max(0.0) + (-z.abs()).exp().ln_1p()) / self.period
    }

    /// Upper bound of [`ReleaseLaw::hazard`], without its exponential: softplus z is at most max(z,
    /// 0) + ln 2 (1/s).
    pub fn most_hazard(&self, pull: f64) -> f64 {
        let z = self.steepness * (pull - 0.5 * self.strong_pull);
        (z.max(0.0) + LN_2) / self.period
    }
}

/// Half angle beta of Eq. (22), the largest angle between a pull and its spring, as a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfAngle {
    sin: f64,
    cos: f64,
}

impl HalfAngle {
    /// Half angle from 0 to pi (rad).
    pub fn new(half_angle: f64) -> Self {
        let (sin, cos) = half_angle.sin_cos();
        Self { sin, cos }
    }

    /// Directions in which ants want to pull, Eq. (22), as vectors of any length: towards the nest,
    /// but at most the half angle off the direction in which the `spring` of each leads away from
    /// the load. A nest exactly behind the spring counts as on its left.
    pub fn pull_directions(&self, spring: Vectors, nest: Vectors) -> Vectors {
        let (sin, cos) = (Numbers::splat(self.sin), Numbers::splat(self.cos));
        let is_left = spring.perp(nest).simd_ge(Numbers::ZERO);
        let turned = spring.turned(cos, is_left.select(sin, -sin));
        let beyond = turned.perp(nest);
        let is_past = is_left.select(beyond, -beyond).simd_gt(Numbers::ZERO);
        let is_behind = spring.dot(nest).simd_lt(Numbers::ZERO);
        // An angle above 90 degrees exceeds any half angle below 90 degrees; an angle below 90
        // degrees is within any half angle above.
        let is_beyond = if self.cos > 0.0 { is_behind | is_past } else { is_behind & is_past };
        turned.or(nest, is_beyond)
    }
}

/// Directions that ants face when they pull in these directions: they walk backwards, Eq. (21).
pub fn facing_for_pull(pull_directions: Vectors) -> Vectors {
    Vectors { x: -pull_directions.x, y: -pull_directions.y }
}

/// Signed angle from the unit vector `ahead` to a `desired` direction of any length in (-pi, pi]
/// (rad), Eq. (19).
pub fn turn_towards(desired: &Vec2, ahead: &Vec2) -> f64 {
    let (across, along) = (ahead.perp(desired), ahead.dot(desired));
    if across.abs() <= SMALL_TANGENT * along && along > 0.0 {
        return small_arctangent(across / along);
    }
    // Adding zero removes minus zeros, which would turn the result to minus pi, or an ant that
    // already faces the right way.
    (across + 0.0).atan2(along + 0.0)
}

/// Angles of [`turn_towards`] for several ants side by side (rad).
#[inline]
pub fn turns_towards(desired: Vectors, ahead: Vectors) -> Numbers {
    let (across, along) = (ahead.perp(desired), ahead.dot(desired));
    let is_small = across.abs().simd_le(Numbers::splat(SMALL_TANGENT) * along) & along.simd_gt(Numbers::ZERO);
    // Most ants that pull face nearly the desired direction.
    if is_small.all() {
        return small_arctangent(across / along);
    }
    (across + Numbers::ZERO).atan2(along + Numbers::ZERO)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::math::{LANES, direction, wrap_to_pi};

    const PAPER: ReleaseLaw = ReleaseLaw { strong_pull: 0.020, steepness: 100.0, period: 0.25 };

    /// Six values from 0 to 36.5 mN, of an independent calculation with four digits.
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
            // At the pull with probability 1/2 the two are equal.
            assert!(PAPER.hazard(pull) <= PAPER.most_hazard(pull) * (1.0 + 1e-15));
        }
        assert!(PAPER.hazard(1e6).is_finite());
        assert!((probability_within(hazard_of(0.2, 0.0025), 0.0025) - 0.2).abs() < 1e-16);
    }

    /// The ant may face any direction, and zeros may have either sign.
    #[test]
    fn an_ant_without_a_desired_direction_does_not_turn() {
        for quarter in 0..8 {
            let ahead = direction(0.1 + 0.25 * PI * f64::from(quarter));
            assert_eq!(turn_towards(&Vec2::zeros(), &ahead), 0.0);
            let same = |of: Vec2| Vectors::new([of; LANES]);
            let turns = turns_towards(same(Vec2::zeros()), same(ahead));
            assert!(turns.to_array().iter().all(|turn| *turn == 0.0));
        }
    }

    /// Direction of one ant beside others that pull elsewhere, at every place among them.
    fn pull_direction(limit: &HalfAngle, spring: &Vec2, nest: &Vec2) -> Vec2 {
        let beside =
            |own: &Vec2, at: usize| Vectors::new(std::array::from_fn(|k| if k == at { *own } else { Vec2::new(0.1 - own.y, own.x) }));
        let [first, others @ ..]: [Vec2; LANES] =
            std::array::from_fn(|at| limit.pull_directions(beside(spring, at), beside(nest, at)).lane(at));
        assert!(others.iter().all(|other| *other == first), "{first} {others:?}");
        first
    }

    /// Angle of the pull, computed with angles.
    fn by_angles(spring: f64, nest: f64, half_angle: f64) -> f64 {
        spring + wrap_to_pi(nest - spring).clamp(-half_angle, half_angle)
    }

    #[test]
    fn pulls_stay_within_the_half_angle_of_the_spring() {
        for half_angle in [0.0, 0.5, 0.5 * PI, 2.0, PI] {
            let limit = HalfAngle::new(half_angle);
            for (k, j) in (0..60).flat_map(|k| (0..61).map(move |j| (k, j))) {
                let (spring, nest) = (TAU * f64::from(k) / 60.0 - PI + 0.01, TAU * f64::from(j) / 61.0 - PI + 0.02);
                let pull = pull_direction(&limit, &(0.02 * direction(spring)), &(0.3 * direction(nest)));
                // Rounding of angles of order one.
                assert!(
                    wrap_to_pi(pull.y.atan2(pull.x) - by_angles(spring, nest, half_angle)).abs() < 1e-14,
                    "{spring} {nest} {half_angle}"
                );
            }
        }
    }

    #[test]
    fn a_nest_exactly_behind_the_spring_is_on_its_left() {
        for spring in [Vec2::new(0.01, 0.0), Vec2::new(-0.01, 0.0), Vec2::new(0.003, 0.0), Vec2::new(-0.001, 0.007)] {
            for half_angle in [0.0, 0.5, 1.5, 2.0] {
                let pull = pull_direction(&HalfAngle::new(half_angle), &spring, &(-4.0 * spring));
                assert!((turn_towards(&pull, &spring.normalize()) - half_angle).abs() < 1e-15, "{spring} {half_angle}");
                let pull = pull_direction(&HalfAngle::new(PI - half_angle), &spring, &(4.0 * spring));
                assert!(turn_towards(&pull, &spring.normalize()).abs() < 1e-15, "{spring} {half_angle}");
            }
        }
        let ahead = Vec2::new(1.0, 0.0);
        assert_eq!(turn_towards(&Vec2::new(-2.0, -0.0), &ahead), PI);
        assert_eq!(turn_towards(&facing_for_pull(Vectors::splat(Vec2::new(0.0, 3.0))).lane(1), &ahead), -0.5 * PI);
    }
}
