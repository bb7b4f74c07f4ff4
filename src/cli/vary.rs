//! `cohaul compare --vary`: a map of comparisons over parameters of the scene.

use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::console::Tone;
use super::error::CliError;
use super::input::{check_step, name_of, read_scenario_text};
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use super::threads::pool;
use crate::analysis::compare::Settings;
use crate::backend::{BackendKind, Integrator};
use crate::output::json;
use crate::studies::sweep::{Ask, Axis, Design, Plan, Variant, validate};
use crate::studies::vary::files::write_map;
use crate::studies::vary::report::Map;
use crate::studies::vary::{Question, tasks};

#[derive(Args)]
pub struct VaryArgs {
    /// Parameter and its values: a map of verdicts; give it twice for two parameters
    ///
    /// PATH is a key of the scenario, as load.mass_kg. VALUES are a,b,c or FIRST:LAST:N or
    /// log:FIRST:LAST:N, as for `cohaul sweep`.
    #[arg(long, value_name = "PATH=VALUES")]
    pub vary: Vec<Axis>,
    /// With --vary: compare all three backends at every point, whatever the estimate says
    #[arg(long, requires = "vary")]
    pub everywhere: bool,
    /// With --vary: number of threads [default: one for each processor]
    #[arg(long, value_name = "N", requires = "vary")]
    pub threads: Option<usize>,
}

pub fn vary(args: &VaryArgs, scenario: &Path, seed: Option<u64>, settings: &Settings, output: &OutputArgs) -> Result<ExitCode, CliError> {
    if args.vary.len() > 2 {
        return Err(CliError::Usage(format!("--vary: must be given once or twice, found {} times", args.vary.len())));
    }
    let plan = Plan::new(Ask {
        file: name_of(scenario),
        text: read_scenario_text(scenario)?,
        design: Design::new(args.vary.clone(), None)?,
        variants: vec![Variant {
            backend: BackendKind::QuasiStatic,
            step_s: settings.step_s,
            tolerance_m: settings.reference_tolerance_m,
            integrator: Integrator::default(),
            rapier: settings.rapier,
            skips: settings.skips,
        }],
        first_seed: seed,
        n_seeds: 1,
    })?;
    check_step(settings.step_s, plan.base())?;
    let question = Question { settings: *settings, everywhere: args.everywhere };
    let pool = pool(args.threads, plan.identity.n_cells)?;
    validate(&plan, 0..plan.identity.n_cells, &pool, || true)?;
    let asked = json!({ "sweep": plan.identity, "question": question });
    let started = SystemTime::now();
    let finished = pool.install(|| resumable::run("compare", &asked, &tasks(&plan, &question), output.out.as_deref()))?;
    let map = Map::new(&plan, &question, finished.records.clone(), finished.wall_s);
    json::check(&map)?;
    // What was found is printed even where it cannot be written.
    let written = output.out.as_ref().map_or(Ok(()), |out| {
        let study = json!({ "name": "compare", "scenario": plan.identity.scenario, "axes": plan.identity.design.axes });
        write_map(out, &map, &study_manifest(&study, &json!({ "question": question }), started))?;
        Ok::<(), CliError>(finished.remove_journal()?)
    });
    let tone = match map.n_failed {
        0 if map.n_valid() == map.cells.len() => Tone::Good,
        0 => Tone::Caution,
        _ => Tone::Bad,
    };
    output.print(&map, || map.text(), tone)?;
    written?;
    output.print_report()?;
    Ok(if map.n_failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
