//! Rows of traces that a replay shows: enough that linear interpolation between them has no visible
//! error.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use cohaul::simulation::{Row, Trace};

/// Rows that represent a whole trace, in order, with the first and the last one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thinned {
    pub rows: Vec<usize>,
    /// Largest edge displacement between a row that is left out and the interpolation there (m).
    pub deviation: f64,
}

/// A stretch without the rows inside it.
struct Stretch {
    from: usize,
    to: usize,
    /// Row with the largest error.
    worst: usize,
    /// Error of that row (m): edge displacement, or [`CHANGE_OF_HANDS`] if that is larger there.
    off: f64,
    /// Largest edge displacement between a row and the interpolation (m).
    edge: f64,
}

/// At most `most` rows of traces whose rows are at the same times. A third are spread evenly, so
/// that walking ants move smoothly. The others are where interpolation would have the largest edge
/// displacement from a load of `radius` (m), or next to a grasp, a release, a touch or a
/// separation.
pub fn thinned(traces: &[&Trace], radius: f64, most: usize) -> Thinned {
    let n = traces.iter().map(|trace| trace.rows.len()).min().unwrap_or(0);
    if n <= most.max(2) {
        return Thinned { rows: (0..n).collect(), deviation: 0.0 };
    }
    let n_even = (most / 3).max(2);
    let mut rows: Vec<usize> = (0..n_even).map(|k| k * (n - 1) / (n_even - 1)).collect();
    let stretch = |from, to| Stretch::of(traces, radius, from, to);
    let mut stretches: BinaryHeap<Stretch> = rows.windows(2).map(|pair| stretch(pair[0], pair[1])).collect();
    while rows.len() < most && stretches.peek().is_some_and(|widest| widest.off > 0.0) {
        let Stretch { from, to, worst, .. } = stretches.pop().expect("it was looked at");
        rows.push(worst);
        stretches.extend([stretch(from, worst), stretch(worst, to)]);
    }
    rows.sort_unstable();
    Thinned { rows, deviation: stretches.iter().map(|stretch| stretch.edge).fold(0.0, f64::max) }
}

/// Error of a left-out grasp, release, touch or separation, over the load's radius (1).
const CHANGE_OF_HANDS: f64 = 0.1;

impl Stretch {
    fn of(traces: &[&Trace], radius: f64, from: usize, to: usize) -> Self {
        let mut found = Self { from, to, worst: from + (to - from) / 2, off: 0.0, edge: 0.0 };
        for rows in traces.iter().map(|trace| &trace.rows[from..=to]) {
            let (first, last) = (&rows[0], &rows[rows.len() - 1]);
            for (at, row) in rows.iter().enumerate().take(rows.len() - 1).skip(1) {
                let edge = edge_displacement(first, last, row, radius);
                let changed = !same_hands(&rows[at - 1], row) || at + 2 == rows.len() && !same_hands(row, last);
                let off = if changed { edge.max(CHANGE_OF_HANDS * radius) } else { edge };
                found.edge = found.edge.max(edge);
                if off > found.off {
                    (found.off, found.worst) = (off, from + at);
                }
            }
        }
        found
    }
}

/// Edge displacement between `row` and the linear interpolation between two other rows (m).
fn edge_displacement(first: &Row, last: &Row, row: &Row, radius: f64) -> f64 {
    let share = (row.time - first.time) / (last.time - first.time);
    first.motion.pose.towards(&last.motion.pose, share).edge_displacement(&row.motion.pose, radius)
}

/// Whether the same springs are attached, and the load touches the same obstacles.
fn same_hands(one: &Row, other: &Row) -> bool {
    let has_same_tips = one.tips.len() == other.tips.len() && one.tips.iter().zip(&other.tips).all(|(a, b)| a.spring == b.spring);
    has_same_tips
        && one.contacts.len() == other.contacts.len()
        && one.contacts.iter().zip(&other.contacts).all(|(a, b)| a.obstacle == b.obstacle)
}

impl PartialEq for Stretch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Stretch {}

impl PartialOrd for Stretch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Orders by the error. Of two equal errors the earlier stretch is the larger.
impl Ord for Stretch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.off.total_cmp(&other.off).then(other.from.cmp(&self.from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    const RADIUS: f64 = 0.0122;

    #[test]
    fn what_is_left_out_lies_within_the_stated_deviation() {
        let mut traces = [synthetic::trace(4000, 1.0), synthetic::trace(4000, 1.001)];
        // A swing after a release: three rows a turn for a while.
        for (at, row) in traces[1].rows[2000..2060].iter_mut().enumerate() {
            row.motion.pose.position.x += 2e-3 * (2.0 * at as f64).sin();
        }
        let thinned = thinned(&traces.each_ref(), RADIUS, 600);
        assert!(thinned.rows.len() <= 600 && thinned.rows.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((thinned.rows.first(), thinned.rows.last()), (Some(&0), Some(&3999)));
        let mut largest: f64 = 0.0;
        for pair in thinned.rows.windows(2) {
            for trace in &traces {
                let rows = &trace.rows;
                let off = |at: usize| edge_displacement(&rows[pair[0]], &rows[pair[1]], &rows[at], RADIUS);
                largest = (pair[0] + 1..pair[1]).map(off).fold(largest, f64::max);
            }
        }
        assert_eq!(largest, thinned.deviation);
        let even: Vec<usize> = (0..600).map(|k| k * 3999 / 599).collect();
        let off_evenly = even.windows(2).flat_map(|pair| {
            let rows = &traces[1].rows;
            (pair[0] + 1..pair[1]).map(move |at| edge_displacement(&rows[pair[0]], &rows[pair[1]], &rows[at], RADIUS))
        });
        assert!(thinned.deviation < off_evenly.fold(0.0, f64::max), "better than as many rows spread evenly");
    }

    #[test]
    fn a_jump_and_every_change_of_hands_is_kept() {
        let mut trace = synthetic::trace(4000, 1.0);
        trace.rows[1234..].iter_mut().for_each(|row| row.motion.pose.position.x += 0.01);
        let rows = thinned(&[&trace], RADIUS, 1000).rows;
        assert!(rows.contains(&1233) && rows.contains(&1234), "the last row before a jump and the first after it");
        for event in &trace.events {
            let at = trace.rows.partition_point(|row| row.time < event.time);
            assert!(rows.contains(&at) && rows.contains(&(at - 1)), "{event:?}");
        }
    }

    #[test]
    fn short_and_empty_traces_stay_whole() {
        assert_eq!(thinned(&[], RADIUS, 100), Thinned::default());
        assert_eq!(thinned(&[&Trace::default()], RADIUS, 100), Thinned::default());
        assert_eq!(thinned(&[&synthetic::trace(1, 1.0)], RADIUS, 100).rows, [0]);
        assert_eq!(thinned(&[&synthetic::trace(100, 1.0)], RADIUS, 100).rows.len(), 100);
    }
}
