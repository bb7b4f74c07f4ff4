//! Consecutive ticks of the quasi-static run that make one step of the reduced model.

use serde::{Deserialize, Serialize};

use crate::backend::springs::Attachments;
use crate::math::{Pose, Vec2};

/// What happens to the quasi-static load in one step of the model.
pub struct Interval<'a> {
    pub before: &'a Pose,
    pub after: &'a Pose,
    /// Attachments with their tips at the start of the interval.
    pub attachments: &'a Attachments,
    /// Tips at the end of the interval, one entry a spring (m, world).
    pub targets: &'a [Vec2],
    /// Whether a grasp or a release came just before.
    pub is_event: bool,
    /// (s)
    pub duration: f64,
}

/// Ticks in which the tips move straight on, merged so far. The duration is zero before the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MergedTicks {
    /// Pose of the load at the start.
    pub before: Pose,
    /// Pose of the load now.
    pub after: Pose,
    /// Tips now, one entry a spring (m, world).
    pub targets: Vec<Vec2>,
    /// (s)
    pub duration: f64,
}

/// Largest change of a tip's velocity within merged ticks, divided by its speed (1).
const BEND: f64 = 0.1;

impl MergedTicks {
    pub fn new(n_springs: usize) -> Self {
        let origin = Pose::new(0.0, 0.0, 0.0);
        Self { before: origin, after: origin, targets: vec![Vec2::zeros(); n_springs], duration: 0.0 }
    }

    pub fn are_begun(&self) -> bool {
        self.duration > 0.0
    }

    /// Whether the load rests in them.
    pub fn rest(&self) -> bool {
        self.before == self.after
    }

    /// Adds a tick of `duration` (s) that ends with the load at `after` and the tips at `targets`.
    pub fn extend(&mut self, [before, after]: [&Pose; 2], targets: &[Vec2], duration: f64) {
        if !self.are_begun() {
            self.before = *before;
        }
        self.after = *after;
        self.targets.copy_from_slice(targets);
        self.duration += duration;
    }

    /// Whether the tips keep their velocities if they go to `targets` within `duration` (s).
    pub fn continue_to(&self, attachments: &Attachments, targets: &[Vec2], duration: f64) -> bool {
        attachments.iter().all(|attachment| {
            let (so_far, now) = (self.targets[attachment.spring], targets[attachment.spring]);
            // Velocities times both durations.
            let (last, next) = (duration * (so_far - attachment.tip), self.duration * (now - so_far));
            (next - last).norm_squared() <= BEND * BEND * next.norm_squared()
        })
    }
}
