//! Studies: each builds scenes, runs them, judges the results and writes its report, figures and
//! files.
//!
//! A new study is a folder here and a line below. Its `suite.rs` makes [`runner::Tasks`]: a number
//! of tasks and a function from the number of a task to its record, any type that serde can write.
//! The runner then provides threads, progress, interruption and resumption.
//!
//! ```
//! use cohaul_studies::runner::{Records, Tasks};
//!
//! let tasks = Tasks::equal(100, |task, _go_on| Some((task as f64).sqrt()));
//! let mut records = Records::in_memory();
//! tasks.run(&mut records, &|fraction_done| fraction_done < 2.0).unwrap();
//! assert_eq!(records.get(49), Some(&7.0));
//! ```
//!
//! With `Records::open("DIR.journal", ...)` in place of `Records::in_memory()`, the study survives
//! being stopped or killed at any moment. The ways to move a load that it compares are those of
//! [`methods`], and closed forms are in [`known_answers`].
#![forbid(unsafe_code)]

pub mod advice;
pub mod bench;
pub mod check;
pub mod compare;
pub mod conformance;
pub mod csv_input;
pub mod first_scene;
pub mod gate;
pub mod journal;
mod journal_text;
pub mod known_answers;
pub mod measured;
pub mod methods;
pub mod regime;
pub mod run;
pub mod runner;
pub mod stress;
pub mod subject;
pub mod sweep;
pub mod threshold;
pub mod variants;
pub mod vary;
pub mod verify;
