//! `cohaul check` and `cohaul check store`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::choice::{choice, seconds};
use super::console::{self, Tone, print};
use super::engine::{EngineArgs, warn_of_idle};
use super::error::CliError;
use super::error::at_output;
use super::input::{check_step, read_scenario, stem_of};
use super::output::{JunitArgs, OutputArgs, study_manifest};
use super::watch::watched_to_end;
use cohaul::backend::{BackendKind, BackendOptions, Integrator, step_of};
use cohaul::scenario::Scenario;
use cohaul::simulation::Health;
use cohaul_report::account_words;
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_studies::check::report::{CheckReport, check_suite, check_text, this_build, write_check};
use cohaul_studies::check::{self, Baseline, Check, Settings, Verdict, read_folder, usual_name, write_file};

#[derive(Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "\
Examples:
  cohaul check tests/baselines
  cohaul check baselines four-ants --scenario changed.json --out out/check
  cohaul check baselines --junit out/check.xml
  cohaul check store scene.json --baselines baselines --backend inertial

Folders with the names of subcommands: write ./store or ./help."
)]
pub struct CheckArgs {
    #[command(subcommand)]
    command: Option<CheckCommand>,
    /// Folder of baselines
    #[arg(required = true, value_name = "DIR")]
    baselines: Option<PathBuf>,
    /// Baselines to check, by file name; without any, all in the folder
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Scenario to run in place of the stored one; - for standard input
    #[arg(long, value_name = "FILE", requires = "names")]
    scenario: Option<PathBuf>,
    /// Set all tolerances to zero, so that every digit counts
    #[arg(long)]
    exact: bool,
    /// Store the new result in place of each baseline that differs; keep its tolerances
    #[arg(long)]
    accept: bool,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    junit: JunitArgs,
}

#[derive(Subcommand)]
enum CheckCommand {
    /// Run scenarios and store the results as baselines
    Store(StoreArgs),
}

#[derive(Args)]
#[command(after_help = "\
Example:
  cohaul check store scenes/*.json --baselines baselines \\
    --backend quasi-static --backend rapier")]
struct StoreArgs {
    /// Scenario files; - for standard input
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for the baselines, one file for each scenario and backend
    #[arg(long, value_name = "DIR")]
    baselines: PathBuf,
    /// Backend that moves the load; may be repeated
    #[arg(long, default_value = "quasi-static", value_parser = choice::<BackendKind>())]
    backend: Vec<BackendKind>,
    /// Longest time step of the backend (s) [default: as in `cohaul run`]
    #[arg(long, value_name = "H", value_parser = seconds, hide_short_help = true)]
    step_s: Option<f64>,
    /// Time integration of the inertial backend [default: midpoint]
    #[arg(long, value_name = "METHOD", value_parser = choice::<Integrator>(), hide_short_help = true)]
    integrator: Option<Integrator>,
    /// Seed of all random streams [default: the scenario's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Name of the only baseline [default: names of scenario, backend and options]
    #[arg(long)]
    name: Option<String>,
    /// Largest number of stored rows of the path
    #[arg(long, value_name = "N", default_value_t = 200, hide_short_help = true)]
    rows: usize,
    /// Replace existing baselines
    #[arg(long)]
    replace: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn check(args: &CheckArgs) -> Result<ExitCode, CliError> {
    match (&args.command, &args.baselines) {
        (Some(CheckCommand::Store(args)), _) => store(args),
        (None, Some(folder)) => compare_with(folder, args),
        (None, None) => Err(CliError::Usage("DIR: is required".into())),
    }
}

fn compare_with(folder: &Path, args: &CheckArgs) -> Result<ExitCode, CliError> {
    let baselines = chosen(folder, &args.names)?;
    let scenario = args.scenario.as_deref().map(|path| read_scenario(path, None)).transpose()?;
    args.output.check()?;
    args.junit.check()?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let settings = Settings { scenario, exact: args.exact };
    let checks = watched_to_end("check", |watch| check::check(&baselines, &settings, &this_build(), watch))?;
    let mut report = CheckReport::new(checks, args.exact, clock.elapsed().as_secs_f64());
    if args.accept {
        accept(folder, &mut report)?;
    }
    if let Some(out) = &args.output.out {
        write_check(out, &report, &manifest(&report.baselines, args.exact, started))?;
    }
    args.junit.write(|| check_suite(&report))?;
    let is_good = report.is_good();
    args.output.print(&report, || check_text(&report), if is_good { Tone::Good } else { Tone::Bad })?;
    Ok(if is_good { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The baselines of these names, or all of the folder.
fn chosen(folder: &Path, names: &[String]) -> Result<Vec<Baseline>, CliError> {
    if names.is_empty() {
        return read_folder(folder).map_err(CliError::Usage);
    }
    let (mut baselines, mut faults) = (Vec::new(), Vec::new());
    for (at, name) in names.iter().enumerate() {
        // A file name is accepted too, so that a shell can complete it.
        let plain = name.strip_suffix(".json").unwrap_or(name);
        if names[..at].iter().any(|before| before.strip_suffix(".json").unwrap_or(before) == plain) {
            faults.push(format!("NAME: must be given once, found {plain} again"));
            continue;
        }
        match check_name(plain).and_then(|()| Ok(Baseline::read(&folder.join(format!("{plain}.json")))?)) {
            Ok(baseline) => baselines.push(baseline),
            Err(error) => faults.push(error.to_string()),
        }
    }
    if faults.is_empty() { Ok(baselines) } else { Err(CliError::Usage(faults.join("\n"))) }
}

/// Stores each new result that differs from its baseline or belongs to another scenario.
fn accept(folder: &Path, report: &mut CheckReport) -> Result<(), CliError> {
    let is_new = |check: &&Check| match check.verdict {
        Verdict::Agrees => !check.scenario_changes.is_empty(),
        Verdict::Differs => true,
        Verdict::NotComputed => false,
    };
    for check in report.baselines.iter().filter(is_new) {
        write(folder, &check.found)?;
        report.accepted.push(check.name.clone());
    }
    Ok(())
}

fn manifest(checks: &[Check], exact: bool, started: SystemTime) -> Manifest {
    let of =
        |take: fn(&Check) -> Value| -> BTreeMap<&str, Value> { checks.iter().map(|check| (check.name.as_str(), take(check))).collect() };
    let scenarios = json!(of(|check| json::plain(&check.found.scenario.expanded())));
    let options =
        json!({ "exact": exact, "baselines": of(|check| json!(check.options)), "tolerances": of(|check| json!(check.found.tolerances)) });
    study_manifest(&scenarios, &options, started)
}

fn store(args: &StoreArgs) -> Result<ExitCode, CliError> {
    if args.baselines.is_file() {
        return Err(CliError::Usage(format!("--baselines: must be a folder, found the file {}", args.baselines.display())));
    }
    let questions = questions(args)?;
    warn_of_idle(&args.backend, args.integrator, &args.engine);
    let total: f64 = questions.iter().map(|(_, scenario, _)| scenario.duration).sum();
    let baselines = watched_to_end("store", |watch| {
        let mut done = 0.0;
        let mut baselines = Vec::new();
        for (name, scenario, options) in &questions {
            let (trace, outcome) = check::run(scenario, options, |time| watch((done + time) / total))?;
            baselines.push((Baseline::of(name, scenario, options, &this_build(), (&trace, &outcome), args.rows), outcome.account));
            done += scenario.duration;
        }
        Some(baselines)
    })?;
    let mut code = ExitCode::SUCCESS;
    for (baseline, account) in &baselines {
        let path = args.baselines.join(baseline.file_name());
        if account.health == Health::Failed {
            let cause = account_words::cause(account).unwrap_or_default();
            console::error(format_args!("{}: not stored: {cause}", path.display()));
            code = ExitCode::from(1);
            continue;
        }
        write(&args.baselines, baseline)?;
        print(&format!("{}: stored, {} rows and {} events\n", path.display(), baseline.record.rows.len(), baseline.record.events.len()))?;
    }
    Ok(code)
}

/// Name, scenario and options of every baseline to be, checked before anything runs.
fn questions(args: &StoreArgs) -> Result<Vec<(String, Scenario, BackendOptions)>, CliError> {
    let mut questions: Vec<(String, Scenario, BackendOptions)> = Vec::new();
    for path in &args.scenarios {
        let scenario = read_scenario(path, args.seed)?;
        check_step(args.step_s, &scenario)?;
        for kind in &args.backend {
            let step_s = step_of(args.step_s, *kind, &scenario.system, scenario.control_period);
            let options = BackendOptions {
                integrator: args.integrator.unwrap_or_default(),
                rapier: args.engine.options(),
                ..BackendOptions::new(*kind, step_s)
            };
            let stem = stem_of(path);
            let seeded = args.seed.map_or(stem.clone(), |seed| format!("{stem}-seed-{seed}"));
            let name = args.name.clone().unwrap_or_else(|| usual_name(&seeded, &scenario, &options));
            check_name(&name)?;
            if questions.iter().any(|(other, ..)| *other == name) {
                return Err(CliError::Usage(format!("{name}: must be the name of one baseline, found another scenario or backend of it")));
            }
            questions.push((name, scenario.clone(), options));
        }
    }
    for path in questions.iter().map(|(name, ..)| args.baselines.join(format!("{name}.json"))).filter(|path| path.exists()) {
        if !args.replace {
            return Err(CliError::Usage(format!("{}: already exists; --replace stores it anew, with new tolerances", path.display())));
        }
    }
    Ok(questions)
}

/// A name that is a plain file's.
fn check_name(name: &str) -> Result<(), CliError> {
    let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name) && !name.starts_with('.');
    if is_plain { Ok(()) } else { Err(CliError::Usage(format!("NAME: must be that of a file without its folder, found {name:?}"))) }
}

fn write(folder: &Path, baseline: &Baseline) -> Result<(), CliError> {
    write_file(folder, baseline).map_err(at_output(&folder.join(baseline.file_name())))
}
