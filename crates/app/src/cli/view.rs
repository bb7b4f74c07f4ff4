//! `cohaul view`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::console::{note, print};
use super::error::CliError;
use super::input::{read_scenario, warn_of_scenario};
use super::watch::is_interrupted;
use crate::live::{LiveScene, Server};
use cohaul::scenario::Scenario;
use cohaul::scenario::shipped::{FIRST, shipped};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul view
  cohaul view scenarios/robots/two-fingers.json

The page is served on 127.0.0.1 only, to whoever has the printed link, until
Ctrl-C. Nothing is written; the page saves scenarios through the browser.")]
pub struct ViewArgs {
    /// Scenario file; - for standard input [default: four ants of the paper]
    scenario: Option<PathBuf>,
    /// Port of the page [default: 7329 if it is free, else any]
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Waits until the page hands its scene back, prints it as a scenario on one line, and ends
    #[arg(long)]
    hand_back: bool,
}

pub fn view(args: &ViewArgs) -> Result<ExitCode, CliError> {
    let scenario = match &args.scenario {
        Some(path) => {
            let scenario = read_scenario(path, None)?;
            warn_of_scenario(path, &scenario);
            scenario
        }
        None => Scenario::parse(shipped(FIRST).expect("it is shipped"), FIRST)?,
    };
    let server = Server::bind(args.port, LiveScene::new(scenario), args.hand_back)?;
    print(&format!("{}\n", server.link()))?;
    note("Open this link in a browser; Ctrl-C ends.");
    if let Some(handed) = server.serve(|| !is_interrupted())? {
        print(&format!("{handed}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}
