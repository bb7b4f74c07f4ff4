//! Outcome of a run from its numbers. The rules, worst outcome first:
//!
//! | outcome | when |
//! |---|---|
//! | `panicked` | the run panicked |
//! | `not-finite` | a number of the backend is not finite at some step |
//! | `unexplained` | nothing explains the fault, or a clock or a tip is not where it was sent |
//! | `failed` | some step had no finite answer, and the backend said so |
//! | `too-long` | the run costs more than its budget of work |
//! | `energy-from-nowhere` | the account of the run finds it |
//! | `not-converged` | some step ended above its tolerance, and the backend said so |
//! | `creep` | the edge of a load that must stick moved by over 1e-9 of its radius |
//! | `drift` | a load left the axis of a symmetric scene by over 1e-3 of its displacement |
//! | `error` | the final error exceeds a tenth of the path length: no digit is right |
//! | `refused` | the scenario breaks a rule of the format |
//! | `finished` | none of these |

use serde::{Deserialize, Serialize};

use super::map::Asked;
use super::run::{Numbers, Run};
use crate::variants::names;
use cohaul::backend::Status;
use cohaul::scenario::Scenario;
use cohaul::simulation::Health;

/// How a cell ended. The order is that of severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    Finished,
    Refused,
    Error,
    Drift,
    Creep,
    NotConverged,
    EnergyFromNowhere,
    TooLong,
    Failed,
    Unexplained,
    NotFinite,
    Panicked,
}

impl Outcome {
    pub fn name(self) -> &'static str {
        names::<Self>()[self as usize]
    }

    /// What no scene may bring about: a defect of the program.
    pub fn is_defect(self) -> bool {
        self >= Outcome::Unexplained
    }
}

/// Edge displacement of a load that must stick, over its radius (1).
pub const MOST_CREEP: f64 = 1e-9;
/// Displacement across the axis over displacement along it (1).
pub const MOST_DRIFT: f64 = 1e-3;
/// Error over path length (1).
pub const MOST_ERROR: f64 = 0.1;
/// Displacement over the radius that counts at least, where an account is judged (1).
const LEAST_RIM: f64 = 0.01;
/// Displacement over the radius that counts at least in an error (1): see [`super::run::error`].
const LEAST_PATH: f64 = 1e-9;

/// Numbers and outcome of a run whose error is known or not.
pub fn judge(scenario: &Scenario, asked: &Asked, run: &Run, error: Option<f64>) -> (Outcome, Numbers) {
    let (seen, report) = (&run.seen, &run.seen.report);
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let defect = run.ledger.defect();
    let creep = asked.sticks.then(|| seen.rim / scenario.system.load.radius);
    let drift = asked.symmetric.then(|| seen.across / seen.along.max(MOST_CREEP * scenario.system.load.radius));
    let has_springs = seen.shortest.is_finite();
    let numbers = Numbers {
        residual: finite(report.residual),
        not_converged_share: finite(report.n_not_converged as f64 / report.n_steps.max(1) as f64),
        defect_j: finite(defect),
        defect_share: finite(defect / turnover(run).max(f64::MIN_POSITIVE)),
        creep_radii: creep.and_then(finite),
        drift_share: drift.and_then(finite),
        error_share: error.and_then(finite),
        step_radians: finite(step_radians(scenario)),
        shortest_share: finite(seen.shortest).filter(|_| has_springs),
        swing_rad: finite(seen.swing).filter(|_| has_springs),
        n_steps: report.n_steps,
        n_solves: report.n_solves,
        n_iterations: report.n_iterations,
    };
    let above = |value: Option<f64>, limit: f64| value.is_some_and(|value| value > limit);
    let outcome = match () {
        _ if seen.not_finite.is_some() => Outcome::NotFinite,
        _ if report.status == Status::Failed => Outcome::Failed,
        _ if run.lost.is_some() => Outcome::Unexplained,
        _ if run.is_cut => Outcome::TooLong,
        _ if run.account.gained_energy() => Outcome::EnergyFromNowhere,
        _ if report.status == Status::NotConverged => Outcome::NotConverged,
        _ if above(creep, MOST_CREEP) => Outcome::Creep,
        _ if above(drift, MOST_DRIFT) => Outcome::Drift,
        _ if above(error, MOST_ERROR) => Outcome::Error,
        _ => Outcome::Finished,
    };
    (outcome, numbers)
}

/// What a run said of itself, beside its error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Judged {
    pub health: Health,
    /// Whether the end is right to a tenth of the displacement, or of a hundredth of the radius of
    /// a load that moved less, and the energy ledger closes to a tenth.
    pub is_right: bool,
    /// Whether it is right to that, with the end to the step error that the run stated.
    pub is_as_stated: bool,
}

/// The account of a run beside its `error` over the displacement (1).
pub fn judged(scenario: &Scenario, run: &Run, error: f64) -> Judged {
    let allowed = MOST_ERROR * run.seen.rim.max(LEAST_RIM * scenario.system.load.radius);
    let error = error * run.seen.rim.max(LEAST_PATH * scenario.system.load.radius);
    let stated = run.account.step_error_m.unwrap_or_default().max(allowed);
    let closes = run.account.defect_share.abs() <= MOST_ERROR;
    Judged { health: run.account.health, is_right: closes && error <= allowed, is_as_stated: closes && error <= stated }
}

/// The step in radians of the fastest oscillation of the load on all its springs.
pub fn step_radians(scenario: &Scenario) -> f64 {
    scenario.system.fastest_rate() * scenario.control_period
}

/// Energy that was turned over in the ledger (J).
fn turnover(run: &Run) -> f64 {
    let ledger = &run.ledger;
    ledger.tip_work.abs() + ledger.initial + ledger.dissipated() + run.seen.peak_energy
}
