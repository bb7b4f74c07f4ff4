//! Sums over all runs by the number of pulling ants.

use super::facts::{MIDDLE_WINDOW, OfSize};
use super::trial::Trial;
use super::units::{Unit, runs};
use cohaul::model::paper as printed;

/// Time and way of all runs of `trial` while `size` ants pulled.
pub(super) fn sum_of_size(units: &[Unit], trial: Trial, size: usize) -> OfSize {
    let found = runs(units, trial).filter_map(|run| run.by_size.get(size));
    found.fold(OfSize::default(), |sum, one| OfSize { time_s: sum.time_s + one.time_s, way_m: sum.way_m + one.way_m })
}

/// Number of control periods with `least` or more pulling ants in a trial (1).
pub(super) fn instants(units: &[Unit], trial: Trial, least: usize) -> f64 {
    let (mut time, mut ants_time, mut n_pulls) = (0.0, 0.0, 0.0);
    for run in runs(units, trial) {
        n_pulls += run.pulls_by_time.n() as f64;
        for (size, of_size) in run.by_size.iter().enumerate() {
            ants_time += size as f64 * of_size.time_s;
            time += if size >= least { of_size.time_s } else { 0.0 };
        }
    }
    // One pull is counted for each pulling ant at each control period.
    if ants_time > 0.0 { time * n_pulls / ants_time } else { 0.0 }
}

/// Trial with groups of a size on ten springs: up to five in the trial of five ants, larger groups
/// in that of ten.
pub(super) fn trial_of_size(size: usize) -> Trial {
    if size < printed::SMALLEST_OF_TEN { Trial::FIVE_TEN } else { Trial::TEN_TEN }
}

/// Speed (m/s) in windows in which on average `size` ants pulled, with ten springs.
pub(super) fn speed_of(units: &[Unit], size: usize) -> Option<f64> {
    speed_in_windows(units, size, MIDDLE_WINDOW)
}

/// The same in windows of the length [`WINDOWS`]`[window]`.
pub(super) fn speed_in_windows(units: &[Unit], size: usize, window: usize) -> Option<f64> {
    let found = runs(units, trial_of_size(size)).filter_map(|run| run.by_window[window].get(size));
    let (way, time) = found.fold((0.0, 0.0), |(way, time), one| (way + one.way_m, time + one.time_s));
    (time > 0.0).then(|| way / time)
}
