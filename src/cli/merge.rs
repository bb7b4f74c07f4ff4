//! `cohaul merge`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;

use super::sweep::{finished, said, written};
use super::{CliError, interrupt};
use crate::output::folder::check_target;
use crate::studies::sweep::Shards;

#[derive(Args)]
pub struct MergeArgs {
    /// Finished shards: files, or folders that `cohaul sweep --shard` wrote to
    #[arg(required = true, value_name = "DIR|FILE")]
    sources: Vec<PathBuf>,
    /// Folder for tables, figure, summary and manifest
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

pub fn merge(args: &MergeArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    check_target(&args.out)?;
    let shards = Shards::gather(&args.sources)?;
    finished(&args.out, &shards.identity)?;
    // Nothing is there before all of it is: a stop loses no work but this.
    if interrupt::asked() {
        return Err(CliError::Interrupted);
    }
    said(&written(&args.out, &shards.identity, &shards, None, started)?, args.json)
}
