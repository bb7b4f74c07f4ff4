//! `cohaul stress`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde::{Deserialize, Serialize};

use super::{CliError, check_out, command_line, interrupt, print, print_report, state};
use crate::output::manifest::{Manifest, sha256_hex};
use crate::output::progress::Progress;
use crate::studies::stress::report::{Stress, stress_list, stress_text, write_stress};
use crate::studies::stress::{self, Done, Effort, Map, Row, Variant};

#[derive(Args)]
pub struct StressArgs {
    /// Only these maps; without it all
    #[arg(long, value_name = "NAME", num_args = 1..)]
    map: Vec<String>,
    /// Only these backends; without it all
    #[arg(long, value_name = "BACKEND", num_args = 1..)]
    backend: Vec<Variant>,
    /// Four values an axis in place of tens
    #[arg(long)]
    quick: bool,
    /// Say which maps there are
    #[arg(long, conflicts_with_all = ["json", "out", "backend", "quick"])]
    list: bool,
    /// Folder for cells, heat maps, summary and manifest; what an interrupted run has done is kept beside it, as DIR.state.json
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
    maps: Vec<String>,
    backends: Vec<Variant>,
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

pub fn stress(args: &StressArgs) -> Result<ExitCode, CliError> {
    let maps = chosen(&args.map)?;
    if args.list {
        print(&stress_list(&maps))?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let maps: Vec<Map> = maps.iter().map(|map| effort.of(map)).collect();
    let backends: Vec<Variant> = Variant::ALL.into_iter().filter(|it| args.backend.is_empty() || args.backend.contains(it)).collect();
    let asked = asked(&maps, &backends, effort);
    let file = args.out.as_deref().map(state::file_beside);
    let (started, clock) = (SystemTime::now(), Instant::now());
    let before = file.as_deref().map(|file| state::saved(file, |state: &State| state.asked == asked)).transpose()?.flatten();
    let (done, spent) = before.map_or((Done::new(), 0.0), |state| (state.done, state.wall_s));
    let done = run(&maps, &backends, done);
    let wall_s = spent + clock.elapsed().as_secs_f64();
    if done.len() < stress::n_cells(&maps) {
        return state::interrupted(file.as_deref(), &State { asked, wall_s, done });
    }
    let rows: Vec<Row> = done.into_values().flatten().collect();
    let found = Stress::new(&maps, &rows, args.quick, wall_s);
    if let Some(out) = &args.out {
        write_stress(out, &found, &maps, &rows, &manifest(&asked, started))?;
    }
    state::remove(file)?;
    print(&if args.json { found.to_json() } else { stress_text(&found) })?;
    if let Some(out) = args.out.as_deref().filter(|_| !args.json) {
        print_report(out)?;
    }
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The maps of these names, or all.
fn chosen(names: &[String]) -> Result<Vec<Map>, CliError> {
    let all = stress::all();
    if let Some(name) = names.iter().find(|name| !all.iter().any(|map| map.name == **name)) {
        return Err(CliError::Usage(format!("--map: must be a map that `cohaul stress --list` names, found {name}")));
    }
    Ok(all.into_iter().filter(|map| names.is_empty() || names.iter().any(|name| name == map.name)).collect())
}

fn asked(maps: &[Map], backends: &[Variant], effort: Effort) -> Asked {
    let build = Manifest::new(serde_json::Value::Null, String::new(), 0, serde_json::Value::Null, Vec::new(), SystemTime::UNIX_EPOCH);
    Asked {
        version: build.version.to_owned(),
        commit: build.commit.map(str::to_owned),
        maps: maps.iter().map(|map| map.name.to_owned()).collect(),
        backends: backends.to_vec(),
        effort,
    }
}

fn run(maps: &[Map], backends: &[Variant], done: Done) -> Done {
    let progress = Mutex::new(Progress::of_share("stress"));
    let watch = |share: f64| {
        // Only one thread draws; the others need not wait for it.
        if let Ok(mut progress) = progress.try_lock() {
            progress.at(share);
        }
        !interrupt::asked()
    };
    let done = stress::stress(maps, backends, done, watch);
    progress.into_inner().expect("no thread panicked while it drew").finish();
    done
}

/// In place of a scenario stand the maps asked for.
fn manifest(asked: &Asked, started: SystemTime) -> Manifest {
    let scenario = serde_json::json!({ "name": "stress", "maps": asked.maps });
    let options = serde_json::json!({ "backends": asked.backends, "effort": asked.effort });
    let hash = sha256_hex(scenario.to_string().as_bytes());
    Manifest::new(scenario, hash, 0, options, command_line(), started)
}
