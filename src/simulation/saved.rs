//! Saving a run and going on with it, bit for bit.

use serde::{Deserialize, Serialize};

use super::{Driver, Keep, Simulation, Trace, built, driver_of, held_by};
use crate::backend::{Backend, BackendOptions, PoseError, RestoreError, SaveError, SavedState, StepReport, TransitionCounts};
use crate::scenario::Scenario;

/// Everything of a run that its scenario does not say. Floats are written with all their digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
    /// Hash of the scenario, seed included: a state goes on in its own scenario only.
    pub scenario_hash: String,
    pub options: BackendOptions,
    tick: u64,
    time: f64,
    #[serde(default)]
    n_parts: u64,
    finished: bool,
    keep: Keep,
    steps: StepReport,
    error: Option<PoseError>,
    transitions: TransitionCounts,
    driver: serde_json::Value,
    backend: SavedState,
    trace: Trace,
}

impl Simulation<'_> {
    /// State of the run so far, from which [`Simulation::resume`] continues.
    ///
    /// # Errors
    /// When the backend cannot be saved.
    pub fn save(&self) -> Result<SavedRun, SaveError> {
        Ok(SavedRun {
            scenario_hash: self.scenario.hash(),
            options: self.options,
            tick: self.clock.tick,
            time: self.clock.time,
            n_parts: self.clock.n_parts,
            finished: self.finished,
            keep: self.keep,
            steps: self.steps,
            error: self.error,
            transitions: self.transitions,
            driver: self.driver.save(),
            backend: self.backend.save()?,
            trace: self.trace.clone(),
        })
    }
}

impl<'a> Simulation<'a> {
    /// Goes on where `saved` left off.
    ///
    /// # Errors
    /// When the state belongs to another scenario, is damaged, or kept no trace and now one is to be kept: its first part would be missing.
    pub fn resume(scenario: &'a Scenario, saved: &SavedRun, keep: Keep) -> Result<Self, RestoreError> {
        Self::resume_on(scenario, saved, keep, built(scenario, &saved.options))
    }

    /// The same on a backend made elsewhere, of the kind that the state was saved from.
    ///
    /// # Errors
    /// As [`Simulation::resume`].
    pub fn resume_on(scenario: &'a Scenario, saved: &SavedRun, keep: Keep, backend: Box<dyn Backend>) -> Result<Self, RestoreError> {
        Self::resume_driven(scenario, saved, keep, driver_of(scenario), backend)
    }

    /// The same with a driver other than the scenario's own, of the kind that the state was saved from: which one that was, a state does not say.
    ///
    /// # Errors
    /// As [`Simulation::resume`].
    pub fn resume_driven(
        scenario: &'a Scenario,
        saved: &SavedRun,
        keep: Keep,
        mut driver: Box<dyn Driver>,
        backend: Box<dyn Backend>,
    ) -> Result<Self, RestoreError> {
        let hash = scenario.hash();
        if saved.scenario_hash != hash {
            return Err(RestoreError(format!("it was saved from the scenario {}, this one is {hash}", saved.scenario_hash)));
        }
        if keep == Keep::Trace && saved.keep == Keep::Outcome {
            return Err(RestoreError("it kept no trace, and one is asked for".into()));
        }
        driver.restore(&saved.driver)?;
        let mut resumed = Self::on(scenario, &saved.options, keep, driver, backend).in_parts(saved.n_parts);
        resumed.backend.restore(&saved.backend)?;
        resumed.tips = held_by(scenario, resumed.backend.as_ref());
        resumed.driver.check(saved.tick, &resumed.tips)?;
        resumed.clock.tick = saved.tick;
        resumed.clock.time = saved.time;
        resumed.finished = saved.finished;
        resumed.steps = saved.steps;
        resumed.error = saved.error;
        resumed.transitions = saved.transitions;
        resumed.trace = saved.trace.clone();
        Ok(resumed)
    }
}
