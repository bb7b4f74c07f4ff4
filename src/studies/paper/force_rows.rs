//! The inertial force of all runs, by trial and smoothing time.

use serde::Serialize;

use super::force::{ForceAt, N_TIMES};
use super::trial::Trial;
use super::units::{Estimate, Unit, estimate};

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
        ForceAt::pooled(units.iter().filter_map(|unit| unit.of(trial)?.inertial_force.get(at)).filter(|force| force.n > 0))
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
