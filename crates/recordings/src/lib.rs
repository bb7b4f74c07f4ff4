//! Scenarios from recordings and drawings as people have them: files of trackers, tables of any
//! form, and outlines of drawing programs.
//!
//! ```text
//! account.rs  what an import did, counted: nothing is invented silently
//! tracks/     readers of tables and of trackers' files, all into one value
//! repair/     swapped ids, jumps, gaps, smoothing
//! scene.rs    tracks as tips, load and obstacles of a scenario
//! obstacles.rs  paths of recorded obstacles
//! drawings/   outlines of drawings
//! import.rs   from files to a checked scenario
//! ```
#![forbid(unsafe_code)]

pub mod account;
pub mod drawings;
pub mod import;
mod obstacles;
pub mod repair;
pub mod scene;
pub mod tracks;
