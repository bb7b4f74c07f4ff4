//! Why a sweep cannot be made, gone on with, or merged.

use std::io;
use std::path::{Path, PathBuf};

use crate::scenario::ScenarioError;

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
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {what}", path.display())]
    Journal { path: PathBuf, what: String },
    #[error("{}: is of another sweep: {}", path.display(), differences.join("; "))]
    Other { path: PathBuf, differences: Vec<String> },
    /// Shards that do not make one table, every fault.
    #[error("{}", faults.join("\n"))]
    Shards { faults: Vec<String> },
    /// A reader of lines failed.
    #[error("{0}")]
    Output(String),
}

impl SweepError {
    pub fn axis(path: &str, rule: impl Into<String>, found: impl ToString) -> Self {
        SweepError::Axis { path: path.to_owned(), rule: rule.into(), found: found.to_string() }
    }

    pub(super) fn journal(path: &Path, what: impl Into<String>) -> Self {
        SweepError::Journal { path: path.to_owned(), what: what.into() }
    }
}

/// For `map_err`: the file beside what went wrong with it.
pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> SweepError {
    let path = path.to_owned();
    move |source| SweepError::Io { path, source }
}
