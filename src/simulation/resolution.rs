//! How well the steps of a run resolve its motion.
//!
//! With the increments d of the pose in equal steps, a first-order method is off by about half of
//! the change of d in each step. One of second order is off by about an eighth of the change of
//! that change, which is also what it misses where something happens within a step, such as a stop.
//! Summed up over a run, this estimates the error of fixed steps at next to no cost. Errors add up
//! otherwise than these sums; `results/2026-11-29-account` counts how often they are larger.

use serde::{Deserialize, Serialize};

use crate::backend::{BackendOptions, Integrator, StepReport};
use crate::math::Vec3;
use crate::model::Motion;

/// Factor between the sum of errors of steps and what is stated (1). The sum is an estimate of the
/// leading term; errors of forces that turn with the load add up to a few times as much. With four,
/// 98 % of the runs of the stress maps that are ok, but for those with the engine's own settings,
/// end within what they state.
const SAFETY: f64 = 4.0;

/// Sums over the steps of a run, at the edge of the load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// Sum of the sizes of the changes of the increment (m).
    pub changes_m: f64,
    /// Sum of the sizes of the changes of these changes (m).
    pub second_changes_m: f64,
    /// Path length: sum of the sizes of the increments (m).
    pub path_length_m: f64,
    /// Sum of the sizes of the increments, each times the residual of its steps, at most one (m):
    /// how much of the path lacks forces that balance.
    #[serde(default)]
    pub unsolved_m: f64,
    /// Increment of the last step, and its change in that step: shift, and turn times radius (m).
    last: Vec3,
    last_change: Vec3,
}

impl Resolution {
    /// Nothing yet, for a load that begins with this motion, with steps of `step` (s). Under error
    /// control steps have no length, and nothing is added later.
    pub(super) fn starting(motion: &Motion, step: f64, radius: f64) -> Self {
        let step = if step.is_finite() { step } else { 0.0 };
        Self { last: step * motion.twist.linear.push(radius * motion.twist.angular), ..Self::default() }
    }

    /// Estimated error of the pose by the length of the steps, at the edge of the load (m): four
    /// times the sum of what each step may be off by.
    pub fn step_error_m(&self, options: &BackendOptions) -> f64 {
        let is_second_order = options.kind.is_exact() && options.integrator == Integrator::Midpoint;
        SAFETY * if is_second_order { 0.125 * self.second_changes_m } else { 0.5 * self.changes_m }
    }

    /// Adds an advance from one motion to another of a load of this `radius` (m), with what its
    /// steps report.
    pub(super) fn add(&mut self, from: &Motion, to: &Motion, report: &StepReport, radius: f64) {
        let moved = (to.pose.position - from.pose.position).push(radius * (to.pose.heading - from.pose.heading));
        let n_steps = report.n_steps.max(1) as f64;
        let increment = moved / n_steps;
        let change = increment - self.last;
        self.changes_m += change.norm();
        // Increments are means over the advance, from the middle of one to the middle of the next.
        self.second_changes_m += (change - self.last_change).norm() / n_steps;
        self.path_length_m += moved.norm();
        self.unsolved_m += report.residual.min(1.0) * moved.norm();
        (self.last, self.last_change) = (increment, change);
    }
}
