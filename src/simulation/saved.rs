//! Saving a run and resuming it: the resumed run equals the uninterrupted one to the bit.

use serde::{Deserialize, Serialize};

use super::clock::Clock;
use super::controllers::{Controller, controller_of};
use super::run::{Simulation, attached_tips, backend_of};
use super::trace::{Keep, Totals, Trace};
use crate::backend::{Backend, BackendOptions, RestoreError, SaveError, SavedState, Tolerance};
use crate::scenario::Scenario;

/// Version of this program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Format of a saved run (1). It changes with the meaning of any field.
const FORMAT: u32 = 1;

/// Shortest step over the control period (1): a period of more steps takes minutes.
const SHORTEST_STEP: f64 = 1e-9;
/// Largest count in the totals of a run (1): far from the end of whole numbers, and more than any
/// run adds up.
const MOST_COUNTED: u64 = 1 << 60;
/// Largest number of rows in a control period (1).
const MOST_PARTS: u64 = 1_000_000;

/// State of a run. It holds all that does not follow from the scenario, with every digit. Only the
/// version of the program that saved it resumes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
    format: u32,
    /// Version of the program that saved the run.
    version: String,
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
            trace: self.trace.clone(),
        })
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

impl SavedRun {
    /// # Errors
    /// When the state is of another format, version or scenario, or when no backend can be built
    /// from its options.
    fn check(&self, scenario: &Scenario) -> Result<(), RestoreError> {
        let refused = |why: String| Err(RestoreError(why));
        if (self.format, self.version.as_str()) != (FORMAT, VERSION) {
            let (format, version) = (self.format, &self.version);
            return refused(format!("it was saved by version {version} in format {format}, this is version {VERSION}, format {FORMAT}"));
        }
        let hash = scenario.hash();
        if self.scenario_hash != hash {
            return refused(format!("it was saved from the scenario {}, this one is {hash}", self.scenario_hash));
        }
        let BackendOptions { kind, step_s, tolerance, .. } = self.options;
        if let Some(tolerance) = tolerance {
            if !kind.is_exact() {
                return refused(format!("a tolerance {}", kind.tolerance_rule()));
            }
            let Tolerance { position_m, heading_rad, .. } = tolerance;
            if ![position_m, heading_rad].into_iter().all(|size| size > 0.0 && size.is_finite()) {
                return refused(format!("a tolerance of {position_m} m and {heading_rad} rad"));
            }
        }
        // A step is infinite under error control only.
        let is_possible = step_s >= SHORTEST_STEP * scenario.control_period && (step_s.is_finite() || tolerance.is_some());
        if !is_possible {
            return refused(format!("a step of {step_s} s at a control period of {} s", scenario.control_period));
        }
        if self.n_parts > MOST_PARTS {
            return refused(format!("{} rows in a control period", self.n_parts));
        }
        let totals = serde_json::to_value(&self.totals).expect("totals are plain data");
        match largest_count(&totals) {
            count if count > MOST_COUNTED => refused(format!("a count of {count} in its totals")),
            _ => Ok(()),
        }
    }
}

/// The largest whole number in a value.
fn largest_count(value: &serde_json::Value) -> u64 {
    match value {
        serde_json::Value::Object(map) => map.values().map(largest_count).fold(0, u64::max),
        serde_json::Value::Array(list) => list.iter().map(largest_count).fold(0, u64::max),
        other => other.as_u64().unwrap_or_default(),
    }
}
