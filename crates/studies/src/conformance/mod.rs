//! Conformance: questions with closed answers, put to any engine that moves a load.
//!
//! A [`Test`] is one question with its known answer, where that comes from, and what a wrong answer
//! means to a user. Each run of a test meets the engine anew, so that one which refuses a scene,
//! fails or hangs in one test leaves a row that says so, and the table goes on.
//!
//! ```text
//! asked.rs      an engine as tests ask it: a fresh run for each scenario
//! test.rs       a question, and what was measured
//! grade.rs      errors in words, and why the limits lie where they do
//! scenes.rs     loads, springs and tips
//! stops.rs      slide, spin, direction of friction, order, directions
//! springs.rs    hold, pull, oscillation, a grasp at a release, light and heavy loads
//! contact.rs    walls and impacts
//! invariance.rs equal runs, control ticks, units
//! suite.rs      all tests as tasks
//! report.rs     JSON, text, Markdown
//! files.rs      the page and the files
//! ```

mod asked;
mod contact;
pub mod files;
mod grade;
mod invariance;
pub mod report;
mod scenes;
mod springs;
mod stops;
mod suite;
mod test;

pub use grade::Grade;
pub use suite::{STEP_S, STEPS_S, all, first_scene, tasks};
pub use test::{Answer, Measure, Outcome, Test};
