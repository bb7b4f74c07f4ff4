//! Distance of two paths.

use serde::Serialize;

use super::solution::Point;
use crate::backend::{Transition, TransitionKind};
use crate::simulation::{SAME_INSTANT, Trace};

/// Difference of two paths, or the error of one: largest value and value at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    pub position_max_m: f64,
    pub position_final_m: f64,
    pub heading_max_rad: f64,
    pub heading_final_rad: f64,
    pub edge_displacement_max_m: f64,
}

/// Jumps of a quasi-static load. A jump takes no time, and a load with inertia cannot follow it at
/// once: paths are compared again at the next tick.
#[derive(Default)]
pub(super) struct Jumps {
    /// Times in order (s).
    times: Vec<f64>,
    /// (s)
    control_period: f64,
    /// End of the trace (s).
    end: f64,
}

impl Difference {
    /// Difference of two paths at common instants, for a load of this `radius` (m).
    pub fn between(a: &[Point], b: &[Point], radius: f64) -> Self {
        Self::outside_jumps(a, b, radius, &Jumps::default())
    }

    /// Difference of two paths at those common instants that follow no jump of one of them.
    pub(super) fn outside_jumps(a: &[Point], b: &[Point], radius: f64, jumps: &Jumps) -> Self {
        Self::largest(radius, a.iter().zip(b).filter(|(a, _)| jumps.allow(a.time)).map(|(a, b)| a.difference(b)))
    }

    /// Numerical error of a path, for a load of this `radius` (m).
    pub fn error_of(path: &[Point], radius: f64) -> Self {
        Self::largest(radius, path.iter().map(|point| (point.error.position, point.error.heading)))
    }

    /// The larger value of each field.
    pub fn max(&self, other: &Self) -> Self {
        Self {
            position_max_m: self.position_max_m.max(other.position_max_m),
            position_final_m: self.position_final_m.max(other.position_final_m),
            heading_max_rad: self.heading_max_rad.max(other.heading_max_rad),
            heading_final_rad: self.heading_final_rad.max(other.heading_final_rad),
            edge_displacement_max_m: self.edge_displacement_max_m.max(other.edge_displacement_max_m),
        }
    }

    fn largest(radius: f64, pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        pairs.fold(Self::default(), |so_far, (position, heading)| Self {
            position_max_m: so_far.position_max_m.max(position),
            position_final_m: position,
            heading_max_rad: so_far.heading_max_rad.max(heading),
            heading_final_rad: heading,
            edge_displacement_max_m: so_far.edge_displacement_max_m.max(position + radius * heading),
        })
    }
}

impl Jumps {
    /// Jumps in a trace with this control period (s).
    pub fn of(trace: &Trace, control_period: f64) -> Self {
        let is_jump = |transition: &&Transition| matches!(transition.kind, TransitionKind::Jump { .. });
        let end = trace.rows.last().map_or(0.0, |row| row.time);
        Self { times: trace.transitions.iter().filter(is_jump).map(|jump| jump.time).collect(), control_period, end }
    }

    /// Whether paths are compared at an instant (s): at every tick and at the end, and between
    /// ticks if there was no jump since the last tick.
    pub fn allow(&self, time: f64) -> bool {
        let n_periods = time / self.control_period;
        self.since_tick(time).is_none() || (n_periods - n_periods.round()).abs() <= SAME_INSTANT || time >= self.end
    }

    /// Time of the first jump since the last tick before an instant (s).
    pub fn since_tick(&self, time: f64) -> Option<f64> {
        let tick = ((time / self.control_period - SAME_INSTANT).ceil() - 1.0 - SAME_INSTANT) * self.control_period;
        self.times.get(self.times.partition_point(|jump| *jump < tick)).copied().filter(|jump| *jump <= time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks every 0.1 s, a jump at a tick, one between ticks, and an end between ticks after a
    /// third.
    #[test]
    fn paths_are_compared_again_at_the_tick_after_a_jump() {
        let jumps = Jumps { times: vec![0.3, 0.52, 0.71], control_period: 0.1, end: 0.77 };
        let allowed = |times: &[f64]| times.iter().map(|time| jumps.allow(*time)).collect::<Vec<_>>();
        assert_eq!(allowed(&[0.0, 0.05, 0.25, 0.1 + 0.2, 0.3]), [true; 5]);
        assert_eq!(allowed(&[0.32, 0.38, 0.4, 0.42, 0.51]), [false, false, true, true, true]);
        assert_eq!(allowed(&[0.52, 0.58, 0.6, 0.65, 0.7, 0.705, 0.75, 0.77]), [false, false, true, true, true, true, false, true]);
        assert_eq!([0.35, 0.4, 0.45, 0.6].map(|time| jumps.since_tick(time)), [Some(0.3), Some(0.3), None, Some(0.52)]);
        assert!(Jumps::default().allow(0.123));
    }
}
