//! `cohaul regime`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde::{Deserialize, Serialize};

use super::{CliError, check_out, command_line, interrupt, print, state};
use crate::output::manifest::{Manifest, sha256_hex};
use crate::output::progress::Progress;
use crate::studies::regime::report::{Regime, regime_text, write_regime};
use crate::studies::regime::{self, Cell, Done, Effort, Grid, Scene};

#[derive(Args)]
pub struct RegimeArgs {
    /// Only these scenes; without it all
    #[arg(long, value_name = "SCENE", num_args = 1..)]
    scene: Vec<Scene>,
    /// Six values an axis in place of twenty
    #[arg(long)]
    quick: bool,
    /// Folder for maps, cells, summary and manifest; what an interrupted run has done is kept beside it, as DIR.state.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

/// What was asked: a state belongs to one such.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Asked {
    version: String,
    commit: Option<String>,
    scenes: Vec<Scene>,
    effort: Effort,
}

/// An interrupted run.
#[derive(Serialize, Deserialize)]
struct State {
    asked: Asked,
    /// Of runs before this one (s).
    wall_s: f64,
    done: Done,
}

pub fn regime(args: &RegimeArgs) -> Result<ExitCode, CliError> {
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let scenes: Vec<Scene> = Scene::ALL.into_iter().filter(|scene| args.scene.is_empty() || args.scene.contains(scene)).collect();
    let maps: Vec<Grid> = scenes.iter().map(|scene| Grid::of(*scene, effort)).collect();
    let grids: Vec<Grid> = maps.iter().cloned().chain(scenes.iter().map(|scene| Grid::paper(*scene))).collect();
    let asked = asked(scenes, effort);
    let file = args.out.as_deref().map(state::file_beside);
    let (started, clock) = (SystemTime::now(), Instant::now());
    let before = file.as_deref().map(|file| state::saved(file, |state: &State| state.asked == asked)).transpose()?.flatten();
    let (done, spent) = before.map_or((Done::new(), 0.0), |state| (state.done, state.wall_s));
    let done = run(&grids, done);
    let wall_s = spent + clock.elapsed().as_secs_f64();
    if done.len() < regime::cells(&grids).len() {
        return state::interrupted(file.as_deref(), &State { asked, wall_s, done });
    }
    let mut cells: Vec<Cell> = done.into_values().collect();
    let paper = cells.split_off(maps.iter().map(Grid::n_cells).sum());
    let found = Regime::new(&maps, cells, &paper, args.quick, wall_s);
    if let Some(out) = &args.out {
        write_regime(out, &found, &manifest(&asked, started))?;
    }
    state::remove(file)?;
    print(&if args.json { found.to_json() } else { regime_text(&found) })?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn asked(scenes: Vec<Scene>, effort: Effort) -> Asked {
    let build = Manifest::new(serde_json::Value::Null, String::new(), 0, serde_json::Value::Null, Vec::new(), SystemTime::UNIX_EPOCH);
    Asked { version: build.version.to_owned(), commit: build.commit.map(str::to_owned), scenes, effort }
}

fn run(grids: &[Grid], done: Done) -> Done {
    let progress = Mutex::new(Progress::of_share("regime"));
    let watch = |share: f64| {
        // Only one thread draws; the others need not wait for it.
        if let Ok(mut progress) = progress.try_lock() {
            progress.at(share);
        }
        !interrupt::asked()
    };
    let done = regime::measure(grids, done, watch);
    progress.into_inner().expect("no thread panicked while it drew").finish();
    done
}

/// In place of a scenario stand the scenes asked for.
fn manifest(asked: &Asked, started: SystemTime) -> Manifest {
    let scenario = serde_json::json!({ "name": "regime", "scenes": asked.scenes });
    let options = serde_json::json!({ "effort": asked.effort });
    let hash = sha256_hex(scenario.to_string().as_bytes());
    Manifest::new(scenario, hash, 0, options, command_line(), started)
}
