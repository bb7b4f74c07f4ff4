//! All attached springs as one joint. At their centre of stiffness, shifts and turns are not
//! coupled, so that three axes are enough. With `S = K + D / h = [[A, b], [b', c]]` over (velocity,
//! turn rate), the velocity of the point at the arm a is `v + omega J a`. In terms of that velocity
//! S has no coupling for `J a = A^-1 b`. The joint has A along its own axes, and `c - b' A^-1 b`
//! against turning.

use nalgebra::SymmetricEigen;

use super::joints::{AxisLaw, SpringJoint};
use super::springs::SpringSum;
use crate::backend::numerics::SOFT_AXIS;
use crate::math::{Mat2, Mat3, Vec2, Vec3, perpendicular};

/// One joint with the effect of the springs of `sum` in a step of `duration` (s).
pub fn fold(sum: &SpringSum, duration: f64) -> SpringJoint {
    let slope = sum.stiffness + sum.damping / duration;
    let linear: Mat2 = slope.fixed_view::<2, 2>(0, 0).into();
    let coupling = Vec2::new(slope.m13, slope.m23);
    let axes = SymmetricEigen::new(linear);
    let softest = SOFT_AXIS * axes.eigenvalues.amax();
    let first: Vec2 = axes.eigenvectors.column(0).into();
    let second = perpendicular(&first);
    let share = |axis: &Vec2| {
        let stiffness = axis.dot(&(linear * axis));
        if stiffness > softest { axis * (axis.dot(&coupling) / stiffness) } else { Vec2::zeros() }
    };
    let arm_turned = share(&first) + share(&second);
    let law = |twist: Vec3| Some(axis_law(sum, &twist));
    SpringJoint {
        arm: -perpendicular(&arm_turned),
        direction: first,
        axes: [law(first.push(0.0)), law(second.push(0.0))],
        turning: law((-arm_turned).push(1.0)),
    }
}

/// Law of the springs along the twist `unit`.
fn axis_law(sum: &SpringSum, unit: &Vec3) -> AxisLaw {
    let form = |matrix: &Mat3| unit.dot(&(matrix * unit));
    AxisLaw { stiffness: form(&sum.stiffness).max(0.0), damping: form(&sum.damping).max(0.0), force: unit.dot(&sum.wrench) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::direction;

    fn spring(arm: Vec2, bearing: f64, across: Option<f64>) -> SpringJoint {
        let law = |stiffness, force| AxisLaw { stiffness, damping: 0.3 * stiffness, force };
        SpringJoint { arm, direction: direction(bearing), axes: [Some(law(0.7, 0.02)), across.map(|k| law(k, -0.004))], turning: None }
    }

    /// Slope and wrench of the folded joint, computed from its numbers as in the engine.
    fn sum_of(joint: &SpringJoint) -> SpringSum {
        let mut sum = SpringSum::of(std::slice::from_ref(joint));
        let turning = joint.turning.unwrap();
        sum.stiffness.m33 += turning.stiffness;
        sum.damping.m33 += turning.damping;
        sum.wrench.z += turning.force;
        sum
    }

    #[test]
    fn one_joint_has_the_slope_and_the_wrench_of_all() {
        let many = [spring(Vec2::new(0.03, 0.01), 0.3, Some(0.5)), spring(Vec2::new(-0.01, 0.04), 1.9, Some(0.2))];
        let alone = [spring(Vec2::new(0.03, 0.01), 0.3, None)];
        let duration = 0.7;
        for springs in [&many[..], &many[..1], &alone[..]] {
            let (want, folded) = (SpringSum::of(springs), sum_of(&fold(&SpringSum::of(springs), duration)));
            let slope = |sum: &SpringSum| sum.stiffness + sum.damping / duration;
            // Some roundings of a stiffness near one.
            assert!((slope(&want) - slope(&folded)).norm() < 1e-15, "{} {}", slope(&want), slope(&folded));
            assert!((want.wrench - folded.wrench).norm() < 1e-17);
        }
    }

    #[test]
    fn the_centre_of_one_spring_is_its_tip() {
        let arm = Vec2::new(0.03, 0.01);
        let joint = fold(&SpringSum::of(&[spring(arm, 0.3, Some(0.5))]), 0.001);
        assert!((joint.arm - arm).norm() < 1e-16, "{}", joint.arm);
    }
}
