//! Numbers and vectors of the plane, some side by side.

use std::ops::{Add, Mul, Sub};

use super::Vec2;

/// Numbers side by side: as many as one register holds on every supported processor. Wider ones
/// would not leave enough registers for a hot loop.
pub type Numbers = wide::f64x2;

/// Count of [`Numbers`] (1).
pub const LANES: usize = 2;

/// A number, or several side by side.
pub trait Number: Copy + From<f64> + Add<Output = Self> + Mul<Output = Self> + Sub<Output = Self> {
    /// Whether all numbers are at most `size` in size.
    fn is_within(self, size: f64) -> bool;
}

impl Number for f64 {
    fn is_within(self, size: f64) -> bool {
        self.abs() <= size
    }
}

impl Number for Numbers {
    fn is_within(self, size: f64) -> bool {
        self.abs().simd_le(Numbers::splat(size)).all()
    }
}

/// [`LANES`] vectors of the plane, side by side.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vectors {
    pub x: Numbers,
    pub y: Numbers,
}

impl Vectors {
    pub fn splat(v: Vec2) -> Self {
        Self { x: Numbers::splat(v.x), y: Numbers::splat(v.y) }
    }

    pub fn new(lanes: [Vec2; LANES]) -> Self {
        Self { x: Numbers::new(lanes.map(|v| v.x)), y: Numbers::new(lanes.map(|v| v.y)) }
    }

    pub fn dot(self, other: Self) -> Numbers {
        self.x * other.x + self.y * other.y
    }

    pub fn perp(self, other: Self) -> Numbers {
        self.x * other.y - self.y * other.x
    }

    pub fn less(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }

    pub fn and(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }

    pub fn times(self, factor: Numbers) -> Self {
        Self { x: factor * self.x, y: factor * self.y }
    }

    /// These vectors turned by the rotation whose first column is (cos, sin).
    pub fn turned(self, cos: Numbers, sin: Numbers) -> Self {
        Self { x: cos * self.x - sin * self.y, y: sin * self.x + cos * self.y }
    }

    /// These vectors where the `mask` is set, the others elsewhere.
    pub fn or(self, other: Self, mask: Numbers) -> Self {
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
