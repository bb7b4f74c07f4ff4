//! Instruction counts of the hot paths, held against stored ceilings: a slow-down fails, however
//! noisy the machine.
//!
//! ```text
//! cargo instructions [NAME...] [--json]    count and compare
//! cargo instructions --accept              make what is counted the stored counts
//! ```
//!
//! A step, not a clock, is what repeats: `stepper.rs` says how. A count is no time, but a path that
//! takes more instructions for the same work is very rarely faster.
//!
//! Exit codes: 0 all within their ceilings, 1 some above or without one, 2 usage or input, 3
//! internal, 4 nothing counted or nothing to compare with. The last is neither a pass nor a
//! failure, and it is said aloud.

mod ceilings;
mod paths;
mod report;
#[cfg_attr(not(all(target_os = "linux", target_arch = "x86_64")), path = "nowhere.rs")]
mod stepper;

use std::collections::BTreeMap;
use std::env::consts::{ARCH, OS};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use clap::Parser;
use cohaul_report::progress::Progress;
use rayon::prelude::*;

use ceilings::{Ceilings, CeilingsError, USUAL_MARGIN};
use paths::{HOT_PATHS, HotPath};
use report::{Line, Report};
use stepper::StepError;

/// Counts the machine instructions of the hot paths and holds them against stored ceilings
#[derive(Parser)]
#[command(name = "cargo instructions", after_help = EXIT_CODES)]
struct Options {
    /// Hot paths to count; without any, all
    names: Vec<String>,
    /// Store what is counted
    #[arg(long)]
    accept: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Name the hot paths and stop
    #[arg(long)]
    list: bool,
    /// Run one path without counting, for a profiler that collects within `uncounted`
    #[arg(long, value_name = "NAME", conflicts_with_all = ["names", "accept", "json", "list"])]
    plain: Option<String>,
    /// What `cargo bench` adds
    #[arg(long, hide = true)]
    bench: bool,
}

const EXIT_CODES: &str =
    "Exit codes: 0 all within their ceilings; 1 some above or without one; 2 usage or input; 3 internal; 4 not counted or not compared.";
const CEILINGS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/ceilings.json");

/// Why the program ended without an answer.
#[derive(Debug, thiserror::Error)]
enum Unanswered {
    #[error("no hot path is called {0:?}; --list names them")]
    Name(String),
    #[error(transparent)]
    Ceilings(#[from] CeilingsError),
    #[error("--accept of some paths: the stored counts are of another build or compiler ({0}); accept all")]
    Mixture(String),
    #[error("{0}: {1}")]
    Step(&'static str, StepError),
    #[error("not counted: {0}")]
    NotCounted(StepError),
    #[error("not compared: {CEILINGS} has counts of {stored:?}, and this build is {found:?}; `cargo instructions` makes the right one")]
    NotCompared { stored: String, found: String },
}

impl Unanswered {
    fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Unanswered::Name(_) | Unanswered::Ceilings(_) | Unanswered::Mixture(_) => 2,
            Unanswered::Step(..) => 3,
            Unanswered::NotCounted(_) | Unanswered::NotCompared { .. } => 4,
        })
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, mode, name] = &arguments[..]
        && mode == stepper::CHILD
    {
        return stepper::run_child(name);
    }
    answer(&Options::parse()).unwrap_or_else(|error| {
        eprintln!("error: {error}");
        error.exit_code()
    })
}

fn answer(options: &Options) -> Result<ExitCode, Unanswered> {
    if options.list {
        HOT_PATHS.iter().for_each(|path| println!("{}", path.name));
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(name) = &options.plain {
        let path = paths::find(name).ok_or_else(|| Unanswered::Name(name.clone()))?;
        uncounted(&mut (path.prepare)(), path.n_calls);
        return Ok(ExitCode::SUCCESS);
    }
    let chosen = chosen(&options.names)?;
    let stored = Ceilings::read(CEILINGS.as_ref())?;
    let counts = count_all(&chosen)?;
    if options.accept {
        return accept(stored, &chosen, &counts);
    }
    let (same_build, other_build): (Option<Ceilings>, Option<Ceilings>) = match stored {
        Some(stored) if stored.build != this_build() => (None, Some(stored)),
        // Without a file, no path has a ceiling.
        stored => (Some(stored.unwrap_or_else(empty)), None),
    };
    let lines = chosen.iter().zip(&counts).map(|(path, count)| Line::new(path, *count, same_build.as_ref())).collect();
    let report = Report::new(this_build(), this_compiler(), same_build.as_ref(), lines);
    if options.json {
        println!("{}", serde_json::to_string_pretty(&report).expect("a report is plain data"));
    } else {
        print!("{}", report.text());
    }
    match other_build {
        Some(other) => Err(Unanswered::NotCompared { stored: other.build, found: this_build() }),
        None => Ok(ExitCode::from(u8::from(report.failed))),
    }
}

/// The paths of these names, in the order of the table; all without any.
fn chosen(names: &[String]) -> Result<Vec<&'static HotPath>, Unanswered> {
    if let Some(unknown) = names.iter().find(|name| paths::find(name).is_none()) {
        return Err(Unanswered::Name(unknown.clone()));
    }
    Ok(HOT_PATHS.iter().filter(|path| names.is_empty() || names.iter().any(|name| name == path.name)).collect())
}

/// Instructions of all counted calls of each path.
fn count_all(chosen: &[&'static HotPath]) -> Result<Vec<u64>, Unanswered> {
    if !stepper::fix_addresses() {
        eprintln!("addresses cannot be fixed here: counts may differ a little from run to run");
    }
    let n_counted = AtomicUsize::new(0);
    let count = |path: &&'static HotPath, at: &(dyn Fn(f64) + Sync)| {
        let count = stepper::count(path);
        at((n_counted.fetch_add(1, Relaxed) + 1) as f64 / chosen.len() as f64);
        let is_unavailable = |error: &StepError| matches!(error, StepError::Unavailable(_));
        count.map_err(|error| if is_unavailable(&error) { Unanswered::NotCounted(error) } else { Unanswered::Step(path.name, error) })
    };
    Progress::of_share("counting").shown(&|_| {}, |at| chosen.par_iter().with_max_len(1).map(|path| count(path, at)).collect())
}

fn accept(stored: Option<Ceilings>, chosen: &[&HotPath], counts: &[u64]) -> Result<ExitCode, Unanswered> {
    let are_all = chosen.len() == HOT_PATHS.len();
    let mut ceilings = stored.unwrap_or_else(empty);
    if !are_all && (ceilings.build != this_build() || ceilings.compiler != this_compiler()) {
        return Err(Unanswered::Mixture(format!("{}, {}", ceilings.build, ceilings.compiler)));
    }
    (ceilings.build, ceilings.compiler) = (this_build(), this_compiler());
    let counts: BTreeMap<String, u64> = chosen
        .iter()
        .zip(counts)
        .map(|(path, count)| (path.name.to_owned(), Line::new(path, *count, None).instructions_per_call))
        .collect();
    ceilings.accept(&counts, are_all);
    ceilings.write(Path::new(CEILINGS))?;
    println!("{} of {} hot paths stored in {CEILINGS}", chosen.len(), HOT_PATHS.len());
    Ok(ExitCode::SUCCESS)
}

fn empty() -> Ceilings {
    Ceilings { build: this_build(), compiler: this_compiler(), margin: USUAL_MARGIN, instructions_per_call: BTreeMap::new() }
}

fn this_build() -> String {
    let profile = option_env!("COHAUL_PROFILE").unwrap_or("an unknown profile");
    let assertions = if cfg!(debug_assertions) { "with" } else { "without" };
    format!("{ARCH}-{OS}, {profile}, {assertions} debug assertions")
}

fn this_compiler() -> String {
    option_env!("COHAUL_COMPILER").unwrap_or("an unknown compiler").to_owned()
}

/// What is stepped otherwise, under a name that profilers can ask for.
#[inline(never)]
fn uncounted(call: &mut dyn FnMut(), n_calls: u32) {
    (0..n_calls).for_each(|_| call());
}
