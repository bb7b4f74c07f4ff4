//! The state of a run as data.

use serde::{Deserialize, Serialize};

use super::trace::{Keep, Totals, Trace};
use crate::backend::{BackendOptions, RestoreError, SavedState, Tolerance};
use crate::formats::STATE;
use crate::scenario::Scenario;

/// Version of this program.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Format of a saved run (1). It changes with the meaning of any field.
pub(super) const FORMAT: u32 = STATE.version;

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
    pub(super) format: u32,
    /// Version of the program that saved the run.
    pub(super) version: String,
    /// Hash of the scenario, seed included: a run resumes in its own scenario only.
    pub scenario_hash: String,
    pub options: BackendOptions,
    pub(super) tick: u64,
    pub(super) time: f64,
    #[serde(default)]
    pub(super) n_parts: u64,
    pub(super) finished: bool,
    pub(super) keep: Keep,
    pub(super) totals: Totals,
    pub(super) controller: serde_json::Value,
    pub(super) backend: SavedState,
    pub(super) trace: Trace,
}

impl SavedRun {
    /// Time that the run had reached (s).
    pub fn time(&self) -> f64 {
        self.time
    }

    /// # Errors
    /// When the state is of another format, version or scenario, or when no backend can be built
    /// from its options.
    pub(super) fn check(&self, scenario: &Scenario) -> Result<(), RestoreError> {
        let refused = |why: String| Err(RestoreError::unreadable(why));
        if (self.format, self.version.as_str()) != (FORMAT, VERSION) {
            let (format, version) = (self.format, &self.version);
            return refused(format!(
                "it was saved by version {version} in format {format}, this is version {VERSION}, format {FORMAT} of {:?}",
                STATE.name
            ));
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
