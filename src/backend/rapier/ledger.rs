//! The energy of one step: what friction, dashpots and tips did.
//!
//! Quadratures. Friction: minus force times `h v` at the support's arm at the start of the step, the slip that the engine's solver saw; the
//! true slip differs by O(h^2 omega^2) and would give a support that the load turns about a spurious sign. Dashpots: force times `h` times
//! their rate of deformation at the end of the step in the geometry of its start. Tips: trapezoid of the law's force, and at a load that stood what
//! the springs have got, which is exact; plus the dashpots' force of the step. With these the defect of a step is `-1/2 dv' M dv - 1/2 h^2 v' K v` (numerical damping of implicit Euler) and terms of O(h^3).

use serde::{Deserialize, Serialize};

use super::joints::SpringJoint;
use super::springs::turned;
use super::step::Step;
use crate::math::{Vec2, perpendicular};
use crate::model::Load;

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
        let before = self.friction;
        for (joint, wrench) in step.friction.iter().zip(step.wrenches) {
            let slip_velocity = step.end.twist.velocity_at(&turned(&step.facing, &joint.offset));
            self.friction -= step.duration * (wrench.force.dot(&slip_velocity) + wrench.torque * step.end.twist.angular);
        }
        let [start, end] = [&step.start, &step.end].map(|motion| load.kinetic_energy(&motion.twist));
        self.numerical_damping -= self.friction - before + end - start;
    }

    /// Books dashpots and tips, and leaves the force of each held spring's dashpots on its tip in `on_tips` (N, world).
    pub fn add_springs(&mut self, step: &Step, on_tips: &mut Vec<Vec2>) {
        let stands = step.start.pose == step.end.pose;
        let (way, turn) = (step.end.pose.position - step.start.pose.position, step.end.pose.heading - step.start.pose.heading);
        let [before, after] = step.strands;
        on_tips.clear();
        for (at, joint) in step.springs.iter().enumerate() {
            let (shift, [before, after]) = (step.to[at].tip - step.from[at].tip, [&before[at], &after[at]]);
            if stands {
                self.tip_work += after.energy - before.energy;
            } else {
                self.tip_work += 0.5 * (before.pull + after.pull).dot(&shift);
                let way_at = |tip: &Vec2, origin: &Vec2| way + turn * perpendicular(&(tip - origin));
                self.numerical_damping += 0.5
                    * (before.pull.dot(&way_at(&step.from[at].tip, &step.start.pose.position))
                        + after.pull.dot(&way_at(&step.to[at].tip, &step.end.pose.position)));
            }
            on_tips.push(self.add_dashpots(step, joint, &shift));
        }
    }

    /// Force of a spring's dashpots on its tip (N, world), whose way is `shift` (m).
    fn add_dashpots(&mut self, step: &Step, joint: &SpringJoint, shift: &Vec2) -> Vec2 {
        if !joint.is_damped() {
            return Vec2::zeros();
        }
        let rate_for = |velocity: Vec2| shift / step.duration - velocity;
        let rate = rate_for(step.end.twist.velocity_at(&joint.arm));
        let rate_seen = rate_for(step.damped_twist().velocity_at(&joint.arm));
        let on_load = joint.force(|law, axis| law.damping * rate_seen.dot(axis));
        self.tip_work += on_load.dot(shift);
        self.damping += on_load.dot(&rate) * step.duration;
        self.numerical_damping += on_load.dot(&(shift - rate * step.duration));
        -on_load
    }
}
