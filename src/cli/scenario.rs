//! `cohaul scenario show|check|schema`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand;

use super::console::{self, print};
use super::error::CliError;
use super::input::{name_of, read_scenario};
use crate::output::json;
use crate::scenario::format;

#[derive(Subcommand)]
pub enum ScenarioCommand {
    /// Print a scenario with all short forms and defaults written out
    #[command(after_help = "Example:\n  cohaul scenario show scenarios/paper/four-ants-four-springs.json")]
    Show {
        /// Scenario file; - for standard input
        scenario: PathBuf,
    },
    /// Check scenario files and list every fault
    #[command(after_help = "Example:\n  cohaul scenario check scenarios/*/*.json")]
    Check {
        /// Scenario files; - for standard input
        #[arg(required = true, value_name = "SCENARIO")]
        scenarios: Vec<PathBuf>,
    },
    /// Print the JSON Schema of the scenario format
    #[command(after_help = "Example:\n  cohaul scenario schema > scenario.schema.json")]
    Schema,
}

pub fn scenario(command: &ScenarioCommand) -> Result<ExitCode, CliError> {
    match command {
        ScenarioCommand::Show { scenario } => print(&json::pretty(&read_scenario(scenario, None)?.expanded())?)?,
        ScenarioCommand::Schema => print(&json::pretty(&format::schema())?)?,
        ScenarioCommand::Check { scenarios } => return check(scenarios),
    }
    Ok(ExitCode::SUCCESS)
}

fn check(paths: &[PathBuf]) -> Result<ExitCode, CliError> {
    let mut code = ExitCode::SUCCESS;
    for path in paths {
        match read_scenario(path, None) {
            Ok(scenario) => print(&format!("{}: ok, \"{}\", hash {}\n", name_of(path), scenario.name, scenario.hash()))?,
            Err(error) => {
                console::error(error);
                code = ExitCode::from(2);
            }
        }
    }
    Ok(code)
}
