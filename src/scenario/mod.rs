//! A run as data. A scenario file is read, checked as a whole and expanded into a [`Scenario`]. The
//! rest of the program does not use the file.

pub mod bounded;
mod data;
mod error;
mod expand;
pub mod json;
mod nearest;
mod read;
mod scaled;
mod structure;
mod validate;
mod warnings;

pub mod format;
pub mod presets;
pub mod shipped;

pub use data::SAME_INSTANT;
pub use data::{AntDrive, Drive, Scenario, TipPath, Waypoint};
pub use error::cut;
pub use error::is_in_range;
pub use error::{Finding, Findings, ScenarioError, lines};
pub use expand::sha256_hex;
pub use nearest::nearest;
