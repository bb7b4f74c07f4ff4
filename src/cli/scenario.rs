//! `cohaul scenario show|check|schema`.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand;
use serde::Serialize;

use super::console::{self, print};
use super::cost::long_run;
use super::error::CliError;
use super::input::{name_of, read_scenario, warn_of_scenario};
use crate::analysis::ExpectedCost;
use crate::analysis::compare::Settings;
use crate::output::json;
use crate::scenario::{Finding, format};

#[derive(Subcommand)]
pub enum ScenarioCommand {
    /// Print a scenario with all short forms and defaults written out
    #[command(after_help = "Example:\n  cohaul scenario show scenarios/paper/four-ants-four-springs.json")]
    Show {
        /// Scenario file; - for standard input
        scenario: PathBuf,
    },
    /// Check scenario files and list every fault and warning
    #[command(after_help = "Example:\n  cohaul scenario check scenarios/*/*.json")]
    Check {
        /// Scenario files; - for standard input
        #[arg(required = true, value_name = "SCENARIO")]
        scenarios: Vec<PathBuf>,
        /// Print one JSON object with names, hashes, faults and warnings instead of text
        #[arg(long)]
        json: bool,
    },
    /// Print the JSON Schema of the scenario format
    #[command(after_help = "Example:\n  cohaul scenario schema > scenario.schema.json")]
    Schema,
}

pub fn scenario(command: &ScenarioCommand) -> Result<ExitCode, CliError> {
    match command {
        ScenarioCommand::Show { scenario } => print(&json::pretty(&read_scenario(scenario, None)?.expanded())?)?,
        ScenarioCommand::Schema => print(&json::pretty(&format::schema())?)?,
        ScenarioCommand::Check { scenarios, json } => return check(scenarios, *json),
    }
    Ok(ExitCode::SUCCESS)
}

/// What is reported of one file.
#[derive(Default, Serialize)]
struct Checked {
    file: String,
    /// Whether a run can use it.
    ok: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hash: Option<String>,
    /// Why the file cannot be used, in one text.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    faults: Vec<Finding>,
    warnings: Vec<Finding>,
}

fn check(paths: &[PathBuf], as_json: bool) -> Result<ExitCode, CliError> {
    let (mut code, mut all) = (ExitCode::SUCCESS, Vec::new());
    for path in paths {
        let file = name_of(path);
        match read_scenario(path, None) {
            Ok(scenario) => {
                warn_of_scenario(path, &scenario);
                let cost = ExpectedCost::of_comparison(&scenario, &Settings::default());
                if let Some(found) = long_run("compare", &scenario, &cost) {
                    console::warn(format_args!("{file}: {}; {}", found.found, found.rule));
                }
                let hash = scenario.hash();
                if !as_json {
                    print(&format!("{file}: ok, \"{}\", hash {hash}\n", scenario.name))?;
                }
                let warnings = scenario.warnings().into_iter().chain(long_run("compare", &scenario, &cost)).collect();
                all.push(Checked { file, ok: true, name: Some(scenario.name), hash: Some(hash), warnings, ..Checked::default() });
            }
            Err(error) => {
                let faults = if let CliError::Scenario(error) = &error { error.findings().to_vec() } else { Vec::new() };
                all.push(Checked { file, error: Some(error.to_string()), faults, ..Checked::default() });
                console::error(error);
                code = ExitCode::from(2);
            }
        }
    }
    if as_json {
        print(&json::pretty(&BTreeMap::from([("scenarios", all)]))?)?;
    }
    Ok(code)
}
