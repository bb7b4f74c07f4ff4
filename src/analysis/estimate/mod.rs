//! An a-posteriori estimate of the inertia effect, from a quasi-static run alone.
//!
//! A reduced inertial model of the load runs beside the quasi-static load: one oscillator along the
//! direction of slip, stepped exactly over intervals of a few control periods. It costs a fifth of
//! the run and keeps no trace. Among obstacles it is a load with inertia at fixed steps.
//! `examples/calibrate_estimate` compares the estimate with the measured inertia effect over all
//! scenes and many random ones.
//!
//! ```text
//! friction_oscillator.rs  a mass on a spring and a dashpot with Coulomb friction, in one direction
//! static_friction.rs      friction forces that hold the model at rest
//! slip.rs                 directions of slip, and the friction against them
//! springs.rs              springs and dashpots on the model
//! interval.rs             consecutive ticks that make one step of the model
//! reduced_model.rs        the reduced inertial model
//! displacement.rs         its displacement from the quasi-static load, by trigger
//! open_plane.rs           follows a run on an open plane, with this model
//! among_obstacles.rs      follows a run among obstacles, with a load with inertia
//! follower.rs             the estimate, and what both of them do
//! estimator.rs            follows a run call by call, with one of them
//! hook.rs                 a quasi-static backend with an estimator beside it
//! ```

mod among_obstacles;
mod displacement;
mod estimator;
mod follower;
mod friction_oscillator;
mod hook;
mod interval;
mod open_plane;
mod reduced_model;
mod slip;
mod springs;
mod static_friction;

pub(super) use among_obstacles::step_among_obstacles;
pub use displacement::Largest;
pub use estimator::Estimator;
pub use follower::{CLEAR, InertiaEstimate, TOLERANCE_SHARE};
pub use hook::{with_estimate, with_estimate_if};
