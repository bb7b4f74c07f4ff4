//! The rules by which a run gives an account of itself.
//!
//! [`RULES`] is the one table that decides whether a run is ok, doubtful or failed. The measures
//! come from what the backend reports of its steps, and from the energy ledger.

use super::{Account, Cause, Finding, Health, Outcome};
use crate::backend::{BackendOptions, Status};
use crate::scenario::Scenario;

/// A row of the table: a measure of the run, and what it means where it is large.
pub struct Rule {
    pub cause: Cause,
    /// What is measured, as a clause that ends before the number.
    pub measure: &'static str,
    /// Unit of the measure; empty for a share or a count.
    pub unit: &'static str,
    /// The run is doubtful where the measure is larger.
    pub doubtful: f64,
    /// The run has failed where the measure is larger.
    pub failed: f64,
    /// What happened, for a warning.
    pub means: &'static str,
    /// What to do about it.
    pub cure: &'static str,
    get: fn(&Facts) -> f64,
}

/// What the measures are taken from.
#[derive(Clone, Copy)]
struct Facts<'a> {
    scenario: &'a Scenario,
    options: &'a BackendOptions,
    outcome: &'a Outcome,
}

/// Path length over the load's radius below which errors are compared with this share (1): a load
/// that moves less is nearly at rest, and the first step decides how far it comes.
const LEAST_PATH: f64 = 0.01;

/// Every rule, in the order of reports.
///
/// The limits for inertia and the engine are set on the maps of `cohaul stress`: few runs beyond
/// them are right within a tenth of their path, and few others are wrong.
pub const RULES: [Rule; 15] = [
    Rule {
        cause: Cause::Squeezed,
        measure: "number of obstacles",
        unit: "",
        doubtful: 0.0,
        failed: 0.0,
        means: "no step keeps the load out of the obstacles that press on it, and the run ended there",
        cure: "look at the scene at that time: an obstacle with a path gives way to nothing",
        get: |facts| facts.outcome.transitions.n_squeezes as f64,
    },
    Rule {
        cause: Cause::NoSolution,
        measure: "",
        unit: "",
        doubtful: 0.0,
        failed: 0.0,
        means: "a step had no finite solution, and the run ended there",
        cure: "use a shorter step, and look at the scene at that time",
        get: |facts| f64::from(u8::from(facts.outcome.steps.status == Status::Failed && facts.outcome.transitions.n_squeezes == 0)),
    },
    Rule {
        cause: Cause::ToleranceMissed,
        measure: "error bound over tolerance",
        unit: "",
        doubtful: 1.0,
        failed: 1.0,
        means: "the error bound exceeds the tolerance",
        cure: "use a larger tolerance, or fixed steps",
        get: |facts| facts.error_over_tolerance(),
    },
    Rule {
        cause: Cause::BoundNotKnown,
        measure: "share of macro-steps",
        unit: "",
        doubtful: 0.0,
        failed: 0.0,
        means: "macro-steps did not converge, so that the error bound is not known",
        cure: "compare it with fixed steps",
        get: |facts| if facts.options.tolerance.is_some() { facts.share_not_converged() } else { 0.0 },
    },
    Rule {
        cause: Cause::NotSolved,
        measure: "largest residual times share of steps",
        unit: "",
        doubtful: 1e-3,
        failed: 5e-3,
        means: "steps did not converge",
        cure: "use a shorter step",
        get: |facts| if facts.options.kind.is_exact() { facts.not_solved() } else { 0.0 },
    },
    Rule {
        cause: Cause::EngineNotSolved,
        measure: "share of the path with unsolved forces",
        unit: "",
        doubtful: 0.03,
        failed: 0.5,
        means: "steps of the engine did not converge",
        cure: "use a shorter step, or more iterations of the engine",
        get: |facts| if facts.options.kind.is_exact() { 0.0 } else { facts.of_path(facts.outcome.resolution.unsolved_m) },
    },
    Rule {
        cause: Cause::EnergyGained,
        measure: "share of the energy turned over",
        unit: "",
        doubtful: 0.05,
        failed: 0.5,
        means: "energy appeared from nowhere",
        cure: "use a shorter step, or --tolerance",
        get: |facts| if facts.options.kind.has_inertia() { facts.gained().max(0.0) } else { 0.0 },
    },
    Rule {
        cause: Cause::LedgerOpen,
        measure: "gain beyond the error of the work, over the largest entry",
        unit: "",
        doubtful: 0.01,
        failed: 0.5,
        means: "energy appeared without inertia",
        cure: "use a shorter step, or --tolerance",
        get: |facts| if facts.options.kind.has_inertia() { 0.0 } else { facts.gained_beyond_work() },
    },
    Rule {
        cause: Cause::EnergyLost,
        measure: "share of the energy turned over",
        unit: "",
        doubtful: 0.1,
        failed: 0.9,
        means: "energy vanished",
        cure: "use a shorter step, or --tolerance",
        get: |facts| if facts.options.kind.has_inertia() { (-facts.gained()).max(0.0) } else { 0.0 },
    },
    Rule {
        cause: Cause::StepsTooLong,
        measure: "estimated step error over the path length",
        unit: "",
        doubtful: 0.8,
        failed: f64::INFINITY,
        means: "the steps are too long for the motion",
        cure: "use a shorter step, or --tolerance",
        get: |facts| facts.of_path(facts.outcome.resolution.step_error_m(facts.options)),
    },
    Rule {
        cause: Cause::UnresolvedOscillation,
        measure: "angle in a step",
        unit: "rad",
        doubtful: 1.0,
        failed: f64::INFINITY,
        means: "the shortest default step does not resolve the springs as attached",
        cure: "use --tolerance, or a shorter --step-s",
        get: |facts| facts.outcome.steps.unresolved_rad,
    },
    Rule {
        cause: Cause::TipNearRoot,
        measure: "turn of a spring in a step",
        unit: "rad",
        doubtful: 0.5,
        failed: f64::INFINITY,
        means: "a tip passes close to the root of its spring",
        cure: "use a shorter step, or --tolerance",
        get: |facts| if facts.options.kind.has_inertia() { 0.0 } else { facts.outcome.steps.swing_rad },
    },
    Rule {
        cause: Cause::Overlap,
        measure: "depth",
        unit: "m",
        doubtful: 0.0,
        failed: f64::INFINITY,
        means: "the load lay inside an obstacle after a step",
        cure: "use a shorter step",
        get: |facts| facts.outcome.steps.doubts.overlap_m,
    },
    Rule {
        cause: Cause::NotUnique,
        measure: "number of steps",
        unit: "",
        doubtful: 0.0,
        failed: f64::INFINITY,
        means: "the motion is not unique: another one was admissible",
        cure: "less friction at the obstacles makes it unique",
        get: |facts| facts.outcome.steps.doubts.n_not_unique as f64,
    },
    Rule {
        cause: Cause::LostDigits,
        measure: "share of the path",
        unit: "",
        doubtful: 0.1,
        failed: f64::INFINITY,
        means: "single precision lost a part of the path by rounding",
        cure: "use a longer step or double precision",
        get: |facts| facts.outcome.steps.lost_share,
    },
];

impl Rule {
    /// What the rule says of a run; `None` if nothing.
    fn finding(&self, facts: &Facts) -> Option<Finding> {
        let found = (self.get)(facts);
        let health = match found {
            _ if found.is_nan() || found > self.failed => Health::Failed,
            _ if found > self.doubtful => Health::Doubtful,
            _ => return None,
        };
        let doubtful = &facts.outcome.doubtful;
        let since_s = match self.cause {
            Cause::Squeezed | Cause::NoSolution => facts.outcome.failed_at,
            Cause::BoundNotKnown | Cause::NotSolved | Cause::EngineNotSolved => doubtful.not_converged_s,
            Cause::Overlap => doubtful.overlap_s,
            Cause::NotUnique => doubtful.not_unique_s,
            _ => None,
        };
        Some(Finding { cause: self.cause, health, found: found.min(f64::MAX), since_s })
    }
}

impl Finding {
    /// The rule that found it.
    ///
    /// # Panics
    /// Never: each cause has a rule.
    pub fn rule(&self) -> &'static Rule {
        RULES.iter().find(|rule| rule.cause == self.cause).expect("each cause has a rule")
    }
}

impl Facts<'_> {
    fn error_over_tolerance(&self) -> f64 {
        let (options, outcome) = (self.options, self.outcome);
        options.tolerance.zip(outcome.error).map_or(0.0, |(asked, error)| {
            let shares = [error.position / asked.position_m, error.heading / asked.heading_rad];
            shares.into_iter().fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
        })
    }

    fn share_not_converged(&self) -> f64 {
        let steps = &self.outcome.steps;
        steps.n_not_converged as f64 / steps.n_steps.max(1) as f64
    }

    fn not_solved(&self) -> f64 {
        let steps = &self.outcome.steps;
        if steps.n_not_converged == 0 || steps.status == Status::Failed { 0.0 } else { steps.residual * self.share_not_converged() }
    }

    /// Energy gained from nowhere over the largest entry of the ledger (1), negative if lost. A run
    /// of rapier knows more of its energies: it says itself what it gained beyond what its steps
    /// explain, over the energy that went in.
    fn gained(&self) -> f64 {
        let (steps, energy) = (&self.outcome.steps, &self.outcome.energy);
        if !self.options.kind.is_exact() {
            return steps.gained_share;
        }
        let size = energy.largest_entry();
        if size > 0.0 { (energy.defect() + energy.jumps) / size } else { 0.0 }
    }

    /// Energy that a run without inertia gained over the largest entry of the ledger (1). Its work
    /// is that of the trapezoid rule, whose error the backend bounds at fixed steps.
    fn gained_beyond_work(&self) -> f64 {
        let energy = &self.outcome.energy;
        let (gain, size) = (energy.defect() + energy.jumps - self.outcome.steps.work_error_j, energy.largest_entry());
        if gain > 0.0 { gain / size } else { 0.0 }
    }

    /// Energy that appeared from nowhere (1), negative where it vanished. Without inertia it is
    /// that beyond the error of the work.
    fn defect_share(&self) -> f64 {
        let gained = self.gained();
        if self.options.kind.has_inertia() || gained < 0.0 { gained } else { self.gained_beyond_work() }
    }

    /// A length over the path length (1), or over a hundredth of the radius of a load that moves
    /// less.
    fn of_path(&self, length: f64) -> f64 {
        let least = LEAST_PATH * self.scenario.system.load.radius;
        length / self.outcome.resolution.path_length_m.max(least)
    }
}

impl Account {
    /// The account of a run of `scenario` with these options that ended so.
    pub fn of(scenario: &Scenario, options: &BackendOptions, outcome: &Outcome) -> Self {
        let facts = Facts { scenario, options, outcome };
        let findings: Vec<Finding> = RULES.iter().filter_map(|rule| rule.finding(&facts)).collect();
        let health = findings.iter().map(|finding| finding.health).max().unwrap_or_default();
        let has_estimate = options.kind.has_inertia() && options.tolerance.is_none();
        let defect_share = facts.defect_share().clamp(-f64::MAX, f64::MAX);
        Self { health, defect_share, step_error_m: has_estimate.then(|| outcome.resolution.step_error_m(options)), findings }
    }

    /// The worst finding, of several the first; `None` for a run that is ok.
    pub fn worst(&self) -> Option<&Finding> {
        self.findings.iter().rev().max_by_key(|finding| finding.health)
    }
}
