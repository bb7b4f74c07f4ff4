//! `cohaul scenario show|check|new|import|from-tips|schema`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Subcommand;
use serde::Serialize;

use super::calibrate::table_of;
use super::choice::seconds;
use super::console::{self, detail, print};
use super::cost::long_run;
use super::error::CliError;
use super::import::{ImportArgs, import};
use super::input::{name_of, read_scenario, read_text, warn_of_scenario};
use super::new::{NewArgs, new};
use super::output::scenario_json;
use cohaul::analysis::{Advice, ExpectedCost};
use cohaul::formats::{self, Format, Versioned, stamped};
use cohaul::scenario::{Finding, Scenario, format};
use cohaul_paper::from_tips::scenario_from_tips;
use cohaul_report::json;
use cohaul_report::text::{Detail, Lines};
use cohaul_studies::advice::advice_text;

#[derive(Subcommand)]
pub enum ScenarioCommand {
    /// Print a scenario with all short forms and defaults written out
    #[command(after_help = "Example:\n  cohaul scenario show scenarios/paper/four-ants-four-springs.json")]
    Show {
        /// Scenario file; - for standard input
        scenario: PathBuf,
    },
    /// Check scenario files: every fault and warning, and what is known before a run
    ///
    /// For each file that a run can use, it prints the weight, the slip limit, and the natural
    /// frequencies on the springs attached first. First pulls over the slip limit, epsilon, Phi and
    /// expected run times on one core follow.
    #[command(after_help = "Example:\n  cohaul scenario check scenarios/*/*.json")]
    Check {
        /// Scenario files; - for standard input
        #[arg(required = true, value_name = "SCENARIO")]
        scenarios: Vec<PathBuf>,
        /// Print one JSON object with names, hashes, faults, warnings and advice instead of text
        #[arg(long)]
        json: bool,
    },
    /// Write a first scene: robots that tow a box or a disc, each on a spring of its own
    ///
    /// On a terminal the program asks for what no option gives; elsewhere that has its default.
    /// The roots are on the front of the load, and the tips move along x. When the load begins to
    /// slip, the springs are stretched by a fifth of its radius. The JSON Schema of the format,
    /// which editors read, is written beside the scene.
    New(NewArgs),
    /// Make a scenario of a tracker's recording or a drawing, on the ground and springs of another
    ///
    /// Files are those of DeepLabCut, SLEAP, idtracker.ai, TRex, tracktor and SwisTrack, and tables
    /// with one header row of any order, separator and unit. Drawings are SVG, DXF, GeoJSON, OBJ
    /// and MJCF; a scenario alone has its outline put right. A table of all that was done is
    /// printed.
    Import(Box<ImportArgs>),
    /// Make a scenario of recorded tips, on the load, ground and springs of another
    ///
    /// The recording is the table that `cohaul run --tips` writes and `cohaul calibrate forces`
    /// reads, in world axes: time_s, spring, x_m, y_m, heading_rad, tip_x_m, tip_y_m and, if known,
    /// event. A spring is attached from its first row until its row with the event "release", or
    /// without that column until the first time at which the other springs have rows and it has
    /// none. The load starts at the recorded pose of time 0, if there is one.
    #[command(after_help = "\
Example:
  cohaul scenario from-tips out/run/tips.csv --like ants.json > recorded.json")]
    FromTips {
        /// Table of tips, or the folder of a run with --tips; - for standard input
        #[arg(value_name = "FILE")]
        recording: PathBuf,
        /// Scenario with the load, the ground, the springs and the obstacles
        #[arg(long, value_name = "SCENARIO")]
        like: PathBuf,
        /// Name of the new scenario [default: the name of the other one, and "recorded tips"]
        #[arg(long)]
        name: Option<String>,
        /// Duration (s) [default: that of the other one if it has prescribed tips, or of the table]
        #[arg(long, value_name = "T", value_parser = seconds)]
        duration_s: Option<f64>,
    },
    /// Print the JSON Schema of the scenario format
    #[command(after_help = "Example:\n  cohaul scenario schema > scenario.schema.json")]
    Schema,
}

pub fn scenario(command: &ScenarioCommand) -> Result<ExitCode, CliError> {
    match command {
        ScenarioCommand::Show { scenario } => print_scenario(&read_scenario(scenario, None)?)?,
        ScenarioCommand::Schema => print(&json::pretty(&format::schema())?)?,
        ScenarioCommand::New(args) => return new(args),
        ScenarioCommand::Import(args) => return import(args),
        ScenarioCommand::Check { scenarios, json } => return check(scenarios, *json),
        ScenarioCommand::FromTips { recording, like, name, duration_s } => {
            let file = table_of(recording)?;
            let like = read_scenario(like, None)?;
            let made = scenario_from_tips(&read_text(&file)?, &name_of(&file), &like)?;
            let name = name.clone().unwrap_or(made.name.clone());
            let made = Scenario { name, duration: duration_s.unwrap_or(made.duration), ..made };
            print_scenario(&made.expanded().checked(&name_of(&file))?)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints the expanded scenario with the version of its format.
fn print_scenario(scenario: &Scenario) -> Result<(), CliError> {
    print(&scenario_json(scenario)?)
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
    /// What is known before a run.
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<Advice>,
}

/// What `scenario check` prints with `--json`.
#[derive(Serialize)]
struct AllChecked {
    scenarios: Vec<Checked>,
}

impl Versioned for AllChecked {
    const FORMAT: Format = formats::SCENARIO_CHECK;
}

/// The name of a valid scenario, and what is known before a run; with `--verbose` also its hash.
fn checked_text(file: &str, scenario: &Scenario, advice: &Advice) -> String {
    let mut lines = Lines::default();
    lines.section(&format!("{file}: ok"));
    lines.row("scene", &scenario.name);
    if detail() == Detail::Full {
        lines.text += &format!("  hash {}\n", scenario.hash());
    }
    lines.text + &advice_text(scenario, advice)
}

fn check(paths: &[PathBuf], as_json: bool) -> Result<ExitCode, CliError> {
    let (mut code, mut all) = (ExitCode::SUCCESS, Vec::new());
    for path in paths {
        let file = name_of(path);
        match read_scenario(path, None) {
            Ok(scenario) => {
                warn_of_scenario(path, &scenario);
                let cost = ExpectedCost::of_compare(&scenario);
                if let Some(found) = long_run("compare", &scenario, &cost) {
                    console::warn(format_args!("{file}: {}; {}", found.found, found.rule));
                }
                let (hash, advice) = (scenario.hash(), Advice::of(&scenario));
                if !as_json {
                    print(&checked_text(&file, &scenario, &advice))?;
                }
                let warnings = long_run("compare", &scenario, &cost).into_iter().chain(scenario.warnings()).collect();
                let (name, hash, advice) = (Some(scenario.name), Some(hash), Some(advice));
                all.push(Checked { file, ok: true, name, hash, warnings, advice, ..Checked::default() });
            }
            Err(error) => {
                let faults = if let CliError::Scenario(error) = &error { error.findings().to_vec() } else { Vec::new() };
                all.push(Checked { file, error: Some(error.to_string()), faults, ..Checked::default() });
                console::fault(&error);
                code = ExitCode::from(2);
            }
        }
    }
    if as_json {
        print(&json::pretty(&stamped(&AllChecked { scenarios: all }))?)?;
    }
    Ok(code)
}
