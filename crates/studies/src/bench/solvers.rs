//! The exact solver against clarabel on the friction problems of a run, in their order.

use serde::{Deserialize, Serialize};

use super::clock::{Timing, time_of};
use super::problems::{Problem, kkt_residual};
use crate::variants::names;
use cohaul::backend::friction::FrictionSolver;
use cohaul::backend::friction::clarabel::ClarabelSolver;
use cohaul::math::{Vec2, Vec3};
use cohaul::scenario::Scenario;

/// What a solver makes of a sequence of problems.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolverRow {
    pub sequence: Sequence,
    pub solver: Solver,
    pub n_problems: usize,
    /// Residual of the optimality conditions, the same measure for all (1).
    pub residual_median: f64,
    pub residual_max: f64,
    /// CPU time a problem of each timed pass (s).
    pub seconds: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sequence {
    /// All of a run in which a spring is held.
    All,
    /// Those of them in which the load moves.
    Moving,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// The exact one, from its last answer.
    Exact,
    /// Clarabel, with new numbers in the same solver.
    ClarabelUpdated,
    /// Clarabel, built anew for every problem.
    ClarabelBuilt,
}

impl Solver {
    pub const ALL: [Solver; 3] = [Solver::Exact, Solver::ClarabelUpdated, Solver::ClarabelBuilt];

    pub fn name(self) -> &'static str {
        match self {
            Solver::Exact => "exact, warm",
            Solver::ClarabelUpdated => "clarabel, data updated",
            Solver::ClarabelBuilt => "clarabel, built anew",
        }
    }
}

impl Sequence {
    pub fn name(self) -> &'static str {
        names::<Self>()[self as usize]
    }
}

/// Both sequences of `problems`.
pub fn sequences(scenario: &Scenario, problems: &[Problem]) -> [(Sequence, Vec<Problem>); 2] {
    let mut solver = FrictionSolver::new(&scenario.system.ground, scenario.system.load.radius);
    let moves = |problem: &&Problem| solver.solve(&problem.hessian, &problem.drive).increment != Vec3::zeros();
    let moving = problems.iter().filter(moves).copied().collect();
    [(Sequence::All, problems.to_vec()), (Sequence::Moving, moving)]
}

impl SolverRow {
    /// Residuals; no times yet.
    pub fn of(scenario: &Scenario, sequence: Sequence, solver: Solver, problems: &[Problem]) -> Self {
        let (ground, length) = (&scenario.system.ground, scenario.system.load.radius);
        let mut residuals = Vec::with_capacity(problems.len());
        pass(scenario, solver, problems, |problem, increment, forces| {
            residuals.push(kkt_residual(ground, length, problem, increment, &forces()));
        });
        residuals.sort_by(f64::total_cmp);
        let residual_median = residuals.get(residuals.len() / 2).copied().unwrap_or_default();
        let residual_max = residuals.last().copied().unwrap_or_default();
        Self { sequence, solver, n_problems: problems.len(), residual_median, residual_max, seconds: Vec::new() }
    }

    /// CPU time a problem of one pass over the problems (s).
    pub fn time(&self, scenario: &Scenario, problems: &[Problem]) -> f64 {
        let seconds = time_of(|| {
            pass(scenario, self.solver, problems, |_, increment, _| {
                std::hint::black_box(increment);
            });
        });
        seconds / problems.len().max(1) as f64
    }

    pub fn timing(&self) -> Option<Timing> {
        Timing::of(&self.seconds)
    }

    /// Least time over that of the exact solver on the same problems, among `rows` (1).
    pub fn over_exact(&self, rows: &[SolverRow]) -> Option<f64> {
        let exact = rows.iter().find(|other| other.sequence == self.sequence && other.solver == Solver::Exact)?;
        Some(self.timing()?.min_s / exact.timing()?.min_s)
    }
}

/// Solves all problems in turn; `see` gets each with its increment, and its friction resistances if
/// it asks.
fn pass(scenario: &Scenario, solver: Solver, problems: &[Problem], mut see: impl FnMut(&Problem, &Vec3, &dyn Fn() -> Vec<Vec2>)) {
    let (ground, length) = (&scenario.system.ground, scenario.system.load.radius);
    let mut exact = FrictionSolver::new(ground, length);
    let mut clarabel = ClarabelSolver::new(ground, length);
    for problem in problems {
        let Problem { hessian, drive } = problem;
        if solver == Solver::Exact {
            let increment = exact.solve(hessian, drive).increment;
            see(problem, &increment, &|| exact.forces().iter().map(|force| -force).collect());
        } else {
            if solver == Solver::ClarabelBuilt {
                clarabel = ClarabelSolver::new(ground, length);
            }
            let increment = clarabel.friction_solution(hessian, drive).increment;
            see(problem, &increment, &|| clarabel.forces());
        }
    }
}
