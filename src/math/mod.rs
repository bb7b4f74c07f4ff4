//! Geometry of the plane, angles, damped oscillations, keyed random numbers and statistics.

mod angle;
mod bisection;
mod lanes;
mod oscillation;
mod pose;
mod positive;
mod random;
mod statistics;

pub use angle::{SMALL_TANGENT, direction, perpendicular, rotation, small_arctangent, unwrap_near, wrap_to_pi};
pub use bisection::bisected;
pub use lanes::{LANES, Number, Numbers, Vectors};
pub use oscillation::damped_rotation;
pub use pose::{Arc, Pose, SERIES_BELOW, Twist, Wrench, increment_of, shift_of, small_rotation};
pub use positive::PositiveDefinite;
pub use random::{Draws, RandomStreams, Stream};
pub use statistics::{Interval, Summary, exact_proportion_interval, proportion_interval, share_difference_interval, student};

/// A point or a free vector in the plane.
pub type Vec2 = nalgebra::Vector2<f64>;
/// A twist, wrench or gradient as a column: two linear entries, then the angular one.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A linear map of vectors in the plane.
pub type Mat2 = nalgebra::Matrix2<f64>;
/// A symmetric stiffness or mass over (x, y, heading).
pub type Mat3 = nalgebra::Matrix3<f64>;
/// A linear map from vectors in the plane to columns of three.
pub type Mat3x2 = nalgebra::Matrix3x2<f64>;

/// Whether a number is zero, for numbers that are left out of JSON then.
pub(crate) fn is_zero<T: Default + PartialEq>(number: &T) -> bool {
    *number == T::default()
}
