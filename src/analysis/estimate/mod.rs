//! An a-posteriori estimate of the inertia effect, from a quasi-static run alone.
//!
//! A reduced inertial model of the load runs beside the quasi-static load: one oscillator along the
//! direction of slip, stepped exactly over intervals of a few control periods. It costs a fifth of
//! the run and keeps no trace. `examples/calibrate_estimate` compares the estimate with the
//! measured inertia effect over all scenes and many random ones.
//!
//! ```text
//! friction_oscillator.rs  a mass on a spring and a dashpot with Coulomb friction, in one direction
//! static_friction.rs      friction forces that hold the model at rest
//! slip.rs                 directions of slip, and the friction against them
//! springs.rs              springs and dashpots on the model
//! interval.rs             consecutive ticks that make one step of the model
//! reduced_model.rs        the reduced inertial model
//! displacement.rs         its displacement from the quasi-static load, by trigger
//! estimator.rs            follows a run call by call
//! hook.rs                 a quasi-static backend with an estimator beside it
//! ```

mod displacement;
mod estimator;
mod friction_oscillator;
mod hook;
mod interval;
mod reduced_model;
mod slip;
mod springs;
mod static_friction;

pub use displacement::Largest;
pub use estimator::{CLEAR, Estimator, InertiaEstimate, TOLERANCE_SHARE};
pub use hook::{with_estimate, with_estimate_if};
