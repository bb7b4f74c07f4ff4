//! Support points with Coulomb friction (Eq. 11-14).

use crate::math::{Vec2, Vec3};

/// A point at which the load stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPoint {
    /// Position in the load's frame (m).
    pub offset: Vec2,
    /// Normal load (N). It is constant, since the motion is in the plane.
    pub normal_load: f64,
    /// Coulomb's coefficient of friction of this support; `None` for that of the ground (1).
    pub friction_coefficient: Option<f64>,
}

/// Level ground under the load.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Coulomb's coefficient of friction mu of all supports without one of their own, the same for
    /// sticking and slipping (1).
    pub friction_coefficient: f64,
    /// Points at which the load stands.
    pub supports: Vec<SupportPoint>,
}

impl Ground {
    /// Largest friction force of each support, mu times its normal load, Eq. (13) (N).
    ///
    /// Deviation: the paper has one coefficient for all supports.
    pub fn slip_limits(&self) -> impl Iterator<Item = f64> + '_ {
        let limit = |support: &SupportPoint| support.friction_coefficient.unwrap_or(self.friction_coefficient) * support.normal_load;
        self.supports.iter().map(limit)
    }
}

/// Slip velocity of the point at `offset` (m) for a body twist (u_x, u_y, omega), B xi of Eq. (12)
/// (m/s, load axes).
///
/// Deviation: Eq. (12) prints the twist in the inertial frame beside offsets in the body frame,
/// which is wrong unless the heading is zero. B belongs to the body twist.
pub fn slip_velocity(offset: &Vec2, body_twist: &Vec3) -> Vec2 {
    Vec2::new(body_twist.x - body_twist.z * offset.y, body_twist.y + body_twist.z * offset.x)
}

/// Wrench (F_x, F_y, torque) of a `force` (N) that acts at `offset` (m), B^T force (N, N, N m; load
/// axes).
pub fn wrench_of(offset: &Vec2, force: &Vec2) -> Vec3 {
    Vec3::new(force.x, force.y, offset.perp(force))
}

/// Normal loads of three supports under a weight (N) at the load's origin; `None` when the supports
/// lie on one line (N).
///
/// With a negative entry the centre of mass lies outside the triangle, and the load would tip over.
pub fn normal_loads_of_three(offsets: &[Vec2; 3], weight: f64) -> Option<[f64; 3]> {
    let area = |a: &Vec2, b: &Vec2| a.perp(b);
    let [a, b, c] = offsets;
    let whole = area(&(b - a), &(c - a));
    let size = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
    if whole.abs() <= 1e-12 * size {
        return None;
    }
    // Barycentric coordinates of the origin.
    Some([area(b, c), area(c, a), area(a, b)].map(|part| weight * part / whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_normal_loads_balance_force_and_moment() {
        let offsets = [Vec2::new(0.01, 0.002), Vec2::new(-0.007, 0.006), Vec2::new(-0.002, -0.009)];
        let loads = normal_loads_of_three(&offsets, 0.0157).unwrap();
        let moment: Vec2 = offsets.iter().zip(loads).map(|(offset, load)| load * offset).sum();
        // Rounding of sums of order 1e-2 N and 1e-4 N m.
        assert!((loads.iter().sum::<f64>() - 0.0157).abs() < 1e-17);
        assert!(moment.norm() < 1e-18, "{moment}");
        let line = [Vec2::new(-1.0, 0.0), Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0)];
        assert_eq!(normal_loads_of_three(&line, 1.0), None);
    }

    /// Power is the same through the twist and through the wrench: B and B^T are transposes.
    #[test]
    fn slip_and_wrench_are_dual() {
        let (offset, twist, force) = (Vec2::new(0.3, -0.8), Vec3::new(0.2, 0.5, -1.7), Vec2::new(-0.4, 0.9));
        let through_slip = slip_velocity(&offset, &twist).dot(&force);
        assert!((through_slip - twist.dot(&wrench_of(&offset, &force))).abs() < 1e-15);
    }
}
