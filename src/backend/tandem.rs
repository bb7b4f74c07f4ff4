//! A run whose error is known: two of the same kind side by side, one of them less exact.
//!
//! Both take strides under error control, the second with a tolerance four times the first's, and it keeps the answers whose errors the control sees
//! instead of the better ones. What it has strayed from the first after any number of strides is how those errors have added up, and bounds the
//! first one's own error with a margin.

use serde::{Deserialize, Serialize};

use super::{Backend, EnergyLedger, HeldTip, Motion, PoseError, RestoreError, SavedState, StepReport, Transition};
use crate::math::Vec2;

pub(super) struct Tandem {
    pub answer: Box<dyn Backend>,
    pub check: Box<dyn Backend>,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    answer: SavedState,
    check: SavedState,
}

impl Backend for Tandem {
    fn grasp(&mut self, spring: usize, tip: Vec2) {
        self.answer.grasp(spring, tip);
        self.check.grasp(spring, tip);
    }

    fn release(&mut self, spring: usize) {
        self.answer.release(spring);
        self.check.release(spring);
    }

    /// Costs are those of both.
    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = self.answer.advance(tip_targets, duration);
        report.add(&self.check.advance(tip_targets, duration));
        report
    }

    fn motion(&self) -> Motion {
        self.answer.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.answer.tip(spring)
    }

    fn force_on_tip(&self, spring: usize) -> Vec2 {
        self.answer.force_on_tip(spring)
    }

    fn look_at(&self, tips: &mut [HeldTip]) {
        self.answer.look_at(tips);
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.answer.friction_forces()
    }

    fn energy(&self) -> EnergyLedger {
        self.answer.energy()
    }

    fn transitions(&self) -> &[Transition] {
        self.answer.transitions()
    }

    fn pose_error(&self) -> Option<PoseError> {
        let [answer, check] = [&self.answer, &self.check].map(|run| run.motion().pose);
        Some(PoseError { position: (answer.position - check.position).norm(), heading: (answer.heading - check.heading).abs() })
    }

    fn save(&self) -> SavedState {
        SavedState::of(&Saved { answer: self.answer.save(), check: self.check.save() })
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let Saved { answer, check } = state.read()?;
        self.answer.restore(&answer)?;
        self.check.restore(&check)
    }
}
