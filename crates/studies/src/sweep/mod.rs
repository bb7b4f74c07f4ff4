//! Ensembles: one scenario over seeds, methods and any of its parameters, on all processors, shards
//! and machines, as one table.
//!
//! A [`Plan`] numbers all cells: points of the design outermost, then methods, seeds innermost. The
//! row of a cell depends on its number and the plan alone. It is a line of text that no later step
//! changes, so that the table is equal bit for bit for any threads, interruptions and shards.
//!
//! ```text
//! axis.rs       values of one parameter: lists, grids, ranges
//! factor.rs     parameters that are factors on a whole scene
//! path.rs       place of a parameter in a scenario
//! design.rs     points: the grid of all lists times the sample of all ranges
//! hypercube.rs, sobol.rs   Latin hypercubes and Sobol's sequence, point by point
//! template.rs   a point -> its scenario
//! plan.rs       cells, and the identity of a sweep
//! column.rs     columns, fields and lines of the table
//! cell.rs       one cell -> its row
//! shard.rs      finished parts of the cells, and several of them as one table
//! work.rs       all cells that are left, on all threads
//! group.rs      means over the seeds of one point and method
//! ```

mod axis;
mod cell;
mod column;
mod design;
mod error;
mod factor;
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
pub use column::{Column, Table, fields_of, head_of};
pub use design::{Design, Method, Sample};
pub use error::SweepError;
pub use factor::Factor;
pub use group::{Distribution, Group, Grouper, MEASURES};
pub use hypercube::coordinate as hypercube_coordinate;
pub use path::Path as Place;
pub use plan::{Ask, FORMAT, Identity, Plan, Variant};
pub use shard::{Part, Shards, finish_shard, shard_files, verified};
pub use sobol::{MOST_DIMENSIONS, MOST_POINTS, coordinate as sobol_coordinate};
pub use template::present_value;
pub use work::{validate, work};
