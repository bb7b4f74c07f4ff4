//! Forces of the supports that hold a shadow at rest.
//!
//! Forces f_i within all limits c_i that balance a wrench w prove rest. From the last ones they are found by the least change, in units of the limits, that
//! balances the wrench; where that takes some of them beyond their limits, they are taken back to a little within and what that leaves is balanced again, over
//! and over. The change is along the slip of some twist n; where nothing can hold the load, n comes near to the slip that begins, and
//!
//! ```text
//! n'w > sum_i c_i |B_i n|
//! ```
//!
//! proves that it does. Close to the edge of slipping this ends without an answer, and the exact solver has to tell.

use crate::backend::friction::move_back_within;
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};

#[derive(Clone, Debug)]
pub struct Bearing {
    /// Offset (m, load axes) and limit (N) of each support.
    supports: Vec<(Vec2, f64)>,
    /// (sum_i c_i^2 B_i' B_i)^-1; `None` where supports alone do not hold a load against turns.
    balance: Option<Mat3>,
    /// The wrench's units: sum of the limits, and that times the largest distance of a support (N, N, N m).
    units: Vec3,
    /// Last ones (N, load axes).
    forces: Vec<Vec2>,
    trial: Vec<Vec2>,
}

/// What the supports can do about a wrench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Forces that balance it were found, and are the last ones.
    Holds,
    /// None were; if there are none, a load begins to slip near this direction.
    Open(Vec3),
}

/// So often forces are taken back: nearly all that can come to rest does by then.
const MOST_ROUNDS: u32 = 24;
/// What may be out of balance (1): roundings.
const BALANCED: f64 = 1e-13;

impl Bearing {
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

    /// Looks for forces that balance a `wrench` (N, N, N m), from the last ones on.
    pub fn look(&mut self, wrench: &Vec3) -> Look {
        let Some(balance) = self.balance else { return Look::Open(Vec3::zeros()) };
        self.trial.copy_from_slice(&self.forces);
        let mut twist = Vec3::zeros();
        for round in 0..MOST_ROUNDS {
            twist = balance * (wrench - self.held_by_trial());
            if round > 0 && round % 4 == 0 && twist.dot(wrench) > self.loss(&twist) {
                break;
            }
            let mut fits = true;
            for (force, (offset, limit)) in self.trial.iter_mut().zip(&self.supports) {
                *force += limit * limit * slip_velocity(offset, &twist);
                fits &= force.norm_squared() <= limit * limit;
            }
            if fits && self.keep(wrench) {
                return Look::Holds;
            }
            self.trial.iter_mut().zip(&self.supports).for_each(|(force, (_, limit))| move_back_within(force, *limit));
        }
        Look::Open(twist)
    }

    /// `sum_i c_i |B_i n|` (N m).
    fn loss(&self, n: &Vec3) -> f64 {
        self.supports.iter().map(|(offset, limit)| limit * slip_velocity(offset, n).norm()).sum()
    }

    /// Takes the trial as the last forces, if it balances the `wrench`.
    fn keep(&mut self, wrench: &Vec3) -> bool {
        let left = (wrench - self.held_by_trial()).abs();
        let is_balanced = (0..3).all(|k| left[k] <= BALANCED * self.units[k]);
        if is_balanced {
            std::mem::swap(&mut self.forces, &mut self.trial);
        }
        is_balanced
    }

    fn held_by_trial(&self) -> Vec3 {
        self.trial.iter().zip(&self.supports).map(|(force, (offset, _))| wrench_of(offset, force)).sum()
    }

    pub fn forces(&self) -> &[Vec2] {
        &self.forces
    }

    /// Goes on from the `friction` that was found to hold the load (N, load axes), one a support: what pulls at the supports is its opposite.
    pub fn go_on_from(&mut self, friction: &[Vec2]) {
        self.forces.iter_mut().zip(friction).for_each(|(force, friction)| *force = -friction);
    }

    /// Goes on from other forces (N, load axes), one a support; says whether they are so many.
    pub fn set_forces(&mut self, forces: &[Vec2]) -> bool {
        let is_of_this = forces.len() == self.forces.len();
        if is_of_this {
            self.forces.copy_from_slice(forces);
        }
        is_of_this
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::friction::{ContactMode, FrictionSolver};
    use crate::math::{RandomStreams, Stream, direction};
    use crate::model::SupportPoint;

    fn tripod() -> Ground {
        let supports = [0.5, 2.6, 4.7].map(|angle| SupportPoint { offset: 0.0081333 * direction(angle), normal_load: 0.005232 });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// Wrenches that grow in steps of a hundredth while they turn: what is held is at rest by the exact solver, and what is at rest with a fiftieth to spare
    /// is held.
    #[test]
    fn what_it_holds_rests_and_nearly_all_that_rests_is_held() {
        let ground = tripod();
        let stiffness = Mat3::from_diagonal(&Vec3::new(2.0, 2.0, 1e-3));
        let (mut n_held, mut n_slipping) = (0, 0);
        for case in 0..40 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let (mut bearing, mut solver) = (Bearing::new(&ground), FrictionSolver::new(&ground, 0.0122));
            let way = Vec3::new(draw(0), draw(1), 0.008 * draw(2));
            let bend = Vec3::new(draw(3), draw(4), 0.008 * draw(5));
            for step in 1..300 {
                let t = 0.01 * f64::from(step);
                let wrench = 0.022 * t * (way + t * bend);
                let holds = bearing.look(&wrench) == Look::Holds;
                if holds {
                    n_held += 1;
                    assert_eq!(solver.solve(&stiffness, &wrench).mode, ContactMode::Stick, "{case} {step}");
                    let held: Vec3 =
                        bearing.supports.iter().zip(&bearing.forces).map(|((offset, _), force)| wrench_of(offset, force)).sum();
                    assert!((held - wrench).xy().amax() <= BALANCED * bearing.units.x, "{case} {step}");
                    assert!(bearing.forces.iter().zip(&bearing.supports).all(|(force, (_, limit))| force.norm() <= *limit));
                } else {
                    n_slipping += 1;
                    assert_ne!(solver.solve(&stiffness, &(1.02 * wrench)).mode, ContactMode::Stick, "{case} {step}");
                    // What it slips by, a little further on, is near the direction that was found.
                    let Look::Open(near) = bearing.look(&(1.1 * wrench)) else { panic!("{case} {step}") };
                    let slip = solver.solve(&stiffness, &(1.1 * wrench)).increment;
                    let units = Vec3::new(1.0, 1.0, 0.008);
                    let (a, b) = (near.component_mul(&units).normalize(), slip.component_mul(&units).normalize());
                    assert!(a.dot(&b) > 0.9, "{case} {step}: {a} {b}");
                    break;
                }
            }
        }
        assert!(n_held > 1000 && n_slipping > 30, "{n_held} {n_slipping}");
    }

    /// One support gives way to any moment, and without friction nothing holds.
    #[test]
    fn what_cannot_hold_does_not() {
        let [one, bare] = [(1, 1.4), (3, 0.0)].map(|(n, friction_coefficient)| {
            let ground = tripod();
            Ground { friction_coefficient, supports: ground.supports[..n].to_vec() }
        });
        for ground in [one, bare] {
            assert_ne!(Bearing::new(&ground).look(&Vec3::new(0.0, 0.0, 1e-6)), Look::Holds, "{ground:?}");
        }
    }
}
