//! Status and cost of an advance.

use serde::{Deserialize, Serialize};

use super::doubt::Doubts;
use super::skips::{Skip, SkipCounts};

/// How an advance ended. The order is that of severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Every step met its tolerance.
    #[default]
    Converged,
    /// Some step ended above its tolerance; its best point was kept.
    NotConverged,
    /// Some step had no finite answer: the load stayed where it was.
    Failed,
}

/// What an advance cost and how well it ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    pub status: Status,
    /// Largest residual of a step, relative to the forces in it (1).
    pub residual: f64,
    /// Steps of the backend; macro-steps under error control.
    pub n_steps: u64,
    /// Solutions of the friction problem.
    pub n_solves: u64,
    /// Newton iterations in all of these solutions.
    pub n_iterations: u64,
    /// Steps that were known without solving.
    pub n_skipped: u64,
    /// Steps that did not converge.
    pub n_not_converged: u64,
    /// Macro-steps that error control rejected as too long.
    pub n_rejected: u64,
    /// Largest residual of a step in which an obstacle pushed the load, relative to the forces in
    /// it (1).
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub contact_residual: f64,
    /// Whether the contact forces of some step were statically indeterminate: other forces balance
    /// the load just as well.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_indeterminate: bool,
    /// Largest angle of the fastest oscillation in a step, where no step that the backend may take
    /// resolves it (rad); zero where all steps do.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub unresolved_rad: f64,
    /// Energy that quasi-static steps gained within the error of the trapezoid rule for the work
    /// (J).
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub work_error_j: f64,
    /// Largest change of the direction of a spring about its root in a fixed step of an exact
    /// backend (rad); zero where all are small.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub swing_rad: f64,
    /// Share of the path that the positions of the engine lost by rounding, where it exceeds what a
    /// run may lose (1); zero where it does not.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub lost_share: f64,
    /// What makes the accepted steps of an exact backend doubtful.
    #[serde(default, skip_serializing_if = "Doubts::is_empty")]
    pub doubts: Doubts,
    /// Energy that appeared from nowhere, where it exceeds what a run may gain, over the energy
    /// that went into it, or over the largest entry of the ledger of an exact backend (1). Energy
    /// that is missing beyond what a run under error control may lose has a minus. Zero where
    /// neither holds.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub gained_share: f64,
    /// Work that was skipped, by kind.
    #[serde(default)]
    pub skipped: SkipCounts,
}

impl StepReport {
    /// Whether the advance had no answer: nothing was solved and nothing moved.
    pub fn is_refused(&self) -> bool {
        self.status == Status::Failed && self.n_solves == 0
    }

    /// Report of an advance that has no answer, and in which nothing moved.
    #[cold]
    pub(in crate::backend) fn refused() -> Self {
        Self { status: Status::Failed, n_steps: 1, n_not_converged: 1, ..Self::default() }
    }

    /// What an attempt has cost, without its steps and what became of them.
    pub(in crate::backend) fn work(&self) -> Self {
        let Self { n_solves, n_iterations, n_skipped, n_rejected, skipped, .. } = *self;
        Self { n_solves, n_iterations, n_skipped, n_rejected, skipped, ..Self::default() }
    }

    /// Adds `n_steps` that were skipped.
    pub fn leave_out(&mut self, why: Skip, n_steps: u64) {
        self.n_steps += n_steps;
        self.n_skipped += n_steps;
        self.skipped.count(why, n_steps);
    }

    pub fn add(&mut self, other: &StepReport) {
        self.status = self.status.max(other.status);
        self.residual = self.residual.max(other.residual);
        self.n_steps += other.n_steps;
        self.n_solves += other.n_solves;
        self.n_iterations += other.n_iterations;
        self.n_skipped += other.n_skipped;
        self.n_not_converged += other.n_not_converged;
        self.n_rejected += other.n_rejected;
        self.contact_residual = self.contact_residual.max(other.contact_residual);
        self.unresolved_rad = self.unresolved_rad.max(other.unresolved_rad);
        // Only steps that no other step is a part of have these.
        if other.work_error_j + other.swing_rad > 0.0 {
            self.work_error_j += other.work_error_j;
            self.swing_rad = self.swing_rad.max(other.swing_rad);
        }
        // Steps that lose or gain too much have not converged.
        if other.status != Status::Converged {
            self.lost_share = self.lost_share.max(other.lost_share);
            self.gained_share =
                [self.gained_share, other.gained_share].into_iter().fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
        }
        self.is_indeterminate |= other.is_indeterminate;
        if !other.doubts.is_empty() {
            self.doubts.add(&other.doubts);
        }
        self.skipped.add(&other.skipped);
    }
}
