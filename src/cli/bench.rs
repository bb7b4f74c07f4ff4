//! `cohaul bench`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::{Value, json};

use super::{CliError, check_out, command_line, interrupt, positive, print, print_report, resumable};
use crate::output::json;
use crate::output::manifest::{Manifest, sha256_hex};
use crate::scenario::Scenario;
use crate::studies::bench::files::write_benchmark;
use crate::studies::bench::report::Benchmark;
use crate::studies::bench::text::bench_text;
use crate::studies::bench::{self, BenchError, Effort, Growth, Host, Plan, Scene, crowd, four_ants, standard_scenes};
use crate::studies::runner::with_progress;

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
    /// What was measured so far: resumed from if the file is there, removed when the benchmark is done; without
    /// it DIR.journal beside the folder
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
}

pub fn bench(args: &BenchArgs) -> Result<ExitCode, CliError> {
    let (plan, hashes) = plan(args)?;
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let host = Host::here();
    let asked = json!({
        "cpu": host.cpu,
        "scenes": hashes,
        "solvers": plan.solvers.is_some(),
        "growth": plan.growth.is_some(),
        "effort": plan.effort,
    });
    let path = args.state.clone().or_else(|| args.out.as_deref().map(resumable::journal_beside));
    let mut records = resumable::open("bench", &asked, path.as_deref())?;
    let started = SystemTime::now();
    let measured = with_progress("bench", interrupt::asked, |watch| bench::bench(&plan, &mut records, &mut |share| watch(share)));
    let found = measured.map_err(|error| match error {
        BenchError::Stopped => resumable::stopped(&format!("{} measurements", records.n_done()), path.as_deref()),
        BenchError::NoReference(cause) => CliError::Usage(cause),
        BenchError::Journal(error) => error.into(),
    })?;
    let finished = resumable::finished(records, 0)?;
    let benchmark = Benchmark::new(host, plan.effort, &found, finished.wall_s);
    if let Some(out) = &args.out {
        write_benchmark(out, &benchmark, &manifest(&plan, &asked, started))?;
    }
    finished.remove_journal()?;
    print(&if args.json { json::pretty(&benchmark)? } else { bench_text(&benchmark) })?;
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

fn manifest(plan: &Plan, asked: &Value, started: SystemTime) -> Manifest {
    let expanded = |scene: &Scene| (scene.name.clone(), json::plain(&scene.scenario.expanded()));
    let scenarios = json!(plan.scenes.iter().map(expanded).collect::<serde_json::Map<_, _>>());
    let options = json!({ "effort": asked["effort"], "solvers": asked["solvers"], "growth": asked["growth"] });
    let hash = sha256_hex(scenarios.to_string().as_bytes());
    Manifest::new(&scenarios, hash, None, &options, command_line(), started)
}
