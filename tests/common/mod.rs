//! Loads, springs and drives that several tests share.
#![allow(dead_code, unused_imports, reason = "each test file uses its own part")]

use cohaul::backend::{Backend, BackendKind, BackendOptions, Integrator, Motion, build};
use cohaul::math::{Pose, Vec3};
use cohaul::model::System;

pub use cohaul_studies::verify::extrapolated;
pub use cohaul_studies::verify::scenes::*;

pub const WITH_INERTIA: [BackendKind; 2] = [BackendKind::Inertial, BackendKind::Rapier];

pub fn backend(kind: BackendKind, system: &System, start: Motion, step: f64) -> Box<dyn Backend> {
    build(system, start, &BackendOptions { integrator: Integrator::Euler, ..BackendOptions::new(kind, step) })
}

/// (x, y, heading) of a pose (m, m, rad).
pub fn entries(pose: &Pose) -> Vec3 {
    Vec3::new(pose.position.x, pose.position.y, pose.heading)
}

/// Error at a step over the error at its half: 2 for a method of first order.
pub fn error_ratio(coarse: f64, fine: f64, exact: f64) -> f64 {
    (coarse - exact) / (fine - exact)
}
