//! The state of a run as data.

use serde::{Deserialize, Serialize};

use super::trace::{Keep, Totals, Trace};
use crate::backend::{BackendOptions, SavedState};

/// State of a run. It holds all that does not follow from the scenario, with every digit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
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
}
