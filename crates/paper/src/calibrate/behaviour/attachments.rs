//! Attachments of ants to springs: from a grasp to a release, or to the end of the recording.
//!
//! A row with the event `release` ends an attachment. In a table without such events, a tip that is
//! missing for a frame was released within that frame. A table with events that loses a tip without
//! one did not see the release.

use std::collections::BTreeMap;

use crate::calibrate::recording::{Recording, Sample, Tip};
use crate::calibrate::sensor::Sensor;
use cohaul::math::Vec2;

/// An attached tip at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// (s)
    pub time: f64,
    /// Size of the pull (N).
    pub pull: f64,
    /// Part of its standard deviation that comes from the tip position (N).
    pub pull_sd: f64,
    /// Tip and root (m, world); `None` for a tip in the frame of its root.
    pub places: Option<[Vec2; 2]>,
}

/// One ant at one spring. It has at least one sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attachment {
    pub spring: usize,
    /// Samples in the order of time, without the release.
    pub held: Vec<Held>,
    /// Time and pull of the release; `None` where it was not seen.
    pub release: Option<(f64, f64)>,
    /// Whether the grasp was seen: an attachment of the first frame began earlier.
    pub has_grasp: bool,
}

impl Attachment {
    /// Time from the first sample to the release or the last sample (s).
    pub fn duration(&self) -> f64 {
        let last = self.held[self.held.len() - 1].time;
        self.release.map_or(last, |(time, _)| time) - self.held[0].time
    }
}

/// A gap of so many frames ends an attachment.
const GAP: f64 = 1.5;

/// Attachments of a recording in the order of springs and time. `releases` are the rows with the
/// event; `None` stands for a table without events.
pub fn attachments(recording: &Recording, releases: Option<&[Sample]>, sensor: &Sensor) -> Vec<Attachment> {
    let mut rows: BTreeMap<usize, Vec<(bool, &Sample)>> = BTreeMap::new();
    // A release comes before a grasp of the same spring at the same time.
    for sample in releases.unwrap_or_default() {
        rows.entry(sample.spring).or_default().push((true, sample));
    }
    for sample in &recording.samples {
        rows.entry(sample.spring).or_default().push((false, sample));
    }
    let Some(period) = frame_period(recording) else { return Vec::new() };
    let times = |pick: fn(f64, f64) -> f64| recording.samples.iter().map(|sample| sample.time).reduce(pick).unwrap_or(0.0);
    let [first, last] = [times(f64::min), times(f64::max)];
    let mut found: Vec<Attachment> = Vec::new();
    for (spring, mut rows) in rows {
        rows.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
        let mut own = Attachment { spring, ..Attachment::default() };
        let mut swing = 0.0;
        for (is_release, sample) in rows {
            let before = own.held.last().map(|held| held.time);
            if before.is_some_and(|before| sample.time - before > GAP * period) {
                found.push(lost(std::mem::take(&mut own), period, releases.is_none()));
                (own.spring, swing) = (spring, 0.0);
            }
            let (held, turned) = held(sample, sensor, swing);
            if is_release {
                own.release = Some((held.time, held.pull));
                if !own.held.is_empty() {
                    found.push(std::mem::take(&mut own));
                }
                (own, swing) = (Attachment { spring, ..Attachment::default() }, 0.0);
                continue;
            }
            own.has_grasp |= own.held.is_empty() && sample.time > first;
            own.held.push(held);
            swing = turned;
        }
        if !own.held.is_empty() {
            let ends_early = own.held[own.held.len() - 1].time < last - 0.5 * period;
            found.push(if ends_early { lost(own, period, releases.is_none()) } else { own });
        }
    }
    found
}

/// An attachment whose tip is missing in the next frame.
fn lost(mut own: Attachment, period: f64, is_release: bool) -> Attachment {
    let last = own.held[own.held.len() - 1];
    own.release = is_release.then_some((last.time + period, last.pull));
    own
}

fn held(sample: &Sample, sensor: &Sensor, near: f64) -> (Held, f64) {
    let force = sensor.force(sample, near);
    let places = match sample.tip {
        Tip::InRoot(_) => None,
        Tip::InWorld { load, tip } => Some([tip, load.to_world(&sensor.spring(sample.spring).root)]),
    };
    (Held { time: sample.time, pull: force.size, pull_sd: force.tip_part, places }, force.shape.swing)
}

/// Median time between two frames of a spring (s); `None` where no spring has two.
fn frame_period(recording: &Recording) -> Option<f64> {
    let mut last: BTreeMap<usize, f64> = BTreeMap::new();
    let since = |sample: &Sample| last.insert(sample.spring, sample.time).map(|before| sample.time - before);
    let mut periods: Vec<f64> = recording.samples.iter().filter_map(since).filter(|period| *period > 0.0).collect();
    periods.sort_by(f64::total_cmp);
    periods.get(periods.len() / 2).copied()
}
