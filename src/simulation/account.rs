//! The account that a run gives of itself: whether its numbers can be trusted, and why not.
//!
//! A run is ok, doubtful or failed. [`super::rules`] decides it. Whoever reports a run reads the
//! account and decides nothing of its own.

use serde::{Deserialize, Serialize};

/// Whether the numbers of a run can be trusted. The order is that of severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Health {
    /// No rule found anything.
    #[default]
    Ok,
    /// Something was found that may make the numbers wrong.
    Doubtful,
    /// The run ended early, its numbers are wrong, or it missed the tolerance that was asked for.
    Failed,
}

/// What a rule looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    Squeezed,
    NoSolution,
    ToleranceMissed,
    BoundNotKnown,
    NotSolved,
    EngineNotSolved,
    EnergyGained,
    LedgerOpen,
    EnergyLost,
    StepsTooLong,
    UnresolvedOscillation,
    TipNearRoot,
    Overlap,
    NotUnique,
    LostDigits,
}

/// What a rule says of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    pub cause: Cause,
    pub health: Health,
    /// The measure of the rule, in its unit.
    pub found: f64,
    /// Start of the first advance in which it was found (s), where the backend reports it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub since_s: Option<f64>,
}

/// Whether the numbers of a run can be trusted, and what was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Account {
    pub health: Health,
    /// Energy that appeared from nowhere over the energy turned over (1), negative where it
    /// vanished; without inertia beyond the error of the work in steps of that length.
    #[serde(default)]
    pub defect_share: f64,
    /// Estimated error of the pose by the length of the steps, at the edge of the load (m): see
    /// [`super::Resolution::step_error_m`]. Only for fixed steps with inertia.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_error_m: Option<f64>,
    /// In the order of the rules.
    #[serde(default)]
    pub findings: Vec<Finding>,
}

impl Account {
    /// Whether energy appeared from nowhere.
    pub fn gained_energy(&self) -> bool {
        self.findings.iter().any(|finding| matches!(finding.cause, Cause::EnergyGained | Cause::LedgerOpen))
    }
}
