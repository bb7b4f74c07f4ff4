//! Numbers and vectors of rapier for one precision, and those of f64. The file is included twice,
//! like `world.rs`.

use super::Real;
use super::engine::prelude::{Pose, Rotation, Vector};
use crate::math::{Vec2, direction};

// In f64 the cast does nothing, in f32 it is exact.
#[allow(clippy::unnecessary_cast)]
pub fn widened(value: Real) -> f64 {
    value as f64
}

pub fn wide(v: Vector) -> Vec2 {
    Vec2::new(widened(v.x), widened(v.y))
}

pub fn narrow(v: &Vec2) -> Vector {
    Vector::new(v.x as Real, v.y as Real)
}

/// Rotation whose cosine and sine are the components of `v`.
pub fn unit(v: &Vec2) -> Rotation {
    Rotation::from_cos_sin_unchecked(v.x as Real, v.y as Real)
}

pub fn pose_of(pose: &crate::math::Pose) -> Pose {
    Pose::from_parts(narrow(&pose.position), unit(&direction(pose.heading)))
}
