//! Why a sweep cannot be made, gone on with, or merged.

use crate::journal::JournalError;
use cohaul::scenario::{ScenarioError, cut};
use cohaul_report::lines::TableError;

#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A parameter: where, what must hold, what was found.
    #[error("{path}: {rule}, found {found}")]
    Axis { path: String, rule: String, found: String },
    /// A point of the design breaks a rule of the scenario.
    #[error("with {values}: {source}")]
    Point { values: String, source: ScenarioError },
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The disk failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A number or the disk failed a table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Shards that do not make one table, every fault.
    #[error("{}", faults.join("\n"))]
    Shards { faults: Vec<String> },
    /// A line that does not fit the columns.
    #[error("a row does not fit the columns of the table: {0}")]
    Line(String),
}

/// Longest text of a place or of what was found in a message (characters).
const LONGEST: usize = 500;

impl SweepError {
    pub fn axis(path: &str, rule: impl Into<String>, found: impl ToString) -> Self {
        SweepError::Axis { path: cut(path.to_owned(), LONGEST), rule: rule.into(), found: cut(found.to_string(), LONGEST) }
    }
}
