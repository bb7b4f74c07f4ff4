//! Floor 4: where backends agree, where inertia makes them differ, and how much of a difference is only a solver's error.
//!
//! Comparison has three tiers, because closed-loop paths decorrelate at the first release that falls differently: [`Tier::Prescribed`] tips,
//! compared pathwise; [`Tier::Replayed`] grasps, releases and tip motions of one recorded run, compared pathwise; [`Tier::ClosedLoop`] runs of paired
//! seeds, compared as distributions.
//!
//! ```text
//! solution.rs   a backend's path with its own error
//! difference.rs how far two paths lie apart
//! parting.rs    when they part, after what, and what takes them how far
//! numbers.rs    epsilon, Phi and zeta of a run, and what theory predicts from them
//! pathwise.rs   the prescribed and the replayed tier
//! ensemble.rs   the closed-loop tier
//! verdict.rs    what it amounts to
//! remedy.rs     what would bring paths together
//! ```

mod difference;
mod ensemble;
mod numbers;
mod parting;
mod pathwise;
mod remedy;
mod solution;
mod verdict;

use serde::{Deserialize, Serialize};

use crate::analysis::estimate::AGREEMENT;
use crate::backend::{BackendKind, BackendOptions, RapierOptions, Skips, Tolerance, n_steps_in, step_of};
use crate::scenario::Scenario;

pub use difference::Difference;
pub use ensemble::{ClosedLoop, DecisionsPart, Distribution, Measure, Shift, closed_loop, closed_loop_with};
pub use numbers::{Numbers, Predicted};
pub use parting::{InertiaFrom, Occasion, OccasionKind, Parting};
pub use pathwise::{Backends, Cause, Cost, OwnErrors, Partings, Pathwise, Rim, prescribed, prescribed_with, replayed, replayed_with};
pub use remedy::Remedy;
pub use solution::Solution;
pub use verdict::Verdict;

/// How backends are made to answer the same question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    Prescribed,
    Replayed,
    ClosedLoop,
}

/// Steps and settings of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Longest step of runs at a fixed step (s): rapier's, and all of the closed loop; `None` is the default of each backend.
    pub step_s: Option<f64>,
    /// Error of the exact backends' paths (m); `None` is what the verdict needs.
    pub tolerance_m: Option<f64>,
    pub rapier: RapierOptions,
    /// Backend whose run is replayed into the others.
    pub recorded_from: BackendKind,
    /// Difference that counts as agreement, over [`Pathwise::path_length_m`] (1).
    pub agreement: f64,
    /// What may be left out.
    pub skips: Skips,
}

/// Error of the exact backends' paths unasked, over the load's radius (1). What the verdict needs is known only when there are paths.
const FIRST_TOLERANCE: f64 = 1e-3;

/// Turn of the load's fastest oscillation from one instant at which paths are compared to the next (rad), at most: between them no more than 1 - cos of half of it
/// of a swing, 3 %, can go unseen.
const LARGEST_TURN_UNSEEN: f64 = 0.5;
/// So many instants are enough of any comparison; of one with more ticks, the ticks.
const ENOUGH_INSTANTS: f64 = 2e5;

/// Those of `cohaul compare`.
impl Default for Settings {
    fn default() -> Self {
        let (recorded_from, rapier, skips) = (BackendKind::QuasiStatic, RapierOptions::default(), Skips::ALL);
        Self { step_s: None, tolerance_m: None, rapier, recorded_from, agreement: AGREEMENT, skips }
    }
}

impl Settings {
    /// Of an exact backend whose path is compared.
    pub fn within(&self, scenario: &Scenario, kind: BackendKind) -> BackendOptions {
        let load = &scenario.system.load;
        let tolerance = Tolerance::on_rim(self.tolerance_m.unwrap_or(FIRST_TOLERANCE * load.radius), load);
        BackendOptions { skips: self.skips, ..BackendOptions::within(kind, tolerance) }
    }

    pub fn options(&self, scenario: &Scenario, kind: BackendKind) -> BackendOptions {
        let step_s = step_of(self.step_s, kind, &scenario.system, scenario.control_period);
        BackendOptions { rapier: self.rapier, skips: self.skips, ..BackendOptions::new(kind, step_s) }
    }

    /// Equal parts of a control period, at the ends of which paths are compared: as many as show how far the load swings between ticks, of those that a step of the
    /// engine ends with, and no more than are enough.
    fn parts_of_period(&self, scenario: &Scenario) -> u64 {
        let period = scenario.control_period;
        let n_steps = n_steps_in(period, self.options(scenario, BackendKind::Rapier).step_s);
        let n_needed = period * scenario.system.fastest_rate() / LARGEST_TURN_UNSEEN;
        let n_most = (ENOUGH_INSTANTS * period / scenario.duration).min(n_steps as f64).max(1.0) as u64;
        let mut choices = (1..=n_most).filter(|n| n_steps.is_multiple_of(*n));
        choices.clone().find(|n| *n as f64 >= n_needed).or(choices.next_back()).unwrap_or(1)
    }
}
