//! How to move a load: kinds, steps, tolerances.

use serde::{Deserialize, Serialize};

use super::controlled::{Column, Control};
use super::friction::ConeSolver;
use super::{Integrator, PoseError, RapierOptions, Skips};
use crate::model::{Load, System};

/// The ways to move a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum BackendKind {
    /// The paper's max-min step: no inertia.
    QuasiStatic,
    /// The same step with the mass matrix: the reference dynamics.
    Inertial,
    /// The rigid-body engine rapier2d.
    Rapier,
}

impl BackendKind {
    pub const ALL: [BackendKind; 3] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];

    pub fn name(self) -> &'static str {
        match self {
            BackendKind::QuasiStatic => "quasi-static",
            BackendKind::Inertial => "inertial",
            BackendKind::Rapier => "rapier",
        }
    }
}

/// How to move the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BackendOptions {
    pub kind: BackendKind,
    /// Longest step (s): a duration is cut into the fewest equal steps that do not exceed it. Infinite under error control.
    #[serde(default = "unlimited", skip_serializing_if = "is_unlimited")]
    pub step_s: f64,
    /// Error control in place of the step, for the exact backends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Of the inertial backend at a fixed step.
    pub integrator: Integrator,
    pub rapier: RapierOptions,
    /// What may be left out.
    #[serde(default, skip_serializing_if = "is_default")]
    pub skips: Skips,
    /// Of the quasi-static backend at a fixed step.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cone_solver: ConeSolver,
    /// Whether quasi-static steps of fixed length are of second order where the load goes on slipping.
    #[serde(default, skip_serializing_if = "is_default")]
    pub second_order: bool,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn unlimited() -> f64 {
    f64::INFINITY
}

fn is_unlimited(step: &f64) -> bool {
    step.is_infinite()
}

impl BackendOptions {
    /// The usual settings at this longest step (s).
    pub fn new(kind: BackendKind, step_s: f64) -> Self {
        Self {
            kind,
            step_s,
            tolerance: None,
            integrator: Integrator::default(),
            rapier: RapierOptions::default(),
            skips: Skips::ALL,
            cone_solver: ConeSolver::Exact,
            second_order: false,
        }
    }

    /// An exact backend under error control.
    pub fn within(kind: BackendKind, tolerance: Tolerance) -> Self {
        Self { tolerance: Some(tolerance), ..Self::new(kind, f64::INFINITY) }
    }
}

/// Error that the pose of a run may have at any instant, given its grasps, releases and tip motions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    pub position_m: f64,
    pub heading_rad: f64,
    /// How often the errors of strides, which add up to that of the run, have been divided by ten because they added up to too much.
    #[serde(default)]
    pub tightened: u32,
}

/// Error of a stride over that of the run (1). The former add up, but friction and springs bring a load back to its path, so that it is not for long.
const STRIDE_SHARE: f64 = 1e-4;
/// Largest error of a stride over the load's radius (1): beyond, an error is no longer small against what it is estimated from.
const LARGEST_STRIDE_ERROR: f64 = 1e-3;
/// Smallest error of a stride over the load's radius (1): below, roundings of places decide.
const SMALLEST_STRIDE_ERROR: f64 = 1e-13;
/// How often a run is repeated with smaller errors of strides.
const MOST_TIGHTENED: u32 = 3;
/// Tolerance of the run that checks another one, over that one's (1).
pub(super) const CHECK_SHARE: f64 = 4.0;

impl Tolerance {
    /// Of a load whose rim may be off by `position_m` (m) through a shift, and by as much through a turn.
    pub fn on_rim(position_m: f64, load: &Load) -> Self {
        Self { position_m, heading_rad: position_m / load.radius, tightened: 0 }
    }

    /// The same, for a run whose strides err a tenth as much; `None` when that would not help any more.
    pub fn tightened(&self) -> Option<Self> {
        (self.tightened < MOST_TIGHTENED).then_some(Self { tightened: self.tightened + 1, ..*self })
    }

    /// Whether an error keeps to it.
    pub fn allows(&self, error: &PoseError) -> bool {
        error.position <= self.position_m && error.heading <= self.heading_rad
    }

    pub(super) fn control(&self, system: &System, settling_time: Option<f64>) -> Control {
        let load = &system.load;
        // What friction or a spring stretched by the load's radius has: energies err by that times the error of the position.
        let stiffness = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
        let force = system.total_slip_limit() + stiffness * load.radius;
        let share = STRIDE_SHARE * 0.1f64.powi(self.tightened as i32);
        let of_stride = |error: f64, size: f64| (share * error).clamp(SMALLEST_STRIDE_ERROR * size, LARGEST_STRIDE_ERROR * size);
        Control {
            position: of_stride(self.position_m, load.radius),
            heading: of_stride(self.heading_rad, 1.0),
            energy: of_stride(self.position_m, load.radius) * force,
            settling_time,
            keeps: Column::Last,
        }
    }
}
