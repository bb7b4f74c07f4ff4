//! The energy of one step: what friction, dashpots and tips did.
//!
//! Quadratures. Friction: minus force times `h v` at the support's arm at the start of the step, the slip that the engine's solver saw; the
//! true slip differs by O(h^2 omega^2) and would give a support that the load turns about a spurious sign. Dashpots: force times `h` times
//! their rate of deformation at the end of the step in the geometry of its start. Tips: trapezoid of the law's force, plus the dashpots'
//! force of the step. With these the defect of a step is `-1/2 dv' M dv - 1/2 h^2 v' K v` (numerical damping of implicit Euler) and terms of O(h^3).

use serde::{Deserialize, Serialize};

use super::joints::SpringJoint;
use super::step::Step;
use crate::backend::held::HeldSprings;
use crate::math::{Vec2, perpendicular, rotation};
use crate::model::{Load, PolarSpring};

/// Energy that went somewhere so far (J); see [`crate::backend::EnergyLedger`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Books {
    pub friction: f64,
    pub damping: f64,
    pub released: f64,
    pub tip_work: f64,
    pub initial: f64,
    pub numerical_damping: f64,
}

impl Books {
    pub fn is_finite(&self) -> bool {
        [self.friction, self.damping, self.released, self.tip_work, self.initial, self.numerical_damping].iter().all(|v| v.is_finite())
    }

    /// Books friction, and what it and the change of motion of `load` leave to be explained.
    pub fn add_friction(&mut self, load: &Load, step: &Step) {
        let turn = rotation(step.start.pose.heading);
        let before = self.friction;
        for (joint, wrench) in step.friction.iter().zip(&step.wrenches) {
            let slip_velocity = step.end.twist.velocity_at(&(turn * joint.offset));
            self.friction -= step.duration * (wrench.force.dot(&slip_velocity) + wrench.torque * step.end.twist.angular);
        }
        let [start, end] = [&step.start, &step.end].map(|motion| load.kinetic_energy(&motion.twist));
        self.numerical_damping -= self.friction - before + end - start;
    }

    /// Books dashpots and tips, and leaves the forces of the dashpots in `on_tip` (N, world, one a spring). `held` has the tips at the end of the
    /// step.
    pub fn add_springs(&mut self, springs: &[PolarSpring], held: &HeldSprings, step: &Step, on_tip: &mut [Vec2]) {
        let work = held.trapezoid_work(springs, &step.from, &step.start.pose, &step.end.pose);
        self.tip_work += work.of_tips;
        self.numerical_damping += work.on_load;
        for ((grip, before), joint) in held.grips().iter().zip(&step.from).zip(&step.springs) {
            let shift = grip.tip - before.tip;
            let rate = shift / step.duration - step.end.twist.velocity_at(&joint.arm);
            let on_load = dashpot_force(joint, &rate);
            self.tip_work += on_load.dot(&shift);
            self.damping += on_load.dot(&rate) * step.duration;
            self.numerical_damping += on_load.dot(&(shift - rate * step.duration));
            on_tip[grip.spring] = -on_load;
        }
    }
}

/// Force of the dashpots on the load (N, world) when the tip moves at `rate` (m/s) against the load's material there.
fn dashpot_force(joint: &SpringJoint, rate: &Vec2) -> Vec2 {
    let axes = [joint.direction, perpendicular(&joint.direction)];
    joint.axes.iter().zip(axes).map(|(law, axis)| law.map_or(0.0, |law| law.damping) * rate.dot(&axis) * axis).sum()
}
