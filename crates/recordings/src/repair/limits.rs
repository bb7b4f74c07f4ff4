//! Bounds of what is repaired, and their defaults.

use serde::Deserialize;

use crate::tracks::{Sample, Tracks};

/// Bounds as they are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Bounds {
    /// Longest time between two places of a tip that is bridged (s). A longer one is a release.
    pub bridge: Option<f64>,
    /// Longest step from one frame to the next (m).
    pub jump: Option<f64>,
    /// Largest distance by which a place is moved by smoothing (m). The default is no smoothing.
    pub smooth: Option<f64>,
}

/// Bounds of one recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Time from one frame to the next (s).
    pub frame: f64,
    /// Longest time between two places of a tip that is bridged (s).
    pub bridge: f64,
    /// Longest step from one frame to the next (m).
    pub jump: f64,
}

/// Frames from one place to the next over which a tip counts as attached: five lost frames. A
/// tracker that loses one frame in twenty at random loses six in a row once in 6e7 frames.
const BRIDGED_FRAMES: f64 = 6.0;
/// Frames over which a tip is bridged however fast the load is: one lost frame.
const LEAST_FRAMES: f64 = 2.0;
/// Distance that the tips may move meanwhile, over the load's radius (1): over a quarter of the
/// load a straight line says little about the pull.
const BRIDGED_DISTANCE: f64 = 0.25;
/// Share of steps that are no jumps, however bad the tracker is (1).
const USUAL_STEPS: f64 = 0.9;
/// Largest step over the usual ones (1): noise and a start from rest stay far below it.
const LARGEST_STEP: f64 = 8.0;
/// What is never a jump, over the load's radius (1): a tip at rest may start to move.
const LEAST_JUMP: f64 = 0.02;
/// Two instants are one when they are nearer than this share of the frame interval (1).
const SAME_FRAME: f64 = 1e-3;

impl Limits {
    /// The bounds that are asked for, and the defaults of others for a load of this radius (m).
    pub fn of(tracks: &Tracks, radius: f64, bounds: &Bounds) -> Self {
        let frame = tracks.frame_interval();
        let mut steps: Vec<f64> = Vec::new();
        for track in &tracks.tracks {
            steps.extend(
                track.samples.windows(2).map(|pair| distance(&pair[0], &pair[1]) * (frame / (pair[1].time - pair[0].time)).min(1.0)),
            );
        }
        steps.sort_by(f64::total_cmp);
        let usual = steps.get((USUAL_STEPS * steps.len() as f64) as usize).copied().unwrap_or(0.0);
        let jump = bounds.jump.unwrap_or(LARGEST_STEP * usual + LEAST_JUMP * radius);
        let by_speed = if usual > 0.0 { BRIDGED_DISTANCE * radius / usual * frame } else { f64::INFINITY };
        let bridge = bounds.bridge.unwrap_or((BRIDGED_FRAMES * frame).min(by_speed.max(LEAST_FRAMES * frame)));
        Self { frame, bridge, jump }
    }

    /// Whether a tip that was seen at these two times (s) was attached in between.
    pub fn is_bridged(&self, from: f64, to: f64) -> bool {
        to - from <= self.bridge.max(self.frame) + SAME_FRAME * self.frame
    }

    /// Whether there are frames between these two times (s).
    pub fn is_gap(&self, from: f64, to: f64) -> bool {
        to - from > (1.0 + SAME_FRAME) * self.frame
    }

    /// Longest step in this time (m).
    pub fn step(&self, time: f64) -> f64 {
        self.jump * (time / self.frame).max(1.0)
    }
}

/// Distance of two places (m).
pub fn distance(a: &Sample, b: &Sample) -> f64 {
    (a.position - b.position).norm()
}
