//! A benchmark for programs: one object, and flat rows for tables.

use serde::Serialize;

use crate::studies::bench::{
    Effort, EqualError, GrowthPoint, Host, Level, MOST_SPREAD, Measured, NOISY_SHARE, Row, SceneFacts, SolverRow, Timing, equal_errors,
    fits, is_noisy,
};
use crate::studies::bench::{Fit, Solver};

/// What `bench --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Benchmark {
    pub host: Host,
    pub effort: Effort,
    pub noise: Noise,
    pub warnings: Vec<String>,
    pub wall_s: f64,
    pub scenes: Vec<SceneFacts>,
    pub rows: Vec<BenchLine>,
    pub equal_error: Vec<EqualError>,
    pub solvers: Vec<SolverLine>,
    /// Time of clarabel with its data updated over that of the exact solver (1), of the problems in
    /// which the load moves; `null` where they were not asked.
    pub clarabel_over_exact: Option<f64>,
    pub growth: Vec<GrowthLine>,
    pub fits: Vec<FitLine>,
}

/// Whether times may be compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Timed settings, and those of them whose median is too far above the least time.
    pub n_timings: usize,
    pub n_spread: usize,
    /// What too far is (1), and the share of such timings from which on nothing should be concluded
    /// (1).
    pub most_spread: f64,
    pub noisy_share: f64,
    pub is_noisy: bool,
}

/// A setting. A column of `bench.csv` each, in this order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchLine {
    pub scene: String,
    pub method: String,
    pub step_s: Option<f64>,
    pub tolerance_m: Option<f64>,
    pub error_max_m: Option<f64>,
    pub error_final_m: Option<f64>,
    /// Over the length of the path (1).
    pub error_max_share: Option<f64>,
    pub error_final_share: Option<f64>,
    pub cpu_min_s: Option<f64>,
    pub cpu_median_s: Option<f64>,
    pub spread: Option<f64>,
    pub n_runs: usize,
    pub n_steps: u64,
    pub n_solves: u64,
    pub n_not_converged: u64,
    /// Why the setting did not succeed; empty if it did.
    pub cause: Option<String>,
    pub reference: Option<String>,
    pub reference_error_m: Option<f64>,
    pub path_length_m: Option<f64>,
}

/// A solver on a sequence of problems. A column of `solvers.csv` each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SolverLine {
    pub problems: &'static str,
    pub solver: &'static str,
    pub n_problems: usize,
    pub residual_median: f64,
    pub residual_max: f64,
    pub cpu_min_s: Option<f64>,
    pub cpu_median_s: Option<f64>,
    pub spread: Option<f64>,
    pub n_runs: usize,
    /// Over the exact solver (1).
    pub over_exact: Option<f64>,
}

/// Cost at one size. A column of `growth.csv` each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GrowthLine {
    pub quantity: &'static str,
    pub backend: &'static str,
    pub n: usize,
    /// A step, or a tick of ants (s).
    pub cpu_min_s: Option<f64>,
    pub cpu_median_s: Option<f64>,
    pub spread: Option<f64>,
    pub n_runs: usize,
}

/// How a cost grows. A column of `fits.csv` each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitLine {
    pub quantity: &'static str,
    pub backend: &'static str,
    /// Over sizes from a thirtieth of the largest on (1).
    pub exponent: Option<f64>,
    pub exponent_error: Option<f64>,
    /// Line over all sizes (s, s per one more).
    pub offset_s: Option<f64>,
    pub slope_s: Option<f64>,
    pub slope_error_s: Option<f64>,
}

impl Benchmark {
    pub fn new(host: Host, effort: Effort, found: &Measured, wall_s: f64) -> Self {
        let rows: Vec<&Row> = found.rows.iter().collect();
        let timings = timings(found);
        let solvers = solver_lines(&found.solvers);
        let ratio = |line: &&SolverLine| line.problems == "moving" && line.solver == Solver::ClarabelUpdated.name();
        let noise = Noise {
            n_timings: timings.len(),
            n_spread: timings.iter().filter(|timing| timing.spread > MOST_SPREAD).count(),
            most_spread: MOST_SPREAD,
            noisy_share: NOISY_SHARE,
            is_noisy: is_noisy(&timings),
        };
        Self {
            warnings: warnings(&host, &noise),
            host,
            effort,
            noise,
            wall_s,
            scenes: found.scenes.clone(),
            rows: rows.iter().map(|row| BenchLine::of(row, found.scenes.iter().find(|facts| facts.scene == row.scene))).collect(),
            equal_error: equal_errors(&found.rows),
            clarabel_over_exact: solvers.iter().find(ratio).and_then(|line| line.over_exact),
            solvers,
            growth: found.growth.iter().map(GrowthLine::of).collect(),
            fits: fits(&found.growth).iter().map(FitLine::of).collect(),
        }
    }
}

fn timings(found: &Measured) -> Vec<Timing> {
    let rows = found.rows.iter().filter_map(Row::timing);
    let solvers = found.solvers.iter().filter_map(SolverRow::timing);
    rows.chain(solvers).chain(found.growth.iter().filter_map(GrowthPoint::timing)).collect()
}

fn warnings(host: &Host, noise: &Noise) -> Vec<String> {
    let mut warnings = Vec::new();
    if noise.is_noisy {
        warnings.push(format!(
            "{} of {} median times are more than {} times the least: the machine was too busy for a conclusion; run again when it is idle",
            noise.n_spread, noise.n_timings, noise.most_spread
        ));
    }
    if !host.is_optimised {
        warnings.push("built without optimisation: times say nothing of a release build".to_owned());
    }
    warnings
}

impl BenchLine {
    fn of(row: &Row, facts: Option<&SceneFacts>) -> Self {
        let timing = row.timing();
        let path_length_m = facts.map(|facts| facts.path_length_m);
        let has_inertia = row.method().kind.has_inertia();
        let share = |error: f64| path_length_m.map(|length| error / length);
        let (reference, reference_error_m) = match facts {
            Some(facts) if !has_inertia => (facts.quasi_static_reference.clone(), facts.quasi_static_reference_error_m),
            Some(facts) => (Some(facts.inertial_reference.clone()), Some(facts.inertial_reference_error_m)),
            None => (None, None),
        };
        Self {
            scene: row.scene.clone(),
            method: row.method.clone(),
            step_s: if let Level::Step(step) = row.level { Some(step) } else { None },
            tolerance_m: if let Level::Tolerance(tolerance) = row.level { Some(tolerance) } else { None },
            error_max_m: row.errors_m.map(|errors| errors[0]),
            error_final_m: row.errors_m.map(|errors| errors[1]),
            error_max_share: row.errors_m.and_then(|errors| share(errors[0])),
            error_final_share: row.errors_m.and_then(|errors| share(errors[1])),
            cpu_min_s: timing.map(|timing| timing.min_s),
            cpu_median_s: timing.map(|timing| timing.median_s),
            spread: timing.map(|timing| timing.spread),
            n_runs: row.seconds.len(),
            n_steps: row.n_steps,
            n_solves: row.n_solves,
            n_not_converged: row.n_not_converged,
            cause: row.cause(),
            reference,
            reference_error_m,
            path_length_m,
        }
    }
}

fn solver_lines(rows: &[SolverRow]) -> Vec<SolverLine> {
    let least = |row: &SolverRow| row.timing().map(|timing| timing.min_s);
    let exact = |row: &SolverRow| rows.iter().find(|other| other.sequence == row.sequence && other.solver == Solver::Exact).and_then(least);
    let line = |row: &SolverRow| SolverLine {
        problems: row.sequence.name(),
        solver: row.solver.name(),
        n_problems: row.n_problems,
        residual_median: row.residual_median,
        residual_max: row.residual_max,
        cpu_min_s: least(row),
        cpu_median_s: row.timing().map(|timing| timing.median_s),
        spread: row.timing().map(|timing| timing.spread),
        n_runs: row.seconds.len(),
        over_exact: least(row).zip(exact(row)).map(|(own, exact)| own / exact),
    };
    rows.iter().map(line).collect()
}

impl GrowthLine {
    fn of(point: &GrowthPoint) -> Self {
        let timing = point.timing();
        Self {
            quantity: point.quantity.name(),
            backend: point.backend.name(),
            n: point.n,
            cpu_min_s: timing.map(|timing| timing.min_s),
            cpu_median_s: timing.map(|timing| timing.median_s),
            spread: timing.map(|timing| timing.spread),
            n_runs: point.seconds.len(),
        }
    }
}

impl FitLine {
    fn of(fit: &Fit) -> Self {
        Self {
            quantity: fit.quantity.name(),
            backend: fit.backend.name(),
            exponent: fit.power_law.map(|law| law.exponent),
            exponent_error: fit.power_law.and_then(|law| law.exponent_error),
            offset_s: fit.line.map(|line| line.offset),
            slope_s: fit.line.map(|line| line.slope),
            slope_error_s: fit.line.and_then(|line| line.slope_error),
        }
    }
}
