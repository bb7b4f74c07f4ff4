//! What is measured on a recording and on a run alike: pulls, load speed by group size, the three
//! series of the paper's Fig. 11, and their changes.
//!
//! Speeds are displacements over windows of half a second. The sum of all steps from frame to frame
//! would count the noise of a camera as motion.

use serde::{Deserialize, Serialize};

use crate::paper::{Changes, Series, WINDOW_S, ticks_in};
use cohaul::math::{Summary, Vec2};
use cohaul::model::paper::MEASURED_LIMIT_N;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::Row;

/// Numbers of a recording, or of a run that is seen in the same frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// From the first frame to the last (s).
    pub duration_s: f64,
    /// Straight distance of the load from its first to its last place (m).
    pub displacement_m: f64,
    /// Pulls of all tips in all frames (N).
    pub pulls: Summary,
    /// Number of those of at most 30 mN.
    pub n_within_limit: u64,
    /// Load speed in windows (m/s).
    pub speed: Summary,
    /// The same by the mean number of pulling ants in the window, rounded, from none.
    pub speed_by_size: Vec<Summary>,
    /// Turn rate of the load in windows, of either sense (rad/s).
    pub turn_rate: Summary,
    /// Sum of the sizes of all interaction forces (Eq. 4) in windows (N).
    pub interaction: Summary,
    /// Where the three series change their mean, once the team has gathered and before it is near
    /// the nest.
    pub changes: Changes,
}

impl Measures {
    /// Measures of frames at equal times, `period` apart (s), with the `nest` of the scenario (m).
    /// `seed` is that of the tests for changes.
    pub fn of(rows: &[Row], period: f64, nest: Option<Vec2>, seed: u64) -> Self {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Self::default() };
        let pulls = || rows.iter().flat_map(|row| row.tips.iter().map(|tip| tip.pull.norm()));
        let series = series(rows, period);
        Self {
            duration_s: last.time - first.time,
            displacement_m: (last.motion.pose.position - first.motion.pose.position).norm(),
            pulls: Summary::of(pulls()),
            n_within_limit: pulls().filter(|pull| *pull <= MEASURED_LIMIT_N).count() as u64,
            speed: Summary::of(series.speed.iter().copied()),
            speed_by_size: by_size(rows, period),
            turn_rate: Summary::of(series.turn_rate.iter().copied()),
            interaction: Summary::of(series.interaction.iter().copied()),
            changes: Changes::of(&Series::once_gathered(rows, period, nest), seed),
        }
    }

    /// Share of the windows with at least one pulling ant in which so many pulled (1); `None`
    /// without such windows.
    pub fn share_of_size(&self, size: usize) -> Option<f64> {
        let n = |size: usize| self.speed_by_size.get(size).map_or(0, Summary::n);
        let all: u64 = (1..self.speed_by_size.len()).map(n).sum();
        (all > 0).then(|| n(size) as f64 / all as f64)
    }

    /// Load speed in windows with so many pulling ants (m/s).
    pub fn speed_of_size(&self, size: usize) -> Option<f64> {
        self.speed_by_size.get(size).filter(|speeds| speeds.n() > 0).map(Summary::mean)
    }
}

/// Where the ants of a scenario haul to (m); `None` without ants.
pub fn nest_of(scenario: &Scenario) -> Option<Vec2> {
    if let Drive::Ants(ants) = &scenario.drive { Some(ants.nest_position) } else { None }
}

/// The three series from the first frame with an attached tip on.
pub fn series(rows: &[Row], period: f64) -> Series {
    let first = rows.iter().position(|row| !row.tips.is_empty()).unwrap_or(rows.len());
    Series::of_rows(&rows[first..], period, ticks_in(WINDOW_S, period))
}

fn by_size(rows: &[Row], period: f64) -> Vec<Summary> {
    let mut found: Vec<Summary> = Vec::new();
    let ticks = ticks_in(WINDOW_S, period);
    for rows in rows.windows(ticks + 1).step_by(ticks) {
        let n_pulling: usize = rows[..ticks].iter().map(|row| row.tips.len()).sum();
        let size = (n_pulling as f64 / ticks as f64).round() as usize;
        let moved = (rows[ticks].motion.pose.position - rows[0].motion.pose.position).norm();
        found.resize(found.len().max(size + 1), Summary::default());
        found[size].add(moved / (rows[ticks].time - rows[0].time));
    }
    found
}
