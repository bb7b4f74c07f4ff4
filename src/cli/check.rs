//! `cohaul check` and `cohaul check store`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Instant, SystemTime};

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::{CliError, EngineArgs, check_out, check_step, command_line, interrupt, print, read_scenario, step, warn_of_idle};
use crate::backend::{BackendKind, BackendOptions, Integrator, Status, step_of};
use crate::output::json;
use crate::output::manifest::{Manifest, sha256_hex};
use crate::output::progress::Progress;
use crate::scenario::Scenario;
use crate::studies::check::report::{CheckReport, check_text, this_build, write_check};
use crate::studies::check::{self, Baseline, Check, Settings, Verdict, read_folder, usual_name, write_file};

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct CheckArgs {
    #[command(subcommand)]
    command: Option<CheckCommand>,
    /// Folder with baselines (./store and ./help for folders of these names)
    #[arg(required = true, value_name = "DIR")]
    baselines: Option<PathBuf>,
    /// Baselines to check, by the names of their files; without any all of the folder
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Scenario file to run in place of the stored scenario of the named baselines
    #[arg(long, value_name = "FILE", requires = "names")]
    scenario: Option<PathBuf>,
    /// Count every difference, down to the last digit: all tolerances are zero
    #[arg(long)]
    exact: bool,
    /// Store what is found in place of each baseline that differs; tolerances stay
    #[arg(long)]
    accept: bool,
    /// Folder for tables and figures of the differences, summary and manifest
    #[arg(long, value_name = "OUT")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(Subcommand)]
enum CheckCommand {
    /// Run scenarios and store them as baselines
    Store(StoreArgs),
}

#[derive(Args)]
struct StoreArgs {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Folder for the baselines, a file for each scenario and backend
    #[arg(long, value_name = "DIR")]
    baselines: PathBuf,
    /// What moves the load; may be given several times
    #[arg(long, default_value = "quasi-static")]
    backend: Vec<BackendKind>,
    /// Longest step of the backend (s); without it each backend's default
    #[arg(long, value_name = "H", value_parser = step)]
    step_s: Option<f64>,
    /// How the inertial backend cuts a step; without it midpoint
    #[arg(long, value_name = "METHOD")]
    integrator: Option<Integrator>,
    /// Seed of all chance, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Name of the only baseline; without it that of the scenario's file, of the backend and of all unusual options
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Most rows of the path to keep
    #[arg(long, value_name = "N", default_value_t = 200)]
    rows: usize,
    /// Replace baselines that are there
    #[arg(long)]
    replace: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn check(args: &CheckArgs) -> Result<ExitCode, CliError> {
    match (&args.command, &args.baselines) {
        (Some(CheckCommand::Store(args)), _) => store(args),
        (None, Some(folder)) => hold_against(folder, args),
        (None, None) => Err(CliError::Usage("DIR: is required".into())),
    }
}

fn hold_against(folder: &Path, args: &CheckArgs) -> Result<ExitCode, CliError> {
    let baselines = chosen(folder, &args.names)?;
    let scenario = args.scenario.as_deref().map(Scenario::read).transpose()?;
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let (started, clock) = (SystemTime::now(), Instant::now());
    let settings = Settings { scenario, exact: args.exact };
    let checks = watched("check", |watch| check::check(&baselines, &settings, &this_build(), watch))?;
    let mut report = CheckReport::new(checks, args.exact, clock.elapsed().as_secs_f64());
    if args.accept {
        accept(folder, &mut report)?;
    }
    if let Some(out) = &args.out {
        write_check(out, &report, &manifest(&report.baselines, args.exact, started))?;
    }
    print(&if args.json { json::pretty(&report)? } else { check_text(&report) })?;
    Ok(if report.is_good() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The baselines of these names, or all of the folder.
fn chosen(folder: &Path, names: &[String]) -> Result<Vec<Baseline>, CliError> {
    if names.is_empty() {
        return read_folder(folder).map_err(CliError::Usage);
    }
    let (mut baselines, mut faults) = (Vec::new(), Vec::new());
    for (at, name) in names.iter().enumerate() {
        // A file's name does as well, so that a shell can complete it.
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

/// Keeps what was found wherever it differs or answers another scenario, if it was computed.
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
    let hash = sha256_hex(scenarios.to_string().as_bytes());
    Manifest::new(&scenarios, hash, None, &options, command_line(), started)
}

fn store(args: &StoreArgs) -> Result<ExitCode, CliError> {
    let questions = questions(args)?;
    warn_of_idle(&args.backend, args.integrator, &args.engine);
    let total: f64 = questions.iter().map(|(_, scenario, _)| scenario.duration).sum();
    let baselines = watched("store", |watch| {
        let mut done = 0.0;
        let mut baselines = Vec::new();
        for (name, scenario, options) in &questions {
            let (trace, outcome) = check::run(scenario, options, |time| watch((done + time) / total))?;
            baselines.push((Baseline::of(name, scenario, options, &this_build(), (&trace, &outcome), args.rows), outcome.steps.status));
            done += scenario.duration;
        }
        Some(baselines)
    })?;
    let mut code = ExitCode::SUCCESS;
    for (baseline, status) in &baselines {
        let path = args.baselines.join(baseline.file_name());
        if *status == Status::Failed {
            say!("error: {}: not stored: a step of the run had no finite answer", path.display());
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
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let seeded = args.seed.map_or(stem.to_string(), |seed| format!("{stem}-seed-{seed}"));
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
            return Err(CliError::Usage(format!("{}: is there already; --replace stores it anew, tolerances too", path.display())));
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
    write_file(folder, baseline).map_err(|source| CliError::File { path: folder.join(baseline.file_name()), source })
}

/// Runs `work` under a progress bar, until it is done or the user asks to stop.
fn watched<T>(label: &str, work: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> Option<T>) -> Result<T, CliError> {
    let progress = Mutex::new(Progress::of_share(label));
    let watch = |share: f64| {
        // Only one thread draws; the others need not wait for it.
        if let Ok(mut progress) = progress.try_lock() {
            progress.at(share);
        }
        !interrupt::asked()
    };
    let done = work(&watch);
    progress.into_inner().expect("no thread panicked while it drew").finish();
    done.ok_or(CliError::Interrupted)
}
