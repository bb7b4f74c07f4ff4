//! A recording as rows over time, as a run has them.

use crate::calibrate::{Force, Recording, Sample, Tip};
use cohaul::backend::{EnergyLedger, Motion};
use cohaul::math::{Pose, Twist};
use cohaul::simulation::{AttachedTip, AttachedTips, Row};

/// Frames of a recording at equal times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    pub rows: Vec<Row>,
    /// Time between two frames (s).
    pub period: f64,
    /// Frames in the table (1).
    pub n_frames: usize,
    /// Frames that the table does not have, because no tip was held or seen: the load is then on
    /// the straight way between its poses before and after (1).
    pub n_filled: usize,
}

/// Longest recording in frames, with those that are filled in (1): 100 frames a second for almost
/// three hours. A frame takes some 400 bytes.
const MOST_FRAMES: f64 = 1e6;

/// The rows of a recording in world axes, with its forces in the same order. `None` for tips in the
/// frames of their roots, for fewer than two frames, and for frames so far apart that filling them
/// in would take more than a million.
pub fn recorded(recording: &Recording, forces: &[Force]) -> Option<Recorded> {
    let pairs: Vec<(&Sample, &Force)> = recording.samples.iter().zip(forces).collect();
    let frames: Vec<Row> = pairs.chunk_by(|one, next| one.0.time == next.0.time).map(frame).collect::<Option<_>>()?;
    let mut periods: Vec<f64> = frames.windows(2).map(|pair| pair[1].time - pair[0].time).collect();
    periods.sort_by(f64::total_cmp);
    let period = *periods.get(periods.len() / 2)?;
    let n_frames = frames.len();
    if !(period > 0.0 && (frames[n_frames - 1].time - frames[0].time) / period <= MOST_FRAMES) {
        return None;
    }
    let mut rows: Vec<Row> = Vec::with_capacity(n_frames);
    for frame in frames {
        if let Some(last) = rows.last().cloned() {
            let n_steps = ((frame.time - last.time) / period).round().max(1.0);
            rows.extend((1..n_steps as usize).map(|step| between(&last, &frame, step as f64 / n_steps)));
        }
        rows.push(frame);
    }
    Some(Recorded { n_filled: rows.len() - n_frames, rows, period, n_frames })
}

/// The row of the tips of one frame.
fn frame(tips: &[(&Sample, &Force)]) -> Option<Row> {
    let first = tips.first()?.0;
    let Tip::InWorld { load, .. } = first.tip else { return None };
    let tip = |(sample, force): &(&Sample, &Force)| match sample.tip {
        Tip::InWorld { tip, .. } => Some(AttachedTip { spring: sample.spring, position: tip, pull: force.in_world? }),
        Tip::InRoot(_) => None,
    };
    let mut tips: Vec<AttachedTip> = tips.iter().map(tip).collect::<Option<_>>()?;
    tips.sort_by_key(|tip| tip.spring);
    Some(row(first.time, load, tips))
}

fn row(time: f64, pose: Pose, tips: Vec<AttachedTip>) -> Row {
    let motion = Motion { pose, twist: Twist::default() };
    Row {
        time,
        motion,
        energy: EnergyLedger::default(),
        tips: AttachedTips::from_vec(tips),
        contacts: Vec::new(),
        steered: Vec::new(),
        error: None,
    }
}

/// A frame without tips, at a share of the time from one frame to another (1).
fn between(from: &Row, to: &Row, share: f64) -> Row {
    let (start, end) = (&from.motion.pose, &to.motion.pose);
    let position = start.position + share * (end.position - start.position);
    let pose = Pose { position, heading: start.heading + share * (end.heading - start.heading) };
    row(from.time + share * (to.time - from.time), pose, Vec::new())
}
