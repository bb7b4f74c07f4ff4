//! How far the engine's sweeps ended from the solution of the step it was asked.

use super::joints::FrictionJoint;
use super::springs::turned;
use super::step::Step;
use crate::math::{Twist, Vec2, Vec3, perpendicular};
use crate::model::Load;
use crate::model::support::wrench_of;

/// Largest violation of the step's equations, relative to the forces in them, `slip_limit` (N) of all supports together among them (1).
///
/// The sweeps keep the balance of each impulse with the twist exactly, so what is left shows in two places: springs whose force belongs
/// to an older twist, seen as a gap in the balance of all forces, and supports that slip below their limit.
pub fn residual(load: &Load, slip_limit: f64, step: &Step) -> f64 {
    let mut gap = balance_without_friction(load, step);
    let gyration = (load.inertia / load.mass).sqrt();
    let mut worst: f64 = 0.0;
    for (joint, wrench) in step.friction.iter().zip(step.wrenches) {
        let arm = turned(&step.facing, &joint.offset);
        gap -= wrench_of(&arm, &wrench.force) + Vec3::z() * wrench.torque;
        let slip = step.end.twist.velocity_at(&arm);
        worst = worst.max(slip_below_limit(joint, &slip, &wrench.force, load.mass / step.duration));
        if joint.turning_limit > 0.0 {
            worst = worst.max(load.inertia / gyration / step.duration * step.end.twist.angular.abs());
        }
    }
    worst = worst.max(gap.xy().norm()).max(gap.z.abs() / gyration);
    relative(worst, slip_limit + step.sum.force_scale)
}

/// `violation` (N) over `forces` (N). Where there are none, nothing is violated or all is: one.
fn relative(violation: f64, forces: f64) -> f64 {
    let ratio = violation / forces;
    match () {
        _ if violation == 0.0 => 0.0,
        _ if violation.is_finite() && !ratio.is_finite() => 1.0,
        _ => ratio,
    }
}

/// `M (v - v_n) / h - W + (h K + D) v` (N, N, N m).
fn balance_without_friction(load: &Load, step: &Step) -> Vec3 {
    let (before, after) = (column(&step.start.twist), column(&step.end.twist));
    let inertia = Vec3::new(load.mass, load.mass, load.inertia);
    let slope = step.duration * step.sum.stiffness + step.sum.damping;
    inertia.component_mul(&(after - before)) / step.duration - step.sum.wrench + slope * after
}

/// Force by which a support's forces miss Coulomb's law along its axes (N): the change that its `slip` (m/s) asks for and the limits allow.
/// `rate` (N s/m) turns slip into force.
fn slip_below_limit(joint: &FrictionJoint, slip: &Vec2, force: &Vec2, rate: f64) -> f64 {
    let axes = [joint.direction, perpendicular(&joint.direction)];
    let misses = axes.iter().zip(joint.limits).map(|(axis, limit)| {
        let along = force.dot(axis);
        // Not `clamp`, which ends the program where a limit is no number.
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

    /// A load without friction and springs that the engine slows down all the same, as its largest speed as shipped does, has a residual of one.
    #[test]
    fn without_any_force_a_residual_has_a_value() {
        assert_eq!([relative(0.0, 0.0), relative(1e-3, 0.0), relative(1e3, 1e-307), relative(1e-3, 2e-3)], [0.0, 1.0, 1.0, 0.5]);
        assert!(relative(f64::NAN, 1.0).is_nan());
    }
}
