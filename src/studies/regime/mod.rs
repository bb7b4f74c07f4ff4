//! Floor 4: where inertia matters. Scenes over the plane of Phi and epsilon, each cell measured
//! with inertia and without, beside what theory expects.
//!
//! ```text
//! Phi = omega_n T_e    epsilon = v sqrt(k m) / f    zeta    with omega_n = sqrt(k / m), f = mu m g
//! ```
//!
//! v is the speed of the tips, T_e the time between two events. Times in units of 1 / omega_n and
//! ways in units of v / omega_n leave nothing but these three numbers, as long as springs are
//! linear; friction sits in epsilon alone. On the way from one event to the next a tip goes
//! `epsilon Phi` times f / k: a load without inertia sees only that product, and a change of mass
//! at fixed friction, or of pace at fixed ways, moves a scene along a line of constant product.
//!
//! ```text
//! theory.rs   closed forms and rules of thumb
//! script.rs   grasps and releases at given ticks, tips at given velocities: a controller
//! scene.rs    the scenes at one point of the plane
//! cell.rs     one point, measured
//! map.rs      all points on all processors, resumable
//! law.rs      measurement over theory, and why they part
//! ```

mod cell;
pub mod figure;
pub mod files;
mod law;
mod map;
pub mod page;
pub mod report;
mod scene;
mod script;
mod tables;
pub mod theory;

pub use cell::Cell;
pub use law::{Cause, Law, Standing};
pub use map::{Effort, Grid, PAPER_PHIS, PAPER_SPEEDS, cells, epsilon_of, tasks};
pub use scene::{Scene, Setting, Staged};
pub use script::{Act, Cue, Script};

/// Share of the way (1) up to which paths count as the same.
pub const AGREEMENT: f64 = 0.01;
