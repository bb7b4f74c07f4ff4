//! Up to which value of a parameter quasi-static is valid, quantity by quantity.
//!
//! The two exact models are compared, without an engine, on a logarithmic grid. Wherever two
//! neighbours differ in their answer on a quantity, more points are put between them until the
//! boundary is known to a percent. A quantity may have any number of boundaries, and what is open,
//! at rest or failed is a range of its own.
//!
//! ```text
//! asked.rs    a parameter and its range, as asked for
//! point.rs    the two exact models at one value
//! search.rs   the grid, and the points that follow from those before
//! bands.rs    ranges of one answer, and the boundaries between them
//! report.rs   the answer, the tables and the text
//! words.rs    values and ranges in words
//! figure.rs   inertia effect over tolerance
//! files.rs    page, table, figure and summary in an output folder
//! ```

mod asked;
mod bands;
mod figure;
pub mod files;
mod point;
pub mod report;
mod search;
mod words;

pub use asked::Asked;
pub use bands::{Band, Bound};
pub use point::{Class, Effect, Point};
pub use search::{PRECISION, search};
