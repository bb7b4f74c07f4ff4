//! Results of `calibrate` for programs.

use serde::Serialize;

use super::design::{Limits, Made, Wanted};
use super::forces::ForceSummary;

/// The result of `calibrate design`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DesignReport {
    pub wanted: Wanted,
    pub limits: Limits,
    pub exact: Made,
    /// The design with lengths rounded to a grid; absent without a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_grid: Option<Made>,
}

/// The result of `calibrate forces`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForcesReport {
    pub n_frames: usize,
    /// One entry for each recorded spring, then one for all together.
    pub springs: Vec<ForceSummary>,
    pub tip_noise_m: f64,
    pub warnings: Vec<String>,
}

/// A share in percent, without the digits that a binary share adds.
pub fn percent(share: f64) -> f64 {
    (1e6 * share).round() / 1e4
}
