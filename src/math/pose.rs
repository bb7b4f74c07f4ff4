//! Poses, twists and wrenches of the plane, and the motion by a constant body twist.
//!
//! A constant body twist (u, delta) takes the pose (x, heading) to (x + R(heading) V(delta) u,
//! heading + delta) with `V = [[sin d / d, -(1 - cos d) / d], [(1 - cos d) / d, sin d / d]]` (the
//! exponential map of SE(2)).

use serde::{Deserialize, Serialize};

use super::{Mat2, Number, Vec2, Vec3, perpendicular, rotation};

/// Position and heading of the load's frame in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of the origin (m).
    pub position: Vec2,
    /// Angle from the x axis of the world to that of the load (rad). It counts whole turns.
    pub heading: f64,
}

/// Velocity of the load's origin and turn rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Velocity of the origin (m/s, world axes).
    pub linear: Vec2,
    /// Turn rate (rad/s).
    pub angular: f64,
}

/// Force and torque on the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force (N, world axes).
    pub force: Vec2,
    /// Torque about the load's origin (N m).
    pub torque: f64,
}

impl Pose {
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Vec2::new(x, y), heading }
    }

    /// Edge displacement from `other` (m): |dx| + R |dtheta|. It bounds the displacement of any
    /// point within the `radius` (m) of the load's origin.
    pub fn edge_displacement(&self, other: &Pose, radius: f64) -> f64 {
        (self.position - other.position).norm() + radius * (self.heading - other.heading).abs()
    }

    /// Pose at a `share` (1) of the straight way to `other`, with a constant rate of turn.
    pub fn towards(&self, other: &Pose, share: f64) -> Pose {
        let position = self.position + share * (other.position - self.position);
        Pose { position, heading: self.heading + share * (other.heading - self.heading) }
    }

    /// World position of a point fixed to the load (m).
    pub fn to_world(&self, point_in_load: &Vec2) -> Vec2 {
        self.position + rotation(self.heading) * point_in_load
    }

    /// Point fixed to the load at a world position (m).
    pub fn to_local(&self, point: &Vec2) -> Vec2 {
        rotation(self.heading).tr_mul(&(point - self.position))
    }

    /// Pose reached by the body-twist increment (u_x, u_y, delta) (m, m, rad).
    pub fn moved_by(&self, increment: &Vec3) -> Pose {
        Pose { position: self.position + self.shift_by(increment), heading: self.heading + increment.z }
    }

    /// Displacement of the origin by the body-twist increment (m, world axes), with all digits. A
    /// difference of two positions has fewer, since rounding grows with the distance from the
    /// world's origin.
    pub fn shift_by(&self, increment: &Vec3) -> Vec2 {
        shift_of(&rotation(self.heading), increment)
    }

    pub fn is_finite(&self) -> bool {
        self.position.iter().all(|v| v.is_finite()) && self.heading.is_finite()
    }
}

impl Twist {
    pub const ZERO: Twist = Twist { linear: Vec2::new(0.0, 0.0), angular: 0.0 };

    /// Edge speed (m/s): |v| + R |omega|. It bounds the speed of any point within the `radius` (m)
    /// of the load's origin.
    pub fn edge_speed(&self, radius: f64) -> f64 {
        self.linear.norm() + radius * self.angular.abs()
    }

    /// Velocity of the point of the load at `arm` from its origin, both in world axes (m/s).
    pub fn velocity_at(&self, arm: &Vec2) -> Vec2 {
        self.linear + self.angular * perpendicular(arm)
    }

    pub fn is_finite(&self) -> bool {
        self.linear.iter().all(|v| v.is_finite()) && self.angular.is_finite()
    }
}

/// [`Pose::shift_by`] for a load whose axes are turned by the rotation `turn`.
pub fn shift_of(turn: &Mat2, increment: &Vec3) -> Vec2 {
    turn * Arc::of(increment.z).shift(&increment.xy())
}

/// Body-twist increment that shifts the origin by `shift` (m, world axes) and turns the load, whose
/// axes are turned by the rotation `turn`, by `angle` (rad), less than a whole turn: the inverse of
/// [`shift_of`].
pub fn increment_of(turn: &Mat2, shift: &Vec2, angle: f64) -> Vec3 {
    let mean = Arc::of(angle).mean_rotation();
    (mean.tr_mul(&turn.tr_mul(shift)) / mean.determinant()).push(angle)
}

/// The rotation by an angle delta, and the mean V of all rotations from zero to delta with its
/// derivatives. Near zero no digits cancel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    delta: f64,
    cos: f64,
    sin: f64,
    /// (1 - sin d / d) / d^2.
    sine_rest: f64,
    /// (1 - cos d) / d^2.
    cosine_rest: f64,
    /// (1 - 2 (1 - cos d) / d^2) / d^2.
    mean_rest: f64,
}

/// Angle below which the Taylor series are exact, while digits of the closed forms cancel (rad).
/// The first term left out is below 1e-17.
pub const SERIES_BELOW: f64 = 0.25;
/// Angle below which four terms of the series are enough (rad).
const FEW_BELOW: f64 = 1.0 / 128.0;

/// Series of (1 - sin d / d) / d^2: factors and first term for [`series`].
const SINE_REST: ([f64; 5], f64) = ([1.0 / 156.0, 1.0 / 110.0, 1.0 / 72.0, 1.0 / 42.0, 1.0 / 20.0], 1.0 / 6.0);
/// Series of (1 - cos d) / d^2.
const COSINE_REST: ([f64; 5], f64) = ([1.0 / 132.0, 1.0 / 90.0, 1.0 / 56.0, 1.0 / 30.0, 1.0 / 12.0], 1.0 / 2.0);
/// Series of (1 - 2 (1 - cos d) / d^2) / d^2.
const MEAN_REST: ([f64; 5], f64) = ([1.0 / 182.0, 1.0 / 132.0, 1.0 / 90.0, 1.0 / 56.0, 1.0 / 30.0], 1.0 / 12.0);

/// The first term times 1 - f_n d^2 (1 - f_(n-1) d^2 (...)) for the `square` of an angle d. The
/// first `N_LEFT_OUT` factors are left out.
fn series<T: Number, const N_LEFT_OUT: usize>(square: T, (factors, first): ([f64; 5], f64)) -> T {
    factors[N_LEFT_OUT..].iter().fold(T::from(1.0), |rest, factor| T::from(1.0) - square * T::from(*factor) * rest) * T::from(first)
}

/// Cosine and sine of an angle below [`SERIES_BELOW`] (rad), or of several angles side by side.
pub fn small_rotation<T: Number>(delta: T) -> (T, T) {
    let square = delta * delta;
    let (sine_rest, cosine_rest) = if delta.is_within(FEW_BELOW) {
        (series::<T, 2>(square, SINE_REST), series::<T, 2>(square, COSINE_REST))
    } else {
        (series::<T, 0>(square, SINE_REST), series::<T, 0>(square, COSINE_REST))
    };
    (T::from(1.0) - square * cosine_rest, delta * (T::from(1.0) - square * sine_rest))
}

impl Arc {
    // Inlined, so that unused parts are not computed.
    #[inline]
    pub fn of(delta: f64) -> Self {
        if delta.is_within(FEW_BELOW) { Self::by_series::<2>(delta) } else { Self::long(delta) }
    }

    /// Arc by a larger angle. It is a function of its own, to keep the common case short.
    #[inline(never)]
    fn long(delta: f64) -> Self {
        if delta.abs() < SERIES_BELOW {
            return Self::by_series::<0>(delta);
        }
        let square = delta * delta;
        let (sin, cos) = delta.sin_cos();
        // 1 - cos d = 2 sin^2(d / 2) keeps every digit.
        let half = (0.5 * delta).sin();
        let cosine_rest = 2.0 * half * half / square;
        Self { delta, cos, sin, sine_rest: (1.0 - sin / delta) / square, cosine_rest, mean_rest: (1.0 - 2.0 * cosine_rest) / square }
    }

    #[inline]
    fn by_series<const N_LEFT_OUT: usize>(delta: f64) -> Self {
        let square = delta * delta;
        let sine_rest = series::<f64, N_LEFT_OUT>(square, SINE_REST);
        let cosine_rest = series::<f64, N_LEFT_OUT>(square, COSINE_REST);
        let mean_rest = series::<f64, N_LEFT_OUT>(square, MEAN_REST);
        let (cos, sin) = (1.0 - square * cosine_rest, delta * (1.0 - square * sine_rest));
        Self { delta, cos, sin, sine_rest, cosine_rest, mean_rest }
    }

    /// Angle delta (rad).
    pub fn angle(&self) -> f64 {
        self.delta
    }

    pub fn rotation(&self) -> Mat2 {
        Mat2::new(self.cos, -self.sin, self.sin, self.cos)
    }

    /// V(delta), the mean of the rotations from 0 to delta: the left Jacobian of SE(2).
    pub fn mean_rotation(&self) -> Mat2 {
        let (along, across) = (1.0 - self.delta * self.delta * self.sine_rest, self.delta * self.cosine_rest);
        Mat2::new(along, -across, across, along)
    }

    /// Displacement V u of the origin on this arc by a twist with the linear part `u` (m, axes at
    /// the start).
    pub fn shift(&self, u: &Vec2) -> Vec2 {
        self.mean_rotation() * u
    }

    /// Displacement of the end of an `arm` that turns about its other end, with all its digits.
    pub fn turning(&self, arm: &Vec2) -> Vec2 {
        let shorter = -self.delta * self.delta * self.cosine_rest;
        Vec2::new(shorter * arm.x - self.sin * arm.y, self.sin * arm.x + shorter * arm.y)
    }

    /// First derivative of V by delta in the axes at the end of the arc: R(-delta) V'.
    pub fn first_at_end(&self) -> Mat2 {
        let (along, across) = (self.delta * self.sine_rest, self.cosine_rest);
        Mat2::new(along, -across, across, along)
    }

    /// Second derivative of V by delta in the axes at the end of the arc.
    pub fn second_at_end(&self) -> Mat2 {
        let (along, across) = (-2.0 * self.sine_rest, self.delta * self.mean_rest);
        Mat2::new(along, -across, across, along)
    }
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
    fn arcs_are_rotations_and_their_derivatives_match_differences_on_both_sides_of_the_series() {
        for delta in [0.0, 1e-9, 0.0078, 0.0079, 0.2499999, 0.2500001, 0.4, -0.2, -1.3, 2.9] {
            let arc = Arc::of(delta);
            // Roundings of one.
            assert!((arc.rotation() - rotation(delta)).norm() < 4e-16, "{delta}");
            let step = 1e-4;
            let (plus, minus) = (Arc::of(delta + step), Arc::of(delta - step));
            let at_end = |arc: &Arc| arc.rotation() * arc.first_at_end();
            // Central differences: step^2 / 6 times a third derivative below 0.3, then rounding /
            // step.
            let first = (plus.mean_rotation() - minus.mean_rotation()) / (2.0 * step);
            assert!((first - at_end(&arc)).norm() < 5e-9, "{delta}");
            let second = (at_end(&plus) - at_end(&minus)) / (2.0 * step);
            assert!((second - arc.rotation() * arc.second_at_end()).norm() < 5e-9, "{delta}");
        }
    }

    /// Next to the limit between them, series and closed forms differ by the digits that cancel in
    /// the latter, some ten roundings over the square. Short and long series differ by roundings of
    /// the rests, which are at most 1/2.
    #[test]
    fn series_and_closed_forms_join() {
        let (few, many) = (Arc::of(FEW_BELOW), Arc::long(FEW_BELOW));
        for (a, b) in [
            (few.sine_rest, many.sine_rest),
            (few.cosine_rest, many.cosine_rest),
            (few.mean_rest, many.mean_rest),
            (few.sin, many.sin),
            (few.cos, many.cos),
        ] {
            assert!((a - b).abs() <= 1.2e-16, "{a} {b}");
        }
        assert_eq!(small_rotation(FEW_BELOW), (few.cos, few.sin));
        let (below, above) = (Arc::of(SERIES_BELOW - 1e-15), Arc::of(SERIES_BELOW));
        for (a, b, tolerance) in [
            (below.sine_rest, above.sine_rest, 1e-14),
            (below.cosine_rest, above.cosine_rest, 1e-15),
            (below.mean_rest, above.mean_rest, 4e-14),
            (below.sin, above.sin, 2e-15),
            (below.cos, above.cos, 1e-15),
        ] {
            assert!((a - b).abs() < tolerance, "{a} {b}");
        }
    }
}
