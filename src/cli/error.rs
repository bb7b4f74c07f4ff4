//! Why a command ended without its result, and the exit code of each reason.

use std::path::{Path, PathBuf};

use crate::backend::{RestoreError, SaveError};
use crate::live::ServerError;
use crate::output::folder::FolderError;
use crate::output::json::NotFinite;
use crate::scenario::ScenarioError;
use crate::studies::from_tips::FromTipsError;
use crate::studies::journal::JournalError;
use crate::studies::sweep::SweepError;

#[derive(Debug, thiserror::Error)]
pub enum CliError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    FromTips(#[from] FromTipsError),
    #[error("{path}: cannot be read or written: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Journal(#[from] JournalError),
    #[error("{path}: {source}")]
    Restore { path: PathBuf, source: RestoreError },
    #[error(transparent)]
    Save(#[from] SaveError),
    #[error(transparent)]
    Server(#[from] ServerError),
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error("interrupted")]
    Interrupted,
    #[error("stopped after {work}; the same command continues from {}", path.display())]
    Stopped { work: String, path: PathBuf },
    #[error("a result is not finite: {0}")]
    NotFinite(#[from] NotFinite),
    #[error("cannot write to standard output: {0}")]
    Output(#[from] std::io::Error),
}

impl CliError {
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::NotFinite(_) | CliError::Output(_) => 3,
            // Shells report the same number for a process that a keyboard interrupt ended.
            CliError::Interrupted | CliError::Stopped { .. } => 130,
            _ => 2,
        }
    }
}

/// Adds the path of the file to an error of reading or writing it.
pub fn at_file(path: &Path) -> impl FnOnce(std::io::Error) -> CliError {
    move |source| CliError::File { path: path.to_owned(), source }
}
