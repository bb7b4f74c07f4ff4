//! How far two paths lie apart, and when they first part.

use serde::Serialize;

use super::Solution;
use super::solution::Point;
use crate::simulation::{Event, EventKind};

/// Distance of two paths, or an error of one: at its largest and at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    pub position_max_m: f64,
    pub position_final_m: f64,
    pub heading_max_rad: f64,
    pub heading_final_rad: f64,
}

/// The first instant at which two paths lie further apart than their own errors and the tolerance allow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parting {
    pub time_s: f64,
    /// What happened last before; `None` when nothing had.
    pub after: Option<Occasion>,
}

/// A grasp or a release.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Occasion {
    pub kind: EventKind,
    pub spring: usize,
    pub time_s: f64,
}

impl Difference {
    /// Of two paths over the instants that both have.
    pub fn between(a: &Solution, b: &Solution) -> Self {
        Self::over(a.points.iter().zip(&b.points).map(|(a, b)| apart(a, b)))
    }

    /// A path's own error.
    pub fn own(solution: &Solution) -> Self {
        Self::over(solution.points.iter().map(|point| (point.position_error, point.heading_error)))
    }

    /// Entry by entry the larger one.
    pub fn max(&self, other: &Self) -> Self {
        Self {
            position_max_m: self.position_max_m.max(other.position_max_m),
            position_final_m: self.position_final_m.max(other.position_final_m),
            heading_max_rad: self.heading_max_rad.max(other.heading_max_rad),
            heading_final_rad: self.heading_final_rad.max(other.heading_final_rad),
        }
    }

    fn over(pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        pairs.fold(Self::default(), |so_far, (position, heading)| Self {
            position_max_m: so_far.position_max_m.max(position),
            position_final_m: position,
            heading_max_rad: so_far.heading_max_rad.max(heading),
            heading_final_rad: heading,
        })
    }
}

impl Parting {
    /// Where `a` and `b` first lie further apart than both own errors and `tolerance` (m) together.
    pub fn of(a: &Solution, b: &Solution, tolerance: f64) -> Option<Self> {
        let parts = |(a, b): &(&Point, &Point)| apart(a, b).0 > tolerance + a.position_error + b.position_error;
        let time_s = a.points.iter().zip(&b.points).find(parts)?.0.time;
        Some(Self { time_s, after: last_before(&a.trace.events, time_s) })
    }
}

fn last_before(events: &[Event], time: f64) -> Option<Occasion> {
    let at = events.partition_point(|event| event.time < time).checked_sub(1)?;
    let event = &events[at];
    Some(Occasion { kind: event.kind, spring: event.spring, time_s: event.time })
}

fn apart(a: &Point, b: &Point) -> (f64, f64) {
    ((a.position - b.position).norm(), (a.heading - b.heading).abs())
}
