//! A gate for new builds of an engine: its errors on a set of scenes, stored, and how those of the
//! next build differ.
//!
//! ```text
//! record.rs   stored errors, and their file
//! scenes.rs   the scenes that are recorded unless others are named
//! measured.rs a scene on an engine -> its errors
//! change.rs   stored and new errors -> better, worse or same
//! report.rs   JSON, text, Markdown, JUnit
//! ```
//!
//! An error is known to its reference error, that of the exact runs. A change counts where it is
//! larger than the reference errors of both builds together, than rounding, and than a margin that
//! the user sets. What changes by less is the same.

mod change;
mod measured;
mod record;
pub mod report;
mod scenes;

pub use change::{Change, MARGIN, MeasureChange, QuantityChange, SceneChange};
pub use measured::{record, settings};
pub use record::{Error, Quantity, Record, SceneRecord, file_name};
pub use report::Gate;
pub use scenes::usual;
