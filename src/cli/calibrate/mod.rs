//! `cohaul calibrate fit|design|forces`.

mod design;
mod fit;
mod forces;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::SystemTime;

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::{CliError, command_line, interrupt, positive};
use crate::output::manifest::{Manifest, sha256_hex};
use crate::studies::calibrate::{Dimensions, InputError};

#[derive(Subcommand)]
pub enum CalibrateCommand {
    /// Fit E and linear stiffnesses to measured forces and displacements
    Fit(fit::FitArgs),
    /// Find member lengths and width for wanted stiffnesses
    Design(design::DesignArgs),
    /// Turn recorded tips into the forces of the ants that hold them
    Forces(forces::ForcesArgs),
}

pub fn calibrate(command: &CalibrateCommand) -> Result<ExitCode, CliError> {
    // All of them are short: who asks them to stop waits for what is being written.
    interrupt::asked();
    match command {
        CalibrateCommand::Fit(args) => fit::fit(args),
        CalibrateCommand::Design(args) => design::design(args),
        CalibrateCommand::Forces(args) => forces::forces(args),
    }
}

impl From<InputError> for CliError {
    fn from(error: InputError) -> Self {
        CliError::Usage(error.to_string())
    }
}

/// Dimensions of the spring; what is not given is the paper's.
#[derive(Args)]
struct DimensionArgs {
    /// JSON file of dimensions, with the names of these options and underscores
    #[arg(long, value_name = "FILE")]
    dimensions: Option<PathBuf>,
    /// h, in the plane of bending (m) [paper: 8e-4]
    #[arg(long, value_name = "M", value_parser = positive)]
    member_width_m: Option<f64>,
    /// b, across that plane (m) [paper: 3.2e-3]
    #[arg(long, value_name = "M", value_parser = positive)]
    member_depth_m: Option<f64>,
    /// l_1 (m) [paper: 9.8e-3]
    #[arg(long, value_name = "M", value_parser = positive)]
    short_member_length_m: Option<f64>,
    /// l_2 = l_4 (m) [paper: 1.19e-2]
    #[arg(long, value_name = "M", value_parser = positive)]
    folded_member_length_m: Option<f64>,
    /// l_3 + l_5 (m) [paper: 1.65e-2]
    #[arg(long, value_name = "M", value_parser = positive)]
    link_length_m: Option<f64>,
}

impl DimensionArgs {
    /// Of the file, with the options in place of what it says.
    fn read(&self) -> Result<Dimensions, CliError> {
        let file = self.dimensions.as_deref().map(of_file).transpose()?.unwrap_or_default();
        let found = Dimensions {
            member_width_m: self.member_width_m.unwrap_or(file.member_width_m),
            member_depth_m: self.member_depth_m.unwrap_or(file.member_depth_m),
            short_member_length_m: self.short_member_length_m.unwrap_or(file.short_member_length_m),
            folded_member_length_m: self.folded_member_length_m.unwrap_or(file.folded_member_length_m),
            link_length_m: self.link_length_m.unwrap_or(file.link_length_m),
            ..file
        };
        let from = self.dimensions.as_ref().map_or("dimensions".to_owned(), |path| path.display().to_string());
        match found.faults().first() {
            Some(_) => {
                let lines: Vec<String> = found.faults().iter().map(|fault| format!("{from}: {fault}")).collect();
                Err(CliError::Usage(lines.join("\n")))
            }
            None => Ok(found),
        }
    }
}

fn of_file(path: &Path) -> Result<Dimensions, CliError> {
    let text = read(path)?;
    serde_json::from_str(&text).map_err(|error| CliError::Usage(format!("{}: must be JSON of dimensions: {error}", path.display())))
}

fn read(path: &Path) -> Result<String, CliError> {
    std::fs::read_to_string(path).map_err(|source| CliError::File { path: path.to_owned(), source })
}

/// A number that is zero or more.
fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) && value >= 0.0 => Ok(value),
        _ => Err(format!("must be a finite number, zero or more, found {text}")),
    }
}

/// In place of a scenario stand the question and the hash of the file that was read.
fn manifest(question: &str, input: Option<&Path>, options: Value, started: SystemTime) -> Result<Manifest, CliError> {
    let hash = match input {
        Some(path) => sha256_hex(&std::fs::read(path).map_err(|source| CliError::File { path: path.to_owned(), source })?),
        None => sha256_hex(options.to_string().as_bytes()),
    };
    let asked = json!({ "name": question, "input": input.map(|path| path.display().to_string()) });
    Ok(Manifest::new(&asked, hash, None, &options, command_line(), started))
}
