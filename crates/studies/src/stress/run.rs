//! One run of a cell on one method, and its numbers.

use serde::{Deserialize, Serialize};

use super::guard::guarded;
use super::map::Answer;
use super::observer::{Observer, Seen};
use crate::methods::Method;
use cohaul::backend::{Motion, Shared, Status};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Account, Keep, MakeBackend, Simulation, controller_of};

/// Steps times joints that a run may cost: seconds. Counted before it starts, so that the same
/// cells are too long everywhere.
const MOST_WORK: f64 = 2e5;
/// Steps times joints that a run at an eighth of the step may cost.
const MOST_FINER_WORK: f64 = 4e5;
/// Newton iterations that a run may cost.
const MOST_ITERATIONS: u64 = 2_000_000;
/// The exact reference takes a step this many times shorter.
const FINER: f64 = 8.0;

/// A run that came to its end, or as far as its budget.
#[derive(Clone, Debug)]
pub struct Run {
    pub seen: Seen,
    pub end: Motion,
    pub ledger: cohaul::backend::EnergyLedger,
    /// Whether the run itself says that its numbers can be trusted.
    pub account: Account,
    /// Spent more than its budget of iterations.
    pub is_cut: bool,
    /// Fault of the clock or of the tips.
    pub lost: Option<String>,
}

/// Numbers of a cell; `None` where there is none, or where one has no finite value, which is an
/// outcome of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Largest of all steps (1).
    pub residual: Option<f64>,
    /// Steps that did not converge over all steps (1).
    pub not_converged_share: Option<f64>,
    /// Energy that appeared from nowhere (J), and over all that was turned over (1).
    pub defect_j: Option<f64>,
    pub defect_share: Option<f64>,
    /// Largest edge displacement where nothing may move, over the radius of the load (1).
    pub creep_radii: Option<f64>,
    /// Largest displacement across the axis of a symmetric scene, over that along it (1).
    pub drift_share: Option<f64>,
    /// Edge displacement from the known answer, over the path length (1).
    pub error_share: Option<f64>,
    /// Step in radians of the fastest oscillation (1).
    pub step_radians: Option<f64>,
    /// Shortest distance of a tip from its root over the rest length (1), and largest swing (rad).
    pub shortest_share: Option<f64>,
    pub swing_rad: Option<f64>,
    pub n_steps: u64,
    pub n_solves: u64,
    pub n_iterations: u64,
}

/// Steps times joints of a run (1).
pub fn work(scenario: &Scenario) -> f64 {
    let joints = scenario.system.ground.supports.len() + scenario.system.springs.len();
    (1 + joints) as f64 * scenario.duration / scenario.control_period
}

pub fn too_long(scenario: &Scenario) -> Option<String> {
    let work = work(scenario);
    (work > MOST_WORK).then(|| format!("{work:.0} solutions of joints are asked for, and the budget is {MOST_WORK}"))
}

/// The run of `scenario` at its control period as the step.
///
/// # Errors
/// The message of a panic.
pub fn run(scenario: &Scenario, method: Method, make: &MakeBackend) -> Result<Run, String> {
    run_at(scenario, method, scenario.control_period, make)
}

/// The run at an eighth of the step; `None` where that exceeds the budget or fails.
pub fn finer(scenario: &Scenario, method: Method, make: &MakeBackend) -> Option<Run> {
    if FINER * work(scenario) > MOST_FINER_WORK {
        return None;
    }
    let step = scenario.control_period / FINER;
    let run = run_at(scenario, method, step, make).ok()?;
    let is_whole = run.seen.not_finite.is_none() && run.seen.report.status != Status::Failed && !run.is_cut;
    is_whole.then_some(run)
}

fn run_at(scenario: &Scenario, method: Method, step: f64, make: &MakeBackend) -> Result<Run, String> {
    guarded(|| {
        let options = method.options(step);
        let (observer, seen) = Observer::around(make(scenario, &options), &scenario.system);
        let mut simulation = Simulation::from_parts(scenario, &options, Keep::Outcome, controller_of(scenario), observer);
        let spent = |seen: &Shared<Seen>| {
            let report = seen.borrow().report;
            report.n_iterations + report.n_solves
        };
        while !simulation.is_finished() && spent(&seen) <= MOST_ITERATIONS {
            simulation.step();
        }
        let (is_cut, outcome) = (!simulation.is_finished(), simulation.outcome());
        let seen = seen.borrow().clone();
        let late = (outcome.time - scenario.duration).abs() > 1e-9 * scenario.control_period;
        let lost = (late && !is_cut).then(|| format!("the clock stands at {} s at the end, not at {} s", outcome.time, scenario.duration));
        Run {
            account: outcome.account,
            lost: lost.or_else(|| seen.misplaced.clone()),
            end: outcome.motion,
            ledger: outcome.energy,
            is_cut,
            seen,
        }
    })
}

/// What the answer of a cell is measured against: a reference run, if it needs one and that can be
/// trusted.
pub fn reference(scenario: &Scenario, answer: &Answer, method: Method, make: &MakeBackend) -> Option<Run> {
    // The same scene in other units has the same sweeps, whether they converge or not.
    let (found, worst) = match answer {
        Answer::Unknown | Answer::Shift { .. } => return None,
        Answer::Finer => (finer(scenario, method.exact(), make)?, Status::Converged),
        Answer::Scaled { base, .. } => (run(base, method, make).ok()?, Status::NotConverged),
    };
    (found.seen.report.status <= worst && found.seen.not_finite.is_none()).then_some(found)
}

/// Edge displacement from the known answer over the path length (1); `None` where nothing is known.
pub fn error(scenario: &Scenario, answer: &Answer, method: Method, run: &Run, reference: Option<&Run>) -> Option<f64> {
    let radius = scenario.system.load.radius;
    let pose = &run.end.pose;
    let error = match answer {
        Answer::Unknown => return None,
        Answer::Shift { quasi_static, inertial, scale } => {
            let known = if method.kind.has_inertia() { inertial } else { quasi_static };
            (pose.position.x - known).abs() / scale
        }
        Answer::Finer | Answer::Scaled { .. } => {
            let reference = reference?;
            let unit = if let Answer::Scaled { length, .. } = answer { *length } else { 1.0 };
            let shift = (pose.position - unit * reference.end.pose.position).norm();
            let turn = radius * (pose.heading - reference.end.pose.heading).abs();
            // For a load that stays, a billionth of its radius counts as path length.
            (shift + turn) / (unit * reference.seen.rim).max(1e-9 * radius)
        }
    };
    error.is_finite().then_some(error)
}
