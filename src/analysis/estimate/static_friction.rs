//! Friction forces that hold the reduced model at rest.
//!
//! Forces f_i within all limits c_i that balance a wrench w prove rest. They are found from the
//! last ones by the least change, in units of the limits, that balances the wrench. Forces that
//! leave their limits are reduced to a little within them, the rest is balanced again, and so on.
//! The change is along the slip of a twist n. If nothing can hold the load, n approaches the
//! direction of slip, and
//!
//! ```text
//! n'w > sum_i c_i |B_i n|
//! ```
//!
//! proves slip. Close to the slip limit the search ends undecided, and the exact solver decides.

use crate::backend::friction::move_back_within;
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};

#[derive(Clone, Debug)]
pub struct StaticFriction {
    /// Offset (m, load axes) and limit (N) of each support.
    supports: Vec<(Vec2, f64)>,
    /// (sum_i c_i^2 B_i' B_i)^-1; `None` if the supports cannot balance every wrench.
    balance: Option<Mat3>,
    /// Scale of a wrench: the sum of the limits, and that times the largest distance of a support
    /// (N, N, N m).
    units: Vec3,
    /// Last forces, one a support (N, load axes).
    forces: Vec<Vec2>,
    trial: Vec<Vec2>,
}

/// Whether the load sticks under a wrench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StickTest {
    /// Forces that balance the wrench were found, and are now the last ones.
    Sticks,
    /// No forces were found. If there are none, the load begins to slip near this direction.
    Undecided(Vec3),
}

/// Largest number of rounds: nearly all loads that can rest are at rest by then.
const MOST_ROUNDS: u32 = 24;
/// Largest relative imbalance of a wrench, which is rounding (1).
const BALANCED: f64 = 1e-13;

impl StaticFriction {
    pub fn new(ground: &Ground) -> Self {
        let supports: Vec<(Vec2, f64)> = ground.supports.iter().map(|support| support.offset).zip(ground.slip_limits()).collect();
        let limits: f64 = ground.slip_limits().sum();
        let reach = supports.iter().map(|(offset, _)| offset.norm()).fold(0.0, f64::max);
        let mut gram = Mat3::zeros();
        for (offset, limit) in &supports {
            let (x, y) = (Vec3::new(1.0, 0.0, -offset.y), Vec3::new(0.0, 1.0, offset.x));
            gram += limit * limit * (x * x.transpose() + y * y.transpose());
        }
        let forces = vec![Vec2::zeros(); supports.len()];
        Self { supports, balance: gram.try_inverse(), units: limits * Vec3::new(1.0, 1.0, reach), trial: forces.clone(), forces }
    }

    /// Searches forces that balance a `wrench` (N, N, N m), beginning with the last ones.
    pub fn test(&mut self, wrench: &Vec3) -> StickTest {
        let Some(balance) = self.balance else { return StickTest::Undecided(Vec3::zeros()) };
        self.trial.copy_from_slice(&self.forces);
        let mut twist = Vec3::zeros();
        for round in 0..MOST_ROUNDS {
            twist = balance * (wrench - self.wrench_of_trial());
            if round > 0 && round % 4 == 0 && twist.dot(wrench) > self.loss(&twist) {
                break;
            }
            let mut fits = true;
            for (force, (offset, limit)) in self.trial.iter_mut().zip(&self.supports) {
                *force += limit * limit * slip_velocity(offset, &twist);
                fits &= force.norm_squared() <= limit * limit;
            }
            if fits && self.keep(wrench) {
                return StickTest::Sticks;
            }
            self.trial.iter_mut().zip(&self.supports).for_each(|(force, (_, limit))| move_back_within(force, *limit));
        }
        StickTest::Undecided(twist)
    }

    /// `sum_i c_i |B_i n|` (N m).
    fn loss(&self, n: &Vec3) -> f64 {
        self.supports.iter().map(|(offset, limit)| limit * slip_velocity(offset, n).norm()).sum()
    }

    /// Keeps the trial as the last forces, if it balances the `wrench`.
    fn keep(&mut self, wrench: &Vec3) -> bool {
        let left = (wrench - self.wrench_of_trial()).abs();
        let is_balanced = (0..3).all(|k| left[k] <= BALANCED * self.units[k]);
        if is_balanced {
            std::mem::swap(&mut self.forces, &mut self.trial);
        }
        is_balanced
    }

    fn wrench_of_trial(&self) -> Vec3 {
        self.trial.iter().zip(&self.supports).map(|(force, (offset, _))| wrench_of(offset, force)).sum()
    }

    pub fn forces(&self) -> &[Vec2] {
        &self.forces
    }

    /// Continues from the `friction` forces that hold the load, one a support (N, load axes). They
    /// are the opposite of the forces on the supports.
    pub fn continue_from(&mut self, friction: &[Vec2]) {
        self.forces.iter_mut().zip(friction).for_each(|(force, friction)| *force = -friction);
    }

    /// Continues from other forces, one a support (N, load axes). Returns whether their number
    /// fits.
    pub fn set_forces(&mut self, forces: &[Vec2]) -> bool {
        let fits = forces.len() == self.forces.len();
        if fits {
            self.forces.copy_from_slice(forces);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::friction::{ContactMode, FrictionSolver};
    use crate::math::{self, RandomStreams, Stream};
    use crate::model::SupportPoint;

    fn tripod() -> Ground {
        let supports = [0.5, 2.6, 4.7].map(|angle| SupportPoint {
            offset: 0.0081333 * math::direction(angle),
            normal_load: 0.005232,
            friction_coefficient: None,
        });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// Wrenches that grow by steps of 1 % and turn: the exact solver confirms rest, and finds none
    /// at 2 % more than the last wrench that sticks.
    #[test]
    fn what_sticks_rests_and_nearly_all_that_rests_sticks() {
        let ground = tripod();
        let stiffness = Mat3::from_diagonal(&Vec3::new(2.0, 2.0, 1e-3));
        let (mut n_sticking, mut n_slipping) = (0, 0);
        for case in 0..40 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let (mut static_friction, mut solver) = (StaticFriction::new(&ground), FrictionSolver::new(&ground, 0.0122));
            let direction = Vec3::new(draw(0), draw(1), 0.008 * draw(2));
            let bend = Vec3::new(draw(3), draw(4), 0.008 * draw(5));
            for step in 1..300 {
                let t = 0.01 * f64::from(step);
                let wrench = 0.022 * t * (direction + t * bend);
                let sticks = static_friction.test(&wrench) == StickTest::Sticks;
                if sticks {
                    n_sticking += 1;
                    assert_eq!(solver.solve(&stiffness, &wrench).mode, ContactMode::Stick, "{case} {step}");
                    let balanced: Vec3 = static_friction
                        .supports
                        .iter()
                        .zip(&static_friction.forces)
                        .map(|((offset, _), force)| wrench_of(offset, force))
                        .sum();
                    assert!((balanced - wrench).xy().amax() <= BALANCED * static_friction.units.x, "{case} {step}");
                    assert!(static_friction.forces.iter().zip(&static_friction.supports).all(|(force, (_, limit))| force.norm() <= *limit));
                } else {
                    n_slipping += 1;
                    assert_ne!(solver.solve(&stiffness, &(1.02 * wrench)).mode, ContactMode::Stick, "{case} {step}");
                    // Its slip under 10 % more is near the direction that was found.
                    let StickTest::Undecided(near) = static_friction.test(&(1.1 * wrench)) else { panic!("{case} {step}") };
                    let slip = solver.solve(&stiffness, &(1.1 * wrench)).increment;
                    let units = Vec3::new(1.0, 1.0, 0.008);
                    let (a, b) = (near.component_mul(&units).normalize(), slip.component_mul(&units).normalize());
                    assert!(a.dot(&b) > 0.9, "{case} {step}: {a} {b}");
                    break;
                }
            }
        }
        assert!(n_sticking > 1000 && n_slipping > 30, "{n_sticking} {n_slipping}");
    }

    /// One support does not resist a torque about itself, and without friction nothing sticks.
    #[test]
    fn what_cannot_stick_does_not() {
        let [one, bare] = [(1, 1.4), (3, 0.0)].map(|(n, friction_coefficient)| {
            let ground = tripod();
            Ground { friction_coefficient, supports: ground.supports[..n].to_vec() }
        });
        for ground in [one, bare] {
            assert_ne!(StaticFriction::new(&ground).test(&Vec3::new(0.0, 0.0, 1e-6)), StickTest::Sticks, "{ground:?}");
        }
    }
}
