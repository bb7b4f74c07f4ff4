//! All cells that are left, on all threads of a pool.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::ThreadPool;
use rayon::prelude::*;

use super::cell::Prepared;
use super::error::SweepError;
use super::plan::Plan;
use crate::runner;

/// Builds the scenario of every point of these cells and forgets it again, so that one that breaks
/// a rule is known before anything runs. No more of them are built once `go_on` says no.
///
/// # Errors
/// With the first point that breaks a rule.
pub fn validate(plan: &Plan, cells: Range<u64>, pool: &ThreadPool, go_on: impl Fn() -> bool + Sync) -> Result<(), SweepError> {
    if cells.is_empty() {
        return Ok(());
    }
    let points = plan.identity.point_of(cells.start)..plan.identity.point_of(cells.end - 1) + 1;
    let first = pool.install(|| {
        points.into_par_iter().find_map_first(|point| match go_on() {
            true => plan.scenario(&plan.values(point)).err().map(Some),
            false => Some(None),
        })
    });
    first.flatten().map_or(Ok(()), Err)
}

/// Runs every cell that `is_done` does not know, and gives its line to `keep` as soon as it ends.
/// All cells were run if `go_on`, which is also asked in the middle of runs, never returned false.
///
/// # Errors
/// When `keep` fails.
pub fn work(
    plan: &Plan,
    cells: Range<u64>,
    pool: &ThreadPool,
    is_done: impl Fn(u64) -> bool + Sync,
    go_on: impl Fn() -> bool + Sync,
    mut keep: impl FnMut(u64, &str) -> Result<(), SweepError> + Send,
) -> Result<(), SweepError> {
    let next = AtomicU64::new(cells.start);
    let take = || {
        let taken = std::iter::from_fn(|| Some(next.fetch_add(1, Relaxed)).filter(|cell| *cell < cells.end));
        taken.into_iter().find(|cell| !is_done(*cell))
    };
    // Each thread builds the scenario of a point once.
    let worker = || {
        let mut prepared: Option<Prepared> = None;
        move |cell, go_on: &(dyn Fn() -> bool + Sync)| {
            let point = plan.identity.point_of(cell);
            if prepared.as_ref().is_none_or(|prepared| prepared.point != point) {
                match Prepared::new(plan, point) {
                    Ok(new) => prepared = Some(new),
                    Err(error) => return Some(Err(error)),
                }
            }
            prepared.as_mut()?.line(cell, &go_on).map(Ok)
        }
    };
    pool.install(|| runner::work(take, worker, &go_on, |cell, line: String| keep(cell, &line)))
}
