//! Error estimate of a run under error control: two backends of the same kind side by side.
//!
//! Both take macro-steps under error control, the second with four times the tolerance of the
//! first. It keeps the answers whose errors the control estimates, in place of the better ones. Its
//! distance from the first shows how those errors have added up, and bounds the error of the first
//! with a margin.

use serde::{Deserialize, Serialize};

use super::wrapped::{Hook, Wrapped};
use super::{Backend, PoseError, RestoreError, SaveError, SavedState, StepReport};
use crate::math::Vec2;

/// The less exact of the two backends.
pub(super) struct Check(Box<dyn Backend + Send>);

/// The backend `answer`, with a pose error that `check` estimates.
pub(super) fn tandem(answer: Box<dyn Backend + Send>, check: Box<dyn Backend + Send>) -> Wrapped<Check, Box<dyn Backend + Send>> {
    Wrapped { inside: answer, hook: Check(check) }
}

#[derive(Serialize, Deserialize)]
struct Saved {
    answer: SavedState,
    check: SavedState,
}

impl Hook for Check {
    fn attach(&mut self, answer: &mut dyn Backend, spring: usize, tip: Vec2) {
        answer.attach(spring, tip);
        self.0.attach(spring, tip);
    }

    fn release(&mut self, answer: &mut dyn Backend, spring: usize) {
        answer.release(spring);
        self.0.release(spring);
    }

    /// The report counts the work of both.
    fn advance(&mut self, answer: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = answer.advance(tip_targets, duration);
        report.add(&self.0.advance(tip_targets, duration));
        report
    }

    fn pose_error(&self, answer: &dyn Backend) -> Option<PoseError> {
        let [answer, check] = [answer, self.0.as_ref()].map(|run| run.motion().pose);
        Some(PoseError { position: (answer.position - check.position).norm(), heading: (answer.heading - check.heading).abs() })
    }

    fn companion<'a>(&'a self, _answer: &'a dyn Backend) -> Option<&'a dyn Backend> {
        Some(self.0.as_ref())
    }

    fn save(&self, answer: &dyn Backend) -> Result<SavedState, SaveError> {
        Ok(SavedState::of(&Saved { answer: answer.save()?, check: self.0.save()? }))
    }

    fn restore(&mut self, answer: &mut dyn Backend, state: &SavedState) -> Result<(), RestoreError> {
        let saved: Saved = state.read()?;
        answer.restore(&saved.answer)?;
        self.0.restore(&saved.check)
    }
}
