//! A quasi-static backend with an estimator beside it: what moves the load tells what inertia would have done.

use std::cell::RefCell;
use std::rc::Rc;

use super::{Estimator, InertiaEstimate};
use crate::backend::{
    AttachedTip, Backend, BackendOptions, EnergyLedger, Motion, PoseError, RestoreError, SaveError, SavedState, StepReport, Transition,
    build,
};
use crate::math::Vec2;
use crate::model::System;

/// Answers as the backend inside does, bit for bit.
pub struct Watched {
    backend: Box<dyn Backend>,
    estimator: Rc<RefCell<Estimator>>,
}

/// Key of the estimator's state beside those of the backend.
const KEY: &str = "inertia_estimate";

impl Watched {
    /// A quasi-static backend for `system`, and the estimator that follows it.
    ///
    /// # Panics
    /// When the options are those of a backend with inertia, of which there is nothing to estimate.
    pub fn new(system: &System, start: Motion, options: &BackendOptions) -> (Box<Self>, Rc<RefCell<Estimator>>) {
        assert!(!options.kind.has_inertia(), "{} has inertia: there is nothing to estimate", options.kind.name());
        let estimator = Rc::new(RefCell::new(Estimator::new(system, &start)));
        let backend = build(system, start, options);
        (Box::new(Self { backend, estimator: Rc::clone(&estimator) }), estimator)
    }

    /// What has been found so far.
    pub fn estimate(&self, agreement: f64) -> InertiaEstimate {
        self.estimator.borrow().estimate(agreement)
    }
}

impl Backend for Watched {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        let pose = self.motion().pose;
        self.estimator.borrow_mut().attach(spring, tip, &pose);
        self.backend.attach(spring, tip);
    }

    fn release(&mut self, spring: usize) {
        let pose = self.motion().pose;
        self.estimator.borrow_mut().release(spring, &pose);
        self.backend.release(spring);
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let before = self.motion().pose;
        let report = self.backend.advance(tip_targets, duration);
        let after = self.motion().pose;
        if report.is_refused() {
            return report;
        }
        self.estimator.borrow_mut().advance(&before, &after, tip_targets, duration);
        report
    }

    fn motion(&self) -> Motion {
        self.backend.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.backend.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.backend.pull(spring)
    }

    fn read_tips(&self, tips: &mut [AttachedTip]) {
        self.backend.read_tips(tips);
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.backend.friction_forces()
    }

    fn energy(&self) -> EnergyLedger {
        self.backend.energy()
    }

    fn transitions(&self) -> &[Transition] {
        self.backend.transitions()
    }

    fn pose_error(&self) -> Option<PoseError> {
        self.backend.pose_error()
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        let SavedState(mut state) = self.backend.save()?;
        state[KEY] = self.estimator.borrow().save();
        Ok(SavedState(state))
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let estimator = state.0.get(KEY).ok_or_else(|| RestoreError("it was saved without an inertia estimate".into()))?;
        self.estimator.borrow_mut().restore(estimator)?;
        self.backend.restore(state)
    }
}
