//! Ticks that the shadow goes through at once: those in which the tips go straight on and the load does what it did.

use serde::{Deserialize, Serialize};

use crate::backend::springs::Attachments;
use crate::math::{Pose, Vec2};

/// A stretch of ticks of the load without inertia; one without duration is not begun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stride {
    /// Of the load, where it begins and now.
    pub before: Pose,
    pub after: Pose,
    /// Where the tips are by now (m, world, one entry a spring).
    pub targets: Vec<Vec2>,
    /// (s)
    pub duration: f64,
}

/// Share of its speed by which a tip may go another way than so far (1).
const BEND: f64 = 0.1;

impl Stride {
    pub fn new(n_springs: usize) -> Self {
        let still = Pose::new(0.0, 0.0, 0.0);
        Self { before: still, after: still, targets: vec![Vec2::zeros(); n_springs], duration: 0.0 }
    }

    pub fn is_begun(&self) -> bool {
        self.duration > 0.0
    }

    /// Whether the load stays where it is.
    pub fn rests(&self) -> bool {
        self.before == self.after
    }

    /// Adds a tick of `duration` (s) at whose end the load is `after` and the tips are at `targets`.
    pub fn extend(&mut self, [before, after]: [&Pose; 2], targets: &[Vec2], duration: f64) {
        if !self.is_begun() {
            self.before = *before;
        }
        self.after = *after;
        self.targets.copy_from_slice(targets);
        self.duration += duration;
    }

    /// Whether the tips, `held` where the stride begins, go the way to `targets` within `duration` (s) as they went so far.
    pub fn leads_on(&self, held: &Attachments, targets: &[Vec2], duration: f64) -> bool {
        held.iter().all(|grip| {
            let (so_far, now) = (self.targets[grip.spring], targets[grip.spring]);
            // Velocities times both durations.
            let (last, next) = (duration * (so_far - grip.tip), self.duration * (now - so_far));
            (next - last).norm_squared() <= BEND * BEND * next.norm_squared()
        })
    }
}
