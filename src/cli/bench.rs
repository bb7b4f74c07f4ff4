//! `cohaul bench`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{CliError, check_out, command_line, interrupt, positive, print, print_report, state};
use crate::output::manifest::{Manifest, sha256_hex};
use crate::output::progress::Progress;
use crate::scenario::Scenario;
use crate::studies::bench::files::write_benchmark;
use crate::studies::bench::report::Benchmark;
use crate::studies::bench::text::bench_text;
use crate::studies::bench::{self, Effort, Growth, Host, Measured, Plan, Scene, crowd, four_ants, standard_scenes};

#[derive(Args)]
pub struct BenchArgs {
    /// Scenario files with prescribed tips; without any, and without --solvers and --growth, all analytic scenes, the paper's load with prescribed
    /// tips, solvers and growth
    #[arg(value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Time the exact friction solver and clarabel on the problems of four ants
    #[arg(long)]
    solvers: bool,
    /// Time steps over the number of springs, supports and ants
    #[arg(long)]
    growth: bool,
    /// Rounds of times; without it 5, or 2 with --quick
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// CPU time that one run may take (s); without it 0.5, or 0.1 with --quick
    #[arg(long, value_name = "T", value_parser = positive)]
    budget_s: Option<f64>,
    /// Every second setting, less of all else
    #[arg(long)]
    quick: bool,
    /// Folder for tables, figures, summary and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What was measured so far: resumed from if the file is there, written when the benchmark is interrupted, removed when it is done; without it DIR.state
    /// beside the folder
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

/// What an interrupted benchmark leaves.
#[derive(Serialize, Deserialize)]
struct State {
    question: Question,
    wall_s: f64,
    found: Measured,
}

/// What was asked, where and of which program: times of different answers do not go together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Question {
    version: String,
    commit: Option<String>,
    cpu: Option<String>,
    /// Names and hashes.
    scenes: Vec<(String, String)>,
    solvers: bool,
    growth: bool,
    effort: Effort,
}

pub fn bench(args: &BenchArgs) -> Result<ExitCode, CliError> {
    let (plan, hashes) = plan(args)?;
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let host = Host::here();
    let question = Question {
        version: host.version.to_owned(),
        commit: host.commit.map(str::to_owned),
        cpu: host.cpu.clone(),
        scenes: hashes,
        solvers: plan.solvers.is_some(),
        growth: plan.growth.is_some(),
        effort: plan.effort,
    };
    let path = state_path(args);
    let (mut found, before) = resumed(&question, path.as_deref())?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let mut progress = Progress::of_share("bench");
    let is_done = bench::bench(&plan, &mut found, &mut |share| {
        progress.at(share);
        !interrupt::asked()
    });
    progress.finish();
    let wall_s = before + clock.elapsed().as_secs_f64();
    if !is_done.map_err(CliError::Usage)? {
        return interrupted(State { question, wall_s, found }, path.as_deref());
    }
    let benchmark = Benchmark::new(host, plan.effort, &found, wall_s);
    if let Some(out) = &args.out {
        write_benchmark(out, &benchmark, &manifest(&plan, &question, started))?;
    }
    if let Some(path) = path.filter(|path| path.exists()) {
        std::fs::remove_file(&path).map_err(|source| CliError::File { path, source })?;
    }
    print(&if args.json { benchmark.to_json() } else { bench_text(&benchmark) })?;
    if let Some(out) = args.out.as_deref().filter(|_| !args.json) {
        print_report(out)?;
    }
    benchmark.warnings.iter().for_each(|warning| say!("warning: {warning}"));
    Ok(ExitCode::SUCCESS)
}

/// What to measure, with names and hashes of its scenes.
fn plan(args: &BenchArgs) -> Result<(Plan, Vec<(String, String)>), CliError> {
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
    let hashes = scenes.iter().map(|scene| (scene.name.clone(), scene.scenario.hash())).collect();
    let plan = Plan {
        scenes,
        effort,
        solvers: (is_all || args.solvers).then(four_ants),
        growth: (is_all || args.growth).then(|| Growth { ants: crowd(), is_quick: args.quick }),
    };
    plan.check().map_err(CliError::Usage)?;
    Ok((plan, hashes))
}

/// Scenes by the names of their files, which name figures too.
fn scenes(paths: &[PathBuf]) -> Result<Vec<Scene>, CliError> {
    let mut scenes: Vec<Scene> = Vec::new();
    for path in paths {
        let scenario = Scenario::read(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if scenes.iter().any(|scene| scene.name == name) {
            return Err(CliError::Usage(format!("SCENARIO: must have file names of their own, found {name} again")));
        }
        scenes.push(Scene::new(name, &scenario));
    }
    Ok(scenes)
}

/// Where an interrupted benchmark is kept; nowhere without an output.
fn state_path(args: &BenchArgs) -> Option<PathBuf> {
    let beside = |out: &PathBuf| {
        let name = out.file_name()?.to_string_lossy().into_owned();
        Some(out.with_file_name(format!("{name}.state")))
    };
    args.state.clone().or_else(|| args.out.as_ref().and_then(beside))
}

/// What an earlier call measured, and for how long (s).
fn resumed(question: &Question, path: Option<&Path>) -> Result<(Measured, f64), CliError> {
    let none = || Ok((Measured::default(), 0.0));
    let Some(path) = path else { return none() };
    let Some(state) = state::read::<State>(path)? else { return none() };
    if state.question != *question {
        let text = "was kept by a benchmark of other scenes, options, program or machine; finish that, or remove the file";
        return Err(CliError::Usage(format!("{}: {text}", path.display())));
    }
    Ok((state.found, state.wall_s))
}

fn interrupted(state: State, path: Option<&Path>) -> Result<ExitCode, CliError> {
    let Some(path) = path else { return Err(CliError::Interrupted) };
    state::keep(path, &state)?;
    say!("stopped after {} settings; the same command goes on from {}", state.found.rows.len(), path.display());
    Ok(ExitCode::from(130))
}

fn manifest(plan: &Plan, question: &Question, started: SystemTime) -> Manifest {
    let expanded = |scene: &Scene| (scene.name.clone(), serde_json::to_value(scene.scenario.expanded()).expect("a scenario is plain data"));
    let scenarios = json!(plan.scenes.iter().map(expanded).collect::<serde_json::Map<_, _>>());
    let options = json!({ "effort": question.effort, "solvers": question.solvers, "growth": question.growth });
    let hash = sha256_hex(scenarios.to_string().as_bytes());
    Manifest::new(scenarios, hash, None, options, command_line(), started)
}
