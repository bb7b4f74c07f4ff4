//! Load speed by the number of pulling ants, as in the paper's ninth figure.

use serde::Serialize;

use super::by_size::{speed_in_windows, speed_of, sum_of_size, trial_of_size};
use super::facts::WINDOWS;
use super::measures::Measure;
use super::trial::Trial;
use super::units::{Estimate, Unit};
use cohaul::math::Summary;
use cohaul::model::paper as printed;

/// Load speed by group size, as in the paper's ninth figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Speeds {
    pub n_transporting: usize,
    pub trial: Trial,
    /// Over windows in which on average so many pulled.
    pub load_speed_m_per_s: Option<Estimate>,
    /// Standard deviation over runs (m/s).
    pub sd_over_runs_m_per_s: Option<f64>,
    /// Mean over the ticks at which so many ants pulled (m/s). The jump after a release then counts
    /// for the smaller group.
    pub load_speed_by_tick_m_per_s: Option<f64>,
    /// In windows of each of [`WINDOWS`] (m/s).
    pub load_speed_by_window_m_per_s: [Option<f64>; WINDOWS.len()],
    /// Of those ticks: time (s), number, and the number printed.
    pub time_s: f64,
    pub n_instants: u64,
    pub printed_instants: u64,
    /// Of so many ants on ten springs, however many of them pull (m/s, towards the nest).
    pub headway_m_per_s: Option<Estimate>,
}

/// Speed by the number of ants that pull, and by that of ants, from one to ten.
pub fn load_speeds(units: &[Unit], control_period: f64) -> Vec<Speeds> {
    let of_size = |size: usize| {
        let trial = trial_of_size(size);
        let of_ticks = sum_of_size(units, trial, size);
        let over_runs = Summary::of(units.iter().filter_map(|unit| speed_of(std::slice::from_ref(unit), size)));
        Speeds {
            n_transporting: size,
            trial,
            load_speed_m_per_s: Measure::LoadSpeed(size).estimate(units),
            sd_over_runs_m_per_s: (over_runs.n() > 1).then(|| over_runs.sd()),
            load_speed_by_tick_m_per_s: (of_ticks.time_s > 0.0).then(|| of_ticks.way_m / of_ticks.time_s),
            load_speed_by_window_m_per_s: std::array::from_fn(|window| speed_in_windows(units, size, window)),
            time_s: of_ticks.time_s,
            n_instants: (of_ticks.time_s / control_period).round() as u64,
            printed_instants: printed::SIMULATED_SAMPLES[size - 1],
            headway_m_per_s: Measure::Headway(size as u8).estimate(units),
        }
    };
    (1..=Trial::TEN_TEN.n_ants()).map(of_size).collect()
}
