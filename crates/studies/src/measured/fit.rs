//! A fit of few numbers of a scene to measured runs, with a confidence region.
//!
//! All runs share the numbers. The difference of a run is the root mean square of measured minus
//! quasi-static poses. The fit minimises Huber's function of it, summed over the runs: squares up
//! to a bound, and straight lines beyond, so that a run of which the scene knows nothing does not
//! decide for all others. It takes damped Gauss-Newton steps (Levenberg and Marquardt) in the
//! logarithms of the numbers, from the best point of a coarse scan.
//!
//! What a model leaves out differs from run to run, and is often larger than the noise of the
//! measurement. The region therefore rests on the spread of the runs and not on a known noise: the
//! covariance is that of the jackknife over runs, each left out in turn, with one Gauss-Newton step
//! in place of a new fit (Bell and McCaffrey 2002, "bias reduction in standard errors"). Runs are
//! taken as independent. Intervals have quantiles of Student's distribution, and the joint region
//! that of Hotelling's.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::parameter::Parameter;
use super::recording::MeasuredRun;
use super::run::{Predicted, mean_measured_force, predicted};
use super::scene::{Preparation, SceneTemplate};
use cohaul::analysis::compare::Settings;
use cohaul::backend::BackendKind;
use cohaul::math::student;
use cohaul::stop::Stop;

/// Level of the region (1).
pub const LEVEL: f64 = 0.95;

/// Factors of the scan about the number in the scene (1).
const SCAN: [f64; 6] = [0.125, 0.25, 0.5, 2.0, 4.0, 8.0];
/// Half of a difference for slopes, in logarithms (1): 2 % of a number. Paths have corners where a
/// contact begins to slide, and slopes over less would see some of them only.
const DIFFERENCE: f64 = 0.02;
/// Longest step of an iteration, in logarithms (1).
const LONGEST: f64 = 0.7;
/// Step at which an iteration ends, in logarithms (1): far below any region of real data.
const SHORTEST: f64 = 1e-4;
const MOST_ITERATIONS: usize = 25;
/// Bound of squares in Huber's function over the median difference of the runs (1): of runs with
/// normal noise in three coordinates one in ten is beyond.
const HUBER: f64 = 1.6;
/// Share of the displacement of the runs by which poses must change when a number is changed to e
/// times itself, for it to be determined (1).
const LEAST_EFFECT: f64 = 1e-6;

/// A fit and its check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    pub numbers: Vec<Fitted>,
    /// Runs of the fit.
    pub n_fit: usize,
    /// Runs that were left for the check.
    pub n_check: usize,
    /// Median model error of the quasi-static load before the fit and after it, edge displacement
    /// at the last pose (m), on the runs of the fit.
    pub on_fit_m: [f64; 2],
    /// The same on the other runs; `null` without any.
    pub on_check_m: Option<[f64; 2]>,
    /// Correlation of each pair of numbers that are determined, row by row (1).
    pub correlation: Vec<Vec<f64>>,
    /// Factor on the standard errors in the joint region of all numbers (1).
    pub joint_factor: f64,
    pub n_evaluations: usize,
}

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitted {
    pub name: String,
    /// In the scene.
    pub before: f64,
    pub value: f64,
    /// Confidence interval; `null` where the runs do not determine the number.
    pub interval_95: Option<[f64; 2]>,
}

/// What is fitted to what.
pub struct Problem<'a> {
    pub template: &'a SceneTemplate,
    pub runs: &'a [MeasuredRun],
    pub parameters: &'a [Parameter],
    pub preparation: &'a Preparation,
    pub settings: &'a Settings,
    /// Standard deviation of positions (m) and headings (rad) by which differences are weighted;
    /// `None` weighs a turn by the displacement of the load's edge.
    pub uncertainty: Option<[f64; 2]>,
}

/// Differences of each run, weighted: one vector a run, `None` where a run has no scene.
type Residuals = Vec<Option<DVector<f64>>>;

/// Receives the number of evaluations so far and returns whether to go on.
pub type Watch<'a> = dyn Fn(usize) -> bool + Sync + 'a;

/// Result of the iterations.
pub struct Solution {
    pub values: Vec<f64>,
    /// Covariance of the logarithms of the numbers that are determined.
    covariance: DMatrix<f64>,
    /// Indices of these.
    determined: Vec<usize>,
    n_runs: usize,
    n_evaluations: usize,
}

impl Problem<'_> {
    /// Fits the numbers; `None` when the watch ended the work.
    ///
    /// # Errors
    /// When there are not more runs than numbers, or the scene does not take a number.
    pub fn solve(&self, watch: &Watch) -> Result<Option<Solution>, String> {
        let mut search = Search { problem: self, watch, n_evaluations: 0, is_stopped: false };
        let start: Vec<f64> = self.parameters.iter().map(|parameter| parameter.start.ln()).collect();
        let result = search.solution(&DVector::from_vec(start));
        if search.is_stopped { Ok(None) } else { result.map(Some) }
    }

    /// Number of evaluations after which the fit ends at the latest.
    pub fn most_evaluations(&self) -> usize {
        let p = self.parameters.len();
        SCAN.len() * p + (MOST_ITERATIONS + 1) * (2 * p + 1) + 2
    }

    /// Weighted differences of all runs at these values.
    fn residuals(&self, values: &[f64]) -> Result<Residuals, String> {
        let changes: Vec<_> = self.parameters.iter().zip(values).map(|(parameter, value)| parameter.at(*value)).collect();
        let template = self.template.changed(&changes)?;
        let stop = Stop::current();
        Ok(self.runs.par_iter().map(|run| stop.within(|| self.residual(&template, run))).collect())
    }

    fn residual(&self, template: &SceneTemplate, run: &MeasuredRun) -> Option<DVector<f64>> {
        let prepared = template.of_run(run, self.preparation, 1.0).ok()?;
        let Predicted { poses, mean_force, is_finished } = predicted(run, &prepared, BackendKind::QuasiStatic, self.settings);
        if !is_finished {
            return None;
        }
        let radius = template.base.system.load.radius;
        let [position, heading] = self.uncertainty.map_or([1.0, radius], |[position, heading]| [position.recip(), heading.recip()]);
        let weight = (poses.len() as f64 - 1.0).sqrt().recip();
        let mut entries = Vec::with_capacity(3 * poses.len());
        for ((_, measured), simulated) in run.load.samples.iter().zip(&poses).skip(1) {
            let difference = weight * position * (measured.position - simulated.position);
            entries.extend([difference.x, difference.y, weight * heading * (measured.heading - simulated.heading)]);
        }
        // An error of the force counts as the same share of the displacement.
        if let (Some(measured), Some(simulated)) = (mean_measured_force(run), mean_force) {
            let (first, last) = (run.load.samples[0].1, run.load.samples[run.load.samples.len() - 1].1);
            entries.push(position * last.edge_displacement(&first, radius) * (measured - simulated) / measured);
        }
        Some(DVector::from_vec(entries))
    }

    /// Result as it is reported: the model error before and after on these runs and on others.
    ///
    /// # Errors
    /// When the scene does not take a number.
    pub fn report(&self, solution: &Solution, others: &[MeasuredRun]) -> Result<Fit, String> {
        let before: Vec<f64> = self.parameters.iter().map(|parameter| parameter.before).collect();
        let medians = |runs: &[MeasuredRun]| -> Result<[f64; 2], String> {
            let of = |values: &[f64]| Ok::<f64, String>(median(self.last_differences(runs, values)?));
            Ok([of(&before)?, of(&solution.values)?])
        };
        let (n, p) = (solution.n_runs, solution.determined.len());
        let errors: Vec<f64> = (0..p).map(|k| solution.covariance[(k, k)].sqrt()).collect();
        let quantile = student(LEVEL, n as f64 - 1.0);
        let interval = |parameter: usize| {
            let k = solution.determined.iter().position(|at| *at == parameter)?;
            let half = quantile * errors[k];
            let value = solution.values[parameter];
            Some([value * (-half).exp(), value * half.exp()])
        };
        let fitted = |(at, parameter): (usize, &Parameter)| Fitted {
            name: parameter.name.clone(),
            before: parameter.before,
            value: solution.values[at],
            interval_95: interval(at),
        };
        let correlation = |a: usize| (0..p).map(|b| solution.covariance[(a, b)] / (errors[a] * errors[b])).collect();
        Ok(Fit {
            numbers: self.parameters.iter().enumerate().map(fitted).collect(),
            n_fit: self.runs.len(),
            n_check: others.len(),
            on_fit_m: medians(self.runs)?,
            on_check_m: if others.is_empty() { None } else { Some(medians(others)?) },
            correlation: (0..p).map(correlation).collect(),
            joint_factor: hotelling(p, n),
            n_evaluations: solution.n_evaluations,
        })
    }

    /// Edge displacement between measured and quasi-static load at the last pose of each run that
    /// has a scene (m).
    fn last_differences(&self, runs: &[MeasuredRun], values: &[f64]) -> Result<Vec<f64>, String> {
        let changes: Vec<_> = self.parameters.iter().zip(values).map(|(parameter, value)| parameter.at(*value)).collect();
        let template = self.template.changed(&changes)?;
        let radius = template.base.system.load.radius;
        let stop = Stop::current();
        let of_run = |run: &MeasuredRun| {
            let prepared = template.of_run(run, self.preparation, 1.0).ok()?;
            let poses = predicted(run, &prepared, BackendKind::QuasiStatic, self.settings).poses;
            Some(run.load.samples.last()?.1.edge_displacement(poses.last()?, radius))
        };
        Ok(runs.par_iter().filter_map(|run| stop.within(|| of_run(run))).collect())
    }
}

/// Factor on standard errors that gives the joint region of `p` numbers from `n` runs (1).
fn hotelling(p: usize, n: usize) -> f64 {
    if p == 0 || n <= p {
        return 0.0;
    }
    let (p, n) = (p as f64, n as f64);
    let fisher = FisherSnedecor::new(p, n - p).expect("both are positive");
    (p * (n - 1.0) / (n - p) * fisher.inverse_cdf(LEVEL)).sqrt()
}

/// Median of values; zero of none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 { 0.0 } else { 0.5 * (values[(n - 1) / 2] + values[n / 2]) }
}

struct Search<'a> {
    problem: &'a Problem<'a>,
    watch: &'a Watch<'a>,
    n_evaluations: usize,
    is_stopped: bool,
}

/// Slopes of the differences of the runs, over the logarithm of each number.
type Slopes = Vec<DMatrix<f64>>;

impl Search<'_> {
    fn solution(&mut self, start: &DVector<f64>) -> Result<Solution, String> {
        let mut at = self.scanned(start)?;
        let mut residuals = self.residuals(&at)?;
        let n_runs = residuals.iter().flatten().count();
        if n_runs <= at.len() {
            return Err(format!("a fit of {} numbers needs more runs than numbers, found {n_runs} that can be simulated", at.len()));
        }
        let mut damping = 1e-3;
        for _ in 0..MOST_ITERATIONS {
            let (slopes, bound) = (self.slopes(&at)?, huber_bound(&residuals));
            let (matrix, gradient, _) = normal_equations(&residuals, &slopes, bound);
            let determined = self.determined(&matrix);
            let mut step = damped_step(&matrix, &gradient, &determined, damping);
            step.apply(|entry| *entry = entry.clamp(-LONGEST, LONGEST));
            let trial = &at + &step;
            let next = self.residuals(&trial)?;
            if self.is_stopped || step.amax() < SHORTEST {
                break;
            }
            if cost(&next, bound) < cost(&residuals, bound) {
                (at, residuals, damping) = (trial, next, damping * 0.2);
            } else if damping > 1e6 {
                break;
            } else {
                damping *= 10.0;
            }
        }
        let (slopes, bound) = (self.slopes(&at)?, huber_bound(&residuals));
        let (matrix, _, of_runs) = normal_equations(&residuals, &slopes, bound);
        let determined = self.determined(&matrix);
        let covariance = jackknife(&of_runs, &determined);
        let mut values: Vec<f64> = at.iter().map(|entry| entry.exp()).collect();
        for (at, parameter) in self.problem.parameters.iter().enumerate().filter(|(at, _)| !determined.contains(at)) {
            values[at] = parameter.before;
        }
        Ok(Solution { values, covariance, determined, n_runs, n_evaluations: self.n_evaluations })
    }

    /// The best of a few values of each number in turn.
    fn scanned(&mut self, start: &DVector<f64>) -> Result<DVector<f64>, String> {
        let first = self.residuals(start)?;
        let bound = huber_bound(&first);
        let mut best = (cost(&first, bound), start.clone());
        for parameter in 0..start.len() {
            for factor in SCAN {
                let mut trial = best.1.clone();
                trial[parameter] = start[parameter] + factor.ln();
                let found = cost(&self.residuals(&trial)?, bound);
                if found < best.0 {
                    best = (found, trial);
                }
            }
        }
        Ok(best.1)
    }

    fn residuals(&mut self, at: &DVector<f64>) -> Result<Residuals, String> {
        if self.is_stopped || !(self.watch)(self.n_evaluations) {
            self.is_stopped = true;
            return Ok(vec![None; self.problem.runs.len()]);
        }
        self.n_evaluations += 1;
        self.problem.residuals(&at.iter().map(|entry| entry.exp()).collect::<Vec<_>>())
    }

    /// Central differences. A run that has no scene at one of them has slopes of zero.
    fn slopes(&mut self, at: &DVector<f64>) -> Result<Slopes, String> {
        let mut sides = Vec::new();
        for parameter in 0..at.len() {
            let mut beside = |difference: f64| {
                let mut trial = at.clone();
                trial[parameter] += difference;
                self.residuals(&trial)
            };
            sides.push([beside(-DIFFERENCE)?, beside(DIFFERENCE)?]);
        }
        let of_run = |run: usize| {
            let columns: Vec<DVector<f64>> = sides
                .iter()
                .map(|[below, above]| match (&below[run], &above[run]) {
                    (Some(below), Some(above)) => (above - below) / (2.0 * DIFFERENCE),
                    (Some(one), None) | (None, Some(one)) => DVector::zeros(one.len()),
                    (None, None) => DVector::zeros(0),
                })
                .collect();
            if columns.iter().any(|column| column.is_empty()) { DMatrix::zeros(0, at.len()) } else { DMatrix::from_columns(&columns) }
        };
        Ok((0..self.problem.runs.len()).map(of_run).collect())
    }

    /// Numbers that change the poses.
    fn determined(&self, matrix: &DMatrix<f64>) -> Vec<usize> {
        let radius = self.problem.template.base.system.load.radius;
        let moved = |run: &MeasuredRun| match run.load.samples[..] {
            [(_, first), .., (_, last)] => last.edge_displacement(&first, radius),
            _ => 0.0,
        };
        let scale = self.problem.uncertainty.map_or(1.0, |[position, _]| position.recip());
        let size: f64 = self.problem.runs.iter().map(|run| (scale * moved(run)).powi(2)).sum();
        (0..matrix.nrows()).filter(|k| matrix[(*k, *k)] > LEAST_EFFECT * LEAST_EFFECT * size).collect()
    }
}

/// Bound of squares in Huber's function.
fn huber_bound(residuals: &Residuals) -> f64 {
    HUBER * median(residuals.iter().flatten().map(DVector::norm).collect())
}

/// Mean of Huber's function over the runs with a scene.
fn cost(residuals: &Residuals, bound: f64) -> f64 {
    let of_run = |residual: &DVector<f64>| {
        let size = residual.norm();
        if size <= bound { size * size } else { bound * (2.0 * size - bound) }
    };
    let costs: Vec<f64> = residuals.iter().flatten().map(of_run).collect();
    if costs.is_empty() { f64::INFINITY } else { costs.iter().sum::<f64>() / costs.len() as f64 }
}

/// What a run adds to the equations of a step.
struct OfRun {
    /// Second derivatives of Huber's function in the logarithms of the numbers, for slopes that do
    /// not change.
    hessian: DMatrix<f64>,
    /// Negative first derivatives.
    right: DVector<f64>,
}

/// Matrix and right-hand side of a Gauss-Newton step, and what each run adds to the equations.
/// Beyond the bound a run counts with the weight bound / difference.
fn normal_equations(residuals: &Residuals, slopes: &Slopes, bound: f64) -> (DMatrix<f64>, DVector<f64>, Vec<OfRun>) {
    let n = slopes.first().map_or(0, DMatrix::ncols);
    let (mut matrix, mut right, mut of_runs) = (DMatrix::zeros(n, n), DVector::zeros(n), Vec::new());
    for (residual, slopes) in residuals.iter().zip(slopes) {
        let Some(residual) = residual.as_ref().filter(|residual| residual.len() == slopes.nrows()) else { continue };
        let size = residual.norm();
        let weight = if size > bound { bound / size } else { 1.0 };
        let (square, towards) = (weight * slopes.transpose() * slopes, slopes.transpose() * residual);
        let along = if size > bound { weight / (size * size) } else { 0.0 };
        matrix += &square;
        right -= weight * &towards;
        of_runs.push(OfRun { hessian: square - along * &towards * towards.transpose(), right: -weight * towards });
    }
    (matrix, right, of_runs)
}

fn damped_step(matrix: &DMatrix<f64>, right: &DVector<f64>, determined: &[usize], damping: f64) -> DVector<f64> {
    let mut damped = matrix.select_rows(determined).select_columns(determined);
    (0..determined.len()).for_each(|k| damped[(k, k)] *= 1.0 + damping);
    let mut step = DVector::zeros(right.len());
    if determined.is_empty() {
        return step;
    }
    if let Some(found) = damped.lu().solve(&right.select_rows(determined)) {
        determined.iter().enumerate().for_each(|(k, at)| step[*at] = found[k]);
    }
    step
}

/// Covariance of the numbers by leaving out each run: the sum of the squares of the steps that this
/// makes.
fn jackknife(of_runs: &[OfRun], determined: &[usize]) -> DMatrix<f64> {
    let (p, n) = (determined.len(), of_runs.len() as f64);
    let mut covariance = DMatrix::zeros(p, p);
    let Some(first) = of_runs.first().filter(|_| p > 0) else { return covariance };
    let whole = of_runs[1..].iter().fold(first.hessian.clone(), |sum, of_run| sum + &of_run.hessian);
    for OfRun { hessian, right } in of_runs {
        let without = (&whole - hessian).select_rows(determined).select_columns(determined);
        let Some(step) = without.lu().solve(&-right.select_rows(determined)) else { continue };
        covariance += (n - 1.0) / n * &step * step.transpose();
    }
    covariance
}
