//! Damping: a dashpot is a spring of stiffness c / t about the shape at the start of the step, seen after the time t. Its force is c times the mean rate of that
//! time, and twice its energy over t the power it takes.

use crate::backend::held::{Grip, HeldSprings};
use crate::math::{Pose, Vec2};
use crate::model::{PolarSpring, System};

/// Dashpots of one step as springs; the index of a dashpot is the place of its grip.
pub(super) struct Dashpots {
    pub springs: Vec<PolarSpring>,
    pub held: HeldSprings,
    /// Time after which their springs are evaluated (s).
    time: f64,
}

impl Dashpots {
    /// One for each of `held`, or none at all without damping. `last` are the grips with their tips at the start of the step, where the load was at `before`.
    pub fn new(system: &System, held: &HeldSprings, last: &[Grip], before: &Pose, time: f64) -> Self {
        let mut dashpots = Dashpots { springs: Vec::new(), held: HeldSprings::default(), time };
        if system.springs.iter().all(|spring| spring.damping_ratio == 0.0) {
            return dashpots;
        }
        for (at, (grip, last)) in held.grips().iter().zip(last).enumerate() {
            let spring = &system.springs[grip.spring];
            let (radial, torsional) = system.dashpot(spring);
            let shape = last.shape(&system.springs, before);
            dashpots.springs.push(spring.about(&shape, radial / time, torsional / time));
            dashpots.held.grasp(&dashpots.springs, at, grip.tip, before);
        }
        dashpots
    }

    /// Energy taken in a step of `step` (s) with the load at `stage` when they are evaluated (J).
    pub fn loss(&self, stage: &Pose, step: f64) -> f64 {
        2.0 * self.held.energy(&self.springs, stage) * step / self.time
    }

    /// Forces on the tips (N, world).
    pub fn forces(&self, stage: &Pose) -> impl Iterator<Item = Vec2> {
        (0..self.springs.len()).map(|at| self.held.force_on_tip(&self.springs, at, stage))
    }
}
