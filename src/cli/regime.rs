//! `cohaul regime`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::{Value, json};

use super::{CliError, check_out, command_line, print, resumable};
use crate::output::json;
use crate::output::manifest::{Manifest, sha256_hex};
use crate::studies::regime::report::{Regime, regime_text, write_regime};
use crate::studies::regime::{self, Effort, Grid, Scene};

#[derive(Args)]
pub struct RegimeArgs {
    /// Only these scenes; without it all
    #[arg(long, value_name = "SCENE", num_args = 1..)]
    scene: Vec<Scene>,
    /// Six values an axis in place of twenty
    #[arg(long)]
    quick: bool,
    /// Folder for maps, cells, summary and manifest; what an interrupted run has done is kept beside it, as DIR.journal
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

pub fn regime(args: &RegimeArgs) -> Result<ExitCode, CliError> {
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let scenes: Vec<Scene> = Scene::ALL.into_iter().filter(|scene| args.scene.is_empty() || args.scene.contains(scene)).collect();
    let maps: Vec<Grid> = scenes.iter().map(|scene| Grid::of(*scene, effort)).collect();
    let grids: Vec<Grid> = maps.iter().cloned().chain(scenes.iter().map(|scene| Grid::paper(*scene))).collect();
    let asked = json!({ "scenes": scenes, "effort": effort });
    let started = SystemTime::now();
    let mut finished = resumable::run("regime", &asked, &regime::tasks(&grids), args.out.as_deref())?;
    let mut cells = std::mem::take(&mut finished.records);
    let paper = cells.split_off(maps.iter().map(Grid::n_cells).sum());
    let found = Regime::new(&maps, cells, &paper, args.quick, finished.wall_s);
    if let Some(out) = &args.out {
        write_regime(out, &found, &manifest(&asked, started))?;
    }
    finished.remove_journal()?;
    print(&if args.json { json::pretty(&found)? } else { regime_text(&found) })?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// In place of a scenario stand the scenes asked for.
fn manifest(asked: &Value, started: SystemTime) -> Manifest {
    let scenario = json!({ "name": "regime", "scenes": asked["scenes"] });
    let options = json!({ "effort": asked["effort"] });
    let hash = sha256_hex(scenario.to_string().as_bytes());
    Manifest::new(&scenario, hash, 0, &options, command_line(), started)
}
