//! Tiers, steps and tolerances of a comparison.

use serde::{Deserialize, Serialize};

use crate::analysis::estimate::TOLERANCE_SHARE;
use crate::backend::{BackendKind, BackendOptions, RapierOptions, Setting, Skips, Tolerance, n_steps_in};
use crate::scenario::Scenario;
use crate::simulation::{Controller, Row};

/// Level of a comparison: how all backends get the same question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    Prescribed,
    Replayed,
    ClosedLoop,
    /// Paths under controllers that follow the load, one for each run: for controllers of your own.
    #[serde(skip_deserializing)]
    Controlled,
}

/// Steps and settings of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Longest step of runs at a fixed step (s): rapier's, and all of the closed loop. `None` is
    /// the default of each backend.
    pub step_s: Option<f64>,
    /// Number of halvings of the engine's step, two at least: the last three steps show its limit.
    pub halvings: u32,
    /// Tolerance of error control in the quasi-static and inertial runs (m). `None` is as small as
    /// the verdict needs.
    pub reference_tolerance_m: Option<f64>,
    pub rapier: RapierOptions,
    /// Backend whose run is recorded for the replayed tier.
    pub recorded_from: BackendKind,
    /// Whether the quasi-static model leaves the dashpots out, as the paper does. What they change
    /// is then part of the inertia effect.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub rate_independent: bool,
    /// Largest edge displacement that counts as agreement, divided by the path length (1).
    pub tolerance_share: f64,
    /// Largest difference of headings that counts as agreement (rad). `None` is 0.01 rad, or 1 % of
    /// the turn of the load if that is more.
    pub tolerance_heading_rad: Option<f64>,
    /// Largest difference of peak or mean pulls that counts as agreement, over the largest of them
    /// without inertia or with it (1).
    pub tolerance_pull_share: f64,
    /// The same for peak and mean speed (1).
    pub tolerance_speed_share: f64,
    /// The same for the energy dissipated (1).
    pub tolerance_energy_share: f64,
    /// Work that may be skipped.
    pub skips: Skips,
    /// Whether suggested changes are tried.
    pub check_suggestions: bool,
}

/// Size that stands in for what is smaller: that of a motion by a millionth of the load's radius
/// (1). Rounding of poses is far below it.
pub const LEAST_MOTION: f64 = 1e-6;

/// Halvings of a step that show a limit of small steps (1).
pub const LEAST_HALVINGS: u32 = 2;

/// A measure of one's own, which a comparison of paths judges as it does its own quantities.
#[derive(Clone, Copy)]
pub struct OwnMeasure<'a> {
    /// Such as `distance to the goal`.
    pub name: &'static str,
    /// Such as `m`; `1` for a number without a unit.
    pub unit: &'static str,
    /// The number from the rows of a run. A run without one has a number that is not finite, and
    /// the measure is then not judged.
    pub of: &'a (dyn Fn(&[Row]) -> f64 + Sync),
    /// Largest difference that counts as agreement, in the unit. `None` is 5 % of the larger number
    /// without inertia or with it.
    pub tolerance: Option<f64>,
}

/// Makes a controller for a scenario; each run gets one of its own.
pub type MakeController<'a> = dyn Fn(&Scenario) -> Box<dyn Controller> + Sync + 'a;

/// First tolerance of the quasi-static and inertial runs, divided by the load's radius (1). What
/// the verdict needs is known only after a first run.
const FIRST_TOLERANCE: f64 = 1e-3;
/// Largest phase of the load's fastest oscillation between two instants of a comparison (rad). At
/// most 1 - cos of half of it, 3 % of an amplitude, is then missed.
const LARGEST_PHASE: f64 = 0.5;
/// Number of instants that is enough for any comparison (1). With more ticks than that, paths are
/// compared at ticks only.
const ENOUGH_INSTANTS: f64 = 2e5;

/// Largest relative difference of pulls, speeds and energies that counts as agreement (1): half of
/// the precision to which such statistics are printed, as in the closed loop.
pub(super) const FORCES: f64 = 0.05;

impl Default for Settings {
    /// Settings of `cohaul compare` without options.
    fn default() -> Self {
        let (recorded_from, rapier, skips) = (BackendKind::QuasiStatic, RapierOptions::default(), Skips::ALL);
        Self {
            step_s: None,
            halvings: LEAST_HALVINGS,
            reference_tolerance_m: None,
            rapier,
            recorded_from,
            rate_independent: false,
            tolerance_share: TOLERANCE_SHARE,
            tolerance_heading_rad: None,
            tolerance_pull_share: FORCES,
            tolerance_speed_share: FORCES,
            tolerance_energy_share: FORCES,
            skips,
            check_suggestions: true,
        }
    }
}

impl Settings {
    /// Options of a quasi-static or inertial run under error control.
    pub fn under_error_control(&self, scenario: &Scenario, kind: BackendKind) -> BackendOptions {
        let load = &scenario.system.load;
        let tolerance = Tolerance::at_edge(self.reference_tolerance_m.unwrap_or(FIRST_TOLERANCE * load.radius), load);
        BackendOptions { skips: self.skips, rate_independent: self.is_rate_independent(kind), ..BackendOptions::within(kind, tolerance) }
    }

    /// Options of a run at a fixed step.
    pub fn at_fixed_step(&self, scenario: &Scenario, kind: BackendKind) -> BackendOptions {
        let options = BackendOptions::at_step(self.step_s, kind, &scenario.system, scenario.control_period);
        BackendOptions { rapier: self.rapier, skips: self.skips, rate_independent: self.is_rate_independent(kind), ..options }
    }

    fn is_rate_independent(&self, kind: BackendKind) -> bool {
        self.rate_independent && kind.reads(Setting::RateIndependent)
    }

    /// Tolerance of the path (m) for a path `length` (m) of a load of this `radius` (m). A
    /// millionth of the radius stands in for the path of a load at rest.
    pub(super) fn tolerance_path(&self, length: f64, radius: f64) -> f64 {
        self.tolerance_share * length.max(LEAST_MOTION * radius)
    }

    /// Number of equal parts of a control period at the ends of which paths are compared (1):
    /// enough to resolve the load's oscillation, a divisor of rapier's number of steps, and not
    /// more than [`ENOUGH_INSTANTS`] allows.
    ///
    /// Controllers that follow the load decide at ticks, and paths are compared there.
    pub(super) fn parts_of_period(&self, tier: Tier, scenario: &Scenario) -> u64 {
        if tier == Tier::Controlled {
            return 1;
        }
        let period = scenario.control_period;
        let n_steps = n_steps_in(period, self.at_fixed_step(scenario, BackendKind::Rapier).step_s);
        let n_needed = period * scenario.system.fastest_rate() / LARGEST_PHASE;
        let n_most = (ENOUGH_INSTANTS * period / scenario.duration).min(n_steps as f64).max(1.0) as u64;
        let mut choices = (1..=n_most).filter(|n| n_steps.is_multiple_of(*n));
        choices.clone().find(|n| *n as f64 >= n_needed).or(choices.next_back()).unwrap_or(1)
    }
}
