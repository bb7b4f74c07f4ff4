//! Directions of slip as body twists, and the friction against them.

use crate::backend::springs::Place;
use crate::math::{Arc, Mat3, Pose, Vec3, perpendicular};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};

/// Edge displacement of a load of this `radius` (m) by a body twist (m).
pub fn edge_length(twist: &Vec3, radius: f64) -> f64 {
    twist.xy().norm() + radius * twist.z.abs()
}

/// Body twist that moves a load from one place to another pose.
pub fn increment(from: &Place, to: &Pose) -> Vec3 {
    let turn = to.heading - from.pose.heading;
    let shift = from.turn.tr_mul(&(to.position - from.pose.position));
    // A whole turn has no shift in its twist: the displacement is used instead.
    let straight = Arc::of(turn).mean_rotation().try_inverse().map_or(shift, |inverse| inverse * shift);
    straight.push(turn)
}

/// Friction loss `sum_i c_i |B_i n|` of a body twist n, with its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    /// Loss for n of unit edge displacement (N).
    pub loss: f64,
    /// Friction wrench against the slip (N, N, N m).
    pub wrench: Vec3,
    /// Second derivative h'' (N, N m, N m^2), which is zero along the slip.
    pub turning: Mat3,
}

/// Slip of a support below which it is pinned, divided by the edge displacement (1).
const PINNED: f64 = 1e-3;

impl Resistance {
    /// Resistance against slip in the direction `n` of unit edge displacement.
    pub fn of(ground: &Ground, n: &Vec3) -> Self {
        let mut sum = Self { loss: 0.0, wrench: Vec3::zeros(), turning: Mat3::zeros() };
        for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
            let offset = &support.offset;
            let velocity = slip_velocity(offset, n);
            let length = velocity.norm();
            let speed = length.max(PINNED);
            let course = velocity / speed;
            sum.loss += limit * length;
            sum.wrench += wrench_of(offset, &(limit * course));
            // B' (1 - u u') B, by the perpendicular of u.
            let across = wrench_of(offset, &perpendicular(&course));
            sum.turning += (limit / speed * across) * across.transpose();
            if length < PINNED {
                let (x, y) = (Vec3::new(1.0, 0.0, -offset.y), Vec3::new(0.0, 1.0, offset.x));
                sum.turning += limit / speed * (1.0 - course.norm_squared()) * (x * x.transpose() + y * y.transpose());
            }
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
        let support = |x, y, normal_load| SupportPoint { offset: Vec2::new(x, y), normal_load, friction_coefficient: None };
        let supports = vec![support(0.8, 0.1, 1.0), support(-0.5, 0.6, 2.0), support(-0.2, -0.7, 0.5)];
        let ground = Ground { friction_coefficient: 0.7, supports };
        let n = Vec3::new(0.5, -0.3, 0.4);
        let at = Resistance::of(&ground, &n);
        let step = 1e-5;
        for i in 0..3 {
            let e = Vec3::ith(i, step);
            // Central differences: step^2 times a third derivative of order 10, and rounding 1e-16
            // / step.
            let slope = (friction_loss(&ground, &(n + e)) - friction_loss(&ground, &(n - e))) / (2.0 * step);
            assert!((slope - at.wrench[i]).abs() < 1e-8, "{i}: {slope}");
            let turn = (Resistance::of(&ground, &(n + e)).wrench - Resistance::of(&ground, &(n - e)).wrench) / (2.0 * step);
            assert!((turn - at.turning.column(i)).norm() < 1e-8, "{i}: {turn}");
        }
        assert!((at.turning * n).norm() < 1e-14);
        // The same sum in another order.
        assert!((at.loss - friction_loss(&ground, &n)).abs() < 1e-15);
    }

    /// The friction of a pinned support is a stiffness against its slip, equal in all directions.
    #[test]
    fn a_pinned_support_resists_slip_equally_in_all_directions() {
        let offset = Vec2::new(0.4, -0.3);
        let ground =
            Ground { friction_coefficient: 0.5, supports: vec![SupportPoint { offset, normal_load: 2.0, friction_coefficient: None }] };
        let turning = Resistance::of(&ground, &Vec3::new(offset.y, -offset.x, 1.0)).turning;
        for n in [Vec3::new(0.3, 0.7, 0.0), Vec3::new(-0.2, 0.1, 0.9)] {
            // Rounding of 1e3 N/m.
            assert!((n.dot(&(turning * n)) - slip_velocity(&offset, &n).norm_squared() / PINNED).abs() < 1e-12, "{n}");
        }
    }

    #[test]
    fn an_increment_leads_from_one_pose_to_the_other() {
        let from = Pose::new(0.3, -0.2, 1.1);
        for twist in [Vec3::new(0.05, -0.02, 0.0), Vec3::new(0.05, -0.02, 0.7), Vec3::new(0.0, 0.0, -2.0)] {
            // Rounding of positions of order 0.3.
            assert!((increment(&Place::of(&from), &from.moved_by(&twist)) - twist).norm() < 1e-15);
        }
        assert_eq!(increment(&Place::of(&from), &from), Vec3::zeros());
    }
}
