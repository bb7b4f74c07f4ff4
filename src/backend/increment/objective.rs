//! What an increment minimises besides friction, and how exactly.

use crate::math::{Vec2, Vec3};
use crate::model::Reaction;

/// Objective of an increment, without friction.
pub trait Objective {
    /// Energy (J), gradient and Hessian by the increment, at the increment `at` (m, m, rad).
    fn at(&mut self, at: &Vec3) -> Reaction;

    /// Gradient alone.
    fn gradient(&mut self, at: &Vec3) -> Vec3;

    /// Rounding of places over the extent of the load (1).
    fn rounding(&self) -> f64;
}

/// Size of a Newton step, over the size of the increment, at which the increment is exact to
/// rounding.
pub const RELATIVE_TOLERANCE: f64 = 1e-12;
/// Size of a Newton step, over the extent of the load, for increments that are themselves near
/// rounding.
pub const ABSOLUTE_TOLERANCE: f64 = 1e-15;
/// Residual of the cone problem, or size of the last Newton step over the load's extent, above
/// which a step counts as not converged. It is a thousand times what converged steps reach, and far
/// below what the error of a path could show.
pub const LARGEST_RESIDUAL: f64 = 1e-9;

/// Rounding of places this far from the world's origin (m), over the `extent` of a load (m): that
/// of their coordinates, and of lengths between them.
pub fn rounding_of_places(position: &Vec2, extent: f64) -> f64 {
    8.0 * f64::EPSILON * position.norm() / extent
}
