//! `cohaul scenario show|check|schema`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand;

use super::{CliError, print};
use crate::output::json;
use crate::scenario::{Scenario, format};

#[derive(Subcommand)]
pub enum ScenarioCommand {
    /// Print a scenario with all short forms and defaults expanded
    Show {
        /// Scenario file
        scenario: PathBuf,
    },
    /// Check scenario files and name every fault
    Check {
        /// Scenario files
        #[arg(required = true)]
        scenarios: Vec<PathBuf>,
    },
    /// Print the JSON Schema of the scenario format
    Schema,
}

pub fn scenario(command: &ScenarioCommand) -> Result<ExitCode, CliError> {
    match command {
        ScenarioCommand::Show { scenario } => print(&json::pretty(&Scenario::read(scenario)?.expanded())?)?,
        ScenarioCommand::Schema => print(&json::pretty(&format::schema())?)?,
        ScenarioCommand::Check { scenarios } => return check(scenarios),
    }
    Ok(ExitCode::SUCCESS)
}

fn check(paths: &[PathBuf]) -> Result<ExitCode, CliError> {
    let mut code = ExitCode::SUCCESS;
    for path in paths {
        match Scenario::read(path) {
            Ok(scenario) => print(&format!("{}: ok, \"{}\", hash {}\n", path.display(), scenario.name, scenario.hash()))?,
            Err(error) => {
                say!("error: {error}");
                code = ExitCode::from(2);
            }
        }
    }
    Ok(code)
}
