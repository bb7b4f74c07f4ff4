//! What figures show of a trace: taken from the rows once, as these are long and there are many of them.

use std::borrow::Cow;

use super::{Labelled, MILLI};
use crate::backend::EnergyLedger;
use crate::math::{Pose, Vec2};
use crate::simulation::{Event, Row};

/// A trace as its figures need it.
pub struct Seen<'a> {
    pub rows: Cow<'a, SeenRows>,
    pub events: &'a [Event],
}

/// What figures need of rows, which may come a few at a time: in print units, a quantity after the other, as each is drawn by itself.
#[derive(Clone, Debug, Default)]
pub struct SeenRows {
    /// (s)
    pub(super) times: Vec<f64>,
    /// Position (mm).
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// (rad)
    pub(super) headings: Vec<f64>,
    /// (mm/s)
    pub(super) speeds: Vec<f64>,
    /// Size of the sum of the pulls (mN).
    pub(super) net_pulls: Vec<f64>,
    /// Sum of their sizes (mN).
    pub(super) total_pulls: Vec<f64>,
    pub(super) n_holders: Vec<f64>,
    /// Done by the tips, dissipated, elastic (mJ).
    pub(super) energies: [Vec<f64>; 3],
    /// The load's pose at both ends; none without rows.
    pub(super) ends: Option<[Pose; 2]>,
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
        if self.times.is_empty() {
            self.reserve();
        }
        let motions = || rows.iter().map(|row| &row.motion);
        self.times.extend(rows.iter().map(|row| row.time));
        self.x.extend(motions().map(|motion| MILLI * motion.pose.position.x));
        self.y.extend(motions().map(|motion| MILLI * motion.pose.position.y));
        self.headings.extend(motions().map(|motion| motion.pose.heading));
        self.speeds.extend(motions().map(|motion| MILLI * motion.twist.linear.norm()));
        self.net_pulls.extend(rows.iter().map(|row| MILLI * row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm()));
        self.total_pulls.extend(rows.iter().map(|row| MILLI * row.tips.iter().map(|tip| tip.pull.norm()).sum::<f64>()));
        self.n_holders.extend(rows.iter().map(|row| row.tips.len() as f64));
        let energies: [fn(&EnergyLedger) -> f64; 3] = [|energy| energy.tip_work, EnergyLedger::dissipated, |energy| energy.elastic];
        for (column, energy) in self.energies.iter_mut().zip(energies) {
            column.extend(rows.iter().map(|row| MILLI * energy(&row.energy)));
        }
    }
    /// Room from which on columns grow without being moved: what is left behind would cost more than the room.
    fn reserve(&mut self) {
        const ROOM: usize = 1 << 14;
        let Self { times, x, y, headings, speeds, net_pulls, total_pulls, n_holders, energies, ends: _ } = self;
        let columns = [times, x, y, headings, speeds, net_pulls, total_pulls, n_holders];
        columns.into_iter().chain(energies).for_each(|column| column.reserve(ROOM));
    }
}
