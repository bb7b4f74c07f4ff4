//! A colony of one's own: a recording of ants on springs becomes forces, fitted ants, a scenario
//! with these ants, and the paper's figures for the recording and for the scenario.
//!
//! ```text
//! recorded.rs  a recording as rows over time, as a run has them
//! measures.rs  pulls, load speed by group size, and changes, of recordings and runs alike
//! ants.rs      the fitted ants as a scenario
//! suite.rs     runs of the fitted ants as tasks
//! report.rs    all results as data
//! text.rs      results as text and as tables
//! figure.rs    the paper's Figures 9, 11 and 12
//! files.rs     the output folder with its page
//! ```

mod ants;
mod figure;
pub mod files;
mod measures;
mod recorded;
pub mod report;
mod suite;
mod text;

pub use ants::{FittedKey, NotFitted, fitted_ants};
pub use measures::{Measures, nest_of};
pub use recorded::{Recorded, recorded};
pub use report::Colony;
pub use suite::{Plan, RunRecord, tasks};
pub use text::colony_text;
