//! Poses of the plane, twists and wrenches, and the motion along a constant body twist.
//!
//! A constant body twist (u, delta) takes the pose (x, heading) to (x + R(heading) V(delta) u, heading + delta) with
//! `V = [[sin d / d, -(1 - cos d) / d], [(1 - cos d) / d, sin d / d]]` (the exponential map of SE(2)).

use serde::{Deserialize, Serialize};

use super::{Mat2, Vec2, Vec3, perpendicular, rotation};

/// Position (m) and heading (rad) of the load's frame in world axes; the heading counts whole turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    pub position: Vec2,
    pub heading: f64,
}

/// Velocity of the load's origin (m/s, world axes) and turn rate (rad/s).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    pub linear: Vec2,
    pub angular: f64,
}

/// Force (N, world axes) and torque about the load's origin (N m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    pub force: Vec2,
    pub torque: f64,
}

impl Pose {
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Vec2::new(x, y), heading }
    }

    /// World position of a point fixed to the load (m).
    pub fn to_world(&self, point_in_load: &Vec2) -> Vec2 {
        self.position + rotation(self.heading) * point_in_load
    }

    /// The pose reached by the body-twist increment (u_x, u_y, delta) in (m, m, rad).
    pub fn moved_by(&self, increment: &Vec3) -> Pose {
        Pose { position: self.position + self.shift_by(increment), heading: self.heading + increment.z }
    }

    /// How far the body-twist increment takes the origin (m, world axes), with all digits: the difference of two positions has lost those that
    /// their distance from the world's origin takes.
    pub fn shift_by(&self, increment: &Vec3) -> Vec2 {
        shift_of(&rotation(self.heading), increment)
    }

    pub fn is_finite(&self) -> bool {
        self.position.iter().all(|v| v.is_finite()) && self.heading.is_finite()
    }
}

impl Twist {
    pub const ZERO: Twist = Twist { linear: Vec2::new(0.0, 0.0), angular: 0.0 };

    /// Velocity of the point of the load at `arm` from its origin, both in world axes (m/s).
    pub fn velocity_at(&self, arm: &Vec2) -> Vec2 {
        self.linear + self.angular * perpendicular(arm)
    }

    pub fn is_finite(&self) -> bool {
        self.linear.iter().all(|v| v.is_finite()) && self.angular.is_finite()
    }
}

/// [`Pose::shift_by`] for a load whose axes `turn` takes to world axes.
pub fn shift_of(turn: &Mat2, increment: &Vec3) -> Vec2 {
    turn * (mean_rotation(increment.z) * increment.xy())
}

/// V(delta): the mean of the rotations from 0 to `delta`, the left Jacobian of SE(2).
pub fn mean_rotation(delta: f64) -> Mat2 {
    let (along, across) = mean_rotation_entries(delta);
    Mat2::new(along, -across, across, along)
}

/// First and second derivative of V by delta.
pub fn mean_rotation_derivatives(delta: f64) -> (Mat2, Mat2) {
    let ((a1, b1), (a2, b2)) = if delta.abs() < SERIES_BELOW {
        series_derivatives(delta)
    } else {
        let (sin, cos) = delta.sin_cos();
        let (a, b) = (sin / delta, (1.0 - cos) / delta);
        let (a1, b1) = ((cos - a) / delta, (sin - b) / delta);
        ((a1, b1), ((-sin - 2.0 * a1) / delta, (cos - 2.0 * b1) / delta))
    };
    (Mat2::new(a1, -b1, b1, a1), Mat2::new(a2, -b2, b2, a2))
}

/// Below this angle (rad) the closed forms cancel and their Taylor series are exact: the first term left out is under 1e-17.
const SERIES_BELOW: f64 = 0.03;

/// (sin d / d, (1 - cos d) / d).
fn mean_rotation_entries(delta: f64) -> (f64, f64) {
    if delta.abs() < SERIES_BELOW {
        let d2 = delta * delta;
        let along = 1.0 - d2 / 6.0 * (1.0 - d2 / 20.0 * (1.0 - d2 / 42.0 * (1.0 - d2 / 72.0)));
        let across = delta / 2.0 * (1.0 - d2 / 12.0 * (1.0 - d2 / 30.0 * (1.0 - d2 / 56.0)));
        (along, across)
    } else {
        // 1 - cos d = 2 sin^2(d / 2) keeps every digit.
        let half = (0.5 * delta).sin();
        (delta.sin() / delta, 2.0 * half * half / delta)
    }
}

/// Derivatives of [`mean_rotation_entries`] from its Taylor series, five terms each.
fn series_derivatives(d: f64) -> ((f64, f64), (f64, f64)) {
    let d2 = d * d;
    let a1 = d * (-1.0 / 3.0 + d2 * (1.0 / 30.0 + d2 * (-1.0 / 840.0 + d2 / 45_360.0)));
    let b1 = 0.5 + d2 * (-1.0 / 8.0 + d2 * (1.0 / 144.0 + d2 * (-1.0 / 5_760.0 + d2 / 403_200.0)));
    let a2 = -1.0 / 3.0 + d2 * (1.0 / 10.0 + d2 * (-1.0 / 168.0 + d2 / 6_480.0));
    let b2 = d * (-1.0 / 4.0 + d2 * (1.0 / 36.0 + d2 * (-1.0 / 960.0 + d2 / 50_400.0)));
    ((a1, b1), (a2, b2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_twist_in_two_halves_is_the_whole() {
        let start = Pose::new(0.3, -0.2, 1.1);
        for delta in [0.0, 1e-9, 1e-3, 0.029999, 0.030001, 0.7, 3.0] {
            let twist = Vec3::new(0.05, -0.02, delta);
            let once = start.moved_by(&twist);
            let twice = start.moved_by(&(0.5 * twist)).moved_by(&(0.5 * twist));
            // Rounding of positions of order 0.3.
            assert!((once.position - twice.position).norm() < 2e-16, "{delta}");
            assert!((once.heading - twice.heading).abs() < 1e-15);
        }
    }

    #[test]
    fn derivatives_of_the_mean_rotation_match_differences_and_join_at_the_series_limit() {
        for delta in [0.0, 0.01, 0.0299999, 0.0300001, 0.4, -1.3, 2.9] {
            let step = 1e-4;
            let (first, second) = mean_rotation_derivatives(delta);
            let (plus, minus) = (mean_rotation(delta + step), mean_rotation(delta - step));
            // Central differences: step^2 / 6 times a third derivative below 0.3, then rounding / step.
            assert!(((plus - minus) / (2.0 * step) - first).norm() < 5e-9, "{delta}");
            let (first_plus, _) = mean_rotation_derivatives(delta + step);
            let (first_minus, _) = mean_rotation_derivatives(delta - step);
            assert!(((first_plus - first_minus) / (2.0 * step) - second).norm() < 5e-9, "{delta}");
        }
    }
}
