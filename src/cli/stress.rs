//! `cohaul stress`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde_json::{Value, json};

use super::{CliError, check_out, command_line, print, print_report, resumable};
use crate::output::json;
use crate::output::manifest::{Manifest, sha256_hex};
use crate::simulation::built;
use crate::studies::methods::Method;
use crate::studies::stress::report::{Stress, stress_list, stress_text, write_stress};
use crate::studies::stress::{self, Effort, Map};

#[derive(Args)]
pub struct StressArgs {
    /// Only these maps; without it all
    #[arg(long, value_name = "NAME", num_args = 1..)]
    map: Vec<String>,
    /// Only these backends; without it all
    #[arg(long, value_name = "BACKEND", num_args = 1.., value_parser = method_parser())]
    backend: Vec<Method>,
    /// Four values an axis in place of tens
    #[arg(long)]
    quick: bool,
    /// Say which maps there are
    #[arg(long, conflicts_with_all = ["json", "out", "backend", "quick"])]
    list: bool,
    /// Folder for cells, heat maps, summary and manifest; what an interrupted run has done is kept beside it, as DIR.journal
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
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
    let backends: Vec<Method> = Method::all_stressed().filter(|it| args.backend.is_empty() || args.backend.contains(it)).collect();
    let names: Vec<&str> = maps.iter().map(|map| map.name).collect();
    let asked = json!({ "maps": names, "backends": backends, "effort": effort });
    let started = SystemTime::now();
    let finished = resumable::run("stress", &asked, &stress::tasks(&maps, &backends, &built), args.out.as_deref())?;
    let rows = finished.records.concat();
    let found = Stress::new(&maps, &rows, args.quick, finished.wall_s);
    if let Some(out) = &args.out {
        write_stress(out, &found, &maps, &rows, &manifest(&asked, started))?;
    }
    finished.remove_journal()?;
    print(&if args.json { json::pretty(&found)? } else { stress_text(&found) })?;
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

/// In place of a scenario stand the maps asked for.
fn manifest(asked: &Value, started: SystemTime) -> Manifest {
    let scenario = json!({ "name": "stress", "maps": asked["maps"] });
    let options = json!({ "backends": asked["backends"], "effort": asked["effort"] });
    let hash = sha256_hex(scenario.to_string().as_bytes());
    Manifest::new(&scenario, hash, 0, &options, command_line(), started)
}

/// The backends under stress by their names.
fn method_parser() -> impl TypedValueParser<Value = Method> {
    let value = |method: Method| {
        let value = PossibleValue::new(method.key);
        if method == Method::RAPIER_ENGINE_DEFAULTS { value.alias("rapier-as-shipped") } else { value }
    };
    let names = Method::all_stressed().map(value);
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Method>())
}
