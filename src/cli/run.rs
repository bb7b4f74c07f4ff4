//! `cohaul run`.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::rc::Rc;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde_json::Value;

use super::{
    CliError, EngineArgs, check_out, check_step, command_line, interrupt, positive, print, print_report, read_scenario, resumable, step,
    warn_idle, warn_of_idle,
};
use crate::analysis::estimate::{Estimator, with_estimate};
use crate::backend::{Backend, BackendKind, BackendOptions, Integrator, Skip, Skips, Status, Tolerance, build, step_of};
use crate::output::chart::Scene;
use crate::output::json;
use crate::output::manifest::Manifest;
use crate::output::progress::Progress;
use crate::output::text::Detail;
use crate::output::trace_csv::TraceColumns;
use crate::scenario::Scenario;
use crate::simulation::run_facts::Run;
use crate::simulation::{Keep, SavedRun, Simulation, driver_of};
use crate::studies::journal;
use crate::studies::run::files::{RunFiles, RunWriter};
use crate::studies::run::summary::RunSummary;
use crate::studies::run::text::{convergence_warning, inertia_warning, run_text};

#[derive(Args)]
pub struct RunArgs {
    /// Scenario file
    scenario: PathBuf,
    /// What moves the load
    #[arg(long, default_value = "quasi-static")]
    backend: BackendKind,
    /// Longest step of the backend (s); without it the control period for quasi-static, but no more than 2.5 ms, and else a tenth of a radian of the fastest oscillation, but no
    /// less than 10 us and no more than 1 ms or the control period
    #[arg(long, value_name = "H", value_parser = step)]
    step_s: Option<f64>,
    /// Error that the load's position may have at any instant, in place of a step (m): quasi-static and inertial
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with_all = ["step_s", "integrator"])]
    tolerance: Option<f64>,
    /// Error that its heading may have (rad); without it what moves the load's rim by the tolerance
    #[arg(long, value_name = "RAD", value_parser = positive, requires = "tolerance")]
    tolerance_rad: Option<f64>,
    /// Take quasi-static steps of second order where the load goes on slipping
    #[arg(long, conflicts_with = "tolerance")]
    second_order: bool,
    /// How the inertial backend cuts a step; without it midpoint
    #[arg(long, value_name = "METHOD")]
    integrator: Option<Integrator>,
    /// Seed of all chance, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder for trace, events, figures, summary and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write energies, the interaction of holders and the pull on each spring to trace.csv, which makes it four times as long
    #[arg(long, requires = "out")]
    full_trace: bool,
    /// Also write tips.csv, the held tips as `cohaul calibrate forces` reads them
    #[arg(long, requires = "out")]
    tips: bool,
    /// Write a report with a replay, report.html, to that folder too
    #[arg(long, requires = "out")]
    report: bool,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// State of the run: resumed from if the file is there, written when the run is interrupted, removed when it is done
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Interrupt the run at this simulated time (s)
    #[arg(long, value_name = "T", requires = "state", value_parser = step)]
    stop_s: Option<f64>,
    /// Leave out the estimate of what inertia would have done to a quasi-static run
    #[arg(long)]
    no_estimate: bool,
    /// Kind of work that is done although its outcome is known; may be repeated
    #[arg(long, value_name = "KIND")]
    no_skip: Vec<Skip>,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn run(args: &RunArgs) -> Result<ExitCode, CliError> {
    let scenario = read_scenario(&args.scenario, args.seed)?;
    let options = options(args, &scenario)?;
    warn_of_idle(&[args.backend], args.integrator, &args.engine);
    if args.no_estimate && options.kind != BackendKind::QuasiStatic {
        warn_idle("--no-estimate", "quasi-static", options.kind.name());
    }
    let n_springs = scenario.system.springs.len();
    let columns = if args.full_trace { TraceColumns::Full { n_springs } } else { TraceColumns::Motion };
    args.out.as_deref().map_or(Ok(()), check_out)?;
    let mut writer = args.out.as_deref().map(|out| RunWriter::create(out, columns)).transpose()?;
    let keep = if writer.is_some() { Keep::Trace } else { Keep::Outcome };
    let (started, clock) = (SystemTime::now(), Instant::now());
    let saved = saved(&options, args.state.as_deref())?;
    let (backend, mut estimator) = backend(&scenario, saved.as_ref().map_or(&options, |saved| &saved.options), args.no_estimate);
    let mut run = match (&saved, &args.state) {
        (Some(saved), Some(path)) => {
            Simulation::resume_on(&scenario, saved, keep, backend).map_err(|source| CliError::Restore { path: path.clone(), source })?
        }
        _ => Simulation::on(&scenario, &options, keep, driver_of(&scenario), backend),
    };
    let mut progress = Progress::start(scenario.duration, args.backend.name());
    let watch = |time| {
        progress.at(time);
        !interrupt::asked() && args.stop_s.is_none_or(|stop| time < stop)
    };
    // Rows that nobody asks for again are not kept.
    let passes_on = args.state.is_none() && args.tolerance.is_none() && !args.tips && !args.report;
    match &mut writer {
        Some(writer) if passes_on => run.run_past(watch, |rows| writer.add(rows))?,
        _ => {
            let afresh = |options: &BackendOptions| {
                let (backend, follower) = self::backend(&scenario, options, args.no_estimate);
                estimator = follower;
                Simulation::on(&scenario, options, keep, driver_of(&scenario), backend)
            };
            run.run_within(afresh, watch);
        }
    }
    progress.finish();
    if !run.is_finished() {
        return Err(interrupted(&run, args.state.as_deref())?);
    }
    let (trace, outcome) = run.into_results();
    if let Some(writer) = &mut writer {
        writer.add(&trace.rows)?;
    }
    let wall_time = Some(clock.elapsed().as_secs_f64());
    let summary = RunSummary {
        run: Run { scenario: &scenario, options: &options, outcome: &outcome, path_length: None, wall_time },
        inertia_estimate: estimator.map(|estimator| estimator.borrow().estimate()),
    };
    if let Some(writer) = writer {
        let manifest = Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, &options, command_line(), started);
        let (scene, report) = (&Scene::of(&scenario), args.report.then_some(&scenario));
        let (summary, trace, manifest, with_tips) = (&summary, &trace, &manifest, args.tips);
        writer.finish(&RunFiles { summary, trace, with_tips, scene, manifest, report })?;
    }
    if let Some(path) = args.state.as_deref().filter(|path| path.exists()) {
        std::fs::remove_file(path).map_err(|source| CliError::File { path: path.to_owned(), source })?;
    }
    print(&if args.json { json::pretty(&summary)? } else { run_text(&summary, Detail::Brief) })?;
    if let Some(out) = args.out.as_deref().filter(|_| args.report && !args.json) {
        print_report(out)?;
    }
    if let Some(warning) = convergence_warning(&summary) {
        say!("warning: {warning}");
    }
    // The text says it as its answer.
    if let Some(warning) = summary.inertia_estimate.filter(|_| args.json).and_then(|estimate| inertia_warning(&estimate)) {
        say!("warning: {warning}");
    }
    Ok(if outcome.steps.status == Status::Failed || !summary.run.is_accurate() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

fn options(args: &RunArgs, scenario: &Scenario) -> Result<BackendOptions, CliError> {
    check_step(args.step_s, scenario)?;
    let skips = Skips::ALL.without_all(&args.no_skip);
    if args.second_order && args.backend != BackendKind::QuasiStatic {
        return Err(CliError::Usage(format!("--second-order: must be of quasi-static, found {}", args.backend.name())));
    }
    let Some(position_m) = args.tolerance else {
        let step_s = step_of(args.step_s, args.backend, &scenario.system, scenario.control_period);
        return Ok(BackendOptions {
            integrator: args.integrator.unwrap_or_default(),
            rapier: args.engine.options(),
            skips,
            second_order: args.second_order,
            ..BackendOptions::new(args.backend, step_s)
        });
    };
    if args.backend == BackendKind::Rapier {
        return Err(CliError::Usage("--tolerance: must be of quasi-static or inertial, found rapier: an engine's steps are fixed".into()));
    }
    let tolerance = Tolerance::on_rim(position_m, &scenario.system.load);
    let heading_rad = args.tolerance_rad.unwrap_or(tolerance.heading_rad);
    Ok(BackendOptions { skips, ..BackendOptions::within(args.backend, Tolerance { heading_rad, ..tolerance }) })
}

/// What moves the load, and what follows it to estimate the inertia that a quasi-static run neglects.
fn backend(scenario: &Scenario, options: &BackendOptions, no_estimate: bool) -> (Box<dyn Backend>, Option<Rc<RefCell<Estimator>>>) {
    if options.kind != BackendKind::QuasiStatic || no_estimate {
        return (build(&scenario.system, scenario.start, options), None);
    }
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, options);
    (backend, Some(estimator))
}

/// The run whose state is there, if it is one of these options.
fn saved(options: &BackendOptions, path: Option<&Path>) -> Result<Option<SavedRun>, CliError> {
    let Some(path) = path else { return Ok(None) };
    let Some(saved) = journal::load_single::<SavedRun>(path, "run")? else { return Ok(None) };
    let as_asked = saved.options.tolerance.map(|tolerance| Tolerance { tightened: 0, ..tolerance });
    let as_asked = BackendOptions { tolerance: as_asked, ..saved.options };
    if as_asked != *options {
        let text = format!("{}: must be of the run asked for, found another: {}", path.display(), differences(&as_asked, options));
        return Err(CliError::Usage(text));
    }
    Ok(Some(saved))
}

/// What differs between the options of a saved run and those asked for.
fn differences(saved: &BackendOptions, asked: &BackendOptions) -> String {
    let [saved, asked] = [saved, asked].map(|options| json::plain(options));
    let names = saved.as_object().into_iter().chain(asked.as_object()).flat_map(|object| object.keys()).collect::<BTreeSet<_>>();
    let differing = names.into_iter().filter(|name| saved.get(name) != asked.get(name));
    let of = |options: &Value, name: &str| options.get(name).map_or("none".to_owned(), Value::to_string);
    differing.map(|name| format!("{name} {} for {}", of(&saved, name), of(&asked, name))).collect::<Vec<_>>().join(", ")
}

/// Keeps the state for the next call, if there is a file for it.
fn interrupted(run: &Simulation, path: Option<&Path>) -> Result<CliError, CliError> {
    if let Some(path) = path {
        journal::save_single(path, "run", &run.save()?)?;
    }
    Ok(resumable::stopped(&format!("{} s", run.time()), path))
}
