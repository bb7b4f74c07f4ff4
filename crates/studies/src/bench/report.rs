//! A benchmark for programs: one object, and its tables.

use serde::Serialize;

use crate::bench::{
    Effort, Ending, EqualError, GrowthPoint, Host, MOST_SPREAD, Measured, NOISY_SHARE, Row, SceneFacts, Sequence, Solver, SolverRow,
    Timing, equal_errors, fits, is_noisy,
};
use cohaul::analysis::compare::EngineName;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::table::Table;

/// What `bench --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Benchmark {
    pub host: Host,
    pub effort: Effort,
    /// Engines of the user, whose times are real times.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub engines: Vec<EngineName>,
    pub noise: Noise,
    pub warnings: Vec<String>,
    pub wall_s: f64,
    pub scenes: Vec<SceneFacts>,
    pub rows: Table,
    pub equal_error: Vec<EqualError>,
    pub solvers: Table,
    /// Time of clarabel with its data updated over that of the exact solver (1), of the problems in
    /// which the load moves; `null` where they were not asked.
    pub clarabel_over_exact: Option<f64>,
    pub growth: Table,
    pub fits: Table,
    #[serde(skip)]
    pub measured: Measured,
}

impl Versioned for Benchmark {
    const FORMAT: Format = formats::BENCH;
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

impl Benchmark {
    pub fn new(host: Host, effort: Effort, measured: Measured, wall_s: f64) -> Self {
        let timings = timings(&measured);
        let updated = |row: &&SolverRow| row.sequence == Sequence::Moving && row.solver == Solver::ClarabelUpdated;
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
            engines: Vec::new(),
            noise,
            wall_s,
            scenes: measured.scenes.clone(),
            rows: settings(&measured),
            equal_error: equal_errors(&measured.rows),
            clarabel_over_exact: measured.solvers.iter().find(updated).and_then(|row| row.over_exact(&measured.solvers)),
            solvers: solvers(&measured.solvers),
            growth: growth(&measured.growth),
            fits: growth_fits(&measured.growth),
            measured,
        }
    }
}

impl Benchmark {
    /// What was wrong with engines of the user, and which scenes they refuse, each once.
    pub fn faults(&self) -> Vec<(&str, String)> {
        let ended = |row: &&Row| matches!(row.ending, Ending::Wrong(_) | Ending::Refused(_));
        let mut faults: Vec<_> =
            self.measured.rows.iter().filter(ended).map(|row| (&*row.method, row.cause().unwrap_or_default())).collect();
        faults.dedup();
        faults
    }

    /// Whether something was wrong with an engine of the user.
    pub fn has_failed(&self) -> bool {
        self.measured.rows.iter().any(|row| matches!(row.ending, Ending::Wrong(_)))
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

/// Columns of `bench.csv`, a row a setting. Its cause is empty if it succeeded.
fn settings(found: &Measured) -> Table {
    let facts = |row: &Row| found.scenes.iter().find(|facts| facts.scene == row.scene).expect("its scene was measured");
    let error = |row: &Row, at: usize| row.errors_m.map(|errors| errors[at]);
    let share = |row: &Row, at: usize| error(row, at).map(|error| error / facts(row).path_length_m).into();
    Table::of(
        &found.rows,
        &[
            ("scene", "", &|row| row.scene.as_str().into()),
            ("method", "", &|row| row.method.as_str().into()),
            ("step", "s", &|row| row.level.step().into()),
            ("tolerance", "m", &|row| row.level.tolerance().into()),
            ("error max", "m", &|row| error(row, 0).into()),
            ("error final", "m", &|row| error(row, 1).into()),
            ("error max share", "", &|row| share(row, 0)),
            ("error final share", "", &|row| share(row, 1)),
            ("cpu min", "s", &|row| row.timing().map(|timing| timing.min_s).into()),
            ("cpu median", "s", &|row| row.timing().map(|timing| timing.median_s).into()),
            ("spread", "", &|row| row.timing().map(|timing| timing.spread).into()),
            ("n runs", "", &|row| row.seconds.len().into()),
            ("n steps", "", &|row| row.n_steps.into()),
            ("n solves", "", &|row| row.n_solves.into()),
            ("n not converged", "", &|row| row.n_not_converged.into()),
            ("cause", "", &|row| row.cause().into()),
            ("reference", "", &|row| facts(row).reference(row.method().kind).0.into()),
            ("reference error", "m", &|row| facts(row).reference(row.method().kind).1.into()),
            ("path length", "m", &|row| facts(row).path_length_m.into()),
        ],
    )
}

/// Columns of `solvers.csv`, a row a solver on a sequence of problems.
fn solvers(rows: &[SolverRow]) -> Table {
    Table::of(
        rows,
        &[
            ("problems", "", &|row| row.sequence.name().into()),
            ("solver", "", &|row| row.solver.name().into()),
            ("n problems", "", &|row| row.n_problems.into()),
            ("residual median", "", &|row| row.residual_median.into()),
            ("residual max", "", &|row| row.residual_max.into()),
            ("cpu min", "s", &|row| row.timing().map(|timing| timing.min_s).into()),
            ("cpu median", "s", &|row| row.timing().map(|timing| timing.median_s).into()),
            ("spread", "", &|row| row.timing().map(|timing| timing.spread).into()),
            ("n runs", "", &|row| row.seconds.len().into()),
            ("over exact", "", &|row| row.over_exact(rows).into()),
        ],
    )
}

/// Columns of `growth.csv`: CPU time of a step, or of a tick of ants, a row a size.
fn growth(points: &[GrowthPoint]) -> Table {
    Table::of(
        points,
        &[
            ("quantity", "", &|point| point.quantity.name().into()),
            ("backend", "", &|point| point.backend.name().into()),
            ("n", "", &|point| point.n.into()),
            ("cpu min", "s", &|point| point.timing().map(|timing| timing.min_s).into()),
            ("cpu median", "s", &|point| point.timing().map(|timing| timing.median_s).into()),
            ("spread", "", &|point| point.timing().map(|timing| timing.spread).into()),
            ("n runs", "", &|point| point.seconds.len().into()),
        ],
    )
}

/// Columns of `fits.csv`: exponent over sizes from a thirtieth of the largest on, and the line over
/// all sizes (s, s per one more).
fn growth_fits(points: &[GrowthPoint]) -> Table {
    Table::of(
        &fits(points),
        &[
            ("quantity", "", &|fit| fit.quantity.name().into()),
            ("backend", "", &|fit| fit.backend.name().into()),
            ("exponent", "", &|fit| fit.power_law.map(|law| law.exponent).into()),
            ("exponent error", "", &|fit| fit.power_law.and_then(|law| law.exponent_error).into()),
            ("offset", "s", &|fit| fit.line.map(|line| line.offset).into()),
            ("slope", "s", &|fit| fit.line.map(|line| line.slope).into()),
            ("slope error", "s", &|fit| fit.line.and_then(|line| line.slope_error).into()),
        ],
    )
}
