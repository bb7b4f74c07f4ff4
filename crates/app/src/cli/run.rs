//! `cohaul run`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde_json::Value;

use super::choice::{choice, positive, seconds};
use super::console::{self, Tone};
use super::cost::warn_of_cost;
use super::engine::{EngineArgs, check_error_control, warn_idle, warn_of_idle};
use super::error::{CliError, at_output};
use super::input::{check_step, read_scenario, warn_of_scenario};
use super::output::{OutputArgs, StrictArgs, manifest_of};
use super::resumable::stopped;
use super::watch::{catch_interrupts, keep_state, unless_stopped, watched_by};
use cohaul::analysis::ExpectedCost;
use cohaul::analysis::estimate::{Estimator, with_estimate_if};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, Setting, Shared, Skip, Skips, Tolerance};
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Health, Keep, SavedRun, Simulation, controller_of};
use cohaul_report::account_words;
use cohaul_report::chart::Scene;
use cohaul_report::json;
use cohaul_report::progress::Progress;
use cohaul_report::trace_csv::TraceColumns;
use cohaul_report::traces::TraceFormat;
use cohaul_studies::journal;
use cohaul_studies::run::files::{RunFiles, RunWriter};
use cohaul_studies::run::summary::RunSummary;
use cohaul_studies::run::text::{inertia_warning, run_text};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul run scenarios/paper/four-ants-four-springs.json
  cohaul run scene.json --backend inertial --out out/run --report
  cohaul run scene.json --tolerance 1e-6 --json

Files in DIR: trace.csv or trace.parquet, events.csv, transitions.csv,
overview.svg, summary.json and manifest.json.")]
pub struct RunArgs {
    /// Scenario file; - for standard input
    scenario: PathBuf,
    /// Backend that moves the load
    #[arg(long, default_value = "quasi-static", value_parser = choice::<BackendKind>())]
    backend: BackendKind,
    /// Longest time step (s) [default: see --help]
    ///
    /// Default of quasi-static: the control period, at most 2.5 ms. Default of the others: a tenth
    /// of a radian of the fastest oscillation, from 10 us to 1 ms, at most the control period.
    #[arg(long, value_name = "H", value_parser = seconds)]
    step_s: Option<f64>,
    /// Largest error of the position (m): error control
    ///
    /// The steps are then chosen so that the error stays below this at every instant. Only
    /// quasi-static and inertial have error control.
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with_all = ["step_s", "integrator"])]
    tolerance: Option<f64>,
    /// Largest error of the heading (rad) [default: --tolerance over the load's radius]
    #[arg(long, value_name = "RAD", value_parser = positive, requires = "tolerance", hide_short_help = true)]
    tolerance_rad: Option<f64>,
    /// Use second-order steps while the load slips (quasi-static)
    #[arg(long, conflicts_with = "tolerance", hide_short_help = true)]
    second_order: bool,
    /// Leave out the dashpots of the springs (quasi-static): the rate-independent model of the
    /// paper
    #[arg(long, hide_short_help = true)]
    rate_independent: bool,
    /// Time integration of the inertial backend [default: midpoint]
    #[arg(long, value_name = "METHOD", value_parser = choice::<Integrator>(), hide_short_help = true)]
    integrator: Option<Integrator>,
    /// Seed of all random streams [default: the scenario's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Do work whose result is already known; see `cohaul explain skipped`. May be repeated
    #[arg(long, value_name = "KIND", value_parser = choice::<Skip>(), hide_short_help = true)]
    no_skip: Vec<Skip>,
    /// Leave out the estimate of the inertia effect of a quasi-static run
    #[arg(long, hide_short_help = true)]
    no_estimate: bool,
    /// State file: read if it exists, written on an interrupt, removed at the end
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    state: Option<PathBuf>,
    /// Interrupt the run at this simulated time (s)
    #[arg(long, value_name = "T", requires = "state", value_parser = seconds, hide_short_help = true)]
    stop_s: Option<f64>,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    strict: StrictArgs,
    #[command(flatten)]
    output: OutputArgs,
    /// Write the report with a replay of the run too, report.html
    #[arg(long, requires = "out", help_heading = "Output")]
    report: bool,
    /// Format of the trace [default: csv]
    #[arg(long, value_name = "FORMAT", value_parser = choice::<TraceFormat>(), requires = "out", help_heading = "Output", hide_short_help = true)]
    traces: Option<TraceFormat>,
    /// Write the energies, the interaction force and the pull on each spring to the trace too
    #[arg(long, requires = "out", help_heading = "Output", hide_short_help = true)]
    full_trace: bool,
    /// Write the attached tips too, as `calibrate forces` reads them
    ///
    /// They are in tips.csv.
    #[arg(long, requires = "out", help_heading = "Output")]
    tips: bool,
}

pub fn run(args: &RunArgs) -> Result<ExitCode, CliError> {
    let scenario = read_scenario(&args.scenario, args.seed)?;
    let options = options(args, &scenario)?;
    warn_of_cost("run", &scenario, &expected(args, &scenario, &options));
    warn_of_scenario(&args.scenario, &scenario);
    warn_of_idle(&[args.backend], args.integrator, &args.engine);
    if args.no_estimate && !options.kind.has_inertia_estimate() {
        warn_idle("--no-estimate", &BackendKind::names_of(BackendKind::has_inertia_estimate), options.kind.name());
    }
    let n_springs = scenario.system.springs.len();
    let columns = if args.full_trace { TraceColumns::Full { n_springs } } else { TraceColumns::Motion };
    args.output.check()?;
    catch_interrupts();
    let mut writer =
        args.output.out.as_deref().map(|out| RunWriter::create(out, columns, args.traces.unwrap_or(TraceFormat::Csv))).transpose()?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let (run, estimator) = computed(args, &scenario, &options, &mut writer)?;
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
        let manifest = manifest_of(&scenario, &options, started);
        let (scene, report) = (&Scene::of(&scenario), args.report.then_some(&scenario));
        writer.finish(&RunFiles { summary: &summary, trace: &trace, with_tips: args.tips, scene, manifest: &manifest, report })?;
    }
    if let Some(path) = args.state.as_deref().filter(|path| path.exists()) {
        std::fs::remove_file(path).map_err(at_output(path))?;
    }
    print(args, &summary)?;
    Ok(args.strict.code(outcome.account.health))
}

fn expected(args: &RunArgs, scenario: &Scenario, options: &BackendOptions) -> ExpectedCost {
    if args.no_estimate { ExpectedCost::of_run(scenario, options) } else { ExpectedCost::of_estimated_run(scenario, options) }
}

/// The run, as far as it got, and what follows it to estimate the inertia effect.
fn computed<'a>(
    args: &RunArgs,
    scenario: &'a Scenario,
    options: &BackendOptions,
    writer: &mut Option<RunWriter>,
) -> Result<(Simulation<'a>, Option<Shared<Estimator>>), CliError> {
    let keep = if writer.is_some() { Keep::Trace } else { Keep::Outcome };
    let saved = saved(options, args.state.as_deref())?;
    let first = saved.as_ref().map_or(options, |saved| &saved.options);
    let (backend, mut estimator) = with_estimate_if(scenario, first, !args.no_estimate);
    let mut run = match (&saved, &args.state) {
        (Some(saved), Some(path)) => Simulation::resume_from_parts(scenario, saved, keep, controller_of(scenario), backend)
            .map_err(|source| CliError::Restore { path: path.clone(), source })?,
        _ => Simulation::from_parts(scenario, options, keep, controller_of(scenario), backend),
    };
    if args.state.is_some() {
        keep_state();
        run = run.with_checkpoints();
    }
    // Rows that nothing needs again are written as they come.
    let streams = writer.as_ref().is_some_and(RunWriter::streams);
    let passes_on = streams && args.state.is_none() && args.tolerance.is_none() && !args.tips && !args.report;
    let progress = Progress::start(scenario.duration, args.backend.name()).expecting(expected(args, scenario, options).time_s);
    let computing = || {
        watched_by(progress, |watch| {
            let watch = |time| watch(time) && args.stop_s.is_none_or(|stop| time < stop);
            if let (Some(writer), true) = (writer, passes_on) {
                return run.run_streaming(watch, |rows| writer.add(rows));
            }
            let afresh = |options: &BackendOptions| {
                let (backend, follower) = with_estimate_if(scenario, options, !args.no_estimate);
                estimator = follower;
                Simulation::from_parts(scenario, options, keep, controller_of(scenario), backend)
            };
            run.run_to_tolerance(afresh, watch);
            Ok(())
        })
    };
    unless_stopped(computing).unwrap_or(Ok(()))?;
    Ok((run, estimator))
}

fn print(args: &RunArgs, summary: &RunSummary) -> Result<(), CliError> {
    let account = &summary.run.outcome.account;
    let inertia = summary.inertia_estimate.as_ref().and_then(inertia_warning);
    let tone = match (account.health, &inertia) {
        (Health::Failed, _) => Tone::Bad,
        (Health::Ok, None) => Tone::Good,
        _ => Tone::Caution,
    };
    args.output.print(summary, || run_text(summary, console::detail()), tone)?;
    if args.report {
        args.output.print_report()?;
    }
    account_words::warnings(account).for_each(console::warn);
    // The text has this warning as its answer.
    inertia.iter().filter(|_| args.output.json).for_each(console::warn);
    Ok(())
}

fn options(args: &RunArgs, scenario: &Scenario) -> Result<BackendOptions, CliError> {
    check_step(args.step_s, scenario)?;
    let skips = Skips::ALL.without_all(&args.no_skip);
    let of_others = [
        ("--second-order", Setting::SecondOrder, args.second_order),
        ("--rate-independent", Setting::RateIndependent, args.rate_independent),
    ];
    if let Some((name, setting, _)) = of_others.into_iter().find(|(_, setting, is_given)| *is_given && !args.backend.reads(*setting)) {
        let names = BackendKind::names_of(|kind| kind.reads(setting));
        return Err(CliError::Usage(format!("{name}: applies to {names} only, found {}", args.backend.name())));
    }
    let rate_independent = args.rate_independent;
    let Some(position_m) = args.tolerance else {
        return Ok(BackendOptions {
            integrator: args.integrator.unwrap_or_default(),
            rapier: args.engine.options(),
            skips,
            second_order: args.second_order,
            rate_independent,
            ..BackendOptions::at_step(args.step_s, args.backend, &scenario.system, scenario.control_period)
        });
    };
    check_error_control(&[args.backend])?;
    let tolerance = Tolerance::at_edge(position_m, &scenario.system.load);
    let heading_rad = args.tolerance_rad.unwrap_or(tolerance.heading_rad);
    Ok(BackendOptions { skips, rate_independent, ..BackendOptions::within(args.backend, Tolerance { heading_rad, ..tolerance }) })
}

/// The saved run in the state file, if there is one.
///
/// # Errors
/// When it was saved with other options.
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

/// Differences between the options of a saved run and those asked for.
fn differences(saved: &BackendOptions, asked: &BackendOptions) -> String {
    let [saved, asked] = [saved, asked].map(json::plain);
    let names = saved.as_object().into_iter().chain(asked.as_object()).flat_map(|object| object.keys()).collect::<BTreeSet<_>>();
    let mut differing: Vec<&String> = names.into_iter().filter(|name| saved.get(name) != asked.get(name)).collect();
    // That a step is adapted follows from the backend, or from the step.
    if differing.len() > 1 {
        differing.retain(|name| *name != "adapts_step");
    }
    let of = |options: &Value, name: &str| match options.get(name) {
        None => "none".to_owned(),
        Some(Value::String(word)) => word.clone(),
        Some(value) => value.to_string(),
    };
    let option = |name: &str| match name {
        "kind" => "--backend".to_owned(),
        "adapts_step" => "default step".to_owned(),
        "cone_solver" => "friction solver".to_owned(),
        "rapier" => "options of rapier".to_owned(),
        name => format!("--{}", name.replace('_', "-")),
    };
    let texts = differing.into_iter().map(|name| format!("{} {} for {}", option(name), of(&saved, name), of(&asked, name)));
    texts.collect::<Vec<_>>().join(", ")
}

/// Keeps the state for the next call, if there is a file for it, and returns how the command ends.
fn interrupted(run: &Simulation, path: Option<&Path>) -> Result<CliError, CliError> {
    if let Some(path) = path {
        let saved = run.save()?;
        journal::save_single(path, "run", &saved)?;
        return Ok(stopped(&format!("{} s", saved.time()), Some(path)));
    }
    Ok(CliError::Interrupted)
}
