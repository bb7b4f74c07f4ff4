//! The rigid-body engine rapier2d as a backend.
//!
//! All data of a step are first written down in f64 (`joints`): friction joints by `ground`, spring
//! joints by `springs`, which `aggregate` folds into one. `world` hands them to rapier, and
//! `backend` runs the steps and keeps the energy ledger. One step solves, for the twist v of the
//! load,
//!
//! ```text
//! M (v - v_n) / h = W - (h K + D) v + sum_i B_i' lambda_i
//!
//! W  wrench of the springs at the pose q_n, with the tips at p_n+1
//! ```
//!
//! with K the positive part of the springs' stiffness and D their dashpots. This is the implicit
//! Euler step of the reference dynamics except for the geometric part of the stiffness, which acts
//! through W alone. At rest the law is exact. In motion it lags by that part times h v, which is of
//! first order like the step itself. The engine finds the impulses by iterations over the joints.

mod aggregate;
mod backend;
mod contact_ledger;
mod contacts;
mod double;
mod ground;
mod joints;
mod ledger;
mod one_step;
mod options;
mod prediction;
mod residual;
mod rest;
mod rounding;
#[cfg(feature = "rapier-f32")]
mod single;
mod springs;
mod step;
mod walls;

pub use options::{EngineSettings, FrictionModel, Precision, RapierOptions, SpringModel};

use super::interface::Backend;
use super::options::BackendOptions;
use crate::model::{Motion, System};

/// A load under rapier.
pub fn build(system: System, start: Motion, options: &BackendOptions) -> Box<dyn Backend> {
    let body = joints::BodyState::of(&start);
    let engine: Box<dyn joints::Engine> = match options.rapier.precision {
        Precision::F64 => Box::new(double::World::new(&system, &body, &options.rapier)),
        #[cfg(feature = "rapier-f32")]
        Precision::F32 => Box::new(single::World::new(&system, &body, &options.rapier)),
    };
    Box::new(backend::Rapier::new(system, start, options, engine))
}
