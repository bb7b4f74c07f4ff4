//! Measured runs beside simulated ones: a fourth difference.
//!
//! ```text
//! inertia effect  = inertial - quasi-static
//! engine error    = engine   - inertial
//! reference error = bound of the numerical error, and what smoothing leaves open
//! model error     = measured - inertial
//! ```
//!
//! The model error says how far ground, outline and friction of the scene are from the real ones.
//!
//! ```text
//! columns.rs    columns of a table and their units
//! recording.rs  tables of instants as runs
//! push_log.rs   logs of single pushes as JSON
//! smoothing.rs  smooth paths from samples
//! scene.rs      the scene of a run
//! run.rs        one run beside its simulated ones
//! parameter.rs  numbers of a scene that a fit may change
//! fit.rs        a fit of these, with its region
//! report.rs     medians over runs and the answer
//! text.rs       the report as text
//! figure.rs     figures
//! files.rs      page, table, figures and summary in an output folder
//! ask.rs        what the program and the Python package share
//! ```

pub mod ask;
mod columns;
mod figure;
pub mod files;
pub mod fit;
pub mod parameter;
pub mod push_log;
pub mod recording;
pub mod report;
pub mod run;
pub mod scene;
pub mod smoothing;
pub mod text;

use recording::MeasuredRun;
use run::{Compare, Question, RunRecord};
use scene::SceneTemplate;

use crate::runner::Tasks;

/// All runs as tasks.
pub fn tasks<'a>(
    template: &'a SceneTemplate,
    runs: &'a [MeasuredRun],
    question: &'a Question,
    compare: &'a Compare<'a>,
) -> Tasks<'a, RunRecord> {
    Tasks::equal(runs.len(), move |at, go_on| RunRecord::of(template, &runs[at], question, compare, go_on))
}
