//! Stress test: where numbers break. Maps over two parameters of a scene, far beyond what it is
//! made for, and the result of each backend in every cell.
//!
//! A [`Map`] is a grid of two parameters over a base scene and what is known of its answer. Each
//! cell is run on every method of the backends, observed at every step, and ends as one
//! [`Row`]: an [`Outcome`], the cause in words of every one but `finished`, and the numbers behind
//! both. Panics are caught cell by cell, numbers that are not finite are looked for in everything
//! that a backend reports, and whatever has no cause counts as unexplained.
//!
//! All budgets count work and not time, and nothing depends on how cells are spread over threads: a
//! table is the same bit for bit on every run.
//!
//! ```text
//! map.rs       axes, grids, a cell and what is asked of it
//! scene.rs     base scenes as scenario files
//! maps/        the maps, one file a family
//! guard.rs     panics as results
//! observer.rs  hook that observes a backend at every step
//! run.rs       one cell on one backend: numbers
//! judge.rs     numbers -> outcome
//! cause.rs     outcome -> cause
//! suite.rs     all cells as tasks
//! ```

mod cause;
pub mod files;
pub(crate) mod guard;
pub mod heat_map;
mod judge;
mod map;
mod maps;
mod observer;
pub mod page;
pub mod report;
mod run;
mod scene;
mod suite;

pub use crate::runner::Effort;
pub use judge::{Judged, Outcome};
pub use map::{Answer, Asked, Axis, Cell, Map};
pub use maps::all;
pub use run::Numbers;
pub use scene::Scene;
pub use suite::{Row, tasks};
