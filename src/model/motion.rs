//! Pose and twist of the load.

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Twist, Vec2};

/// Pose and twist of the load, in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Pose of the load's frame (m, rad).
    pub pose: Pose,
    /// Rates of the pose (m/s, rad/s).
    pub twist: Twist,
}

impl Motion {
    /// x, y, heading and their rates (m, m, rad, m/s, m/s, rad/s).
    pub fn entries(&self) -> [f64; 6] {
        let Motion { pose, twist } = self;
        [pose.position.x, pose.position.y, pose.heading, twist.linear.x, twist.linear.y, twist.angular]
    }

    /// Motion with the first six of these `entries` (m, m, rad, m/s, m/s, rad/s).
    pub fn of_entries(entries: &[f64]) -> Self {
        let twist = Twist { linear: Vec2::new(entries[3], entries[4]), angular: entries[5] };
        Motion { pose: Pose::new(entries[0], entries[1], entries[2]), twist }
    }
}
