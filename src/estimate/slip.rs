//! Directions of slip as body twists: how long they are, how two poses lie apart, and how friction answers them.

use nalgebra::Matrix2x3;

use crate::math::{Arc, Mat2, Mat3, Pose, Vec3, rotation};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};

/// Shift plus radius times turn of a body twist (m): as far as a point of the rim goes at most.
pub fn rim(twist: &Vec3, radius: f64) -> f64 {
    twist.xy().norm() + radius * twist.z.abs()
}

/// Distance of two poses in shift plus radius times turn (m).
pub fn apart(a: &Pose, b: &Pose, radius: f64) -> f64 {
    (b.position - a.position).norm() + radius * (b.heading - a.heading).abs()
}

/// The body twist that takes a load from one pose to the other.
pub fn increment(from: &Pose, to: &Pose) -> Vec3 {
    let turn = to.heading - from.heading;
    let shift = rotation(from.heading).tr_mul(&(to.position - from.position));
    // After a whole turn no shift of the twist remains; a chord stands in.
    let straight = Arc::of(turn).mean_rotation().try_inverse().map_or(shift, |inverse| inverse * shift);
    Vec3::new(straight.x, straight.y, turn)
}

/// First and second derivative of the friction loss `sum_i c_i |B_i n|` by the body twist n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    /// What friction pulls back with (N, N, N m).
    pub wrench: Vec3,
    /// How that turns with the slip: h'' (N, N m, N m^2); zero along the slip itself.
    pub turning: Mat3,
}

/// Slip of a support over that of the rim at which it counts as the pin of a turn (1).
const PINNED: f64 = 1e-3;

impl Resistance {
    /// Against slip in the direction `n` of unit length on the rim.
    pub fn of(ground: &Ground, n: &Vec3) -> Self {
        let mut sum = Self { wrench: Vec3::zeros(), turning: Mat3::zeros() };
        for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
            let velocity = slip_velocity(&support.offset, n);
            let speed = velocity.norm().max(PINNED);
            let course = velocity / speed;
            let jacobian = Matrix2x3::new(1.0, 0.0, -support.offset.y, 0.0, 1.0, support.offset.x);
            let across = Mat2::identity() - course * course.transpose();
            sum.wrench += wrench_of(&support.offset, &(limit * course));
            sum.turning += limit / speed * jacobian.transpose() * across * jacobian;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::increment::friction_loss;
    use crate::math::Vec2;
    use crate::model::SupportPoint;

    #[test]
    fn resistance_is_the_derivative_of_the_friction_loss() {
        let support = |x, y, normal_load| SupportPoint { offset: Vec2::new(x, y), normal_load };
        let supports = vec![support(0.8, 0.1, 1.0), support(-0.5, 0.6, 2.0), support(-0.2, -0.7, 0.5)];
        let ground = Ground { friction_coefficient: 0.7, supports };
        let n = Vec3::new(0.5, -0.3, 0.4);
        let at = Resistance::of(&ground, &n);
        let step = 1e-5;
        for i in 0..3 {
            let e = Vec3::ith(i, step);
            // Central differences: step^2 times a third derivative of order 10, and rounding 1e-16 / step.
            let slope = (friction_loss(&ground, &(n + e)) - friction_loss(&ground, &(n - e))) / (2.0 * step);
            assert!((slope - at.wrench[i]).abs() < 1e-8, "{i}: {slope}");
            let turn = (Resistance::of(&ground, &(n + e)).wrench - Resistance::of(&ground, &(n - e)).wrench) / (2.0 * step);
            assert!((turn - at.turning.column(i)).norm() < 1e-8, "{i}: {turn}");
        }
        assert!((at.turning * n).norm() < 1e-14);
    }

    #[test]
    fn an_increment_leads_from_one_pose_to_the_other() {
        let from = Pose::new(0.3, -0.2, 1.1);
        for twist in [Vec3::new(0.05, -0.02, 0.0), Vec3::new(0.05, -0.02, 0.7), Vec3::new(0.0, 0.0, -2.0)] {
            // Rounding of positions of order 0.3.
            assert!((increment(&from, &from.moved_by(&twist)) - twist).norm() < 1e-15);
        }
        assert_eq!(increment(&from, &from), Vec3::zeros());
    }
}
