//! Saving a run and resuming it: the resumed run equals the uninterrupted one to the bit.

use serde::{Deserialize, Serialize};

use super::controllers::{Controller, controller_of};
use super::run::{Simulation, attached_tips, backend_of};
use super::trace::{Keep, Totals, Trace};
use crate::backend::{Backend, BackendOptions, RestoreError, SaveError, SavedState};
use crate::scenario::Scenario;

/// State of a run. It holds all that does not follow from the scenario, with every digit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
    /// Hash of the scenario, seed included: a run resumes in its own scenario only.
    pub scenario_hash: String,
    pub options: BackendOptions,
    tick: u64,
    time: f64,
    #[serde(default)]
    n_parts: u64,
    finished: bool,
    keep: Keep,
    totals: Totals,
    controller: serde_json::Value,
    backend: SavedState,
    trace: Trace,
}

impl<'a> Simulation<'a> {
    /// State of the run so far, from which [`Simulation::resume`] continues.
    ///
    /// # Errors
    /// When the backend or the controller cannot be saved.
    pub fn save(&self) -> Result<SavedRun, SaveError> {
        Ok(SavedRun {
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
            trace: self.trace.clone(),
        })
    }

    /// Resumes a run of the scenario's own controller.
    ///
    /// # Errors
    /// When the state belongs to another scenario or is damaged, or when a trace is asked for and
    /// the run kept none.
    pub fn resume(scenario: &'a Scenario, saved: &SavedRun, keep: Keep) -> Result<Self, RestoreError> {
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
        let hash = scenario.hash();
        if saved.scenario_hash != hash {
            return Err(RestoreError(format!("it was saved from the scenario {}, this one is {hash}", saved.scenario_hash)));
        }
        if keep == Keep::Trace && saved.keep == Keep::Outcome {
            return Err(RestoreError("it kept no trace, and one is asked for".into()));
        }
        controller.restore(&saved.controller)?;
        let mut resumed = Self::from_parts(scenario, &saved.options, keep, controller, backend).with_rows_per_period(saved.n_parts);
        resumed.backend.restore(&saved.backend)?;
        resumed.tips = attached_tips(scenario, resumed.backend.as_ref());
        resumed.controller.check(saved.tick, &resumed.tips)?;
        resumed.clock.tick = saved.tick;
        resumed.clock.time = saved.time;
        resumed.finished = saved.finished;
        resumed.totals = saved.totals.clone();
        resumed.trace = saved.trace.clone();
        resumed.keeps_companion = !saved.trace.companion.is_empty();
        Ok(resumed)
    }
}
