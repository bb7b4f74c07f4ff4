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

/// Rounding of places this far from the world's origin (m), over the `extent` of a load (m): that
/// of their coordinates, and of lengths between them.
pub fn rounding_of_places(position: &Vec2, extent: f64) -> f64 {
    8.0 * f64::EPSILON * position.norm() / extent
}
