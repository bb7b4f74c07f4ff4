//! `cohaul sweep`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Instant, SystemTime};

use clap::Args;
use cpu_time::ProcessTime;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Value, json};

use super::{
    CliError, EngineArgs, check_step, command_line, interrupt, positive, print, resumable, step, warn_of_idle, warn_of_idle_points,
};
use crate::backend::{BackendKind, BackendOptions, Integrator, Skip, Skips};
use crate::output::folder::{MANIFEST, check_files, check_target};
use crate::output::json;
use crate::output::manifest::Manifest;
use crate::output::progress::Progress;
use crate::scenario::Scenario;
use crate::studies::journal::{Header, Journal, JournalError};
use crate::studies::sweep::files::write_sweep;
use crate::studies::sweep::report::{Cost, FAILED, NOT_WITHIN_TOLERANCE, SweepSummary, sweep_text};
use crate::studies::sweep::{
    Ask, Axis, Design, INERTIA, Identity, Method, Part, Plan, Sample, SweepError, Table, Variant, finish_shard, validate, verified, work,
};

#[derive(Args)]
pub struct SweepArgs {
    /// Scenario file
    scenario: PathBuf,
    /// Number of seeds at each point
    #[arg(long, value_name = "N", default_value_t = 1)]
    seeds: u64,
    /// First seed, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Parameter and its values: a,b,c or FIRST:LAST:N or log:FIRST:LAST:N, or with --sample LOW..HIGH or log:LOW..HIGH; several make a grid
    #[arg(long, value_name = "PATH=VALUES")]
    vary: Vec<Axis>,
    /// Factors of mass and moment of inertia at the same normal loads, and so the same friction; values as with --vary
    #[arg(long, value_name = "VALUES")]
    scale_inertia: Option<String>,
    /// How the ranges are sampled, latin-hypercube or sobol, and by how many points
    #[arg(long, num_args = 2, value_names = ["METHOD", "N"])]
    sample: Option<Vec<String>>,
    /// Key of the sample's chance; without it 1 for latin-hypercube, and the plain sequence for sobol
    #[arg(long, value_name = "N", requires = "sample")]
    sample_seed: Option<u64>,
    /// What moves the load; may be repeated
    #[arg(long, value_name = "BACKEND", default_value = "quasi-static")]
    backend: Vec<BackendKind>,
    /// Longest step of the backend (s); may be repeated
    #[arg(long, value_name = "H", value_parser = step)]
    step_s: Vec<f64>,
    /// Error that the load's position may have at any instant, in place of a step (m): quasi-static and inertial
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with_all = ["step_s", "integrator"])]
    tolerance: Option<f64>,
    /// How the inertial backend cuts a step; without it midpoint
    #[arg(long, value_name = "METHOD")]
    integrator: Option<Integrator>,
    /// Kind of work that is done although its outcome is known; may be repeated
    #[arg(long, value_name = "KIND")]
    no_skip: Vec<Skip>,
    /// Threads; without it one a processor
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Only part I of N, from 1/N to N/N, into DIR/shards; `cohaul merge` makes one table of all
    #[arg(long, value_name = "I/N")]
    shard: Option<Part>,
    /// Folder for tables, figure, summary and manifest; what a stopped sweep has done is kept beside it, as DIR.journal
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn sweep(args: &SweepArgs) -> Result<ExitCode, CliError> {
    let plan = plan(args)?;
    args.step_s.iter().try_for_each(|step| check_step(Some(*step), plan.base()))?;
    check_variants(&plan)?;
    let pool = pool(args.threads, plan.identity.n_cells)?;
    warn_of_idle(&args.backend, args.integrator, &args.engine);
    warn_of_idle_points(plan.base(), &args.backend, args.seeds, args.scale_inertia.is_some());
    match args.shard {
        Some(part) => one_shard(args, &plan, &pool, part),
        None => whole(args, &plan, &pool),
    }
}

fn plan(args: &SweepArgs) -> Result<Plan, CliError> {
    let text = fs::read_to_string(&args.scenario).map_err(|source| CliError::File { path: args.scenario.clone(), source })?;
    let inertia = args.scale_inertia.as_deref().map(|values| Axis::new(INERTIA, values)).transpose()?;
    let axes = args.vary.iter().cloned().chain(inertia).collect();
    Ok(Plan::new(Ask {
        file: args.scenario.display().to_string(),
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
    let method = <Method as clap::ValueEnum>::from_str(method, false).map_err(|_| usage("latin-hypercube or sobol", method))?;
    let n = n.parse().map_err(|_| usage("a method and a number of points", n))?;
    Ok(Some(Sample { method, n, seed: args.sample_seed }))
}

/// Every backend at every step.
fn variants(args: &SweepArgs) -> Result<Vec<Variant>, CliError> {
    if args.tolerance.is_some() && args.backend.contains(&BackendKind::Rapier) {
        return Err(CliError::Usage("--tolerance: must be of quasi-static or inertial, found rapier: an engine's steps are fixed".into()));
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
/// When two of the variants are one: steps end with the control period.
fn check_variants(plan: &Plan) -> Result<(), CliError> {
    let options: Vec<BackendOptions> = plan.identity.variants.iter().map(|variant| variant.options(plan.base())).collect();
    match (1..options.len()).find(|at| options[..*at].contains(&options[*at])) {
        Some(_) => Err(CliError::Usage("--backend, --step-s: must name every backend and step once, found one again".into())),
        None => Ok(()),
    }
}

/// Far more than processors, and few enough to start.
const MOST_THREADS: usize = 1024;

/// No more threads than runs.
fn pool(threads: Option<usize>, n_runs: u64) -> Result<ThreadPool, CliError> {
    if let Some(n) = threads.filter(|n| !(1..=MOST_THREADS).contains(n)) {
        return Err(CliError::Usage(format!("--threads: must be from 1 to {MOST_THREADS}, found {n}")));
    }
    let n_runs = usize::try_from(n_runs).unwrap_or(MOST_THREADS);
    let pool = ThreadPoolBuilder::new().num_threads(threads.map_or(0, |n| n.min(n_runs))).build();
    pool.map_err(|error| CliError::Usage(format!("--threads: {error}")))
}

/// All cells, into the folder.
fn whole(args: &SweepArgs, plan: &Plan, pool: &ThreadPool) -> Result<ExitCode, CliError> {
    let out = &args.out;
    check_target(out)?;
    let path = resumable::journal_beside(out);
    if let Some(summary) = finished(out, &plan.identity)? {
        // Killed between the last two steps, a sweep leaves both.
        if path.exists() {
            fs::remove_file(&path).map_err(|source| CliError::File { path, source })?;
        }
        say!("{}: is finished", out.display());
        return said(&summary, args.json);
    }
    let (started, wall, cpu) = (SystemTime::now(), Instant::now(), ProcessTime::now());
    let header = plan.identity.header(0..plan.identity.n_cells)?;
    let (journal, n_runs) = filled(plan, pool, &path, &header)?;
    let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let cost = Cost { wall_s, cpu_s, n_threads: pool.current_num_threads(), n_runs };
    let summary = written(out, &plan.identity, &journal, Some(cost), started)?;
    journal.remove()?;
    said(&summary, args.json)
}

/// One part, into the folder of shards.
fn one_shard(args: &SweepArgs, plan: &Plan, pool: &ThreadPool, part: Part) -> Result<ExitCode, CliError> {
    let folder = args.out.join("shards");
    if args.out.join(MANIFEST).exists() {
        let what = "holds a finished output; shards go to a folder of their own";
        return Err(CliError::Usage(format!("{}: {what}", args.out.display())));
    }
    fs::create_dir_all(&folder).map_err(|source| CliError::File { path: folder.clone(), source })?;
    let cells = part.cells(plan.identity.n_cells);
    let header = plan.identity.header(cells.clone())?;
    let (path, journal_path) = (folder.join(format!("{}.rows", part.name())), folder.join(format!("{}.journal", part.name())));
    check_neighbours(&folder, &plan.identity, part.n)?;
    let is_skipped = verified(&path, &header)?;
    if is_skipped {
        // Killed between the last two steps, a shard leaves both.
        let _ = fs::remove_file(&journal_path);
    } else {
        let (journal, _) = filled(plan, pool, &journal_path, &header)?;
        remove_partials(&path);
        finish_shard(&path, &header, &journal)?;
        journal.remove()?;
    }
    let n_runs = cells.end - cells.start;
    if args.json {
        let found = json!({ "shard": part.index, "n_shards": part.n, "first_cell": cells.start, "n_runs": n_runs, "file": path.display().to_string(), "was_finished": is_skipped });
        print(&format!("{found:#}\n"))?;
    } else {
        let how = if is_skipped { "was finished" } else { "is finished" };
        print(&format!("shard {} of {} {how}: {n_runs} runs in {}\n", part.index, part.n, path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Shards of another sweep in the same folder, or of one in another number of parts, are a mistake that is better known before the work than after it.
fn check_neighbours(folder: &Path, identity: &Identity, n_parts: u64) -> Result<(), CliError> {
    let entries = fs::read_dir(folder).map_err(|source| CliError::File { path: folder.to_owned(), source })?;
    let shards: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "rows"))
        .collect();
    let of_others = |path: &&PathBuf| path.file_stem().and_then(Part::of_name).is_some_and(|part| part.n != n_parts);
    if let Some(path) = shards.iter().find(of_others) {
        return Err(CliError::Usage(format!(
            "{}: must be one of {n_parts} parts, as the shard asked for; remove it, or write to another folder",
            path.display()
        )));
    }
    let Some(path) = shards.into_iter().next() else { return Ok(()) };
    check_same(&path, identity.differences(&Identity::read(&path)?.0))
}

/// # Errors
/// When there are differences between the sweep asked for and that of the file or folder.
fn check_same(path: &Path, differences: Vec<String>) -> Result<(), CliError> {
    let other = || JournalError::Other { path: path.to_owned(), study: "sweep".to_owned(), differences: differences.clone() };
    if differences.is_empty() { Ok(()) } else { Err(other().into()) }
}

/// The journal with the rows of all its cells, run as far as they were missing, and how many were.
///
/// # Errors
/// When the user stopped the command, a point breaks a rule of the scenario, or the disk fails.
fn filled(plan: &Plan, pool: &ThreadPool, path: &Path, header: &Header) -> Result<(Journal, u64), CliError> {
    let is_new = !path.exists();
    if is_new {
        validate(plan, header.begin..header.end, pool, || !interrupt::asked())?;
        if interrupt::asked() {
            return Err(CliError::Interrupted);
        }
    }
    let mut journal = Journal::open(path, header)?;
    let n_left = journal.n_left();
    if journal.n_dropped > 0 {
        say!("{}: its last {} bytes were cut off or damaged; the runs that they belonged to run again", path.display(), journal.n_dropped);
    }
    if !is_new && journal.n_done() > 0 {
        say!("{}: goes on after {} runs, {n_left} are left", path.display(), journal.n_done());
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
    let (progress, n_ended) = (Mutex::new(Progress::of_count(n_left, "runs", "sweep")), AtomicU64::new(0));
    let go_on = || {
        // Only one thread draws; the others need not wait for it.
        if let Ok(mut progress) = progress.try_lock() {
            progress.at(n_ended.load(Relaxed) as f64);
        }
        !interrupt::asked()
    };
    let ended = work(plan, header.begin..header.end, pool, is_done, go_on, |cell, line| {
        n_ended.fetch_add(1, Relaxed);
        Ok(journal.append(cell, line)?)
    });
    progress.into_inner().expect("no thread panicked while it drew").finish();
    Ok(ended?)
}

/// Writes the folder of a table that is complete.
pub(super) fn written(
    out: &Path,
    identity: &Identity,
    table: &dyn Table,
    cost: Option<Cost>,
    started: SystemTime,
) -> Result<SweepSummary, CliError> {
    if cfg!(not(feature = "parquet")) {
        say!("runs.parquet is left out: this program was built without the feature parquet");
    }
    let base = Scenario::parse(&identity.scenario.to_string(), "scenario")?;
    let summary = SweepSummary::new(identity, &base.name, cost);
    let options = json!({ "sweep": identity, "cost": cost });
    let command = command_line();
    let manifest = Manifest::new(&base.expanded(), identity.scenario_sha256.clone(), None, &options, command, started);
    Ok(write_sweep(out, identity, table, summary, &manifest)?)
}

/// Prints the summary; runs that failed or missed their tolerance are what a sweep was not asked for.
pub(super) fn said(summary: &SweepSummary, json: bool) -> Result<ExitCode, CliError> {
    print(&if json { json::pretty(summary)? } else { sweep_text(summary) })?;
    summary.warnings().iter().for_each(|warning| say!("warning: {warning}"));
    Ok(if summary.n_of(FAILED) + summary.n_of(NOT_WITHIN_TOLERANCE) > 0 { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// What tells the sweep whose output a folder holds from others; `None` where it holds none.
pub(super) fn identity_in(out: &Path) -> Option<Value> {
    let manifest: Value = serde_json::from_slice(&fs::read(out.join(MANIFEST)).ok()?).ok()?;
    manifest["options"].get("sweep").cloned()
}

/// The summary of this very sweep where the folder holds it; `None` where it holds no sweep.
///
/// # Errors
/// When it holds another sweep, or files other than it wrote.
pub(super) fn finished(out: &Path, identity: &Identity) -> Result<Option<SweepSummary>, CliError> {
    let Some(found) = identity_in(out) else { return Ok(None) };
    let differences = match serde_json::from_value::<Identity>(found) {
        Ok(found) => identity.differences(&found),
        Err(error) => vec![format!("it is of another version of this program: {error}")],
    };
    check_same(out, differences)?;
    check_files(out)?;
    let path = out.join("summary.json");
    let text = fs::read(&path).map_err(|source| CliError::File { path: path.clone(), source })?;
    let summary = serde_json::from_slice(&text).map_err(|source| CliError::File { path, source: source.into() })?;
    Ok(Some(summary))
}

/// Removes what a killed process left half-written of a shard: whoever holds its journal is alone.
fn remove_partials(shard: &Path) {
    let start = format!("{}.partial-", shard.file_stem().unwrap_or_default().to_string_lossy());
    let folder = shard.parent().unwrap_or(Path::new("."));
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&start) {
            // What cannot be removed does no harm.
            drop(fs::remove_file(entry.path()));
        }
    }
}

impl From<SweepError> for CliError {
    fn from(error: SweepError) -> Self {
        CliError::Sweep(error)
    }
}
