//! `cohaul merge`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;

use super::error::CliError;
use super::output::StrictArgs;
use super::sweep::{finished, print_summary, write_table};
use super::watch::is_interrupted;
use cohaul_report::folder::check_target;
use cohaul_studies::sweep::Shards;

#[derive(Args)]
#[command(after_help = "\
Example:
  cohaul merge out/sweep-a out/sweep-b --out out/sweep")]
pub struct MergeArgs {
    /// Finished shards: files, or folders of `cohaul sweep --shard`
    #[arg(required = true, value_name = "DIR|FILE")]
    sources: Vec<PathBuf>,
    #[command(flatten)]
    strict: StrictArgs,
    /// Folder for tables, figure, summary and manifest
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: PathBuf,
    /// Print one JSON object instead of text
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub fn merge(args: &MergeArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    check_target(&args.out)?;
    let shards = Shards::gather(&args.sources)?;
    finished(&args.out, &shards.identity)?;
    // The folder appears only when it is complete, so that nothing else is lost.
    if is_interrupted() {
        return Err(CliError::Interrupted);
    }
    print_summary(&write_table(&args.out, &shards.identity, &shards, None, started)?, args.json, &args.strict)
}
