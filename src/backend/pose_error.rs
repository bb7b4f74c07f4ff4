//! Error of a pose.

use serde::{Deserialize, Serialize};

/// Bound of the error of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseError {
    /// Error of the position (m).
    pub position: f64,
    /// Error of the heading (rad).
    pub heading: f64,
}

impl PoseError {
    /// Larger position error and larger heading error of both.
    pub fn max(&self, other: &Self) -> Self {
        Self { position: self.position.max(other.position), heading: self.heading.max(other.heading) }
    }
}
