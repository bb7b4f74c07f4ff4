//! Floor 4: what inertia would have done to a quasi-static run, from that run alone.
//!
//! Beside the load without inertia goes a shadow of it with its mass: along the way, one oscillator that is stepped exactly over strides of a few control periods.
//! It is a reduced model of the dynamics, not a solution: it costs a fifth of what the run does without it, keeps no trace, and takes its course from the
//! quasi-static load. How well it tells the inertia effect that a comparison measures, `examples/calibrate_estimate` shows over all scenes and many
//! random ones.
//!
//! ```text
//! slider.rs    a mass on a spring and a dashpot with Coulomb friction, in one direction
//! bearing.rs   forces that hold the shadow at rest
//! slip.rs      directions of slip, and how friction turns them
//! pulls.rs     held springs and dashpots as the shadow feels them
//! shadow.rs    the load with its mass beside the load without
//! stride.rs    ticks that are gone through at once
//! apart.rs     how far the two lie apart, and what that comes from
//! estimator.rs follows a run call by call
//! watched.rs   a quasi-static backend with an estimator beside it
//! ```

mod apart;
mod bearing;
mod estimator;
mod pulls;
mod shadow;
mod slider;
mod slip;
mod stride;
mod watched;

pub use apart::{Cause, Largest};
pub use estimator::{Estimator, InertiaEstimate};
pub use watched::Watched;

/// Largest edge displacement that counts as agreement, divided by the path length (1).
pub const TOLERANCE_SHARE: f64 = 0.01;
