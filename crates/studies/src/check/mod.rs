//! Stored runs, and how a changed build, engine or scenario differs from them.
//!
//! A baseline is a run in one file: the scenario as run, the options of the backend, some rows of
//! the path, the decisions, and the end. A check runs it again. It reports which quantities differ
//! by more than their tolerances, and where the two runs first diverge.
//!
//! ```text
//! measure.rs    columns of a stored row, and the measures that are compared in them
//! record.rs     what is stored of a run
//! tolerance.rs  default tolerances, from the scales of the scene
//! baseline.rs   a stored run, and its usual name
//! format.rs, reader.rs, rules.rs, writer.rs   its file
//! difference.rs two runs -> deviations, the first different decision, the first divergence
//! changes.rs    changes of the scenario and the build
//! checking.rs   runs baselines again
//! report.rs     JSON, text and files of a check
//! ```
//!
//! A build repeats its runs bit for bit on one machine. Another compiler or mathematical library
//! differs by rounding that grows along the path, for which the default tolerances leave room. A
//! change in an engine is larger.

mod baseline;
mod changes;
mod checking;
mod difference;
mod format;
mod measure;
mod reader;
mod record;
pub mod report;
mod rules;
mod tolerance;
mod writer;

pub use baseline::{Baseline, Build, usual_name};
pub use changes::{BuildChange, ScenarioChange};
pub use checking::{Check, Settings, Verdict, check, run};
pub use difference::{Change, Decision, Deviation, Difference, Divergence, Side};
pub use format::{FORMAT, VERSION};
pub use measure::{COLUMNS, MEASURES, Measure, Quantity, Row};
pub use reader::read_folder;
pub use record::{Ending, Event, MOST_EVENTS, Number, Record, Steps};
pub use tolerance::Tolerances;
pub use writer::write_file;
