//! Where a command writes its results, and the manifest beside them.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde::Serialize;
use serde_json::{Value, json as object};

use super::console::{Tone, print, print_answer};
use super::error::{CliError, at_output};
use cohaul::formats::{self, Versioned, stamped};
use cohaul::scenario::format::ScenarioFile;
use cohaul::scenario::{Scenario, sha256_hex};
use cohaul::simulation::Health;
use cohaul_report::folder::{MANIFEST, check_target};
use cohaul_report::json;
use cohaul_report::junit::Suite;
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::sibling::write_whole;

/// Options of every command that computes something.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Folder for the output files, in place of an earlier output
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

impl OutputArgs {
    /// Checks, before a long run, that the folder may be written.
    pub fn check(&self) -> Result<(), CliError> {
        self.out.as_deref().map_or(Ok(()), check_out)
    }

    /// Prints the result as JSON with its format, or as text with the answer first.
    pub fn print(&self, result: &impl Versioned, text: impl FnOnce() -> String, tone: Tone) -> Result<(), CliError> {
        if self.json { print(&json::pretty(&stamped(result))?) } else { print_answer(&text(), tone) }
    }

    /// Prints where the report is, unless the result is JSON.
    pub fn print_report(&self) -> Result<(), CliError> {
        match self.out.as_deref().filter(|_| !self.json) {
            Some(out) => print(&format!("report\n  {}\n", out.join(REPORT).display())),
            None => Ok(()),
        }
    }
}

/// The text of a scenario file.
pub fn scenario_json(scenario: &Scenario) -> Result<String, CliError> {
    let file = ScenarioFile { format: Some(formats::SCENARIO.version), ..scenario.expanded() };
    Ok(json::pretty(&file)?)
}

/// Option of the commands whose runs give an account of themselves.
#[derive(Args)]
pub struct StrictArgs {
    /// Exit with code 1 if a run is doubtful, too
    ///
    /// `cohaul explain account` says when a run is doubtful.
    #[arg(long, help_heading = "Output")]
    strict: bool,
}

impl StrictArgs {
    /// Exit code of a command whose worst run is so.
    pub fn code(&self, worst: Health) -> ExitCode {
        let most = if self.strict { Health::Ok } else { Health::Doubtful };
        if worst > most { ExitCode::from(1) } else { ExitCode::SUCCESS }
    }
}

/// Option of the commands that check something.
#[derive(Args)]
#[command(next_help_heading = "Output")]
pub struct JunitArgs {
    /// Write the results as JUnit XML too, for continuous integration
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
}

impl JunitArgs {
    /// Checks, before a long run, that a file may be at this place.
    pub fn check(&self) -> Result<(), CliError> {
        match self.junit.as_deref().filter(|path| path.is_dir()) {
            Some(path) => Err(CliError::Usage(format!("--junit: must be a file, found the folder {}", path.display()))),
            None => Ok(()),
        }
    }

    /// Writes the suite, in place of an earlier file.
    pub fn write(&self, suite: impl FnOnce() -> Suite) -> Result<(), CliError> {
        let Some(path) = &self.junit else { return Ok(()) };
        write_whole(path, |out| out.write_all(suite().to_string().as_bytes())).map_err(at_output(path))
    }
}

/// Checks that a folder may be written: see [`check_target`]. A finished sweep is never replaced,
/// because it may have taken days.
pub fn check_out(out: &Path) -> Result<(), CliError> {
    check_target(out)?;
    match identity_in(out) {
        Some(_) => Err(CliError::Usage(format!("{}: must not hold a finished sweep; write to another folder", out.display()))),
        None => Ok(()),
    }
}

/// The identity of the sweep whose output a folder holds; `None` if it holds none.
pub fn identity_in(out: &Path) -> Option<Value> {
    let manifest: Value = serde_json::from_slice(&std::fs::read(out.join(MANIFEST)).ok()?).ok()?;
    manifest["options"].get("sweep").cloned()
}

/// The manifest of a command that ran one scenario.
pub fn manifest_of(scenario: &Scenario, options: &impl Serialize, started: SystemTime) -> Manifest {
    Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, options, command_line(), started)
}

/// The manifest of a study. Its question, with its own scenarios, takes the place of a scenario.
pub fn study_manifest(question: &Value, options: &Value, started: SystemTime) -> Manifest {
    let hash = sha256_hex(question.to_string().as_bytes());
    Manifest::new(question, hash, None, options, command_line(), started)
}

/// The command as it was called. An argument that is no text is written as near as text can.
pub fn command_line() -> Vec<String> {
    std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// The manifest of a command that read the text of the file `name`; the hash is of that text.
pub fn measured_manifest(command: &str, (name, text): (&str, &str), options: &Value, started: SystemTime) -> Manifest {
    let question = object!({ "name": command, "input": name });
    Manifest::new(&question, sha256_hex(text.as_bytes()), None, options, command_line(), started)
}
