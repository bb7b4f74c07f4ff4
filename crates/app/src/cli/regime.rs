//! `cohaul regime`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::choice::choice;
use super::console::Tone;
use super::error::CliError;
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use cohaul_studies::regime::files::{regime_text, write_regime};
use cohaul_studies::regime::report::Regime;
use cohaul_studies::regime::{self, Effort, Grid, Scene};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul regime --quick
  cohaul regime --scene haul --out out/regime

Files in DIR: maps (SVG), regime.csv, summary and manifest. The state of an
interrupted run is kept in DIR.journal.")]
pub struct RegimeArgs {
    /// Only these scenes; without it, all
    #[arg(long, num_args = 1.., value_parser = choice::<Scene>())]
    scene: Vec<Scene>,
    /// Six values on each axis in place of twenty
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn regime(args: &RegimeArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    let effort = Effort::of(args.quick);
    let scenes: Vec<Scene> = Scene::ALL.into_iter().filter(|scene| args.scene.is_empty() || args.scene.contains(scene)).collect();
    let maps: Vec<Grid> = scenes.iter().map(|scene| Grid::of(*scene, effort)).collect();
    let grids: Vec<Grid> = maps.iter().cloned().chain(scenes.iter().map(|scene| Grid::of_short_pulls(*scene))).collect();
    let asked = json!({ "scenes": scenes, "effort": effort });
    let started = SystemTime::now();
    let mut finished = resumable::run("regime", &asked, &regime::tasks(&grids), args.output.out.as_deref())?;
    let mut cells = std::mem::take(&mut finished.records);
    let paper = cells.split_off(maps.iter().map(Grid::n_cells).sum());
    let found = Regime::new(&maps, cells, paper, args.quick, finished.wall_s);
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "regime", "scenes": scenes });
        write_regime(out, &found, &study_manifest(&question, &json!({ "effort": effort }), started))?;
    }
    finished.remove_journal()?;
    let tone = if found.holds { Tone::Good } else { Tone::Bad };
    args.output.print(&found, || regime_text(&found), tone)?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
