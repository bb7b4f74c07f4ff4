//! `cohaul measured`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde_json::json;

use super::choice::{choice, not_negative, positive, seconds};
use super::console::{self, Tone};
use super::engine::EngineArgs;
use super::error::{CliError, at_file};
use super::foreign::ForeignArgs;
use super::input::{name_of, read_scenario_text, read_text, stem_of};
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use super::threads::pool;
use super::watch::{Watch, watched};
use cohaul::analysis::compare::{Pathwise, Settings, ThreeWay, Tier};
use cohaul::scenario::Scenario;
use cohaul_engines::Engine;
use cohaul_report::json;
use cohaul_report::table::csv_of_parquet;
use cohaul_studies::measured::ask::{TableText, fitted, joined};
use cohaul_studies::measured::files::write_measured;
use cohaul_studies::measured::push_log::csv_of_push_log;
use cohaul_studies::measured::recording::{Reading, Recording};
use cohaul_studies::measured::report::{Beside, Measured};
use cohaul_studies::measured::run::Question;
use cohaul_studies::measured::scene::{Preparation, SceneTemplate, Start};
use cohaul_studies::measured::tasks;
use cohaul_studies::measured::text::text;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul measured pushes.csv block.json
  cohaul measured pushes.csv block.json --fit side-friction --out out/pushes
  cohaul measured logs/ block.json --column load_x_m=x --column load_y_m=y

A table has columns time_s, load_x_m, load_y_m, load_heading_rad, and for each
recorded obstacle NAME_x_m, NAME_y_m and NAME_heading_rad, for tips tip0_x_m and
tip0_y_m. Optional are run, NAME_force_x_n, NAME_force_y_n, load_confidence,
load_uncertainty_m and load_heading_uncertainty_rad. Units may be mm, cm, um,
ms, deg and mN in place of these. Fields may be empty where nothing was seen.
Files in DIR: report.html, figures, runs.csv, summary.json and manifest.json.")]
pub struct MeasuredArgs {
    /// Table of measured runs (CSV or Parquet), log of a push (JSON), or a folder of these
    recording: PathBuf,
    /// Scenario file with the load, the ground and the recorded obstacles or springs
    scenario: PathBuf,
    /// Column of the table that has a name of this page; may be repeated
    #[arg(long, value_name = "NAME=COLUMN", value_parser = column)]
    column: Vec<(String, String)>,
    /// Least confidence with which a pose counts (1)
    #[arg(long, value_name = "C", default_value_t = 0.0, value_parser = not_negative, hide_short_help = true)]
    least_confidence: f64,
    /// What happens to an obstacle that overlaps the load at the start
    #[arg(long, default_value = "touching", value_parser = choice::<Start>())]
    start: Start,
    /// Largest such displacement (m) [default: 2 % of the load's radius]
    #[arg(long, value_name = "M", value_parser = positive, hide_short_help = true)]
    largest_shift_m: Option<f64>,
    /// Largest deviation of a smooth path from a recorded place (m) [default: by its noise]
    #[arg(long, value_name = "M", value_parser = not_negative)]
    smooth_m: Option<f64>,
    /// Longest time without a place that is bridged (s) [default: ten rows]
    #[arg(long, value_name = "S", value_parser = seconds, hide_short_help = true)]
    longest_gap_s: Option<f64>,
    /// Standard deviation of a measured position of the load, on each axis (m)
    #[arg(long, value_name = "M", value_parser = positive, requires = "uncertainty_rad")]
    uncertainty_m: Option<f64>,
    /// Standard deviation of a measured heading of the load (rad)
    #[arg(long, value_name = "RAD", value_parser = positive, requires = "uncertainty_m")]
    uncertainty_rad: Option<f64>,
    /// Numbers to be fitted: ground-friction, side-friction or keys of the scenario
    ///
    /// All runs have the same. The fit takes the first runs, and the report is on the others.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    fit: Vec<String>,
    /// Number of runs for the fit [default: half of them]
    #[arg(long, value_name = "N", requires = "fit")]
    fit_runs: Option<usize>,
    /// Compare without an engine
    #[arg(long, conflicts_with = "engine")]
    no_engine: bool,
    /// Largest error of the quasi-static and inertial paths (m) [default: 1e-5 of the
    /// load's radius]
    #[arg(long, value_name = "M", value_parser = positive, hide_short_help = true)]
    tolerance: Option<f64>,
    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N", hide_short_help = true)]
    threads: Option<usize>,
    #[command(flatten)]
    foreign: ForeignArgs,
    #[command(flatten)]
    engine_options: EngineArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// A name and the column that has it.
fn column(text: &str) -> Result<(String, String), String> {
    let (name, column) = text.split_once('=').ok_or_else(|| format!("must be NAME=COLUMN, found {text}"))?;
    Ok((name.trim().to_owned(), column.trim().to_owned()))
}

pub fn measured(args: &MeasuredArgs) -> Result<ExitCode, CliError> {
    let (started, clock) = (SystemTime::now(), Instant::now());
    args.output.check()?;
    let template = SceneTemplate::new(&read_scenario_text(&args.scenario)?, &name_of(&args.scenario))?;
    let (recording, files, hash) = recording(args, &template)?;
    let runs = &recording.runs;
    let question = question(args, &template);
    let stated = args.uncertainty_m.zip(args.uncertainty_rad).map(<[f64; 2]>::from);
    let uncertainty = stated.or_else(|| runs.iter().find_map(|run| run.uncertainty));
    let pool = pool(args.threads, runs.len() as u64)?;
    let fitted = match args.fit[..] {
        [] => None,
        _ => {
            let fit = |watch: Watch| fitted(&args.fit, args.fit_runs, (&template, runs), &question, uncertainty, watch);
            let found = pool.install(|| watched("fit", fit)).map_err(|why| CliError::Usage(format!("--fit: {why}")))?;
            Some(found.ok_or(CliError::Interrupted)?)
        }
    };
    let (template, checked) = fitted.as_ref().map_or((&template, &runs[..]), |fitted| (&fitted.template, fitted.checked(runs)));
    let asked = json!({ "recording": hash, "scene": template.base.hash(), "question": question, "n_runs": checked.len(),
        "settings": question.settings });
    let base = &template.base;
    let mut finished = args.foreign.with(base, &question.settings, |engines| {
        if engines.len() > 1 {
            return Err(CliError::Usage(format!("--engine: must be given once here, found {}", engines.len())));
        }
        let compare = |scenario: &Scenario, settings: &Settings, watch: &(dyn Fn(f64) -> bool + Sync)| {
            compared(scenario, settings, (!args.no_engine).then_some(&engines[0]), watch)
        };
        pool.install(|| resumable::run("measured", &asked, &tasks(template, checked, &question, &compare), args.output.out.as_deref()))
    })?;
    let found = Measured::new(
        std::mem::take(&mut finished.records),
        Beside {
            scenario: base.name.clone(),
            recording: files,
            question,
            notes: recording.notes.clone(),
            fit: fitted.as_ref().map(|fitted| fitted.fit.clone()),
            uncertainty,
            radius: base.system.load.radius,
            wall_s: clock.elapsed().as_secs_f64(),
        },
    );
    json::check(&found)?;
    let asked = json!({ "name": "measured", "recording": found.recording, "sha256": hash, "scenario": base.expanded() });
    let manifest = study_manifest(&asked, &json!({ "question": question, "fit": args.fit }), started);
    let written =
        args.output.out.as_ref().map_or(Ok(()), |out| write_measured(out, &found, (template, checked, &found.question), &manifest));
    if written.is_ok() {
        finished.remove_journal()?;
    }
    let tone = if found.over_runs.is_some() { Tone::Good } else { Tone::Bad };
    args.output.print(&found, || text(&found, console::detail()), tone)?;
    written?;
    args.output.print_report()?;
    Ok(if found.over_runs.is_some() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// All backends on a scene, or the exact ones without an engine.
fn compared(scenario: &Scenario, settings: &Settings, engine: Option<&Engine>, watch: &(dyn Fn(f64) -> bool + Sync)) -> Option<Pathwise> {
    let runs = ThreeWay::new(scenario, settings);
    match engine {
        Some(engine) => engine.paths(runs, Tier::Prescribed, None, watch),
        None => runs.without_engine(watch),
    }
}

fn question(args: &MeasuredArgs, template: &SceneTemplate) -> Question {
    let usual = Question::usual(template);
    let Preparation { largest_shift_m, .. } = usual.preparation;
    Question {
        preparation: Preparation {
            start: args.start,
            bound_m: args.smooth_m,
            largest_shift_m: args.largest_shift_m.unwrap_or(largest_shift_m),
            longest_gap_s: args.longest_gap_s,
        },
        has_engine: !args.no_engine,
        settings: Settings {
            reference_tolerance_m: args.tolerance.or(usual.settings.reference_tolerance_m),
            rapier: args.engine_options.options(),
            ..usual.settings
        },
    }
}

/// The runs of a table or of all tables in a folder, the names of the files, and the hash of what
/// they contain.
fn recording(args: &MeasuredArgs, template: &SceneTemplate) -> Result<(Recording, Vec<String>, String), CliError> {
    let (path, obstacles) = (&args.recording, template.obstacles());
    let mut files = vec![path.clone()];
    if path.is_dir() {
        let entries = std::fs::read_dir(path).map_err(at_file(path))?.collect::<Result<Vec<_>, _>>().map_err(at_file(path))?;
        files = entries.into_iter().map(|entry| entry.path()).filter(|file| is_table(file)).collect();
        files.sort();
    }
    if files.is_empty() {
        return Err(CliError::Usage(format!("{}: must have tables (.csv, .parquet or .json), found none", path.display())));
    }
    let reading = Reading { columns: args.column.clone(), least_confidence: args.least_confidence };
    let pusher = obstacles.first().map_or("tip0", String::as_str);
    let table = |file: &PathBuf| Ok(TableText { name: name_of(file), stem: stem_of(file), text: table_text(file, pusher)? });
    let tables = files.iter().map(table).collect::<Result<Vec<_>, CliError>>()?;
    let (all, hash) = joined(&tables, template, &reading)?;
    Ok((all, tables.into_iter().map(|table| table.name).collect(), hash))
}

fn is_table(file: &Path) -> bool {
    file.is_file() && file.extension().is_some_and(|name| ["csv", "parquet", "json"].iter().any(|known| name == *known))
}

/// The text of a table, which Parquet files and logs of pushes by the obstacle `pusher` are turned
/// into.
fn table_text(file: &Path, pusher: &str) -> Result<String, CliError> {
    let refused = |what: &str, why: String| CliError::Usage(format!("{}: {what}{why}", name_of(file)));
    match file.extension().and_then(|name| name.to_str()) {
        Some("json") => csv_of_push_log(&read_text(file)?, pusher).map_err(|why| refused("", why)),
        Some("parquet") => {
            let bytes = std::fs::read(file).map_err(at_file(file))?;
            csv_of_parquet(bytes).map_err(|why| refused("must be a Parquet table: ", why))
        }
        _ => read_text(file),
    }
}
