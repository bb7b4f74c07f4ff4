//! `cohaul compare --threshold`: up to which value of a parameter quasi-static is valid.

use std::path::Path;
use std::process::ExitCode;
use std::time::SystemTime;

use serde_json::json;

use super::console::Tone;
use super::error::CliError;
use super::input::{name_of, read_scenario_text};
use super::output::{OutputArgs, study_manifest};
use super::resumable::{self, finished, journal_beside};
use super::threads::pool;
use super::vary::VaryArgs;
use super::watch::watched;
use cohaul::analysis::compare::Settings;
use cohaul_report::json;
use cohaul_studies::sweep::{present_value, validate};
use cohaul_studies::threshold::files::write_thresholds;
use cohaul_studies::threshold::report::Thresholds;
use cohaul_studies::threshold::{Asked, Class, search};
use cohaul_studies::vary::plan;

pub fn threshold(
    asked: &Asked,
    args: &VaryArgs,
    scenario: &Path,
    seed: Option<u64>,
    settings: &Settings,
    output: &OutputArgs,
) -> Result<ExitCode, CliError> {
    let text = read_scenario_text(scenario)?;
    let present = if asked.needs_present_value() { present_value(&text, &name_of(scenario), &asked.path)? } else { 1.0 };
    let plan = plan(name_of(scenario), text, vec![asked.axis(present)?], seed, settings)?;
    let pool = pool(args.threads, plan.identity.n_cells)?;
    validate(&plan, 0..plan.identity.n_cells, &pool, || true)?;
    let question = json!({ "sweep": plan.identity, "settings": settings });
    let started = SystemTime::now();
    let mut records = resumable::open("threshold", &question, output.out.as_deref().map(journal_beside).as_deref())?;
    let n_points = pool.install(|| watched("threshold", |watch| search(&plan, settings, &mut records, watch)))?;
    let done = finished(records, n_points)?;
    let found = Thresholds::new(&plan, settings, &done.records, done.wall_s);
    json::check(&found)?;
    // What was found is printed even where it cannot be written.
    let written = output.out.as_ref().map_or(Ok(()), |out| {
        let study = json!({ "name": "threshold", "scenario": plan.identity.scenario, "axes": plan.identity.design.axes });
        write_thresholds(out, &found, &study_manifest(&study, &json!({ "settings": settings }), started))?;
        Ok::<(), CliError>(done.remove_journal()?)
    });
    output.print(&found, || found.text(), tone(&found))?;
    written?;
    output.print_report()?;
    Ok(if found.n_failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn tone(found: &Thresholds) -> Tone {
    let is_valid = found.quantities.iter().all(|of| of.bands.iter().all(|band| band.class == Class::Valid));
    match found.n_failed {
        0 if is_valid => Tone::Good,
        0 => Tone::Caution,
        _ => Tone::Bad,
    }
}
