//! Energy of one step: what friction, dashpots and tips did.
//!
//! - Friction: minus the force times `h v` at the support's arm at the start of the step, the slip
//!   of the engine's solver. The true slip differs by O(h^2 omega^2), and would give a support that
//!   the load turns about a wrong sign.
//! - Dashpots: the force times `h` times the rate of deformation at the end of the step, in the
//!   geometry of its start.
//! - Tips: the trapezoid rule with the force of the law, plus the dashpots' force of the step. For
//!   a load at rest it is the energy that the springs gained, which is exact.
//!
//! With these the defect of a step is `-1/2 dv' M dv - 1/2 h^2 v' K v`, the numerical damping of
//! implicit Euler, and terms of O(h^3).

use super::joints::SpringJoint;
use super::springs::turned;
use super::step::Step;
use crate::backend::report::EnergyLedger;
use crate::math::{Vec2, perpendicular};
use crate::model::Load;

/// Adds the losses of friction in a step, and the part of the change of motion of `load` that
/// neither friction nor contacts nor springs explain. `from_contacts` is the energy that the load
/// got at contacts, less what it lost there (J).
pub fn add_friction(ledger: &mut EnergyLedger, load: &Load, step: &Step, from_contacts: f64) {
    let before = ledger.friction;
    for (joint, wrench) in step.friction.iter().zip(step.wrenches) {
        let slip_velocity = step.end.twist.velocity_at(&turned(&step.facing, &joint.offset));
        ledger.friction -= step.duration * (wrench.force.dot(&slip_velocity) + wrench.torque * step.end.twist.angular);
    }
    let [start, end] = [&step.start, &step.end].map(|motion| load.kinetic_energy(&motion.twist));
    ledger.numerical_damping -= ledger.friction - before - from_contacts + end - start;
}

/// Adds dashpots and tips of a step, and writes the force of each attached spring's dashpots on its
/// tip to `on_tips` (N, world).
pub fn add_springs(ledger: &mut EnergyLedger, step: &Step, on_tips: &mut Vec<Vec2>) {
    let is_at_rest = step.start.pose == step.end.pose;
    let (shift, turn) = (step.end.pose.position - step.start.pose.position, step.end.pose.heading - step.start.pose.heading);
    let [before, after] = step.springs;
    on_tips.clear();
    for (at, joint) in step.joints.iter().enumerate() {
        let (tip_shift, [before, after]) = (step.to[at].tip - step.from[at].tip, [&before[at], &after[at]]);
        if is_at_rest {
            ledger.tip_work += after.energy - before.energy;
        } else {
            ledger.tip_work += 0.5 * (before.pull + after.pull).dot(&tip_shift);
            let shift_at = |tip: &Vec2, origin: &Vec2| shift + turn * perpendicular(&(tip - origin));
            ledger.numerical_damping += 0.5
                * (before.pull.dot(&shift_at(&step.from[at].tip, &step.start.pose.position))
                    + after.pull.dot(&shift_at(&step.to[at].tip, &step.end.pose.position)));
        }
        on_tips.push(add_dashpots(ledger, step, joint, &tip_shift));
    }
}

/// Adds the dashpots of a spring, and returns their force on its tip, whose displacement is
/// `tip_shift` (m) (N, world).
fn add_dashpots(ledger: &mut EnergyLedger, step: &Step, joint: &SpringJoint, tip_shift: &Vec2) -> Vec2 {
    if !joint.is_damped() {
        return Vec2::zeros();
    }
    let rate_for = |velocity: Vec2| tip_shift / step.duration - velocity;
    let rate = rate_for(step.end.twist.velocity_at(&joint.arm));
    let rate_in_engine = rate_for(step.damped_twist().velocity_at(&joint.arm));
    let on_load = joint.force(|law, axis| law.damping * rate_in_engine.dot(axis));
    ledger.tip_work += on_load.dot(tip_shift);
    ledger.damping += on_load.dot(&rate) * step.duration;
    ledger.numerical_damping += on_load.dot(&(tip_shift - rate * step.duration));
    -on_load
}
