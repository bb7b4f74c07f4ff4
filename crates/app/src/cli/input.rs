//! Scenario and table files that a command reads; `-` is standard input.

use std::fs::File;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::console;
use super::error::CliError;
use super::error::at_file;
use cohaul::formats::Format;
use cohaul::scenario::{Scenario, bounded, cut};

/// The text of a file, or of standard input, of at most 1 GiB.
pub fn read_text(path: &Path) -> Result<String, CliError> {
    read_up_to(path, bounded::MOST_BYTES_OF_TABLE)
}

/// The text of a scenario, of at most 64 MiB.
pub fn read_scenario_text(path: &Path) -> Result<String, CliError> {
    read_up_to(path, bounded::MOST_BYTES)
}

fn read_up_to(path: &Path, most: u64) -> Result<String, CliError> {
    if is_stdin(path) {
        return bounded::read_text(std::io::stdin().lock(), most).map_err(at_file(Path::new("standard input")));
    }
    File::open(path).and_then(|file| bounded::read_text(file, most)).map_err(at_file(path))
}

/// Reads data of a format from a JSON file; `rule` says what the file must be.
///
/// # Errors
/// When the file cannot be read, or has another format or a version that this program does not
/// read.
pub fn read_json<T: DeserializeOwned>(path: &Path, format: &Format, rule: &str) -> Result<T, CliError> {
    let fault = |why: String| CliError::Usage(format!("{}: {rule}: {}", name_of(path), cut(why, 500)));
    let text = read_text(path)?;
    let value = serde_json::from_str(&text).map_err(|error| fault(error.to_string()))?;
    format.check(&value).map_err(fault)?;
    // The text is read again, because its errors name line and column.
    serde_json::from_str(&text).map_err(|error| fault(error.to_string()))
}

/// Reads data from a JSON file without a format; `rule` says what the file must be.
pub fn read_plain_json<T: DeserializeOwned>(path: &Path, rule: &str) -> Result<T, CliError> {
    serde_json::from_str(&read_text(path)?)
        .map_err(|error| CliError::Usage(format!("{}: {rule}: {}", name_of(path), cut(error.to_string(), 500))))
}

/// Reads a scenario, with the seed of the command line if it has one.
pub fn read_scenario(path: &Path, seed: Option<u64>) -> Result<Scenario, CliError> {
    let scenario = match is_stdin(path) {
        true => Scenario::parse(&read_scenario_text(path)?, &name_of(path))?,
        false => Scenario::read(path)?,
    };
    Ok(Scenario { seed: seed.unwrap_or(scenario.seed), ..scenario })
}

pub fn warn_of_scenario(path: &Path, scenario: &Scenario) {
    let warnings: Vec<String> = scenario.warnings().iter().map(|warning| format!("{}: {warning}", name_of(path))).collect();
    console::warn_all(&warnings);
}

/// How messages name the file.
pub fn name_of(path: &Path) -> String {
    if is_stdin(path) { "standard input".to_owned() } else { path.display().to_string() }
}

/// The file's name without folder and extension, which names outputs.
pub fn stem_of(path: &Path) -> String {
    if is_stdin(path) { "stdin".to_owned() } else { path.file_stem().unwrap_or_default().to_string_lossy().into_owned() }
}

fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Most steps in a control period (1): interrupts and progress are handled between two periods.
const MOST_STEPS: f64 = 1e6;

/// Warns of a step that is longer than the control period, at which each step ends.
///
/// # Errors
/// When the step is so short that a control period takes minutes.
pub fn check_step(step_s: Option<f64>, scenario: &Scenario) -> Result<(), CliError> {
    let Some(step) = step_s else { return Ok(()) };
    let period = scenario.control_period;
    if step > period {
        console::warn(format_args!("--step-s: steps end with the control period, {period} s, found {step} s"));
    }
    let least = period / MOST_STEPS;
    if step < least {
        return Err(CliError::Usage(format!("--step-s: must be at least {least:e} s, 1e-6 of the control period, found {step:e}")));
    }
    Ok(())
}
