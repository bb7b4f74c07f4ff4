//! Vectors of the plane, four side by side.

use wide::f64x4;

use super::Vec2;

/// Numbers side by side.
pub const LANES: usize = 4;

/// As many vectors of the plane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vec2x4 {
    pub x: f64x4,
    pub y: f64x4,
}

impl Vec2x4 {
    pub fn splat(v: Vec2) -> Self {
        Self { x: f64x4::splat(v.x), y: f64x4::splat(v.y) }
    }

    pub fn new(lanes: [Vec2; LANES]) -> Self {
        Self { x: f64x4::new(lanes.map(|v| v.x)), y: f64x4::new(lanes.map(|v| v.y)) }
    }

    pub fn dot(self, other: Self) -> f64x4 {
        self.x * other.x + self.y * other.y
    }

    pub fn perp(self, other: Self) -> f64x4 {
        self.x * other.y - self.y * other.x
    }

    pub fn less(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }

    pub fn and(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }

    pub fn times(self, factor: f64x4) -> Self {
        Self { x: factor * self.x, y: factor * self.y }
    }

    /// Turned by the rotation whose first column is this (cos, sin).
    pub fn turned(self, cos: f64x4, sin: f64x4) -> Self {
        Self { x: cos * self.x - sin * self.y, y: sin * self.x + cos * self.y }
    }

    /// This where the `mask` is set, the other one elsewhere.
    pub fn or(self, other: Self, mask: f64x4) -> Self {
        Self { x: mask.select(self.x, other.x), y: mask.select(self.y, other.y) }
    }

    pub fn lane(&self, k: usize) -> Vec2 {
        Vec2::new(self.x.as_array()[k], self.y.as_array()[k])
    }

    pub fn lanes(&self) -> [Vec2; LANES] {
        let (x, y) = (self.x.to_array(), self.y.to_array());
        std::array::from_fn(|k| Vec2::new(x[k], y[k]))
    }

    pub fn set_lane(&mut self, k: usize, v: Vec2) {
        self.x.as_mut_array()[k] = v.x;
        self.y.as_mut_array()[k] = v.y;
    }

    pub fn sum(self) -> Vec2 {
        Vec2::new(self.x.reduce_add(), self.y.reduce_add())
    }
}
