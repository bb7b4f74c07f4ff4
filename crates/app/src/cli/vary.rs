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
use cohaul::analysis::compare::Settings;
use cohaul_report::json;
use cohaul_studies::sweep::{Axis, validate};
use cohaul_studies::threshold::Asked;
use cohaul_studies::vary::files::write_map;
use cohaul_studies::vary::report::Map;
use cohaul_studies::vary::{Question, plan, tasks};

#[derive(Args)]
pub struct VaryArgs {
    /// Map of verdicts over values of a parameter
    ///
    /// Give the option twice for a map over two parameters. PATH is a key of the scenario, as
    /// load.mass_kg, or a factor on the scene: speed, size or inertia. VALUES are a,b,c or
    /// FIRST:LAST:N or log:FIRST:LAST:N, as for `cohaul sweep`.
    #[arg(long, value_name = "PATH=VALUES", group = "over")]
    pub vary: Vec<Axis>,
    /// Up to which value of a parameter quasi-static is valid, without rapier
    ///
    /// PARAM is a PATH as for --vary, with FROM:TO or FROM:TO:N behind it for the range and its
    /// grid [default: from 1/32 to 32 times the present value, four points for each factor of 2].
    #[arg(long, value_name = "PARAM[=FROM:TO]", group = "over")]
    pub threshold: Option<Asked>,
    /// With --vary: compare all three backends at every point, whatever the estimate says
    #[arg(long, requires = "vary", hide_short_help = true)]
    pub everywhere: bool,
    /// With --vary or --threshold: number of threads [default: one for each processor]
    #[arg(long, value_name = "N", requires = "over", hide_short_help = true)]
    pub threads: Option<usize>,
}

impl VaryArgs {
    /// Whether the scene is compared as it is.
    pub fn is_one_scene(&self) -> bool {
        self.vary.is_empty() && self.threshold.is_none()
    }
}

pub fn vary(args: &VaryArgs, scenario: &Path, seed: Option<u64>, settings: &Settings, output: &OutputArgs) -> Result<ExitCode, CliError> {
    if args.vary.len() > 2 {
        return Err(CliError::Usage(format!("--vary: must be given once or twice, found {} times", args.vary.len())));
    }
    let plan = plan(name_of(scenario), read_scenario_text(scenario)?, args.vary.clone(), seed, settings)?;
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
