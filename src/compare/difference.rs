//! How far two paths lie apart, and when they first part.

use std::cmp::Ordering;

use serde::Serialize;

use super::Solution;
use super::solution::Point;
use crate::backend::{Transition, TransitionKind};
use crate::simulation::{Event, EventKind, SAME_INSTANT, Trace};

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

/// Jumps of a load without inertia. A jump takes no time, in which nothing with inertia can follow: it has until the next tick.
#[derive(Default)]
pub(super) struct Jumps {
    /// In order (s).
    times: Vec<f64>,
    /// (s)
    control_period: f64,
    /// Of the trace (s).
    end: f64,
}

/// Something that can make paths part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Occasion {
    pub kind: OccasionKind,
    /// That was grasped or let go; `null` for what the load did.
    pub spring: Option<usize>,
    /// That was captured or came free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub support: Option<usize>,
    pub time_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OccasionKind {
    Grasp,
    Release,
    /// The load began to move out of rest.
    Onset,
    /// It came to rest.
    Stop,
    /// A support ceased to slip.
    Capture,
    /// The support that the load turned about slipped again.
    Freed,
    /// The load without inertia jumped.
    Jump,
}

impl Difference {
    /// Of two paths over the instants that both have.
    pub fn between(a: &[Point], b: &[Point]) -> Self {
        Self::but_in_jumps(a, b, &Jumps::default())
    }

    /// Of two paths over those of the instants that both have that count beside the jumps of one of them.
    pub(super) fn but_in_jumps(a: &[Point], b: &[Point], jumps: &Jumps) -> Self {
        Self::over(a.iter().zip(b).filter(|(a, _)| jumps.let_count(a.time)).map(|(a, b)| apart(a, b)))
    }

    /// How far a path may be wrong.
    pub fn own(path: &[Point]) -> Self {
        Self::over(path.iter().map(|point| (point.position_error, point.heading_error)))
    }

    /// How far a point of the load at `radius` (m) from its origin can be apart (m).
    pub fn displacement(&self, radius: f64) -> f64 {
        self.position_max_m + radius * self.heading_max_rad
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
    /// Where a point of the load at most `radius` (m) from its origin first lies further apart in `a` and `b` than both own errors and `tolerance` (m)
    /// together, at instants that count beside `jumps`. What the load does within a `moment` (s) of a grasp or a release is its effect.
    pub(super) fn of(a: &Solution, b: &Solution, [radius, tolerance, moment]: [f64; 3], jumps: &Jumps) -> Option<Self> {
        let parts = |(a, b): &(&Point, &Point)| {
            let own = a.position_error + b.position_error + radius * (a.heading_error + b.heading_error);
            let (position, heading) = apart(a, b);
            jumps.let_count(a.time) && position + radius * heading > tolerance + own
        };
        let time_s = a.points.iter().zip(&b.points).find(parts)?.0.time;
        let until = jumps.since_tick(time_s).map_or(time_s, f64::next_up);
        let after = [a, b].into_iter().filter_map(|solution| last_before(&solution.trace, until, moment));
        Some(Self { time_s, after: after.max_by(Occasion::by_time) })
    }
}

impl Jumps {
    /// Of the load in a trace with this control period (s).
    pub fn of(trace: &Trace, control_period: f64) -> Self {
        let is_jump = |transition: &&Transition| matches!(transition.kind, TransitionKind::Jump { .. });
        let end = trace.rows.last().map_or(0.0, |row| row.time);
        Self { times: trace.transitions.iter().filter(is_jump).map(|jump| jump.time).collect(), control_period, end }
    }

    /// Whether paths are held against each other at an instant (s): at every tick and at the end, and between ticks unless there has been a jump since the last one.
    fn let_count(&self, time: f64) -> bool {
        let n_periods = time / self.control_period;
        self.since_tick(time).is_none() || (n_periods - n_periods.round()).abs() <= SAME_INSTANT || time >= self.end
    }

    /// The first jump from the tick before an instant on (s).
    fn since_tick(&self, time: f64) -> Option<f64> {
        let tick = ((time / self.control_period - SAME_INSTANT).ceil() - 1.0 - SAME_INSTANT) * self.control_period;
        self.times.get(self.times.partition_point(|jump| *jump < tick)).copied().filter(|jump| *jump <= time)
    }
}

impl Occasion {
    /// By time; at one instant a grasp or release is the cause, and what the load does the effect.
    fn by_time(&self, other: &Self) -> Ordering {
        self.time_s.total_cmp(&other.time_s).then(self.spring.cmp(&other.spring))
    }

    fn of_event(event: &Event) -> Self {
        let kind = match event.kind {
            EventKind::Grasp => OccasionKind::Grasp,
            EventKind::Release => OccasionKind::Release,
        };
        Self { kind, spring: Some(event.spring), support: None, time_s: event.time }
    }

    fn of_transition(transition: &Transition) -> Self {
        let (kind, support) = match transition.kind {
            TransitionKind::Onset => (OccasionKind::Onset, None),
            TransitionKind::Stop => (OccasionKind::Stop, None),
            TransitionKind::Capture { support } => (OccasionKind::Capture, Some(support)),
            TransitionKind::Freed { support } => (OccasionKind::Freed, Some(support)),
            TransitionKind::Jump { .. } => (OccasionKind::Jump, None),
        };
        Self { kind, spring: None, support, time_s: transition.time }
    }
}

/// What happened last before `time` (s), but for what the load did within a `moment` (s) of it.
fn last_before(trace: &Trace, time: f64, moment: f64) -> Option<Occasion> {
    let event = trace.events[..trace.events.partition_point(|event| event.time < time)].last().map(Occasion::of_event);
    let transitions = &trace.transitions[..trace.transitions.partition_point(|transition| transition.time < time)];
    let transition = transitions.last().map(Occasion::of_transition);
    let is_effect = event.zip(transition).is_some_and(|(event, transition)| transition.time_s <= event.time_s + moment);
    event.into_iter().chain(transition.filter(|_| !is_effect)).max_by(Occasion::by_time)
}

fn apart(a: &Point, b: &Point) -> (f64, f64) {
    ((a.position - b.position).norm(), (a.heading - b.heading).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks every 0.1 s, a jump at a tick, one between ticks, and an end between ticks after a third.
    #[test]
    fn a_jump_has_until_the_next_tick() {
        let jumps = Jumps { times: vec![0.3, 0.52, 0.71], control_period: 0.1, end: 0.77 };
        let counts = |times: &[f64]| times.iter().map(|time| jumps.let_count(*time)).collect::<Vec<_>>();
        assert_eq!(counts(&[0.0, 0.05, 0.25, 0.1 + 0.2, 0.3]), [true; 5]);
        assert_eq!(counts(&[0.32, 0.38, 0.4, 0.42, 0.51]), [false, false, true, true, true]);
        assert_eq!(counts(&[0.52, 0.58, 0.6, 0.65, 0.7, 0.705, 0.75, 0.77]), [false, false, true, true, true, true, false, true]);
        assert_eq!([0.35, 0.4, 0.45, 0.6].map(|time| jumps.since_tick(time)), [Some(0.3), Some(0.3), None, Some(0.52)]);
        assert!(Jumps::default().let_count(0.123));
    }
}
