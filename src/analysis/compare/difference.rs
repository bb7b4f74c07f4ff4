//! How far two paths lie apart.

use serde::Serialize;

use super::solution::Point;
use crate::backend::{Transition, TransitionKind};
use crate::simulation::{SAME_INSTANT, Trace};

/// Distance of two paths, or an error of one: at its largest and at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    pub position_max_m: f64,
    pub position_final_m: f64,
    pub heading_max_rad: f64,
    pub heading_final_rad: f64,
    /// Of a point of the load at its radius, at most: shift plus radius times turn at one instant.
    pub rim_max_m: f64,
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

impl Difference {
    /// Of two paths of a load of this `radius` (m) at the same instants, one by one, as far as both go.
    pub fn between(a: &[Point], b: &[Point], radius: f64) -> Self {
        Self::but_in_jumps(a, b, radius, &Jumps::default())
    }

    /// Of two paths over those of the instants that both have that count beside the jumps of one of them.
    pub(super) fn but_in_jumps(a: &[Point], b: &[Point], radius: f64, jumps: &Jumps) -> Self {
        Self::over(radius, a.iter().zip(b).filter(|(a, _)| jumps.let_count(a.time)).map(|(a, b)| apart(a, b)))
    }

    /// How far a path may be wrong.
    pub fn own(path: &[Point], radius: f64) -> Self {
        Self::over(radius, path.iter().map(|point| (point.position_error, point.heading_error)))
    }

    /// Entry by entry the larger one.
    pub fn max(&self, other: &Self) -> Self {
        Self {
            position_max_m: self.position_max_m.max(other.position_max_m),
            position_final_m: self.position_final_m.max(other.position_final_m),
            heading_max_rad: self.heading_max_rad.max(other.heading_max_rad),
            heading_final_rad: self.heading_final_rad.max(other.heading_final_rad),
            rim_max_m: self.rim_max_m.max(other.rim_max_m),
        }
    }

    fn over(radius: f64, pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        pairs.fold(Self::default(), |so_far, (position, heading)| Self {
            position_max_m: so_far.position_max_m.max(position),
            position_final_m: position,
            heading_max_rad: so_far.heading_max_rad.max(heading),
            heading_final_rad: heading,
            rim_max_m: so_far.rim_max_m.max(position + radius * heading),
        })
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
    pub fn let_count(&self, time: f64) -> bool {
        let n_periods = time / self.control_period;
        self.since_tick(time).is_none() || (n_periods - n_periods.round()).abs() <= SAME_INSTANT || time >= self.end
    }

    /// The first jump from the tick before an instant on (s).
    pub fn since_tick(&self, time: f64) -> Option<f64> {
        let tick = ((time / self.control_period - SAME_INSTANT).ceil() - 1.0 - SAME_INSTANT) * self.control_period;
        self.times.get(self.times.partition_point(|jump| *jump < tick)).copied().filter(|jump| *jump <= time)
    }
}

/// Shift (m) and turn (rad) from one point to another.
pub(super) fn apart(a: &Point, b: &Point) -> (f64, f64) {
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
