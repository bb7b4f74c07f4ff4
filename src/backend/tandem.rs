//! Error bound of a run under error control: two backends of the same kind side by side.
//!
//! Both take macro-steps under error control, the second with four times the tolerance of the
//! first. It keeps the answers whose errors the control estimates, in place of the better ones. Its
//! distance from the first shows how those errors have added up.
//!
//! The distance alone is no bound. Where a contact mode changes, both runs cut their macro-steps at
//! the same places and may be wrong by the same displacement, which their distance does not show.
//! Such errors are a few hundredths of the tolerance. The bound is therefore the largest distance
//! so far times a safety factor, and at least a twentieth of the tolerance once the two runs differ
//! at all. It covers the errors of 1,100 random scenes (`results/2026-11-24-reference-error`).
//! At obstacles both runs meet the same touches, and the bound is at least half of the tolerance.

use serde::{Deserialize, Serialize};

use super::interface::Backend;
use super::numerics::{SHARED_AT_OBSTACLES, SHARED_ERROR, TANDEM_SAFETY};
use super::report::{PoseError, RestoreError, SaveError, SavedState, StepReport};
use super::tolerance::Tolerance;
use super::wrapped::{Hook, Wrapped};
use crate::math::{Pose, Vec2};
use crate::model::System;

/// The less exact of the two backends, and what the two runs show of the error.
pub(super) struct Check {
    backend: Box<dyn Backend>,
    /// Bound of the errors that both runs share.
    shared: PoseError,
    /// Largest distance of the two runs so far.
    largest: PoseError,
}

/// The backend `answer`, with a bound of its pose error that `check` finds. Both keep to a share of
/// `tolerance`.
pub(super) fn tandem(answer: Box<dyn Backend>, check: Box<dyn Backend>, tolerance: &Tolerance, system: &System) -> Wrapped<Check> {
    let share = if system.world.is_empty() { SHARED_ERROR } else { SHARED_AT_OBSTACLES };
    let shared = PoseError { position: share * tolerance.position_m, heading: share * tolerance.heading_rad };
    Wrapped { inside: answer, hook: Check { backend: check, shared, largest: PoseError::default() } }
}

#[derive(Serialize, Deserialize)]
struct Saved {
    answer: SavedState,
    check: SavedState,
    #[serde(default)]
    largest: PoseError,
}

impl Hook for Check {
    fn attach(&mut self, answer: &mut dyn Backend, spring: usize, tip: Vec2) {
        answer.attach(spring, tip);
        self.backend.attach(spring, tip);
    }

    fn release(&mut self, answer: &mut dyn Backend, spring: usize) {
        answer.release(spring);
        self.backend.release(spring);
    }

    fn steer(&mut self, answer: &mut dyn Backend, obstacle: usize, course: &[(f64, Pose)]) -> bool {
        answer.steer(obstacle, course) && self.backend.steer(obstacle, course)
    }

    /// The report counts the work of both.
    fn advance(&mut self, answer: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = answer.advance(tip_targets, duration);
        report.add(&self.backend.advance(tip_targets, duration));
        let [one, other] = [&*answer, self.backend.as_ref()].map(|run| run.motion().pose);
        let distance = PoseError { position: (one.position - other.position).norm(), heading: (one.heading - other.heading).abs() };
        self.largest = self.largest.max(&distance);
        report
    }

    fn pose_error(&self, _answer: &dyn Backend) -> Option<PoseError> {
        if self.largest == PoseError::default() {
            return Some(self.largest);
        }
        let PoseError { position, heading } = self.largest;
        Some(PoseError { position: TANDEM_SAFETY * position, heading: TANDEM_SAFETY * heading }.max(&self.shared))
    }

    fn companion<'a>(&'a self, _answer: &'a dyn Backend) -> Option<&'a dyn Backend> {
        Some(self.backend.as_ref())
    }

    fn save(&self, answer: &dyn Backend) -> Result<SavedState, SaveError> {
        Ok(SavedState::of(&Saved { answer: answer.save()?, check: self.backend.save()?, largest: self.largest }))
    }

    fn restore(&mut self, answer: &mut dyn Backend, state: &SavedState) -> Result<(), RestoreError> {
        let saved: Saved = state.read()?;
        answer.restore(&saved.answer)?;
        self.largest = saved.largest;
        self.backend.restore(&saved.check)
    }
}
