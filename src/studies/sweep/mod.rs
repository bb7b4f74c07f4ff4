//! Floor 4: ensembles. One scenario over seeds, backends and any of its parameters, on all processors, shards and machines, as one table.
//!
//! A [`Plan`] names every cell by a number: points of the design outermost, then backends, seeds innermost. A cell's row depends on its number and the plan alone, and
//! a finished row is a line of text that no later step changes, so that a table is the same bit for bit whatever threads, kills, resumptions and shards it went
//! through.
//!
//! ```text
//! axis.rs       what one parameter takes: lists, grids, ranges
//! path.rs       where in a scenario it stands
//! design.rs     points: the grid of all lists times the sample of all ranges
//! hypercube.rs  Latin hypercubes; sobol.rs Sobol's sequence, both point by point
//! template.rs   a point -> its scenario
//! plan.rs       cells, and what tells one sweep from another
//! column.rs     columns, fields and lines of the table
//! cell.rs       one cell -> its row
//! shard.rs      a part of the cells, finished; several of them as one table
//! work.rs       all cells that are left, on all threads
//! group.rs      means over the seeds of one point and backend
//! ```

mod axis;
mod cell;
mod column;
mod design;
mod error;
pub mod figure;
pub mod files;
mod group;
mod hypercube;
pub mod page;
mod path;
mod plan;
pub mod report;
mod shard;
mod sobol;
mod template;
mod work;

pub use axis::{Axis, INERTIA, Values};
pub use column::{Column, fields_of, head_of};
pub use design::{Design, Method, Sample};
pub use error::SweepError;
pub use group::{Distribution, Group, Grouper, MEASURES};
pub use plan::{Ask, FORMAT, Identity, Plan, Variant};
pub use shard::{Part, Shards, finish_shard, verified};
pub use sobol::MOST_DIMENSIONS;
pub use work::{validate, work};

/// A table on its way through memory, line by line in the order of cells.
pub trait Table {
    /// Shows every line, without its end, to `visit`.
    ///
    /// # Errors
    /// When the table cannot be read, or `visit` fails.
    fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError>;
}
