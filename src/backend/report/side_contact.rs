//! A contact of the load with an obstacle, as reports show it.

use serde::{Deserialize, Serialize};

use crate::math::Vec2;

/// A closed contact of the load with an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SideContact {
    pub obstacle: usize,
    /// Where they touch (m, world).
    pub point: Vec2,
    /// Force of the obstacle on the load (N, world).
    pub force: Vec2,
}
