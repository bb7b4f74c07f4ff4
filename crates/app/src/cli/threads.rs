//! Number of threads: what an option or the environment asks for, within reason.

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::console;
use super::error::CliError;

/// More than any machine has processors, and few enough to start.
const MOST_THREADS: usize = 1024;
/// Largest number of threads for each processor (1). Threads beyond it only cost memory.
const MOST_PER_PROCESSOR: usize = 8;
/// Variable of the environment that rayon reads.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Bounds the threads of the whole process where the environment asks for too many. Call it before
/// any work.
pub fn bound_environment() {
    if let Some(asked) = asked_by_environment() {
        let n = bounded(VARIABLE, asked);
        // An error means that threads are there already: then there is nothing to bound.
        let _ = ThreadPoolBuilder::new().num_threads(n).build_global();
    }
}

/// Threads for runs: as many as `--threads` asks for, but no more than runs.
///
/// # Errors
/// When the option is out of range, or the system has no threads.
pub fn pool(threads: Option<usize>, n_runs: u64) -> Result<ThreadPool, CliError> {
    if let Some(n) = threads.filter(|n| !(1..=MOST_THREADS).contains(n)) {
        return Err(CliError::Usage(format!("--threads: must be from 1 to {MOST_THREADS}, found {n}")));
    }
    let n_runs = usize::try_from(n_runs).unwrap_or(MOST_THREADS);
    let n = match threads {
        Some(n) => bounded("--threads", n).min(n_runs),
        // Zero stands for the default of rayon, and the warning was printed at the start.
        None => asked_by_environment().map_or(0, |n| n.min(most())),
    };
    let pool = ThreadPoolBuilder::new().num_threads(n).build();
    pool.map_err(|error| CliError::Usage(format!("--threads: {error}")))
}

fn asked_by_environment() -> Option<usize> {
    std::env::var(VARIABLE).ok()?.parse().ok().filter(|n| *n > 0)
}

/// Largest number of threads on this machine.
fn most() -> usize {
    n_processors() * MOST_PER_PROCESSOR
}

fn n_processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The number that `name` asks for, or the largest one, with a warning.
fn bounded(name: &str, asked: usize) -> usize {
    let most = most();
    if asked > most {
        let n = n_processors();
        console::warn(format_args!("{name}: {most} threads are used, {MOST_PER_PROCESSOR} for each of {n} processors, found {asked}"));
    }
    asked.min(most)
}
