//! Displacement that the engine's poses lose by rounding.
//!
//! A step moves the load by the step times its velocity. Where that is a few last digits of its
//! position, each step is rounded by a large share of itself, and steps at the same speed by the
//! same share. The iterations of a step know nothing of it: the twist is right, and the pose does
//! not follow. In f32, at 0.3 m from the origin and 1 cm/s, a step of 10 us is three last digits.

use serde::{Deserialize, Serialize};

use crate::backend::numerics::{LARGEST_SHARE, SHORTEST_PATH};
use crate::backend::report::Motion;
use crate::math::Vec2;

/// Sums over the steps of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rounding {
    /// Displacement by the velocities less that of the positions (m, world).
    lost: Vec2,
    /// The same of the heading (rad).
    lost_turn: f64,
    /// Path length of the edge by the velocities (m).
    path: f64,
}

impl Rounding {
    /// Adds a step of `duration` (s) in `n_substeps` equal parts, for a load of this `radius` (m).
    /// The velocity is taken to change evenly; what is wrong with that cancels over a run.
    pub fn add(&mut self, [start, end]: [&Motion; 2], duration: f64, n_substeps: usize, radius: f64) {
        let weight = 0.5 + 0.5 / n_substeps as f64;
        let (before, after) = (&start.twist, &end.twist);
        let shift = duration * (before.linear + weight * (after.linear - before.linear));
        let turn = duration * (before.angular + weight * (after.angular - before.angular));
        self.lost += shift - (end.pose.position - start.pose.position);
        self.lost_turn += turn - (end.pose.heading - start.pose.heading);
        self.path += shift.norm() + radius * turn.abs();
    }

    /// Share of the path that was lost (1), if a run may not lose so much.
    pub fn excess(&self, radius: f64) -> Option<f64> {
        let share = (self.lost.norm() + radius * self.lost_turn.abs()) / self.path.max(SHORTEST_PATH * radius);
        (share > LARGEST_SHARE).then_some(share)
    }
}
