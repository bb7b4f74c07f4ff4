//! Pose and twist of the load, and how far a pose may be wrong.

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Twist, Vec2};

/// Pose and twist of the load in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    pub pose: Pose,
    pub twist: Twist,
}

impl Motion {
    /// x, y, heading and their rates (m, m, rad, m/s, m/s, rad/s).
    pub(super) fn entries(&self) -> [f64; 6] {
        let Motion { pose, twist } = self;
        [pose.position.x, pose.position.y, pose.heading, twist.linear.x, twist.linear.y, twist.angular]
    }

    /// Motion with these first six `entries`.
    pub(super) fn of_entries(entries: &[f64]) -> Self {
        let twist = Twist { linear: Vec2::new(entries[3], entries[4]), angular: entries[5] };
        Motion { pose: Pose::new(entries[0], entries[1], entries[2]), twist }
    }
}

/// Bound or estimate of the error of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseError {
    /// (m)
    pub position: f64,
    /// (rad)
    pub heading: f64,
}

impl PoseError {
    /// Larger position error and larger heading error of both.
    pub fn max(&self, other: &Self) -> Self {
        Self { position: self.position.max(other.position), heading: self.heading.max(other.heading) }
    }
}
