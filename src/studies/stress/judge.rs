//! Outcome of a run from its numbers. The rules, worst outcome first:
//!
//! | outcome | when |
//! |---|---|
//! | `panicked` | the run panicked |
//! | `not-finite` | a number of the backend is not finite at some step |
//! | `unexplained` | nothing explains the fault, or a clock or a tip is not where it was sent |
//! | `failed` | some step had no finite answer, and the backend said so |
//! | `too-long` | the run costs more than its budget of work |
//! | `energy-from-nowhere` | the positive defect exceeds [`allowed_defect`] |
//! | `not-converged` | some step ended above its tolerance, and the backend said so |
//! | `creep` | the edge of a load that must stick moved by over 1e-9 of its radius |
//! | `drift` | a load left the axis of a symmetric scene by over 1e-3 of its displacement |
//! | `error` | the final error exceeds a tenth of the path length: no digit is right |
//! | `refused` | the scenario breaks a rule of the format |
//! | `finished` | none of these |

use serde::{Deserialize, Serialize};

use super::map::Asked;
use super::run::{Numbers, Run};
use crate::backend::Status;
use crate::backend::increment::LARGEST_RESIDUAL;
use crate::scenario::Scenario;
use crate::studies::methods::Method;
use crate::studies::variants::names;

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
/// Share of the energy turned over that trapezoids may miss where a step does not resolve the
/// oscillation (1).
const MOST_QUADRATURE: f64 = 0.01;

/// Numbers and outcome of a run whose error is known or not.
pub fn judge(scenario: &Scenario, asked: &Asked, method: Method, run: &Run, error: Option<f64>) -> (Outcome, Numbers) {
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
        _ if defect > allowed_defect(scenario, method, run) => Outcome::EnergyFromNowhere,
        _ if report.status == Status::NotConverged => Outcome::NotConverged,
        _ if above(creep, MOST_CREEP) => Outcome::Creep,
        _ if above(drift, MOST_DRIFT) => Outcome::Drift,
        _ if above(error, MOST_ERROR) => Outcome::Error,
        _ => Outcome::Finished,
    };
    (outcome, numbers)
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

/// Positive defect (J) that rounding and quadrature explain:
///
/// * rounding: every step adds to sums as large as the turnover, and its forces know places to a
///   last digit of the load's and the tips';
/// * the residual with which the engine may end a step, as in an impact that turns over everything;
/// * work of tips and moving obstacles, a trapezoid: at most the change of the force times the
///   displacement, step by step;
/// * work on the load, a trapezoid along an oscillation: (omega h)^2 / 12 of what is turned over,
///   and no more than a hundredth where omega h is not small. Without inertia there is none. Rapier
///   with its engine defaults cuts a step in four, of which its forces are those of the last: omega
///   h in place of its square;
/// * friction with the ground in a step in which a load bounces, of the engine: it points against
///   the velocity after the bounce for the whole step;
/// * friction of the midpoint rule, which uses the direction at the end of a step for the whole
///   step: a hundredth of its loss, for a slip that turns by 0.35 rad in a step.
pub fn allowed_defect(scenario: &Scenario, method: Method, run: &Run) -> f64 {
    let digit = if method.options(1.0).is_single_precision() { f64::from(f32::EPSILON) } else { f64::EPSILON };
    let reach = run.seen.farthest + scenario.system.load.radius;
    let turned = turnover(run);
    let rounding = run.seen.report.n_steps.max(1) as f64 * digit * (turned + run.seen.peak_force * reach);
    let solved = if method.kind.is_exact() { 0.0 } else { LARGEST_RESIDUAL * turned };
    let radians = step_radians(scenario);
    let oscillation = match method {
        _ if !method.kind.has_inertia() => 0.0,
        _ if method.has_engine_defaults() => radians,
        _ => radians * radians / 12.0,
    };
    let turning = if method == Method::INERTIAL_MIDPOINT { MOST_QUADRATURE * run.ledger.friction } else { 0.0 };
    let bounces = if method.kind.is_exact() { 0.0 } else { run.seen.at_impacts * run.seen.speed };
    rounding + solved + run.seen.quadrature + bounces + oscillation.min(MOST_QUADRATURE) * turned + turning
}
