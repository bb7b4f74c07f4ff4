//! A run as data. A scenario file is read, checked as a whole and expanded into a [`Scenario`]. The
//! rest of the program does not use the file.

pub(crate) mod bounded;
mod data;
mod error;
mod expand;
pub(crate) mod json;
mod nearest;
mod read;
mod scaled;
mod structure;
mod validate;
mod warnings;

pub mod format;
pub mod presets;

pub(crate) use data::SAME_INSTANT;
pub use data::{AntDrive, Drive, Scenario, TipPath, Waypoint};
pub(crate) use error::cut;
#[cfg(feature = "reports")]
pub(crate) use error::is_in_range;
pub use error::{Finding, Findings, ScenarioError, lines};
#[cfg(any(feature = "program", all(test, feature = "output")))]
pub(crate) use expand::sha256_hex;
#[cfg(feature = "reports")]
pub(crate) use nearest::nearest;
