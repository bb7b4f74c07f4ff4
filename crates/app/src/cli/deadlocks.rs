//! `cohaul paper deadlocks`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::choice::positive;
use super::console::Tone;
use super::error::CliError;
use super::input::{name_of, read_scenario};
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use cohaul::scenario::Drive;
use cohaul_paper::paper::standstill::{Deadlocks, HOLD_S, Plan};
use cohaul_report::folder::OutputFolder;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul paper deadlocks scenarios/paper/corridor.json
  cohaul paper deadlocks scenarios/paper/doorway.json --seeds 100 --out out/door

A standstill is a time of at least HOLD without progress: the load comes no
millimetre nearer to the nest. Files in DIR: deadlocks.csv, README.md,
summary.json and manifest.json. The state of an interrupted run is kept in
DIR.journal.")]
pub struct DeadlocksArgs {
    /// Scenes with ants
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Number of seeds of each scene and backend
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Shortest time without progress that counts
    #[arg(long, value_name = "HOLD", default_value_t = HOLD_S, value_parser = positive)]
    hold_s: f64,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn deadlocks(args: &DeadlocksArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    let mut scenes = Vec::new();
    for path in &args.scenarios {
        let scenario = read_scenario(path, None)?;
        if !matches!(scenario.drive, Drive::Ants(_)) {
            return Err(CliError::Usage(format!("{}: drive.kind: must be ants, found tips", name_of(path))));
        }
        scenes.push((path.file_stem().map_or_else(|| name_of(path), |name| name.to_string_lossy().into_owned()), scenario));
    }
    let plan = Plan { scenes, first_seed: args.seed, n_seeds: args.seeds, hold_s: args.hold_s };
    let started = SystemTime::now();
    let expanded: Vec<_> = plan.scenes.iter().map(|(_, scenario)| scenario.expanded()).collect();
    let asked = json!({ "scenes": expanded, "first_seed": plan.first_seed, "n_seeds": plan.n_seeds, "hold_s": plan.hold_s });
    let finished = resumable::run("paper deadlocks", &asked, &plan.tasks(), args.output.out.as_deref())?;
    let found = Deadlocks::new(&plan, &finished.records);
    if let Some(out) = &args.output.out {
        let mut folder = OutputFolder::create(out)?;
        folder.write("deadlocks.csv", |out| found.rows_table().write_csv(out))?;
        folder.write("README.md", |out| out.write_all(found.readme().as_bytes()))?;
        folder.write_json("summary.json", &found)?;
        folder.finish(&study_manifest(&json!({ "name": "standstills", "scenes": expanded }), &asked, started))?;
    }
    finished.remove_journal()?;
    args.output.print(&found, || found.table().text(), Tone::Good)?;
    Ok(ExitCode::SUCCESS)
}
