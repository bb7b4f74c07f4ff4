//! Expected cost of runs, before they start.
//!
//! The number of steps follows from the scenario: at least one in each control period, at a fixed
//! step as many as fit, and under error control with inertia at least one macro-step for every two
//! radians of the fastest oscillation of the load on the springs that may be attached. Steps that a
//! run skips, because the load rests, are not known beforehand. The estimate counts them, so that a
//! run may be cheaper.

use super::compare::Settings;
use crate::backend::{BackendKind, BackendOptions, LONGEST_MACRO_STEP};
use crate::scenario::{Drive, Scenario};

/// Expected cost of one or more runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedCost {
    /// Number of steps; under error control number of macro-steps (1).
    pub n_steps: f64,
    /// Time on one core of a usual processor (s).
    pub time_s: f64,
    /// What the number of steps of the longest run follows from.
    pub limit: CostLimit,
}

/// What the number of steps of a run follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CostLimit {
    /// One advance in each control period.
    ControlPeriod,
    /// The length of the step.
    Step,
    /// The fastest oscillation of the load, which each macro-step resolves.
    Oscillation,
}

/// Time of a step at a fixed step (s), without and for each spring and support: 0.64 us on the
/// paper's scene, and 19 and 18 ns (`results/2026-11-23-run-time-against-error`).
const STEP: f64 = 0.5e-6;
const STEP_A_PART: f64 = 0.02e-6;
/// Time of a step of rapier over that of an exact backend (1).
const ENGINE: f64 = 10.0;
/// Number of steps that a macro-step and its check take (1): four or five rows of the table each,
/// and some attempts that fail. An inertial run of the paper's scene to 1e-6 m takes 30 us a
/// macro-step.
const STEPS_A_MACRO_STEP: f64 = 40.0;

impl ExpectedCost {
    /// Cost of a run of `scenario` with these options.
    pub fn of_run(scenario: &Scenario, options: &BackendOptions) -> Self {
        let n_periods = scenario.duration / scenario.control_period;
        let n_wanted = match options.tolerance {
            Some(_) if options.kind.has_inertia() => scenario.duration * fastest_rate(scenario) / LONGEST_MACRO_STEP,
            Some(_) => 0.0,
            None => scenario.duration / options.step_s,
        };
        let limit = match options.tolerance {
            // The first step of a period is shorter than the period itself by rounding only.
            _ if n_wanted <= 1.01 * n_periods => CostLimit::ControlPeriod,
            Some(_) => CostLimit::Oscillation,
            None => CostLimit::Step,
        };
        let n_parts = scenario.system.springs.len() + scenario.system.ground.supports.len();
        let of_step = STEP + STEP_A_PART * n_parts as f64;
        let factor = match options.tolerance {
            Some(_) => STEPS_A_MACRO_STEP,
            None if options.kind.is_exact() => 1.0,
            None => ENGINE,
        };
        let n_steps = n_wanted.max(n_periods);
        Self { n_steps, time_s: n_steps * factor * of_step, limit }
    }

    /// Cost of a comparison of paths: the references twice, rapier at its step, a half and a
    /// quarter of it.
    pub fn of_comparison(scenario: &Scenario, settings: &Settings) -> Self {
        let references = [BackendKind::QuasiStatic, BackendKind::Inertial].map(|kind| (2.0, settings.under_error_control(scenario, kind)));
        let engine = (7.0, settings.at_fixed_step(scenario, BackendKind::Rapier));
        let costs = references.into_iter().chain([engine]).map(|(times, options)| {
            let cost = Self::of_run(scenario, &options);
            Self { n_steps: times * cost.n_steps, time_s: times * cost.time_s, ..cost }
        });
        costs.reduce(|a, b| a.and(b)).expect("there are three backends")
    }

    /// Cost of both, with the limit of the longer one.
    fn and(self, other: Self) -> Self {
        let limit = if other.time_s > self.time_s { other.limit } else { self.limit };
        Self { n_steps: self.n_steps + other.n_steps, time_s: self.time_s + other.time_s, limit }
    }
}

/// Rate of the fastest oscillation of the load on all springs that may be attached (rad/s).
pub fn fastest_rate(scenario: &Scenario) -> f64 {
    let system = &scenario.system;
    match &scenario.drive {
        Drive::Tips(paths) => system.fastest_rate_on(paths.iter().map(|path| &system.springs[path.spring])),
        Drive::Ants(_) => system.fastest_rate(),
    }
}
