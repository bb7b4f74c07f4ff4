//! What figures show of a trace: reduced from its rows once, since the rows need much memory.

use std::borrow::Cow;

use crate::chart::scene::Labelled;
use crate::chart::thin::Column;
use cohaul::math::{Pose, Vec2};
use cohaul::simulation::{Event, Row};

pub struct Seen<'a> {
    pub rows: Cow<'a, SeenRows>,
    pub events: &'a [Event],
}

/// Values of the rows of a run that figures need, in SI units. Rows may be added a few at a
/// time, and the memory is bounded: neighbouring rows of a long run share a group, which keeps
/// ranges and means.
#[derive(Clone, Debug)]
pub struct SeenRows {
    groups: Vec<Group>,
    /// Rows of a group, and of the last one, which may not be full.
    n_each: usize,
    n_last: usize,
    path: Path,
    /// The load's pose at both ends; none without rows.
    pub(crate) ends: Option<[Pose; 2]>,
    /// Times of the first and the last row (s).
    pub(crate) span: [f64; 2],
    /// Where the load touches obstacles at the end (m, world).
    pub(crate) touched: Vec<Vec2>,
}

/// What is shown over time.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Quantity {
    /// (rad)
    Heading,
    /// (m/s)
    Speed,
    /// Size of the sum of the pulls (N).
    NetPull,
    /// Sum of their sizes (N).
    TotalPull,
    Attachments,
    /// Work of the tips (J).
    TipWork,
    /// (J)
    Dissipated,
    /// (J)
    Elastic,
    /// Work of moving obstacles (J).
    ObstacleWork,
}

impl Quantity {
    const COUNT: usize = 9;

    /// Values of all quantities of a row, in the order of the variants.
    fn of(row: &Row) -> [f64; Self::COUNT] {
        let (mut net, mut total) = (Vec2::zeros(), 0.0);
        for tip in &row.tips {
            (net, total) = (net + tip.pull, total + tip.pull.norm());
        }
        let energy = &row.energy;
        let [tip_work, dissipated, elastic] = [energy.tip_work, energy.dissipated(), energy.elastic];
        let (speed, n_attached) = (row.motion.twist.linear.norm(), row.tips.len() as f64);
        [row.motion.pose.heading, speed, net.norm(), total, n_attached, tip_work, dissipated, elastic, energy.obstacle_work]
    }
}

/// Rows that share a place: the least, the largest and the sum of each [`Quantity`].
#[derive(Clone, Copy, Debug)]
struct Group {
    /// Time of the first row (s).
    time: f64,
    low: [f64; Quantity::COUNT],
    high: [f64; Quantity::COUNT],
    sum: [f64; Quantity::COUNT],
}

impl Group {
    fn of(time: f64, values: [f64; Quantity::COUNT]) -> Self {
        Self { time, low: values, high: values, sum: values }
    }

    /// Adds a later group.
    fn add(&mut self, other: &Self) {
        for at in 0..Quantity::COUNT {
            // Not `f64::min`, which takes longer as it minds what is no number.
            self.low[at] = if other.low[at] < self.low[at] { other.low[at] } else { self.low[at] };
            self.high[at] = if other.high[at] > self.high[at] { other.high[at] } else { self.high[at] };
            self.sum[at] += other.sum[at];
        }
    }
}

/// Path of the load's origin (m). A point closer than `distance` to the last kept point is left
/// out.
#[derive(Clone, Debug, Default)]
struct Path {
    points: Vec<[f64; 2]>,
    /// (m)
    distance: f64,
}

/// Largest number of groups, several for each pixel of a panel. At this number neighbouring groups
/// are joined in pairs, so that it is even.
const MOST_GROUPS: usize = 2048;
/// Largest number of points of a path. Above it points are kept farther apart.
const MOST_POINTS: usize = 8192;

impl<'a> Seen<'a> {
    pub fn all(traces: &[Labelled<'a>]) -> Vec<Self> {
        let of = |one: &Labelled<'a>| {
            let mut rows = SeenRows::default();
            rows.add(&one.trace.rows);
            Self { rows: Cow::Owned(rows), events: &one.trace.events }
        };
        traces.iter().map(of).collect()
    }
}

impl Default for SeenRows {
    fn default() -> Self {
        Self { groups: Vec::new(), n_each: 1, n_last: 1, path: Path::default(), ends: None, span: [0.0; 2], touched: Vec::new() }
    }
}

impl SeenRows {
    pub fn add(&mut self, rows: &[Row]) {
        let Some(last) = rows.last() else { return };
        let first = self.ends.map_or(rows[0].motion.pose, |[first, _]| first);
        self.span = [if self.ends.is_some() { self.span[0] } else { rows[0].time }, last.time];
        self.touched = last.contacts.iter().map(|contact| contact.point).collect();
        self.ends = Some([first, last.motion.pose]);
        for row in rows {
            let own = Group::of(row.time, Quantity::of(row));
            match self.groups.last_mut() {
                Some(group) if self.n_last < self.n_each => {
                    group.add(&own);
                    self.n_last += 1;
                }
                _ => {
                    self.join_when_full();
                    self.groups.push(own);
                    self.n_last = 1;
                }
            }
            self.path.add([row.motion.pose.position.x, row.motion.pose.position.y]);
        }
    }

    /// Makes room for one more group.
    fn join_when_full(&mut self) {
        if self.groups.len() < MOST_GROUPS {
            return;
        }
        self.n_each *= 2;
        for k in 0..MOST_GROUPS / 2 {
            let later = self.groups[2 * k + 1];
            self.groups[k] = self.groups[2 * k];
            self.groups[k].add(&later);
        }
        self.groups.truncate(MOST_GROUPS / 2);
    }

    pub(crate) fn columns(&self, quantity: Quantity) -> Vec<Column> {
        let (at, n_groups) = (quantity as usize, self.groups.len());
        let of = |(k, group): (usize, &Group)| {
            let n = if k + 1 < n_groups { self.n_each } else { self.n_last };
            Column { x: group.time, low: group.low[at], mean: group.sum[at] / n as f64, high: group.high[at] }
        };
        self.groups.iter().enumerate().map(of).collect()
    }

    /// The load's path (m).
    pub(crate) fn path(&self) -> Vec<[f64; 2]> {
        let end = self.ends.map(|[_, last]| [last.position.x, last.position.y]);
        self.path.points.iter().copied().chain(end).collect()
    }
}

impl Path {
    fn add(&mut self, point: [f64; 2]) {
        if !is_near(self.points.last(), &point, self.distance) {
            self.points.push(point);
        }
        if self.points.len() > MOST_POINTS {
            let lengths = self.points.windows(2).map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]));
            let path_length: f64 = lengths.filter(|length| length.is_finite()).sum();
            self.distance = (2.0 * self.distance).max(2.0 * path_length / MOST_POINTS as f64);
            let (mut last, distance) = (None, self.distance);
            self.points.retain(|point| {
                let is_kept = !is_near(last.as_ref(), point, distance);
                last = if is_kept { Some(*point) } else { last };
                is_kept
            });
        }
    }
}

/// Whether a point lies within `distance` (m) of the one before it. NaN marks a gap and is near no
/// point.
fn is_near(before: Option<&[f64; 2]>, point: &[f64; 2], distance: f64) -> bool {
    before.is_some_and(|before| (point[0] - before[0]).powi(2) + (point[1] - before[1]).powi(2) <= distance * distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    /// More rows than groups, a few at a time: no extreme is lost, means of all are the mean of
    /// all, and there are never more groups than that.
    #[test]
    fn groups_keep_ranges_and_means_of_all_rows() {
        for n_rows in [1, 500, 2048, 2049, 50_000] {
            let mut trace = synthetic::trace(n_rows, 1.0);
            trace.rows[n_rows / 3].motion.pose.heading = 40.0;
            trace.rows[n_rows / 2].motion.pose.heading = -70.0;
            let mut seen = SeenRows::default();
            trace.rows.chunks(13).for_each(|rows| seen.add(rows));
            let (columns, headings) = (seen.columns(Quantity::Heading), trace.rows.iter().map(|row| row.motion.pose.heading));
            assert!(columns.len() <= MOST_GROUPS && columns.len() >= n_rows.min(MOST_GROUPS / 2), "{n_rows}: {}", columns.len());
            let low = columns.iter().map(|column| column.low).fold(f64::INFINITY, f64::min);
            let high = columns.iter().map(|column| column.high).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!((low, high), headings.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y))));
            let n_of = |k: usize| if k + 1 < columns.len() { seen.n_each } else { seen.n_last };
            let sum: f64 = columns.iter().enumerate().map(|(k, column)| n_of(k) as f64 * column.mean).sum();
            // Rounding of sums of as many numbers of order one.
            assert!((sum - headings.sum::<f64>()).abs() < 1e-13 * n_rows as f64 + 1e-13, "{n_rows}");
            assert!(columns.windows(2).all(|pair| pair[0].x < pair[1].x));
            if n_rows <= MOST_GROUPS {
                assert!(columns.iter().zip(&trace.rows).all(|(column, row)| column.low == row.motion.pose.heading && column.x == row.time));
            }
        }
    }

    /// Points are dropped, but none that is far from a kept one: twice what so many points would be
    /// apart.
    #[test]
    fn a_path_keeps_its_course_in_bounded_room() {
        let all: Vec<[f64; 2]> = (0..100_000).map(|k| (1e-3 * f64::from(k)).sin_cos()).map(|(s, c)| [40.0 * s, 30.0 * c * c]).collect();
        let mut path = Path::default();
        for point in &all {
            path.add(*point);
            assert!(path.points.len() <= MOST_POINTS);
        }
        assert!(path.points.len() > MOST_POINTS / 4 && path.distance < 3.0);
        for point in all.iter().step_by(97) {
            assert!(path.points.iter().any(|near| (point[0] - near[0]).hypot(point[1] - near[1]) <= path.distance));
        }
    }
}
