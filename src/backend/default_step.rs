//! Steps that are taken by default, and the time scale of error control.

use super::numerics::{LONGEST_DEFAULT, SHORTEST_STEP};
use super::options::{BackendKind, BackendOptions, Setting};
use crate::model::System;

/// Default step (s): the control period, but at most 2.5 ms. With inertia it is at most 1 ms and a
/// tenth of a radian of the fastest oscillation, which gives a numerical damping ratio of at most
/// 0.05, but at least 10 us. The oscillation is that of springs at rest; the inertial backend takes
/// shorter steps where springs are deformed far ([`super::BackendOptions::adapts_step`]).
pub fn default_step(kind: BackendKind, system: &System, control_period: f64) -> f64 {
    if kind.has_inertia() {
        (0.1 / system.fastest_rate()).clamp(SHORTEST_STEP, 1e-3).min(control_period)
    } else {
        control_period.min(LONGEST_DEFAULT)
    }
}

/// The requested step, at most the control period, or else the default step (s).
pub fn step_of(requested: Option<f64>, kind: BackendKind, system: &System, control_period: f64) -> f64 {
    requested.map_or_else(|| default_step(kind, system, control_period), |step| step.min(control_period))
}

impl BackendOptions {
    /// Default options at the requested step (s), or else at the default step.
    pub fn at_step(requested: Option<f64>, kind: BackendKind, system: &System, control_period: f64) -> Self {
        let step_s = step_of(requested, kind, system, control_period);
        Self { adapts_step: requested.is_none() && kind.reads(Setting::AdaptsStep), ..Self::new(kind, step_s) }
    }
}

/// Time over which a wrong speed makes the position wrong (s): one radian of the slowest
/// oscillation, or the time in which friction stops a load that crosses its radius, whichever is
/// shorter. `None` for a method without inertia. Without springs and friction speeds stay right, up
/// to 1e9 s.
pub fn settling_time(kind: BackendKind, system: &System) -> Option<f64> {
    if !kind.has_inertia() {
        return None;
    }
    let load = &system.load;
    let stiffness =
        system.springs.iter().map(|spring| spring.radial_stiffness).filter(|stiffness| *stiffness > 0.0).fold(f64::INFINITY, f64::min);
    let swing = (load.mass / stiffness).sqrt();
    let braking = (load.mass * load.radius / system.total_slip_limit()).sqrt();
    Some([swing, braking].into_iter().filter(|time| time.is_finite() && *time > 0.0).fold(f64::INFINITY, f64::min).min(1e9))
}
