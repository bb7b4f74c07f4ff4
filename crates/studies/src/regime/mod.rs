//! Where inertia matters: scenes over the plane of Phi and epsilon. Each cell is measured with and
//! without inertia and compared with the predictions of theory.
//!
//! ```text
//! Phi = omega_n T_e    epsilon = v sqrt(k m) / f    zeta    with omega_n = sqrt(k / m), f = mu m g
//! ```
//!
//! v is the speed of the tips and T_e the time between two events. With times in units of 1 /
//! omega_n and lengths in units of v / omega_n, linear springs leave only these three numbers.
//! Friction enters epsilon alone. Between two events a tip moves by `epsilon Phi` times f / k, and
//! the quasi-static solution depends on this product alone. A change of mass at fixed friction, or
//! of speed at fixed path lengths, moves a scene along a line of constant product.
//!
//! ```text
//! theory.rs   closed forms and rules of thumb
//! script.rs   grasps and releases at given ticks, tips at given velocities: a controller
//! scene.rs    the scenes at one point of the plane
//! cell.rs     one point, measured
//! map.rs      grids of points, each point a task
//! law.rs      measurement over theory, and the causes of differences
//! ```

mod cell;
pub mod figure;
pub mod files;
mod law;
mod map;
mod page;
mod readme;
pub mod report;
mod scene;
mod script;
mod tables;
pub mod theory;

pub use crate::runner::Effort;
pub use cell::Cell;
pub use law::{Cause, Law, LawOutcome};
pub use map::{Grid, PAPER_SPEEDS, SHORT_PHIS, cells, epsilon_of, tasks};
pub use scene::{Scene, Setting, Staged};
pub use script::{Act, Cue, Script};

/// Tolerance over the quasi-static path length (1): paths that differ by less agree.
pub const RELATIVE_TOLERANCE: f64 = 0.01;
