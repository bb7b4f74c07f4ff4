//! A backend around another one, which observes or adds to some of the calls.

use super::interface::{Backend, Computes};
use super::report::{EnergyLedger, Motion, PoseError, RestoreError, SaveError, SavedState, SideContact, StepReport, Transition};
use super::springs::AttachedTip;
use crate::math::{Pose, Vec2};
use crate::model::ObstaclePose;

/// What a [`Wrapped`] backend does besides passing a call on. Each default only passes it on.
pub trait Hook: Send {
    fn attach(&mut self, inside: &mut dyn Backend, spring: usize, tip: Vec2) {
        inside.attach(spring, tip);
    }

    fn release(&mut self, inside: &mut dyn Backend, spring: usize) {
        inside.release(spring);
    }

    fn steer(&mut self, inside: &mut dyn Backend, obstacle: usize, course: &[(f64, Pose)]) -> bool {
        inside.steer(obstacle, course)
    }

    fn advance(&mut self, inside: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        inside.advance(tip_targets, duration)
    }

    fn pose_error(&self, inside: &dyn Backend) -> Option<PoseError> {
        inside.pose_error()
    }

    /// See [`Backend::companion`].
    fn companion<'a>(&'a self, inside: &'a dyn Backend) -> Option<&'a dyn Backend> {
        inside.companion()
    }

    /// # Errors
    /// As [`Backend::save`].
    fn save(&self, inside: &dyn Backend) -> Result<SavedState, SaveError> {
        inside.save()
    }

    /// # Errors
    /// As [`Backend::restore`].
    fn restore(&mut self, inside: &mut dyn Backend, state: &SavedState) -> Result<(), RestoreError> {
        inside.restore(state)
    }
}

/// The backend `inside`, called through a hook. All questions about the load go to it unchanged.
pub struct Wrapped<H> {
    pub inside: Box<dyn Backend>,
    pub hook: H,
}

impl<H: Hook> Backend for Wrapped<H> {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.hook.attach(self.inside.as_mut(), spring, tip);
    }

    fn release(&mut self, spring: usize) {
        self.hook.release(self.inside.as_mut(), spring);
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.hook.advance(self.inside.as_mut(), tip_targets, duration)
    }

    fn steer(&mut self, obstacle: usize, course: &[(f64, Pose)]) -> bool {
        self.hook.steer(self.inside.as_mut(), obstacle, course)
    }

    fn steered(&self) -> Vec<ObstaclePose> {
        self.inside.steered()
    }

    fn computes(&self) -> Computes {
        self.inside.computes()
    }

    fn motion(&self) -> Motion {
        self.inside.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.inside.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.inside.pull(spring)
    }

    fn energy(&self) -> EnergyLedger {
        self.inside.energy()
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.inside.friction_forces()
    }

    fn side_contacts(&self) -> Vec<SideContact> {
        self.inside.side_contacts()
    }

    fn read_tips(&self, tips: &mut [AttachedTip]) {
        self.inside.read_tips(tips);
    }

    fn transitions(&self) -> &[Transition] {
        self.inside.transitions()
    }

    fn pose_error(&self) -> Option<PoseError> {
        self.hook.pose_error(self.inside.as_ref())
    }

    fn companion(&self) -> Option<&dyn Backend> {
        self.hook.companion(self.inside.as_ref())
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        self.hook.save(self.inside.as_ref())
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        self.hook.restore(self.inside.as_mut(), state)
    }
}
