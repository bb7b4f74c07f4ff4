//! Residual of the engine's solver: violation of the equations of a step.

use super::contacts::ContactPoint;
use super::joints::FrictionJoint;
use super::springs::turned;
use super::step::Step;
use crate::backend::numerics::{VELOCITY_ROUNDINGS, WHOLE_LIMIT};
use crate::math::{Pose, Twist, Vec2, Vec3, perpendicular};
use crate::model::Load;
use crate::model::support::wrench_of;

/// Largest violation of the equations of a step, relative to the forces in them (1). The sum of all
/// slip limits, `slip_limit` (N), is one of these forces. A penetration counts by its share of the
/// load's extent where that is more. The iterations keep each impulse in
/// balance with the twist. The rest of the error has two forms: springs whose force belongs to an
/// older twist, which leaves a gap in the balance of all forces, and supports that slip below their
/// limit.
pub fn residual(load: &Load, slip_limit: f64, step: &Step) -> f64 {
    let (violation, deepest) = (violation(load, slip_limit, step), deepest(step) / load.radius);
    // A violation that is not a number stays one.
    if deepest > violation { deepest } else { violation }
}

/// The part of [`residual`] that more iterations make smaller (1).
pub fn violation(load: &Load, slip_limit: f64, step: &Step) -> f64 {
    let mut gap = balance_without_friction(load, step);
    let gyration = (load.inertia / load.mass).sqrt();
    let mut worst: f64 = 0.0;
    let rate = load.mass / step.duration;
    let fastest = step.start.twist.edge_speed(load.radius).max(step.end.twist.edge_speed(load.radius));
    let rounding = VELOCITY_ROUNDINGS * step.digit * fastest + gap_rounding(load, &step.start.pose, step.digit) / step.duration;
    for contact in step.contacts {
        gap -= wrench_of(&contact.arm, &contact.force());
        worst = worst.max(rate * contact_violation(contact, step, rounding, rate));
    }
    for (joint, wrench) in step.friction.iter().zip(step.wrenches) {
        let arm = turned(&step.facing, &joint.offset);
        gap -= wrench_of(&arm, &wrench.force) + Vec3::z() * wrench.torque;
        let slip = step.end.twist.velocity_at(&arm);
        worst = worst.max(slip_below_limit(joint, &slip, &wrench.force, rate));
        if joint.turning_limit > 0.0 {
            worst = worst.max(load.inertia / gyration / step.duration * step.end.twist.angular.abs());
        }
    }
    worst = worst.max(gap.xy().norm()).max(gap.z.abs() / gyration);
    if worst <= VELOCITY_ROUNDINGS * step.digit * rate * fastest {
        return 0.0;
    }
    let pushes = step.contacts.iter().fold(0.0, |sum, contact| sum + contact.push);
    relative(worst, slip_limit + step.sum.force_scale + pushes)
}

/// Largest penetration at the start of a step (m).
fn deepest(step: &Step) -> f64 {
    step.contacts.iter().fold(0.0, |deepest, contact| deepest.max(-contact.gap))
}

/// Violation of the laws of a contact: the change of velocity that they require (m/s). A contact
/// that pushes uses up its room, one that does not push keeps within it, and friction opposes the
/// slip. The gap is known to a rounding of positions, and the velocity that closes it to `rounding`
/// (m/s); `rate` (N s/m) converts it to a force that counts as none.
fn contact_violation(contact: &ContactPoint, step: &Step, rounding: f64, rate: f64) -> f64 {
    let [after, slip] = contact.velocity_of(&step.end.twist);
    let closing = after + contact.room / step.duration;
    if contact.push <= rate * rounding {
        return (-closing - rounding).max(0.0);
    }
    let is_at_limit = contact.rub.abs() >= contact.friction * contact.push * (1.0 - WHOLE_LIMIT) && contact.rub * slip <= 0.0;
    closing.abs().max(if is_at_limit { 0.0 } else { slip.abs() })
}

/// Rounding of the gaps of a load at this pose, for an engine whose numbers have the last `digit`
/// (m).
pub fn gap_rounding(load: &Load, pose: &Pose, digit: f64) -> f64 {
    VELOCITY_ROUNDINGS * digit * (pose.position.norm() + load.radius)
}

/// `violation` (N) over `forces` (N). Without forces it is zero for no violation, and else one.
fn relative(violation: f64, forces: f64) -> f64 {
    let ratio = violation / forces;
    match () {
        _ if violation == 0.0 => 0.0,
        _ if violation.is_finite() && !ratio.is_finite() => 1.0,
        _ => ratio,
    }
}

/// Imbalance without friction, `M (v - v_n) / h - W + (h K + D) v` (N, N, N m).
fn balance_without_friction(load: &Load, step: &Step) -> Vec3 {
    let (before, after) = (column(&step.start.twist), column(&step.end.twist));
    let inertia = Vec3::new(load.mass, load.mass, load.inertia);
    let slope = step.duration * step.sum.stiffness + step.sum.damping;
    inertia.component_mul(&(after - before)) / step.duration - step.sum.wrench + slope * after
}

/// Violation of Coulomb's law by the force of a support along its axes: the change of force that
/// its `slip` (m/s) requires and its limits allow. `rate` (N s/m) converts slip to force (N).
fn slip_below_limit(joint: &FrictionJoint, slip: &Vec2, force: &Vec2, rate: f64) -> f64 {
    let axes = [joint.direction, perpendicular(&joint.direction)];
    let misses = axes.iter().zip(joint.limits).map(|(axis, limit)| {
        let along = force.dot(axis);
        // Not `clamp`, which panics where a limit is not a number.
        (along - (along - rate * slip.dot(axis)).min(limit).max(-limit)).abs()
    });
    misses.fold(0.0, f64::max)
}

fn column(twist: &Twist) -> Vec3 {
    twist.linear.push(twist.angular)
}

#[cfg(test)]
mod tests {
    use super::relative;

    /// A load without friction and springs has a residual of one when the engine slows it down, as
    /// the default largest speed does.
    #[test]
    fn without_any_force_a_residual_has_a_value() {
        assert_eq!([relative(0.0, 0.0), relative(1e-3, 0.0), relative(1e3, 1e-307), relative(1e-3, 2e-3)], [0.0, 1.0, 1.0, 0.5]);
        assert!(relative(f64::NAN, 1.0).is_nan());
    }
}
