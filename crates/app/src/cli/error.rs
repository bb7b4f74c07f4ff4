//! Why a command ended without its result, and the exit code of each reason.

use std::error::Error;
use std::path::{Path, PathBuf};

use super::exit::Exit;
use crate::live::ServerError;
use cohaul::backend::{RestoreError, SaveError};
use cohaul::scenario::ScenarioError;
use cohaul_paper::from_tips::FromTipsError;
use cohaul_report::folder::FolderError;
use cohaul_report::json::NotFinite;
use cohaul_report::lines::TableError;
use cohaul_studies::journal::JournalError;
use cohaul_studies::sweep::SweepError;

#[derive(Debug, thiserror::Error)]
pub enum CliError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    FromTips(#[from] FromTipsError),
    #[error("{path}: cannot be read: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error("{path}: cannot be written: {source}")]
    Unwritten { path: PathBuf, source: std::io::Error },
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
    #[error("{0}")]
    Engine(String),
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
    pub fn exit(&self) -> Exit {
        match self {
            error if is_not_finite(error) => Exit::Internal,
            CliError::Save(_) => Exit::Internal,
            CliError::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Exit::Closed,
            CliError::Output(_) | CliError::Unwritten { .. } => Exit::Output,
            CliError::Folder(error) => of_folder(error),
            CliError::Journal(error) => of_journal(error),
            CliError::Sweep(error) => of_sweep(error),
            CliError::Engine(_) => Exit::Failed,
            CliError::Interrupted | CliError::Stopped { .. } => Exit::Interrupted,
            _ => Exit::Input,
        }
    }
}

/// Where an output goes is input; that it cannot be written is not.
fn of_folder(error: &FolderError) -> Exit {
    match error {
        FolderError::Io { .. } => Exit::Output,
        // Rows of shards are read while the table is written.
        FolderError::Content { source, .. } => source.downcast_ref().map_or(Exit::Output, of_sweep),
        _ => Exit::Input,
    }
}

fn of_sweep(error: &SweepError) -> Exit {
    match error {
        SweepError::Io(_) | SweepError::Table(_) => Exit::Output,
        SweepError::Journal(error) => of_journal(error),
        _ => Exit::Input,
    }
}

fn of_journal(error: &JournalError) -> Exit {
    if matches!(error, JournalError::Io { .. }) { Exit::Output } else { Exit::Input }
}

/// Whether an error comes from a result that is not finite. An error that shows another one as
/// itself has the cause of that one, and is looked at by itself.
fn is_not_finite(error: &(dyn Error + 'static)) -> bool {
    let is_it = |error: &(dyn Error + 'static)| {
        error.is::<NotFinite>()
            || matches!(error.downcast_ref(), Some(CliError::NotFinite(_)))
            || matches!(error.downcast_ref(), Some(CliError::Sweep(SweepError::Table(TableError::NotFinite(_)))))
            || matches!(error.downcast_ref(), Some(TableError::NotFinite(_)))
    };
    is_it(error) || error.source().is_some_and(is_not_finite)
}

/// Adds the path of the file to an error of reading it.
pub fn at_file(path: &Path) -> impl FnOnce(std::io::Error) -> CliError {
    move |source| CliError::File { path: path.to_owned(), source }
}

/// Adds the path of the file to an error of writing it.
pub fn at_output(path: &Path) -> impl FnOnce(std::io::Error) -> CliError {
    move |source| CliError::Unwritten { path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_that_is_not_finite_is_internal_wherever_it_is_found() {
        let found = || NotFinite { path: "end.time_s".into(), value: f64::NAN };
        let content = |source| CliError::Folder(FolderError::Content { path: "out".into(), source });
        let table = || TableError::NotFinite(found());
        for error in [content(Box::new(found())), content(Box::new(table())), found().into(), CliError::Sweep(table().into())] {
            assert_eq!(error.exit(), Exit::Internal, "{error}");
        }
        let full = || std::io::Error::from(std::io::ErrorKind::StorageFull);
        let sweep = CliError::Sweep(full().into());
        let journal = CliError::Journal(JournalError::Io { path: "out".into(), source: full() });
        let folder = CliError::Folder(FolderError::Io { path: "out".into(), source: full() });
        for error in [content(Box::new(full())), full().into(), at_output("out".as_ref())(full()), sweep, journal, folder] {
            assert_eq!(error.exit(), Exit::Output, "{error}");
        }
        assert_eq!(at_file("in".as_ref())(full()).exit(), Exit::Input);
        let shard = SweepError::Journal(JournalError::unusable("rows".as_ref(), "line 2 is cut off"));
        assert_eq!(content(Box::new(shard)).exit(), Exit::Input);
        assert_eq!(CliError::Output(std::io::ErrorKind::BrokenPipe.into()).exit(), Exit::Closed);
    }
}
