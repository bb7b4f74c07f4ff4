//! Attachments of ants to springs: from a grasp to a release, or to the end of the recording.
//!
//! A row with the event `release` ends an attachment. A table without the column `event` shows a
//! release in two ways: the tip is missing in the frames after it, or it has sprung back to its
//! place at rest, where another ant has grasped it within the same frame. A table with events that
//! loses a tip without one did not see the release.
//!
//! A tip that is missing for a few frames and comes back where an ant could have walked to was held
//! all the time: the frames are bridged.

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

/// Attachments of a recording, and how they were read from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attachments {
    /// In the order of springs and time.
    pub all: Vec<Attachment>,
    /// Whether the table has a column of events.
    pub has_events: bool,
    /// Number of releases that follow from a tip that sprang back within a frame (1).
    pub n_sprung: usize,
    /// Number of gaps within attachments that were bridged (1).
    pub n_bridged: usize,
    /// Longest step of an attached tip from one frame to the next (m): a longer one is no walk.
    pub reach: f64,
}

/// Time between two samples of a spring, in frames, above which frames are missing.
const GAP: f64 = 1.5;
/// Longest gap that is bridged, in frames.
const MOST_BRIDGED: f64 = 10.0;
/// Distance that an ant walks in a frame over the reach (1): it is half, with a margin for noise.
const WALKED: f64 = 0.7;
/// The reach of an attached tip: so many times the step that this share of all steps does not
/// exceed. Ants walk at about one speed, and releases are far fewer than a tenth of all frames.
const REACH: (f64, f64) = (2.0, 0.9);

/// Attachments of a recording. `releases` are the rows with the event; `None` stands for a table
/// without events.
pub fn attachments(recording: &Recording, releases: Option<&[Sample]>, sensor: &Sensor) -> Attachments {
    let mut rows: BTreeMap<usize, Vec<(bool, &Sample)>> = BTreeMap::new();
    // A release comes before a grasp of the same spring at the same time.
    for sample in releases.unwrap_or_default() {
        rows.entry(sample.spring).or_default().push((true, sample));
    }
    for sample in &recording.samples {
        rows.entry(sample.spring).or_default().push((false, sample));
    }
    let Some(period) = frame_period(recording) else { return Attachments::default() };
    let times = |pick: fn(f64, f64) -> f64| recording.samples.iter().map(|sample| sample.time).reduce(pick).unwrap_or(0.0);
    let mut reader = Reader {
        sensor,
        period,
        ends: [times(f64::min), times(f64::max)],
        own: Attachment::default(),
        swing: 0.0,
        last: None,
        found: Attachments { has_events: releases.is_some(), reach: reach(recording, period), ..Attachments::default() },
    };
    for (spring, mut rows) in rows {
        rows.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
        reader.begin(spring);
        for (is_release, sample) in rows {
            if is_release { reader.release(sample) } else { reader.hold(sample) }
        }
        reader.end();
    }
    reader.found
}

/// What happened to a tip from one sample to the next.
enum Passed {
    /// It was held, in every frame or with some missing.
    Held { is_bridged: bool },
    /// It was let go, or lost from view.
    Missing,
    /// It was let go, and grasped again within the same frame.
    Sprung,
}

/// Reads the samples of one spring after another.
struct Reader<'a> {
    sensor: &'a Sensor,
    /// Time between two frames (s).
    period: f64,
    /// Times of the first and of the last frame (s).
    ends: [f64; 2],
    own: Attachment,
    /// Of the last sample (rad).
    swing: f64,
    last: Option<&'a Sample>,
    found: Attachments,
}

impl<'a> Reader<'a> {
    fn begin(&mut self, spring: usize) {
        (self.own, self.swing, self.last) = (Attachment { spring, ..Attachment::default() }, 0.0, None);
    }

    fn hold(&mut self, sample: &'a Sample) {
        match self.last.map(|last| self.passed(last, sample)) {
            Some(Passed::Missing) => self.lose(),
            Some(Passed::Sprung) => {
                let pull = self.own.held[self.own.held.len() - 1].pull;
                self.found.n_sprung += 1;
                self.finish(Some((sample.time, pull)));
            }
            Some(Passed::Held { is_bridged }) => self.found.n_bridged += usize::from(is_bridged),
            None => {}
        }
        let (held, swing) = held(sample, self.sensor, self.swing);
        self.own.has_grasp |= self.own.held.is_empty() && sample.time > self.ends[0];
        self.own.held.push(held);
        (self.swing, self.last) = (swing, Some(sample));
    }

    fn release(&mut self, sample: &Sample) {
        let (held, _) = held(sample, self.sensor, self.swing);
        self.finish(Some((held.time, held.pull)));
    }

    fn end(&mut self) {
        let ends_early = self.last.is_some_and(|last| last.time < self.ends[1] - 0.5 * self.period);
        if ends_early { self.lose() } else { self.finish(None) }
    }

    /// Ends an attachment whose tip is missing in the next frame.
    fn lose(&mut self) {
        let last = self.own.held[self.own.held.len() - 1];
        self.finish((!self.found.has_events).then_some((last.time + self.period, last.pull)));
    }

    fn finish(&mut self, release: Option<(f64, f64)>) {
        let own = Attachment { release, ..std::mem::take(&mut self.own) };
        let spring = own.spring;
        if !own.held.is_empty() {
            self.found.all.push(own);
        }
        self.begin(spring);
    }

    fn passed(&self, before: &Sample, after: &Sample) -> Passed {
        let n_frames = (after.time - before.time) / self.period;
        let (moved, reach) = (step(before, after), self.found.reach);
        // Ants walk away from the place at rest, where they grasp.
        let [was, is] = [before, after].map(|sample| from_rest(sample, self.sensor));
        let is_new = is < was && is <= reach;
        if n_frames > GAP {
            let is_bridged = n_frames <= MOST_BRIDGED && moved <= WALKED * reach * n_frames && !is_new;
            return if is_bridged { Passed::Held { is_bridged } } else { Passed::Missing };
        }
        let is_sprung = !self.found.has_events && moved > reach && is_new;
        if is_sprung { Passed::Sprung } else { Passed::Held { is_bridged: false } }
    }
}

/// Distance of two samples of a tip (m).
fn step(before: &Sample, after: &Sample) -> f64 {
    match (before.tip, after.tip) {
        (Tip::InWorld { tip: before, .. }, Tip::InWorld { tip: after, .. }) | (Tip::InRoot(before), Tip::InRoot(after)) => {
            (after - before).norm()
        }
        _ => f64::INFINITY,
    }
}

/// Distance of a tip from its place at rest (m).
fn from_rest(sample: &Sample, sensor: &Sensor) -> f64 {
    let spring = sensor.spring(sample.spring);
    match sample.tip {
        Tip::InRoot(tip) => (tip - Vec2::new(spring.rest_length, 0.0)).norm(),
        Tip::InWorld { load, tip } => (tip - load.to_world(&spring.rest_tip())).norm(),
    }
}

/// Longest step of an attached tip from one frame to the next (m), see [`REACH`].
fn reach(recording: &Recording, period: f64) -> f64 {
    let mut last: BTreeMap<usize, &Sample> = BTreeMap::new();
    let pairs = recording.samples.iter().filter_map(|sample| Some((last.insert(sample.spring, sample)?, sample)));
    let mut steps: Vec<f64> =
        pairs.filter(|(before, after)| after.time - before.time <= GAP * period).map(|(before, after)| step(before, after)).collect();
    steps.sort_by(f64::total_cmp);
    steps.get((REACH.1 * steps.len() as f64) as usize).map_or(0.0, |step| REACH.0 * step)
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
