//! What all resumable commands share: a journal beside the output folder, progress, and how a
//! stopped command ends.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::console;
use super::error::CliError;
use super::watch::watched;
use cohaul_studies::journal::{Journal, JournalError, build};
use cohaul_studies::runner::{Records, Tasks};

/// All records of a study, in the order of their tasks.
pub struct Finished<R> {
    pub records: Vec<R>,
    /// Run time of all calls (s).
    pub wall_s: f64,
    journal: Option<Journal>,
}

impl<R> Finished<R> {
    /// Removes the journal once all output is written.
    pub fn remove_journal(self) -> Result<(), JournalError> {
        self.journal.map_or(Ok(()), Journal::remove)
    }
}

/// The journal beside the folder `out`: `DIR.journal`.
pub fn journal_beside(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".journal");
    out.with_file_name(name)
}

/// Opens the records of a study, with those that a stopped call left in the file. Records of
/// another build or of another question, `asked`, are refused.
pub fn open<R: Serialize + DeserializeOwned>(study: &str, asked: &Value, path: Option<&Path>) -> Result<Records<R>, CliError> {
    let Some(path) = path else { return Ok(Records::in_memory()) };
    let mut identity = asked.clone();
    for (key, value) in build().as_object().into_iter().flatten() {
        identity[key] = value.clone();
    }
    let records = Records::open(path, study, &identity)?;
    if records.n_done() > 0 {
        console::note(format_args!("{}: continues after {} tasks", path.display(), records.n_done()));
    }
    Ok(records)
}

/// Runs all tasks of a study that an earlier call has not finished.
///
/// # Errors
/// When the user stopped the command, the journal belongs to another question, or the disk fails.
pub fn run<R>(study: &str, asked: &Value, tasks: &Tasks<R>, out: Option<&Path>) -> Result<Finished<R>, CliError>
where
    R: Serialize + DeserializeOwned + Send,
{
    let mut records = open(study, asked, out.map(journal_beside).as_deref())?;
    watched(study, |watch| tasks.run(&mut records, watch))?;
    finished(records, tasks.costs.len())
}

/// The `n` records of a study and its journal.
///
/// # Errors
/// When records are missing, because the user stopped the command.
pub fn finished<R: Serialize + DeserializeOwned>(records: Records<R>, n: usize) -> Result<Finished<R>, CliError> {
    let wall_s = records.wall_s();
    match records.complete(n) {
        Ok((records, journal)) => Ok(Finished { records, wall_s, journal }),
        Err(records) => Err(stopped(&format!("{} of {n} tasks", records.n_done()), records.path())),
    }
}

/// The end of a command that the user stopped after this work, which is kept in the file.
pub fn stopped(work: &str, path: Option<&Path>) -> CliError {
    let stopped = |path: &Path| CliError::Stopped { work: work.to_owned(), path: path.to_owned() };
    path.map_or(CliError::Interrupted, stopped)
}
