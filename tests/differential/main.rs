//! Answers at obstacles that do not depend on how a scene is posed, beside known answers.
//!
//! ```text
//! scene.rs    scenes as data, and their JSON
//! posed.rs    the same scene turned, mirrored, scaled, cut and refined
//! draws.rs    random numbers
//! run.rs      runs of the exact backends, and distances between them
//! known.rs    known answers of a box that slides past joints, ends and steps
//! reports.rs  known answers of scenes from reports
//! tilings.rs  walls of flush blocks against the wall in one piece
//! pairs.rs    random scenes against themselves posed differently
//! estimate.rs            the inertia estimate of random scenes against their inertia effect
//! integrator.rs          an independent solution with inertia
//! against_integrator.rs  random scenes against that solution
//! cost.rs     a survey of the cost of error control
//! ```
//!
//! `random_scene.rs` and `variant.rs` make the scenes of `pairs.rs` and their other poses. Where
//! the variable `COHAUL_DUMP` names a folder, scenes that are unequal are written there.

mod against_integrator;
#[path = "../contact/random_scene.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod contact_scene;
mod cost;
mod draws;
mod estimate;
mod integrator;
mod known;
mod pairs;
mod posed;
mod random_scene;
mod reports;
mod run;
mod scene;
mod tilings;
mod variant;
