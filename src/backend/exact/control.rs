//! Tolerances of a macro-step and the errors that are compared with them.

use serde::{Deserialize, Serialize};

use crate::backend::numerics::{
    CHANGE_SHARE, ENERGY_ROUNDING, LOCATED, MOST_WAIT, SHORTEST_MACRO_STEP, SHORTEST_UNSOLVED, WORK_PER_SECOND,
};
use crate::backend::report::{Motion, RestoreError, StepReport};
use crate::backend::springs::TipPaths;
use crate::math::{Twist, Vec2, rotation};
use crate::model::{SupportPoint, System};

/// What an advance hands on to the next one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Macro-step to start with (s).
    pub(super) macro_step: f64,
    /// Shortest macro-step over the advance (1).
    pub(super) shortest: f64,
    #[serde(default)]
    pub(super) trial: Trial,
    /// Work at obstacles beyond what the run was allowed so far (1): negative as long as some is
    /// left.
    #[serde(default = "Pace::initial_work")]
    work: f64,
}

/// When to try a macro-step that is longer than its errors say, at an obstacle: after each failure
/// half as often.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    n_left: u32,
    wait: u32,
}

impl Trial {
    /// Whether to try one now.
    pub(super) fn is_due(&mut self) -> bool {
        let is_due = self.n_left == 0;
        if is_due {
            self.wait /= 2
        } else {
            self.n_left -= 1
        }
        is_due
    }

    pub(super) fn fail(&mut self) {
        self.wait = (4 * self.wait).clamp(2, MOST_WAIT);
        self.n_left = self.wait;
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self { macro_step: f64::MAX, shortest: SHORTEST_MACRO_STEP, trial: Trial::default(), work: Self::initial_work() }
    }
}

impl Pace {
    /// # Errors
    /// When a restored pace is none that an advance leaves.
    pub(super) fn check(&self) -> Result<(), RestoreError> {
        let is_possible = self.macro_step > 0.0 && (SHORTEST_MACRO_STEP..=SHORTEST_UNSOLVED).contains(&self.shortest);
        let Self { macro_step, shortest, .. } = self;
        if is_possible && self.work.is_finite() {
            Ok(())
        } else {
            Err(RestoreError(format!("macro-steps of {macro_step} s, at least {shortest} of an advance")))
        }
    }

    fn initial_work() -> f64 {
        -WORK_PER_SECOND
    }

    /// Allows the work of an advance of this `duration` (s).
    pub(super) fn allow_work(&mut self, duration: f64) {
        self.work = (self.work - WORK_PER_SECOND * duration).max(Self::initial_work());
    }

    /// Counts the work since the report `before`. Returns whether none is left.
    pub(super) fn spend(&mut self, before: &StepReport, now: &StepReport) -> bool {
        self.work += ((now.n_iterations - before.n_iterations) + (now.n_solves - before.n_solves)) as f64;
        self.work > 0.0
    }

    /// Raises the shortest macro-step after an advance without an answer in places, such as a path
    /// through the root of a spring, and lowers it after one with answers.
    pub(super) fn hand_on(&mut self, had_answers: bool) {
        let shortest = if had_answers { self.shortest * self.shortest } else { self.shortest.sqrt() };
        self.shortest = shortest.clamp(SHORTEST_MACRO_STEP, SHORTEST_UNSOLVED);
    }
}

/// An advance under error control.
pub struct Task<'a> {
    pub paths: TipPaths<'a>,
    /// Longest macro-step (s). Implicit steps much longer than an oscillation agree with each other
    /// on what is left when it has died out, so that the table cannot tell that it has not.
    pub longest: f64,
    pub control: Control,
}

/// Tolerances of a macro-step, and the answer that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Error of the position in a macro-step (m).
    pub position: f64,
    /// Error of the heading in a macro-step (rad).
    pub heading: f64,
    /// Error of each loss to friction and of each work in a macro-step (J). Where only one motion
    /// is possible, as about a pinned support, poses may be exact at any length while the work is
    /// not.
    pub energy: f64,
    /// Time over which a wrong speed makes the position wrong (s); `None` for a method that carries
    /// no speed on.
    pub settling_time: Option<f64>,
    pub keeps: Column,
}

/// Column of the table that is kept as the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// The last one, the best answer.
    Last,
    /// The one before, whose error is what the control estimates. A run that keeps it shows how
    /// such errors add up.
    LastButOne,
}

impl Control {
    /// Error of a macro-step of `duration` (s) from the flow `before`, over the tolerance (1):
    /// `row` is its last row of the table and `last_row` the one before. The friction of obstacles
    /// has changed by `side_change` (N) with its direction.
    pub(super) fn error(
        &self,
        moving: (&System, &Motion),
        side_change: f64,
        changed_in: Option<usize>,
        before: &[f64],
        [row, last_row]: [&[Vec<f64>]; 2],
        duration: f64,
    ) -> f64 {
        let (n, plain) = (row.len(), self.distance(&row[0], &last_row[0]));
        match changed_in {
            None => self.distance(&row[n - 1], &row[n - 2]).min(plain),
            // What happens in the first step of all rows hides from their difference, and so does
            // what stops a load.
            Some(step) if step == 1 || self.settling_time.is_some() => {
                let lost = plain.max(self.lost_displacement(before, &row[0], duration));
                let hidden = if step == 1 { self.of_reversal(moving, side_change, before, duration / n as f64) } else { 0.0 };
                lost.max(self.before_stop(moving, duration)).max(hidden) / CHANGE_SHARE
            }
            Some(_) => plain / CHANGE_SHARE,
        }
    }

    /// Displacement of tips and obstacles (m) within which a change of a load without inertia is
    /// located.
    pub(super) fn located(&self) -> f64 {
        LOCATED * CHANGE_SHARE * self.position
    }

    /// Distance of two flows over the tolerance (1).
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let poses = self.size(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        let speeds = self.settling_time.map_or(0.0, |time| time * self.size(a[3] - b[3], a[4] - b[4], a[5] - b[5]));
        let energy = |at: usize| (a[at] - b[at]).abs() / (self.energy + ENERGY_ROUNDING * a[at].abs());
        // Forces that hold a load are not unique, and neither is their work.
        let moves = self.settling_time.is_some() && a[3..6].iter().any(|rate| *rate != 0.0);
        let at_obstacles = if moves { energy(8).max(energy(9)) } else { 0.0 };
        poses.max(speeds).max(energy(6)).max(energy(7)).max(at_obstacles)
    }

    /// Possible error of the displacement in an implicit step of `duration` (s) between two flows,
    /// over the tolerance (1). Where its speed has dropped to nothing, one step and two find the
    /// same pose, which is not the right one.
    fn lost_displacement(&self, a: &[f64], b: &[f64], duration: f64) -> f64 {
        0.5 * duration * self.size(a[3] - b[3], a[4] - b[4], a[5] - b[5])
    }

    /// Farthest displacement of a load that stops within `duration` (s) by friction, over the
    /// tolerance (1); zero for a load that goes on. A load that is about to stop as a macro-step
    /// begins loses no displacement by a long one, yet the time of its stop is to be located.
    fn before_stop(&self, (system, motion): (&System, &Motion), duration: f64) -> f64 {
        if self.settling_time.is_none() || motion.twist != Twist::ZERO {
            return 0.0;
        }
        self.size(0.5 * system.braking() * duration * duration, 0.0, 0.0)
    }

    /// Possible error of the speed by supports and side contacts that reverse within a step of
    /// `duration` (s) from the flow `before`, over the tolerance (1): an implicit step has their
    /// friction at its end.
    fn of_reversal(&self, (system, motion): (&System, &Motion), side_change: f64, before: &[f64], duration: f64) -> f64 {
        let (start, ground) = (Motion::of_entries(before), &system.ground);
        let slip = |motion: &Motion, offset: &Vec2| motion.twist.velocity_at(&(rotation(motion.pose.heading) * offset));
        let reverses = |support: &SupportPoint| slip(&start, &support.offset).dot(&slip(motion, &support.offset)) < 0.0;
        let supports = ground.supports.iter().zip(ground.slip_limits());
        let limit: f64 = supports.filter(|(support, _)| reverses(support)).map(|(_, limit)| limit).sum();
        let (load, change) = (&system.load, (2.0 * limit + side_change) * duration);
        let of_time = |time: f64| self.size(time * change / load.mass, 0.0, time * change * load.radius / load.inertia);
        self.settling_time.map_or(0.0, of_time)
    }

    /// The flow `b` with the displacement that it may have lost since `a`. Where a load stops, one
    /// step and two find the same pose, and a run that shows how errors add up would not show that
    /// error.
    pub(super) fn strayed(&self, a: &[f64], b: &[f64], duration: f64) -> Vec<f64> {
        let mut strayed = b.to_vec();
        if self.settling_time.is_some() {
            (0..3).for_each(|i| strayed[i] += 0.5 * duration * (a[i + 3] - b[i + 3]));
        }
        strayed
    }

    /// Size of a shift (m) and a turn (rad) over the tolerance (1).
    fn size(&self, x: f64, y: f64, turn: f64) -> f64 {
        let (shift, turn) = (x.hypot(y) / self.position, turn.abs() / self.heading);
        // `max` drops what is not a number.
        if (shift + turn).is_nan() { f64::INFINITY } else { shift.max(turn) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run may spend the work of its time and of one second more. What it leaves of several
    /// seconds is no more than that of one.
    #[test]
    fn work_is_allowed_by_the_simulated_second() {
        let spent = |n_iterations: f64| StepReport { n_iterations: n_iterations as u64, ..StepReport::default() };
        let spend = |pace: &mut Pace, share: f64| pace.spend(&StepReport::default(), &spent(share * WORK_PER_SECOND));
        let mut pace = Pace::default();
        assert!(!spend(&mut pace, 0.9) && spend(&mut pace, 0.2));
        pace.allow_work(0.5);
        assert!(!spend(&mut pace, 0.3) && spend(&mut pace, 0.2));
        pace.allow_work(10.0);
        assert!(!spend(&mut pace, 0.9) && spend(&mut pace, 0.2));
    }
}
