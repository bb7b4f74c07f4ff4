//! What figures show of a trace: worked out in one pass, as rows are long and there are many of them.

use std::borrow::Cow;

use super::{Labelled, MILLI};
use crate::math::{Pose, Vec2};
use crate::simulation::{Event, Row};

/// A trace as its figures need it.
pub struct Seen<'a> {
    pub rows: Cow<'a, SeenRows>,
    pub events: &'a [Event],
}

/// What figures need of rows, which may come a few at a time: a quarter of what they hold.
#[derive(Clone, Debug, Default)]
pub struct SeenRows {
    pub(super) instants: Vec<Instant>,
    /// The load's pose at both ends; none without rows.
    pub(super) ends: Option<[Pose; 2]>,
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
        let mut rows = SeenRows::default();
        rows.add(&one.trace.rows);
        Self { rows: Cow::Owned(rows), events: &one.trace.events }
    }
}

impl SeenRows {
    /// Takes note of the next rows.
    pub fn add(&mut self, rows: &[Row]) {
        let Some(last) = rows.last() else { return };
        let first = self.ends.map_or(rows[0].motion.pose, |[first, _]| first);
        self.ends = Some([first, last.motion.pose]);
        self.instants.extend(rows.iter().map(Instant::of));
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
