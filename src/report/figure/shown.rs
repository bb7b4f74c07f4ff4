//! What figures show of a trace: worked out in one pass, as rows are long and there are many of them.

use super::{Labelled, MILLI};
use crate::math::{Pose, Vec2};
use crate::simulation::{Event, Row};

/// A trace as its figures need it.
pub struct Seen<'a> {
    pub instants: Vec<Instant>,
    pub events: &'a [Event],
    /// The load's pose at both ends; none of an empty trace.
    pub ends: Option<[Pose; 2]>,
}

/// One row in print units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// (s)
    pub time: f64,
    /// (mm)
    pub position: [f64; 2],
    /// (rad)
    pub heading: f64,
    /// (mm/s)
    pub speed: f64,
    /// Size of the sum of the pulls (mN).
    pub net_pull: f64,
    /// Sum of their sizes (mN).
    pub total_pull: f64,
    pub n_holders: f64,
    /// Done by the tips, dissipated, elastic (mJ).
    pub energies: [f64; 3],
}

impl<'a> Seen<'a> {
    pub fn all(traces: &[Labelled<'a>]) -> Vec<Self> {
        traces.iter().map(Self::of).collect()
    }

    pub fn of(one: &Labelled<'a>) -> Self {
        let rows = &one.trace.rows;
        let ends = rows.first().zip(rows.last()).map(|(first, last)| [first.motion.pose, last.motion.pose]);
        Self { instants: rows.iter().map(Instant::of).collect(), events: &one.trace.events, ends }
    }
}

impl Instant {
    fn of(row: &Row) -> Self {
        let (motion, energy) = (&row.motion, &row.energy);
        Self {
            time: row.time,
            position: [MILLI * motion.pose.position.x, MILLI * motion.pose.position.y],
            heading: motion.pose.heading,
            speed: MILLI * motion.twist.linear.norm(),
            net_pull: MILLI * row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm(),
            total_pull: MILLI * row.tips.iter().map(|tip| tip.pull.norm()).sum::<f64>(),
            n_holders: row.tips.len() as f64,
            energies: [energy.tip_work, energy.dissipated(), energy.elastic].map(|energy| MILLI * energy),
        }
    }
}
