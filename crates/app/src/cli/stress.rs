//! `cohaul stress`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde_json::json;

use super::choice::did_you_mean;
use super::console::{Tone, print};
use super::error::CliError;
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use cohaul::simulation::backend_of;
use cohaul_studies::methods::Method;
use cohaul_studies::stress::files::write_stress;
use cohaul_studies::stress::report::{Stress, stress_list, stress_text};
use cohaul_studies::stress::{self, Effort, Map};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul stress --list
  cohaul stress --quick
  cohaul stress --map step-stiffness --backend rapier --out out/stress

Files in DIR: cells.csv, heat maps (SVG), report, summary and manifest. The
state of an interrupted run is kept in DIR.journal.")]
pub struct StressArgs {
    /// Only these maps; without it, all
    #[arg(long, value_name = "NAME", num_args = 1..)]
    map: Vec<String>,
    /// Only these backends; without it, all
    #[arg(long, num_args = 1.., value_parser = method())]
    backend: Vec<Method>,
    /// Four values on each axis in place of tens
    #[arg(long)]
    quick: bool,
    /// List the maps
    #[arg(long, conflicts_with_all = ["json", "out", "backend", "quick"])]
    list: bool,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn stress(args: &StressArgs) -> Result<ExitCode, CliError> {
    let maps = chosen(&args.map)?;
    if args.list {
        print(&stress_list(&maps))?;
        return Ok(ExitCode::SUCCESS);
    }
    args.output.check()?;
    let effort = Effort::of(args.quick);
    let maps: Vec<Map> = maps.iter().map(|map| map.at(effort)).collect();
    let names: Vec<&str> = maps.iter().map(|map| map.name).collect();
    let backends: Vec<Method> = Method::all_stressed().filter(|it| args.backend.is_empty() || args.backend.contains(it)).collect();
    let asked = json!({ "maps": names, "backends": backends, "effort": effort });
    let started = SystemTime::now();
    let finished = resumable::run("stress", &asked, &stress::tasks(&maps, &backends, &backend_of), args.output.out.as_deref())?;
    let rows = finished.records.concat();
    let found = Stress::new(&maps, &rows, args.quick, finished.wall_s);
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "stress", "maps": names });
        let options = json!({ "backends": backends, "effort": effort });
        write_stress(out, &found, &maps, &rows, &study_manifest(&question, &options, started))?;
    }
    finished.remove_journal()?;
    let tone = if found.holds { Tone::Good } else { Tone::Bad };
    args.output.print(&found, || stress_text(&found), tone)?;
    args.output.print_report()?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The maps of these names, or all.
fn chosen(names: &[String]) -> Result<Vec<Map>, CliError> {
    let all = stress::all();
    if let Some(name) = names.iter().find(|name| !all.iter().any(|map| map.name == **name)) {
        let hint = did_you_mean(name, all.iter().map(|map| map.name));
        return Err(CliError::Usage(format!("--map: must be a map that `cohaul stress --list` names, found {name}{hint}")));
    }
    Ok(all.into_iter().filter(|map| names.is_empty() || names.iter().any(|name| name == map.name)).collect())
}

/// Parser of the methods under stress.
fn method() -> impl TypedValueParser<Value = Method> {
    let value = |method: Method| {
        let value = PossibleValue::new(method.key);
        if method == Method::RAPIER_ENGINE_DEFAULTS { value.alias("rapier-as-shipped") } else { value }
    };
    PossibleValuesParser::new(Method::all_stressed().map(value)).try_map(|name| name.parse::<Method>())
}
