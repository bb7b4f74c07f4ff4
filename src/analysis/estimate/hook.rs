//! A quasi-static backend with an estimator beside it.

use super::estimator::Estimator;
use crate::backend::{Backend, BackendOptions, Hook, Motion, RestoreError, SaveError, SavedState, Shared, StepReport, Wrapped, build};
use crate::math::Vec2;
use crate::model::System;
use crate::scenario::Scenario;

/// Key of the estimator's state beside that of the backend.
const KEY: &str = "inertia_estimate";

/// Passes what happens to the load on to an estimator.
struct Follow(Shared<Estimator>);

/// A quasi-static backend for `system`, and an estimator that follows it. The backend moves the
/// load as it would alone.
///
/// # Panics
/// If the options are those of a backend with inertia.
pub fn with_estimate(system: &System, start: Motion, options: &BackendOptions) -> (Box<dyn Backend>, Shared<Estimator>) {
    assert!(!options.kind.has_inertia(), "{} has inertia: there is nothing to estimate", options.kind.name());
    let estimator = Shared::new(Estimator::new(system, &start, options.rate_independent));
    let (inside, hook) = (build(system, start, options), Follow(estimator.clone()));
    (Box::new(Wrapped { inside, hook }), estimator)
}

/// The backend of a run, and what follows it to estimate the inertia effect: nothing where a
/// backend has no estimate, or none `is_wanted`.
pub fn with_estimate_if(scenario: &Scenario, options: &BackendOptions, is_wanted: bool) -> (Box<dyn Backend>, Option<Shared<Estimator>>) {
    if !options.kind.has_inertia_estimate() || !is_wanted {
        return (build(&scenario.system, scenario.start, options), None);
    }
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, options);
    (backend, Some(estimator))
}

impl Hook for Follow {
    fn attach(&mut self, inside: &mut dyn Backend, spring: usize, tip: Vec2) {
        self.0.borrow().attach(spring, tip, &inside.motion().pose);
        inside.attach(spring, tip);
    }

    fn release(&mut self, inside: &mut dyn Backend, spring: usize) {
        self.0.borrow().release(spring, &inside.motion().pose);
        inside.release(spring);
    }

    fn advance(&mut self, inside: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let before = inside.motion().pose;
        let report = inside.advance(tip_targets, duration);
        if !report.is_refused() {
            let mut estimator = self.0.borrow();
            estimator.advance(&before, &inside.motion().pose, tip_targets, duration);
            estimator.note(inside.transitions());
        }
        report
    }

    fn save(&self, inside: &dyn Backend) -> Result<SavedState, SaveError> {
        let SavedState(mut state) = inside.save()?;
        state[KEY] = self.0.borrow().save();
        Ok(SavedState(state))
    }

    fn restore(&mut self, inside: &mut dyn Backend, state: &SavedState) -> Result<(), RestoreError> {
        let estimator = state.0.get(KEY).ok_or_else(|| RestoreError("it was saved without an inertia estimate".into()))?;
        self.0.borrow().restore(estimator)?;
        inside.restore(state)
    }
}
