//! Tracks: places of named things over time, from the files of trackers.
//!
//! ```text
//! format.rs      the formats, and how a file is known to be of one
//! cells.rs       text of any separator as rows of cells
//! columns.rs     what the columns of a header mean
//! table.rs       tables with one header row: plain ones, and those of most trackers
//! deeplabcut.rs  DeepLabCut's tables with three or four header rows
//! points.rs      what all readers give: points in the file's own units
//! assemble.rs    points of all files as tracks in SI units
//! export.rs      tracks as a table of the project's own form
//! ```

pub mod assemble;
mod cells;
mod columns;
mod deeplabcut;
pub mod export;
pub mod format;
mod points;
mod table;
mod track;

pub use assemble::{Reading, Units, read};
pub use format::TrackFormat;
pub use track::{Sample, Track, Tracks};
