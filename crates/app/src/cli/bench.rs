//! `cohaul bench`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::choice::{positive, seconds};
use super::console::{self, Tone};
use super::error::CliError;
use super::foreign::{met, method_of};
use super::input::{read_scenario, stem_of};
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use super::subject::timeout;
use super::watch::{unless_stopped, watched};
use cohaul::analysis::compare::EngineName;
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul_engines::Engine;
use cohaul_report::json;
use cohaul_studies::bench::files::write_benchmark;
use cohaul_studies::bench::report::Benchmark;
use cohaul_studies::bench::text::bench_text;
use cohaul_studies::bench::{self, BenchError, Effort, Growth, Host, Plan, Scene, crowd, four_ants, standard_scenes};
use cohaul_studies::subject::{Meet, of_user};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul bench --quick
  cohaul bench --solvers --growth
  cohaul bench scenarios/analytic/slide-spin.json --repeats 9 --out out/bench
  cohaul bench scenarios/analytic/slide-spin.json --engine ./my_engine

Without SCENARIO, --solvers and --growth, everything is measured. Files in DIR:
tables (CSV), figures (SVG), report, summary.json and manifest.json.")]
pub struct BenchArgs {
    /// Scenario files with prescribed tips; - for standard input
    #[arg(value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Time the exact friction solver and clarabel on the problems of four ants
    #[arg(long)]
    solvers: bool,
    /// Time steps against the number of springs, supports, contacts, obstacles and ants
    #[arg(long)]
    growth: bool,
    /// Program that is measured too, as a shell command; may be repeated
    ///
    /// It answers one line of JSON a request; the book's page on engines has the protocol. Its
    /// times are real times.
    #[arg(long, value_name = "CMD")]
    engine: Vec<String>,
    /// Longest time that a program may take to answer (s) [default: 60]
    #[arg(long, value_name = "S", value_parser = seconds, requires = "engine", hide_short_help = true)]
    engine_timeout_s: Option<f64>,
    /// Number of timed rounds [default: 5; with --quick 2]
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// Longest CPU time of one run (s) [default: 0.5; with --quick 0.1]
    #[arg(long, value_name = "T", value_parser = positive)]
    budget_s: Option<f64>,
    /// Measure every second setting, and less of everything else
    #[arg(long)]
    quick: bool,
    /// State file: read if it exists, continued and removed at the end
    /// [default: DIR.journal]
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn bench(args: &BenchArgs) -> Result<ExitCode, CliError> {
    let plan = plan(args)?;
    args.output.check()?;
    if args.engine.is_empty() {
        return measured(args, &plan, &[]);
    }
    let Some(first) = plan.scenes.first().map(|scene| scene.scenario.clone()) else {
        return Err(CliError::Usage("--engine: must have a scene, found --solvers or --growth alone".into()));
    };
    let options = BackendOptions::new(BackendKind::Rapier, first.control_period);
    met(&args.engine, timeout(args.engine_timeout_s), &first, &options, |engines| {
        let names: Vec<&EngineName> = engines.iter().map(Engine::name).collect();
        let meets: Vec<_> = engines.iter().map(|engine| of_user(engine)).collect();
        let engines = names.iter().zip(&meets).map(|(name, meet)| Ok((method_of(name)?, meet as &Meet)));
        let engines = engines.collect::<Result<Vec<_>, CliError>>()?;
        let plan = Plan { engines, ..plan };
        measured(args, &plan, &names)
    })
}

fn measured(args: &BenchArgs, plan: &Plan, engines: &[&EngineName]) -> Result<ExitCode, CliError> {
    let host = Host::here();
    let options = json!({ "effort": plan.effort, "solvers": plan.solvers.is_some(), "growth": plan.growth.is_some() });
    let scenes: Vec<(&str, String)> = plan.scenes.iter().map(|scene| (scene.name.as_str(), scene.scenario.hash())).collect();
    // Times of different machines do not go together.
    let asked = json!({ "cpu": host.cpu, "scenes": scenes, "engines": engines, "options": options });
    let path = args.state.clone().or_else(|| args.output.out.as_deref().map(resumable::journal_beside));
    let mut records = resumable::open("bench", &asked, path.as_deref())?;
    let started = SystemTime::now();
    let measured = watched("bench", |watch| {
        let measured = unless_stopped(|| bench::bench(plan, &mut records, &mut |share| watch(share)));
        measured.unwrap_or(Err(BenchError::Stopped))
    });
    let found = measured.map_err(|error| match error {
        BenchError::Stopped => resumable::stopped(&format!("{} measurements", records.n_done()), path.as_deref()),
        BenchError::NoReference(cause) => CliError::Usage(cause),
        BenchError::Journal(error) => error.into(),
    })?;
    let finished = resumable::finished(records, 0)?;
    let engines = engines.iter().map(|engine| (*engine).clone()).collect();
    let benchmark = Benchmark { engines, ..Benchmark::new(host, plan.effort, found, finished.wall_s) };
    if let Some(out) = &args.output.out {
        let expanded = |scene: &Scene| (scene.name.clone(), json::plain(&scene.scenario.expanded()));
        let scenarios = json!(plan.scenes.iter().map(expanded).collect::<serde_json::Map<_, _>>());
        write_benchmark(out, &benchmark, &study_manifest(&scenarios, &options, started))?;
    }
    finished.remove_journal()?;
    args.output.print(&benchmark, || bench_text(&benchmark), Tone::Good)?;
    args.output.print_report()?;
    console::warn_all(&benchmark.warnings);
    Ok(if benchmark.has_failed() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

fn plan(args: &BenchArgs) -> Result<Plan<'_>, CliError> {
    if args.repeats == Some(0) {
        return Err(CliError::Usage("--repeats: must be at least 1, found 0".into()));
    }
    let is_all = args.scenarios.is_empty() && !args.solvers && !args.growth;
    let scenes = if is_all { standard_scenes() } else { scenes(&args.scenarios)? };
    let effort = Effort {
        repeats: args.repeats.unwrap_or(if args.quick { 2 } else { 5 }),
        budget_s: args.budget_s.unwrap_or(if args.quick { 0.1 } else { 0.5 }),
        quick: args.quick,
    };
    let plan = Plan {
        scenes,
        engines: Vec::new(),
        effort,
        solvers: (is_all || args.solvers).then(four_ants),
        growth: (is_all || args.growth).then(|| Growth { ants: crowd(), is_quick: args.quick }),
    };
    plan.check().map_err(CliError::Usage)?;
    Ok(plan)
}

/// Scenes by the names of their files, which are in the names of figures too.
fn scenes(paths: &[PathBuf]) -> Result<Vec<Scene>, CliError> {
    let mut scenes: Vec<Scene> = Vec::new();
    for path in paths {
        let scenario = read_scenario(path, None)?;
        let name = stem_of(path);
        if scenes.iter().any(|scene| scene.name == name) {
            return Err(CliError::Usage(format!("SCENARIO: must have different file names, found {name} twice")));
        }
        scenes.push(Scene::new(name, &scenario));
    }
    Ok(scenes)
}
