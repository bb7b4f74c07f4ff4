//! Saving a run and resuming it: the resumed run equals the uninterrupted one to the bit.

use super::clock::Clock;
use super::controllers::{Controller, controller_of};
use super::run::{Simulation, attached_tips, backend_of};
use super::saved_run::{FORMAT, SavedRun, VERSION};
use super::trace::{Keep, Trace};
use crate::backend::{Backend, RestoreError, SaveError};
use crate::scenario::Scenario;

impl<'a> Simulation<'a> {
    /// State of the run so far, from which [`Simulation::resume`] continues. For a run that was
    /// stopped in the midst of a step it is the last checkpoint.
    ///
    /// # Errors
    /// When the backend or the controller cannot be saved, or when the run was stopped in the midst
    /// of a step and has no checkpoint.
    pub fn save(&self) -> Result<SavedRun, SaveError> {
        if self.is_stopped() {
            return self.checkpoints.as_ref().and_then(|checkpoints| checkpoints.last(&self.trace)).ok_or(SaveError);
        }
        Ok(SavedRun { trace: self.trace.clone(), ..self.state()? })
    }

    /// The same without the trace.
    pub(super) fn state(&self) -> Result<SavedRun, SaveError> {
        Ok(SavedRun {
            format: FORMAT,
            version: VERSION.to_owned(),
            scenario_hash: self.scenario.hash(),
            options: self.options,
            tick: self.clock.tick,
            time: self.clock.time,
            n_parts: self.clock.n_parts,
            finished: self.finished,
            keep: self.keep,
            totals: self.totals.clone(),
            controller: self.controller.save()?,
            backend: self.backend.save()?,
            trace: Trace::default(),
        })
    }

    /// Keeps the state in memory where checkpoints are asked for and one is due.
    pub(super) fn take_checkpoint(&mut self) {
        let Some(mut checkpoints) = self.checkpoints.take() else { return };
        checkpoints.take_if_due(|| Some((self.state().ok()?, &self.trace)));
        self.checkpoints = Some(checkpoints);
    }

    /// Resumes a run of the scenario's own controller.
    ///
    /// # Errors
    /// When the state belongs to another scenario or another version of the program, or is damaged,
    /// or when a trace is asked for and the run kept none.
    pub fn resume(scenario: &'a Scenario, saved: &SavedRun, keep: Keep) -> Result<Self, RestoreError> {
        // The backend is built from the options.
        saved.check(scenario)?;
        Self::resume_from_parts(scenario, saved, keep, controller_of(scenario), backend_of(scenario, &saved.options))
    }

    /// Resumes a run in a scenario whose tips and obstacles move otherwise from the time of the
    /// state on, and which is the same before. The caller promises that.
    ///
    /// # Errors When the state does not fit the scenario, or when the run kept no trace and one is
    /// asked for.
    pub fn resume_with_other_future(scenario: &'a Scenario, saved: &SavedRun, keep: Keep) -> Result<Self, RestoreError> {
        let saved = SavedRun { scenario_hash: scenario.hash(), finished: false, ..saved.clone() };
        Self::resume(scenario, &saved, keep)
    }

    /// Resumes a run with a controller and a backend that were made elsewhere. Both must be of the
    /// kind that was saved; the state of a controller does not name its kind.
    ///
    /// # Errors
    /// As [`Simulation::resume`].
    pub fn resume_from_parts(
        scenario: &'a Scenario,
        saved: &SavedRun,
        keep: Keep,
        mut controller: Box<dyn Controller>,
        backend: Box<dyn Backend>,
    ) -> Result<Self, RestoreError> {
        saved.check(scenario)?;
        if keep == Keep::Trace && saved.keep == Keep::Outcome {
            return Err(RestoreError("it kept no trace, and one is asked for".into()));
        }
        controller.restore(&saved.controller)?;
        let mut resumed = Self::from_parts(scenario, &saved.options, keep, controller, backend).with_rows_per_period(saved.n_parts);
        resumed.backend.restore(&saved.backend)?;
        resumed.tips = attached_tips(scenario, resumed.backend.as_ref());
        resumed.clock.tick = saved.tick;
        resumed.clock.time = saved.time;
        resumed.check_instant()?;
        resumed.controller.check(saved.tick, saved.time, &resumed.tips)?;
        resumed.finished = saved.finished;
        resumed.totals = saved.totals.clone();
        resumed.trace = saved.trace.clone();
        resumed.keeps_companion = !saved.trace.companion.is_empty();
        Ok(resumed)
    }

    /// # Errors
    /// When the time is not in the control period of the tick.
    fn check_instant(&self) -> Result<(), RestoreError> {
        let Clock { tick, time, .. } = self.clock;
        if !self.clock.is_in_period() {
            return Err(RestoreError(format!("a time of {time} s, which is not in the control period after tick {tick}")));
        }
        Ok(())
    }
}
