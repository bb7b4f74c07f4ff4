//! Angles and rotations of the plane, counter-clockwise and in radians.

use std::f64::consts::{PI, TAU};

use super::{Mat2, Number, Vec2};

/// The angle in (-pi, pi] that differs from `angle` by whole turns (rad).
pub fn wrap_to_pi(angle: f64) -> f64 {
    // The division is slow, and leaves an angle below a turn as it is.
    let turned = match angle {
        0.0..TAU => angle,
        _ if -TAU < angle && angle < 0.0 => angle + TAU,
        _ => angle.rem_euclid(TAU),
    };
    if turned > PI { turned - TAU } else { turned }
}

/// The value of `angle` plus whole turns that is nearest to `near` (rad). It follows a branch
/// instead of jumping at pi.
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

/// `v` turned by a quarter turn counter-clockwise. This is the velocity at `v` of a unit turn rate
/// about the origin.
pub fn perpendicular(v: &Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}

/// Rotation matrix by `angle`, whose columns are the turned axes.
pub fn rotation(angle: f64) -> Mat2 {
    let (sin, cos) = angle.sin_cos();
    Mat2::new(cos, -sin, sin, cos)
}

/// Largest tangent for [`small_arctangent`] (1). Up to it the truncation error of the series is
/// below the rounding of one.
pub const SMALL_TANGENT: f64 = 1.0 / 8.0;
/// Largest tangent for a series of five terms (1).
const TINY_TANGENT: f64 = 1.0 / 32.0;

/// Arctangent of t, which is at most [`SMALL_TANGENT`] in size (rad), for one number or several
/// side by side. The series t - t^3 / 3 + t^5 / 5 - ... has nine terms, or five where they are
/// enough.
pub fn small_arctangent<T: Number>(t: T) -> T {
    if t.is_within(TINY_TANGENT) {
        let square = t * t;
        let pair = |odd: f64| T::from(1.0 / odd) - square * T::from(1.0 / (odd + 2.0));
        // In pairs, which can be computed at the same time.
        return t - t * square * (pair(3.0) + square * square * pair(7.0));
    }
    nine_terms(t)
}

/// Series of nine terms. It is a function of its own, to keep the common case of five terms short.
#[inline(never)]
fn nine_terms<T: Number>(t: T) -> T {
    let square = t * t;
    let fourth = square * square;
    let pair = |odd: f64| T::from(1.0 / odd) - square * T::from(1.0 / (odd + 2.0));
    let (first, last) = (pair(3.0) + fourth * pair(7.0), pair(11.0) + fourth * pair(15.0));
    t - t * square * (first + fourth * fourth * last)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tolerance is some roundings of the first, largest term.
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
