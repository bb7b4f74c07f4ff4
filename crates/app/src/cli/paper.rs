//! `cohaul paper`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::choice::{choice, choice_of};
use super::console::{Tone, detail};
use super::error::CliError;
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use super::watch::watched;
use cohaul::backend::{BackendKind, Status};
use cohaul::scenario::presets::Preset;
use cohaul_paper::paper::figure;
use cohaul_paper::paper::files::write_paper;
use cohaul_paper::paper::readings::{Readings, write_readings};
use cohaul_paper::paper::report::{Paper, runs_by_set};
use cohaul_paper::paper::search::Stage;
use cohaul_paper::paper::search::files::write_search;
use cohaul_paper::paper::search::report::Search;
use cohaul_paper::paper::search::text::search_text;
use cohaul_paper::paper::text::paper_text;
use cohaul_paper::paper::{self, Case, Plan, Sampling, Set, Trial};
use cohaul_report::manifest::Manifest;

#[derive(Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  cohaul paper --quick
  cohaul paper --seeds 400 --out out/paper
  cohaul paper --backend quasi-static inertial --preset aged
  cohaul paper --quick --set drive.pull_speed_m_per_s=0.02
  cohaul paper readings
  cohaul paper deadlocks scenarios/paper/corridor.json
  cohaul paper search --out out/search

Files in DIR: tables (CSV), figures (SVG), README.md, report.html, summary.json
and manifest.json. The state of an interrupted run is kept in DIR.journal."
)]
pub struct PaperArgs {
    #[command(subcommand)]
    command: Option<PaperCommand>,
    /// Number of seeds of the first set [default: 400; with --quick 12]
    ///
    /// The other exact backend gets half as many but with --quick, and rapier, other masses and
    /// other presets fewer. Below 8 seeds, other presets are left out.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: Option<u64>,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only these backends; the others are compared with the first of the list below
    #[arg(long, num_args = 1.., value_parser = choice::<BackendKind>())]
    backend: Vec<BackendKind>,
    /// Parameters of the ants
    #[arg(long, value_name = "NAME", default_value = Preset::default().name(), value_parser = choice_of::<Preset>("preset"))]
    preset: Preset,
    /// Set a key of the scenarios, as drive.pull_speed_m_per_s=0.02
    ///
    /// The option may be given several times. Every set of runs has the values; other presets are
    /// left out.
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    set: Vec<(String, Value)>,
    /// A few seeds, one other mass, and no replays: half a minute instead of five
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    output: OutputArgs,
}

#[derive(Subcommand)]
enum PaperCommand {
    /// Find all parameter sets that the paper allows, and what holds over them
    Search(SearchArgs),
    /// Compare readings of what the paper leaves open, fact by fact
    Readings(ReadingsArgs),
    /// Measure how long loads stand still before obstacles, and how that ends
    Deadlocks(super::deadlocks::DeadlocksArgs),
}

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul paper readings --seeds 8
  cohaul paper readings --out out/readings

Files in DIR: readings.csv, README.md, summary.json and manifest.json. The
state of an interrupted run is kept in DIR.journal.")]
struct ReadingsArgs {
    /// Number of seeds of each reading
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    output: OutputArgs,
}

fn readings(args: &ReadingsArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    let plan = paper::readings::plan(args.seed, args.seeds);
    let started = SystemTime::now();
    let finished = resumable::run("paper readings", &json!({ "plan": plan }), &paper::tasks(&plan), args.output.out.as_deref())?;
    let found = Readings::new(&plan, &finished.records);
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "readings of the paper", "plan": plan });
        write_readings(out, &found, &study_manifest(&question, &json!(plan), started))?;
    }
    finished.remove_journal()?;
    args.output.print(&found, || found.text(), Tone::Good)?;
    Ok(ExitCode::SUCCESS)
}

/// A key of a scenario and its value, as JSON or else as a word.
fn setting(text: &str) -> Result<(String, Value), String> {
    let (key, value) = text.split_once('=').ok_or_else(|| format!("must be KEY=VALUE, found {text}"))?;
    Ok((key.to_owned(), serde_json::from_str(value).unwrap_or_else(|_| value.into())))
}

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul paper search --rows 8 --most 4
  cohaul paper search --out out/search

With the defaults it runs an hour on two processors. Files in DIR: tables
(CSV), figures (SVG), README.md, report.html, summary.json and manifest.json.
The state of an interrupted search is kept in DIR.journal.")]
struct SearchArgs {
    /// Rows of each matrix of the design; there are 12 times as many sets
    #[arg(long, value_name = "N", default_value_t = 160, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    rows: u64,
    /// Further sets, in the smallest box around the closest ones
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    within: u64,
    /// Seeds of the first look at each set
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Seeds of the second look at the sets that came close
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(2..=1000))]
    more_seeds: u64,
    /// Look again at so many sets at most
    #[arg(long, value_name = "N", default_value_t = 96)]
    most: usize,
    #[command(flatten)]
    output: OutputArgs,
}

fn search(args: &SearchArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    let plan = paper::search::Plan {
        n_rows: args.rows,
        n_within: args.within,
        n_screening_seeds: args.seeds,
        n_judging_seeds: args.more_seeds,
        most_judged: args.most,
    };
    let started = SystemTime::now();
    let out = args.output.out.as_deref();
    let mut records = resumable::open("paper search", &json!({ "plan": plan }), out.map(resumable::journal_beside).as_deref())?;
    let mut stage = Stage::default();
    let n_first = plan.n_first();
    for (label, n_tasks) in [("design", n_first[0]), ("within the box", n_first[1])] {
        watched(label, |watch| plan.tasks(&stage).run(&mut records, watch))?;
        if records.n_done() < n_tasks {
            return Err(resumable::stopped(&format!("{} of {n_tasks} sets", records.n_done()), records.path()));
        }
        let done = (0..n_tasks).filter_map(|task| records.get(task));
        stage = if n_tasks == n_first[0] { plan.after_design(done) } else { plan.after_first(stage, done) };
    }
    watched("second look", |watch| plan.tasks(&stage).run(&mut records, watch))?;
    let mut finished = resumable::finished(records, n_first[1] + stage.close.len())?;
    let found = Search::new(&plan, &stage, std::mem::take(&mut finished.records), finished.wall_s);
    if let Some(out) = out {
        let question = json!({ "name": "parameter sets that the paper allows", "plan": plan });
        write_search(out, &found, &study_manifest(&question, &json!(plan), started))?;
    }
    finished.remove_journal()?;
    args.output.print(&found, || search_text(&found, detail()), if found.n_accepted > 0 { Tone::Good } else { Tone::Caution })?;
    args.output.print_report()?;
    Ok(ExitCode::SUCCESS)
}

/// Default number of seeds: a tenth of the runs of four ants is then known to 3 %.
const SEEDS: u64 = 400;
const QUICK_SEEDS: u64 = 12;
/// Below this number of seeds, other presets are left out.
const FEWEST_FOR_OTHERS: u64 = 8;

pub fn paper(args: &PaperArgs) -> Result<ExitCode, CliError> {
    match &args.command {
        Some(PaperCommand::Search(args)) => return search(args),
        Some(PaperCommand::Readings(args)) => return readings(args),
        Some(PaperCommand::Deadlocks(args)) => return super::deadlocks::deadlocks(args),
        None => args.output.check()?,
    }
    for trial in Trial::ALL {
        trial.checked(&Case { set: args.set.clone(), ..Case::new(args.preset, BackendKind::QuasiStatic) }, args.seed)?;
    }
    let plan = plan(args);
    let started = SystemTime::now();
    let finished = resumable::run("paper", &json!({ "plan": plan }), &paper::tasks(&plan), args.output.out.as_deref())?;
    let answers = &finished.records;
    let found = Paper::new(&plan, answers, args.quick, finished.wall_s);
    if let Some(out) = &args.output.out {
        let runs = runs_by_set(&plan, answers);
        let units = paper::units(&runs[0]);
        let shown = paper::shown(Trial::FourFour, &plan.sets[0].case, plan.first_seed);
        let figures = figure::of_paper(&found, &units, paper::largest(&units, Sampling::AtDecisions), shown.as_ref());
        write_paper(out, &found, &runs, &figures, &manifest(&plan, started))?;
    }
    finished.remove_journal()?;
    let has_failed = found.status == Status::Failed;
    args.output.print(&found, || paper_text(&found, detail()), if has_failed { Tone::Bad } else { Tone::Good })?;
    Ok(if has_failed { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

fn plan(args: &PaperArgs) -> Plan {
    let n_seeds = args.seeds.unwrap_or(if args.quick { QUICK_SEEDS } else { SEEDS });
    let asked: &[BackendKind] = if args.backend.is_empty() { &BackendKind::COMPARED } else { &args.backend };
    let is_asked = |backend: &BackendKind| asked.contains(backend);
    let fewer = |by: u64, least: u64| (n_seeds / by).max(least).min(n_seeds);
    let by = if args.quick { 4 } else { 8 };
    let set = |case: Case, n_seeds: u64| {
        let case = Case { set: args.set.clone(), ..case };
        // An engine is slow, and other models need no large teams.
        let has_crowd = case.preset == args.preset && case.backend.is_exact();
        let of_crowd = if args.quick { 4 } else { n_seeds.div_ceil(4) };
        Set { case, n_seeds, n_crowd_seeds: if has_crowd { of_crowd.min(n_seeds) } else { 0 } }
    };
    let mut sets: Vec<Set> = Vec::new();
    for backend in BackendKind::ALL.into_iter().filter(is_asked) {
        let n_seeds = match backend.is_exact() {
            true if sets.is_empty() || args.quick => n_seeds,
            true => fewer(2, 2),
            false => fewer(by, 2),
        };
        sets.push(set(Case::new(args.preset, backend), n_seeds));
    }
    if is_asked(&BackendKind::Inertial) {
        let factors: &[f64] = if args.quick { &[100.0] } else { &[0.1, 10.0, 100.0] };
        let scaled = |inertia: &f64| set(Case { inertia: *inertia, ..Case::new(args.preset, BackendKind::Inertial) }, fewer(by, 4));
        sets.extend(factors.iter().map(scaled));
    }
    let has_others = args.set.is_empty() && is_asked(&BackendKind::QuasiStatic) && n_seeds >= FEWEST_FOR_OTHERS;
    if has_others {
        let other = |preset: Preset| set(Case::new(preset, BackendKind::QuasiStatic), fewer(2 * by, 2));
        sets.extend(Preset::ALL.into_iter().filter(|preset| *preset != args.preset).map(other));
    }
    let has_all = BackendKind::COMPARED.iter().all(is_asked);
    Plan {
        preset: args.preset,
        first_seed: args.seed,
        sets,
        replayed: if has_all && !args.quick { Trial::ALL.to_vec() } else { Vec::new() },
        replayed_s: 60.0,
    }
}

/// The manifest names the trials as run at the first seed.
fn manifest(plan: &Plan, started: SystemTime) -> Manifest {
    let case = Case { backend: BackendKind::QuasiStatic, inertia: 1.0, ..plan.sets[0].case.clone() };
    let trials: Vec<_> = Trial::ALL.into_iter().map(|trial| trial.scenario(&case, plan.first_seed).expanded()).collect();
    study_manifest(&json!({ "name": "the paper's trials", "trials": trials }), &json!(plan), started)
}
