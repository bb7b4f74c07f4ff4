//! Angles: counter-clockwise, in radians, and the plane rotations that go with them.

use std::f64::consts::{PI, TAU};
use std::ops::{Mul, Sub};

use super::{Mat2, Vec2};

/// The angle in (-pi, pi] that differs from `angle` by whole turns (rad).
pub fn wrap_to_pi(angle: f64) -> f64 {
    // Less than a turn is left as it is by the division, which is slow.
    let turned = match angle {
        0.0..TAU => angle,
        _ if -TAU < angle && angle < 0.0 => angle + TAU,
        _ => angle.rem_euclid(TAU),
    };
    if turned > PI { turned - TAU } else { turned }
}

/// The value of `angle` plus whole turns that lies nearest to `near` (rad): follows a branch instead of jumping at pi.
pub fn unwrap_near(angle: f64, near: f64) -> f64 {
    if (near - angle).abs() < PI {
        return angle;
    }
    angle + ((near - angle) / TAU).round() * TAU
}

/// The unit vector at `angle` from the x axis.
pub fn direction(angle: f64) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    Vec2::new(cos, sin)
}

/// `v` turned by a quarter turn counter-clockwise: the velocity at `v` of a unit turn rate about the origin.
pub fn perpendicular(v: &Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}

/// The rotation matrix by `angle`: its columns are the turned axes.
pub fn rotation(angle: f64) -> Mat2 {
    let (sin, cos) = angle.sin_cos();
    Mat2::new(cos, -sin, sin, cos)
}

/// Tangent of an angle up to which the terms of the arctangent's series that [`small_arctangent`] leaves out stay below a rounding of one.
pub const SMALL_TANGENT: f64 = 1.0 / 8.0;

/// The angle with the tangent t, at most [`SMALL_TANGENT`], of one number or of several side by side: t - t^3 / 3 + t^5 / 5 - ... of nine terms.
pub fn small_arctangent<T: Copy + From<f64> + Mul<Output = T> + Sub<Output = T>>(t: T) -> T {
    let square = t * t;
    let mut sum = T::from(1.0 / 17.0);
    for odd in [15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
        sum = T::from(1.0 / odd) - square * sum;
    }
    t - t * square * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roundings of a sum of terms of which the first is the largest.
    #[test]
    fn small_arctangents_are_arctangents() {
        for k in -1000..=1000 {
            let t = SMALL_TANGENT * f64::from(k) / 1000.0;
            assert!((small_arctangent(t) - t.atan()).abs() <= 3e-16 * t.abs(), "{t}");
        }
    }

    #[test]
    fn wrapping_keeps_plus_pi_and_maps_minus_pi_onto_it() {
        assert_eq!(wrap_to_pi(PI), PI);
        assert_eq!(wrap_to_pi(-PI), PI);
        // Two ulps of 3 turns: the only rounding is that of the whole turns taken off.
        assert!((wrap_to_pi(3.0 * TAU + 0.5) - 0.5).abs() < 8e-15);
        assert!((wrap_to_pi(-0.25) + 0.25).abs() < 1e-15);
    }

    #[test]
    fn unwrapping_follows_the_branch_through_many_turns() {
        let mut branch = 0.0;
        for step in 1..=1000 {
            let truth = 0.05 * step as f64;
            branch = unwrap_near(wrap_to_pi(truth), branch);
            // The wrapped angle carries the rounding of up to eight whole turns.
            assert!((branch - truth).abs() < 1e-13, "{branch} {truth}");
        }
    }
}
