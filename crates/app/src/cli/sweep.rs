//! `cohaul sweep`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Instant, SystemTime};

use clap::Args;
use cpu_time::ProcessTime;
use rayon::ThreadPool;
use serde::Serialize;
use serde_json::json;

use super::choice::{choice, parse, positive, seconds};
use super::console::{self, Tone, print, print_answer};
use super::engine::{EngineArgs, check_error_control, warn_of_idle, warn_of_idle_points};
use super::error::{CliError, at_output};
use super::input::{check_step, name_of, read_json, read_scenario_text};
use super::output::{StrictArgs, command_line, identity_in};
use super::resumable;
use super::threads::pool;
use super::watch::{is_interrupted, watched_by};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, Skip, Skips};
use cohaul::formats::{self, Format, Versioned, stamped};
use cohaul::scenario::Scenario;
use cohaul_report::folder::{MANIFEST, check_files, check_target};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_report::progress::Progress;
use cohaul_studies::journal::{Header, Journal, JournalError};
use cohaul_studies::sweep::files::write_sweep;
use cohaul_studies::sweep::report::{Cost, SweepSummary, sweep_text};
use cohaul_studies::sweep::{
    Ask, Axis, Design, Factor, INERTIA, Identity, Method, Part, Plan, Sample, Table, Variant, finish_shard, shard_files, validate,
    verified, work,
};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul sweep ants.json --seeds 100 --out out/seeds
  cohaul sweep ants.json --vary drive.n_ants=2,4,8 --backend quasi-static \\
    --backend inertial --seeds 20 --out out/ants
  cohaul sweep ants.json --vary load.mass_kg=log:1e-4..1e-2 \\
    --sample latin-hypercube 64 --out out/mass
  cohaul sweep ants.json --seeds 1000 --shard 3/8 --out out/part

Files in DIR: tables of runs and groups (CSV, Parquet), figure, summary.json and
manifest.json. A stopped sweep continues from DIR.journal.")]
pub struct SweepArgs {
    /// Scenario file; - for standard input
    scenario: PathBuf,
    /// Number of seeds at each point
    #[arg(long, value_name = "N", default_value_t = 1)]
    seeds: u64,
    /// First seed, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Parameter and its values; several make a grid
    ///
    /// PATH is a key of the scenario, as load.mass_kg, or a factor on the scene: speed, size or
    /// inertia. VALUES are a,b,c or FIRST:LAST:N or log:FIRST:LAST:N; with --sample, LOW..HIGH or
    /// log:LOW..HIGH.
    #[arg(long, value_name = "PATH=VALUES")]
    vary: Vec<Axis>,
    /// Factors of the load's inertia at the same normal loads, as --vary inertia=VALUES
    #[arg(long, value_name = "VALUES", hide_short_help = true)]
    scale_inertia: Option<String>,
    /// Sample ranges at N points: latin-hypercube or sobol
    #[arg(long, num_args = 2, value_names = ["METHOD", "N"])]
    sample: Option<Vec<String>>,
    /// Seed of the sample [default: 1 for latin-hypercube; sobol is not shifted]
    #[arg(long, value_name = "N", requires = "sample", hide_short_help = true)]
    sample_seed: Option<u64>,
    /// Backend that moves the load; may be repeated
    #[arg(long, default_value = "quasi-static", value_parser = choice::<BackendKind>())]
    backend: Vec<BackendKind>,
    /// Longest time step (s); may be repeated
    #[arg(long, value_name = "H", value_parser = seconds)]
    step_s: Vec<f64>,
    /// Error control instead of a fixed step: largest error of the load's position (m)
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with_all = ["step_s", "integrator"], hide_short_help = true)]
    tolerance: Option<f64>,
    /// Time integration of the inertial backend [default: midpoint]
    #[arg(long, value_name = "METHOD", value_parser = choice::<Integrator>(), hide_short_help = true)]
    integrator: Option<Integrator>,
    /// Do work whose result is already known; see `cohaul explain skipped`. May be repeated
    #[arg(long, value_name = "KIND", value_parser = choice::<Skip>(), hide_short_help = true)]
    no_skip: Vec<Skip>,
    /// Number of threads [default: number of processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Compute only part I of N, for `cohaul merge`
    ///
    /// The part is written to DIR/shards; `cohaul merge` joins all parts.
    #[arg(long, value_name = "I/N")]
    shard: Option<Part>,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    strict: StrictArgs,
    /// Folder for the output files
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    out: PathBuf,
    /// Print one JSON object instead of text
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub fn sweep(args: &SweepArgs) -> Result<ExitCode, CliError> {
    let plan = plan(args)?;
    args.step_s.iter().try_for_each(|step| check_step(Some(*step), plan.base()))?;
    check_variants(&plan)?;
    let pool = pool(args.threads, plan.identity.n_cells)?;
    warn_of_idle(&args.backend, args.integrator, &args.engine);
    warn_of_idle_points(plan.base(), &args.backend, args.seeds, scales_inertia(args));
    match args.shard {
        Some(part) => one_shard(args, &plan, &pool, part),
        None => whole(args, &plan, &pool),
    }
}

/// The option that scales the inertia.
fn scales_inertia(args: &SweepArgs) -> Option<&'static str> {
    let varies = args.vary.iter().any(|axis| Factor::named(&axis.path) == Some(Factor::Inertia));
    args.scale_inertia.as_ref().map(|_| "--scale-inertia").or(varies.then_some("--vary inertia"))
}

fn plan(args: &SweepArgs) -> Result<Plan, CliError> {
    let text = read_scenario_text(&args.scenario)?;
    let inertia = args.scale_inertia.as_deref().map(|values| Axis::new(INERTIA, values)).transpose()?;
    let axes = args.vary.iter().cloned().chain(inertia).collect();
    Ok(Plan::new(Ask {
        file: name_of(&args.scenario),
        text,
        design: Design::new(axes, sample(args)?)?,
        variants: variants(args)?,
        first_seed: args.seed,
        n_seeds: args.seeds,
    })?)
}

fn sample(args: &SweepArgs) -> Result<Option<Sample>, CliError> {
    let Some([method, n]) = args.sample.as_deref() else { return Ok(None) };
    let usage = |what: &str, found: &str| CliError::Usage(format!("--sample: must be {what}, found {found}"));
    let method = parse::<Method>(method).ok_or_else(|| usage("latin-hypercube or sobol", method))?;
    let n = n.parse().map_err(|_| usage("a method and a number of points", n))?;
    Ok(Some(Sample { method, n, seed: args.sample_seed }))
}

/// Every backend at every step.
fn variants(args: &SweepArgs) -> Result<Vec<Variant>, CliError> {
    if args.tolerance.is_some() {
        check_error_control(&args.backend)?;
    }
    let steps: Vec<Option<f64>> = if args.step_s.is_empty() { vec![None] } else { args.step_s.iter().copied().map(Some).collect() };
    let of = |backend: BackendKind, step_s: Option<f64>| Variant {
        backend,
        step_s,
        tolerance_m: args.tolerance,
        integrator: args.integrator.unwrap_or_default(),
        rapier: args.engine.options(),
        skips: Skips::ALL.without_all(&args.no_skip),
    };
    Ok(args.backend.iter().flat_map(|backend| steps.iter().map(|step_s| of(*backend, *step_s))).collect())
}

/// # Errors
/// When two variants are equal, because steps end with the control period.
fn check_variants(plan: &Plan) -> Result<(), CliError> {
    let options: Vec<BackendOptions> = plan.identity.variants.iter().map(|variant| variant.options(plan.base())).collect();
    if (1..options.len()).any(|at| options[..at].contains(&options[at])) {
        return Err(CliError::Usage("--backend, --step-s: must name every backend and step once, found one again".into()));
    }
    Ok(())
}

/// All cells, into the folder.
fn whole(args: &SweepArgs, plan: &Plan, pool: &ThreadPool) -> Result<ExitCode, CliError> {
    let out = &args.out;
    check_target(out)?;
    let path = resumable::journal_beside(out);
    if let Some(summary) = finished(out, &plan.identity)? {
        // A sweep that was killed between the last two steps leaves both.
        if path.exists() {
            fs::remove_file(&path).map_err(at_output(&path))?;
        }
        console::note(format_args!("{}: is finished", out.display()));
        return print_summary(&summary, args.json, &args.strict);
    }
    let (started, wall, cpu) = (SystemTime::now(), Instant::now(), ProcessTime::now());
    let header = plan.identity.header(0..plan.identity.n_cells)?;
    let (journal, n_runs) = filled(plan, pool, &path, &header)?;
    let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let cost = Cost { wall_s, cpu_s, n_threads: pool.current_num_threads(), n_runs };
    let summary = write_table(out, &plan.identity, &journal, Some(cost), started)?;
    journal.remove()?;
    print_summary(&summary, args.json, &args.strict)
}

/// One part, into the folder of shards.
fn one_shard(args: &SweepArgs, plan: &Plan, pool: &ThreadPool, part: Part) -> Result<ExitCode, CliError> {
    let folder = args.out.join("shards");
    if args.out.join(MANIFEST).exists() {
        let what = "holds a finished output; shards go to a folder of their own";
        return Err(CliError::Usage(format!("{}: {what}", args.out.display())));
    }
    fs::create_dir_all(&folder).map_err(at_output(&folder))?;
    let cells = part.cells(plan.identity.n_cells);
    let header = plan.identity.header(cells.clone())?;
    let (path, journal_path) = (folder.join(format!("{}.rows", part.name())), folder.join(format!("{}.journal", part.name())));
    check_neighbours(&folder, &plan.identity, part.n)?;
    let is_skipped = verified(&path, &header)?;
    if is_skipped {
        // A shard that was killed between the last two steps leaves both.
        let _ = fs::remove_file(&journal_path);
    } else {
        let (journal, _) = filled(plan, pool, &journal_path, &header)?;
        finish_shard(&path, &header, &journal)?;
        journal.remove()?;
    }
    let n_runs = cells.end - cells.start;
    if args.json {
        let found = FinishedShard {
            shard: part.index,
            n_shards: part.n,
            first_cell: cells.start,
            n_runs,
            file: path.display().to_string(),
            was_finished: is_skipped,
        };
        print(&json::pretty(&stamped(&found))?)?;
    } else {
        let how = if is_skipped { "was finished" } else { "is finished" };
        print(&format!("shard {} of {} {how}: {n_runs} runs in {}\n", part.index, part.n, path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// What `--shard` prints with `--json`.
#[derive(Serialize)]
struct FinishedShard {
    shard: u64,
    n_shards: u64,
    first_cell: u64,
    n_runs: u64,
    file: String,
    was_finished: bool,
}

impl Versioned for FinishedShard {
    const FORMAT: Format = formats::SWEEP_SHARD;
}

/// Refuses, before the work, a folder with shards of another sweep or of another number of parts.
fn check_neighbours(folder: &Path, identity: &Identity, n_parts: u64) -> Result<(), CliError> {
    let shards = shard_files(&[folder.to_owned()])?;
    let of_others = |path: &&PathBuf| path.file_stem().and_then(Part::of_name).is_some_and(|part| part.n != n_parts);
    if let Some(path) = shards.iter().find(of_others) {
        return Err(CliError::Usage(format!(
            "{}: must be one of {n_parts} parts, as the shard asked for; remove it, or write to another folder",
            path.display()
        )));
    }
    let Some(path) = shards.first() else { return Ok(()) };
    check_same(path, identity.differences(&Identity::read(path)?.0))
}

/// # Errors
/// When there are differences between the sweep asked for and that of the file or folder.
fn check_same(path: &Path, differences: Vec<String>) -> Result<(), CliError> {
    if differences.is_empty() {
        return Ok(());
    }
    Err(JournalError::Other { path: path.to_owned(), study: "sweep".to_owned(), differences }.into())
}

/// The journal with the rows of all its cells, and the number of cells that were run for it.
///
/// # Errors
/// When the user stopped the command, a point breaks a rule of the scenario, or the disk fails.
fn filled(plan: &Plan, pool: &ThreadPool, path: &Path, header: &Header) -> Result<(Journal, u64), CliError> {
    let is_new = !path.exists();
    if is_new {
        validate(plan, header.begin..header.end, pool, || !is_interrupted())?;
        if is_interrupted() {
            return Err(CliError::Interrupted);
        }
    }
    let mut journal = Journal::open(path, header)?;
    let n_left = journal.n_left();
    if journal.n_dropped > 0 {
        let (path, n_bytes) = (path.display(), journal.n_dropped);
        console::note(format_args!("{path}: its last {n_bytes} bytes were damaged; their runs are computed again"));
    }
    if !is_new && journal.n_done() > 0 {
        console::note(format_args!("{}: continues after {} runs, {n_left} are left", path.display(), journal.n_done()));
    }
    run_left(plan, pool, header, &mut journal, n_left)?;
    if journal.n_left() == 0 {
        return Ok((journal, n_left));
    }
    journal.sync()?;
    let work = format!("{} of {} runs", journal.n_done(), header.end - header.begin);
    Err(resumable::stopped(&work, Some(path)))
}

fn run_left(plan: &Plan, pool: &ThreadPool, header: &Header, journal: &mut Journal, n_left: u64) -> Result<(), CliError> {
    if n_left == 0 {
        return Ok(());
    }
    let done: Vec<bool> = (header.begin..header.end).map(|cell| journal.has(cell)).collect();
    let is_done = |cell: u64| done[(cell - header.begin) as usize];
    let n_ended = AtomicU64::new(0);
    let ended = watched_by(Progress::of_count(n_left, "runs", "sweep"), |watch| {
        let go_on = || watch(n_ended.load(Relaxed) as f64);
        work(plan, header.begin..header.end, pool, is_done, go_on, |cell, line| {
            n_ended.fetch_add(1, Relaxed);
            Ok(journal.append(cell, line)?)
        })
    });
    Ok(ended?)
}

/// Writes the folder of a table that is complete.
pub fn write_table(
    out: &Path,
    identity: &Identity,
    table: &dyn Table,
    cost: Option<Cost>,
    started: SystemTime,
) -> Result<SweepSummary, CliError> {
    if cfg!(not(feature = "parquet")) {
        console::note("runs.parquet is left out: this program was built without the feature parquet");
    }
    let base = Scenario::parse(&identity.scenario.to_string(), "scenario")?;
    let summary = SweepSummary::new(identity, &base.name, cost);
    let options = json!({ "sweep": identity, "cost": cost });
    let command = command_line();
    let manifest = Manifest::new(&base.expanded(), identity.scenario_sha256.clone(), None, &options, command, started);
    Ok(write_sweep(out, identity, table, summary, &manifest)?)
}

/// Prints the summary. The exit code is that of the worst run.
pub fn print_summary(summary: &SweepSummary, json: bool, strict: &StrictArgs) -> Result<ExitCode, CliError> {
    let worst = summary.worst();
    match json {
        true => print(&json::pretty(&stamped(summary))?)?,
        false => print_answer(&sweep_text(summary, console::detail()), Tone::of(worst))?,
    }
    console::warn_all(&summary.warnings());
    Ok(strict.code(worst))
}

/// The summary of this sweep if the folder holds it; `None` if it holds no sweep.
///
/// # Errors
/// When it holds another sweep, or files other than it wrote.
pub fn finished(out: &Path, identity: &Identity) -> Result<Option<SweepSummary>, CliError> {
    let Some(found) = identity_in(out) else { return Ok(None) };
    let differences = match serde_json::from_value::<Identity>(found) {
        Ok(found) => identity.differences(&found),
        Err(error) => vec![format!("another version of this program wrote it: {error}")],
    };
    check_same(out, differences)?;
    check_files(out)?;
    let path = out.join("summary.json");
    read_json(&path, &formats::SWEEP, "must be the summary of a sweep").map(Some)
}
