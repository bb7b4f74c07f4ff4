//! What the paper measured on ants, beside the runs: pulls, group sizes and the inertial force. The
//! simulation is not said to meet these numbers, so that they have no grade.

use serde::Serialize;

use super::facts::RunFacts;
use super::force::{ForceAt, N_TIMES};
use super::sampling::{Pool, Sampling};
use super::trial::Trial;
use super::units::{Estimate, Unit, estimate, runs};
use cohaul::model::paper as printed;

/// A measured number, and the same of the runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Experiment {
    pub quantity: String,
    pub unit: &'static str,
    pub measured: f64,
    /// Number of measured samples (1).
    pub n_measured: u64,
    pub here: Option<Estimate>,
}

/// Pulls at every control period in all trials, and group sizes in the trial of ten ants.
pub fn experiment(units: &[Unit]) -> Vec<Experiment> {
    let row = |quantity: String, unit, measured, n_measured, statistic: &dyn Fn(&[Unit]) -> Option<f64>| Experiment {
        quantity,
        unit,
        measured,
        n_measured,
        here: estimate(units, statistic),
    };
    let n = printed::N_MEASURED_PULLS;
    let pool = |units: &[Unit]| Pool::of_runs(all(units), Sampling::ByTime);
    let mut rows = vec![
        row("pull, mean".into(), "N", printed::MEASURED_PULL_MEAN_N, n, &|units| pool(units).mean()),
        row("pull, standard deviation".into(), "N", printed::MEASURED_PULL_SD_N, n, &|units| pool(units).sd()),
        row("share of pulls of at most 30 mN".into(), "", printed::MEASURED_SHARE_BELOW, n, &share_below),
    ];
    let n: u64 = printed::MEASURED_SAMPLES.iter().sum();
    for (at, count) in printed::MEASURED_SAMPLES.iter().enumerate() {
        let size = printed::SMALLEST_MEASURED + at;
        let statistic = move |units: &[Unit]| share_of_measured_sizes(units, size);
        rows.push(row(format!("share of {size} pulling ants, of 4 to 9"), "", *count as f64 / n as f64, *count, &statistic));
    }
    rows
}

/// Runs of all trials.
fn all<'a>(units: &[Unit<'a>]) -> impl Iterator<Item = &'a RunFacts> {
    units.iter().flat_map(|unit| Trial::ALL.into_iter().filter_map(|trial| unit.of(trial)))
}

/// Share of at most 30 mN of all pulls (1).
fn share_below(units: &[Unit]) -> Option<f64> {
    let n_above: u64 = all(units).map(|run| run.n_pulls_above).sum();
    let n = Pool::of_runs(all(units), Sampling::ByTime).n;
    (n > 0.0).then(|| 1.0 - n_above as f64 / n)
}

/// Share of the time with `size` of ten ants pulling, of that with 4 to 9 (1).
fn share_of_measured_sizes(units: &[Unit], size: usize) -> Option<f64> {
    let time = |sizes: std::ops::RangeInclusive<usize>| {
        let found = runs(units, Trial::TEN_TEN).flat_map(|run| run.by_size.get(sizes.clone()).into_iter().flatten());
        found.map(|of_size| of_size.time_s).sum::<f64>()
    };
    let all = time(printed::SMALLEST_MEASURED..=printed::SMALLEST_MEASURED + printed::MEASURED_SAMPLES.len() - 1);
    (all > 0.0).then(|| time(size..=size) / all)
}

/// Inertial force of one trial at one smoothing time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceRow {
    pub trial: Trial,
    pub smoothing_s: f64,
    /// Mean and root mean square of m |a| over the runs (N).
    pub mean_n: Option<Estimate>,
    pub rms_n: Option<Estimate>,
    /// Largest m |a| (N).
    pub largest_n: f64,
    /// Number of accelerations (1).
    pub n: u64,
}

/// Inertial forces of all trials by smoothing time. Times for which all runs are too short are left
/// out.
pub fn force_rows(units: &[Unit]) -> Vec<ForceRow> {
    let of = |units: &[Unit], trial: Trial, at: usize| {
        ForceAt::pooled(runs(units, trial).filter_map(|run| run.inertial_force.get(at)).filter(|force| force.n > 0))
    };
    let row = |(trial, at): (Trial, usize)| {
        let pooled = of(units, trial, at)?;
        Some(ForceRow {
            trial,
            smoothing_s: pooled.smoothing_s,
            mean_n: estimate(units, &|units| of(units, trial, at)?.mean()),
            rms_n: estimate(units, &|units| of(units, trial, at)?.rms()),
            largest_n: pooled.largest,
            n: pooled.n,
        })
    };
    Trial::ALL.into_iter().flat_map(|trial| (0..N_TIMES).map(move |at| (trial, at))).filter_map(row).collect()
}
