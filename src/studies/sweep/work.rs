//! All cells that are left, on all threads. Runs share nothing but the number of the next cell; one thread, the caller's, keeps their rows.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc;

use rayon::ThreadPool;
use rayon::prelude::*;

use super::cell::Prepared;
use super::error::SweepError;
use super::plan::Plan;

/// Builds the scenario of every point of these cells and forgets it again, so that one that breaks a rule is known before anything runs. No more of them are built once
/// `go_on` says no.
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

/// Runs every cell that `is_done` does not know and gives its line to `keep`, in the order in which runs end: nearly that of cells. `go_on` is asked in the middle of
/// runs; all were run when it never said no.
///
/// # Errors
/// When `keep` fails.
pub fn work(
    plan: &Plan,
    cells: Range<u64>,
    pool: &ThreadPool,
    is_done: impl Fn(u64) -> bool + Sync,
    go_on: impl Fn() -> bool + Sync,
    mut keep: impl FnMut(u64, &str) -> Result<(), SweepError>,
) -> Result<(), SweepError> {
    let (next, stopped) = (AtomicU64::new(cells.start), AtomicBool::new(false));
    let go_on = || !stopped.load(Relaxed) && go_on();
    let take = || {
        let taken = std::iter::from_fn(|| Some(next.fetch_add(1, Relaxed)).filter(|cell| *cell < cells.end));
        taken.into_iter().find(|cell| !is_done(*cell))
    };
    let (sender, lines) = mpsc::channel();
    pool.in_place_scope(|scope| {
        for _ in 0..pool.current_num_threads() {
            let sender = sender.clone();
            scope.spawn(|_| run(plan, take, go_on, sender));
        }
        drop(sender);
        for line in lines {
            let kept = line.and_then(|(cell, line)| keep(cell, &line));
            if kept.is_err() {
                stopped.store(true, Relaxed);
                return kept;
            }
        }
        Ok(())
    })
}

type Sender = mpsc::Sender<Result<(u64, String), SweepError>>;

/// One thread: cell after cell, each point built once.
fn run(plan: &Plan, take: impl Fn() -> Option<u64>, go_on: impl Fn() -> bool, sender: Sender) {
    let mut prepared: Option<Prepared> = None;
    while let Some(cell) = take() {
        let point = plan.identity.point_of(cell);
        if prepared.as_ref().is_none_or(|prepared| prepared.point != point) {
            match Prepared::new(plan, point) {
                Ok(new) => prepared = Some(new),
                // Nobody listens any more once another row could not be kept.
                Err(error) => return drop(sender.send(Err(error))),
            }
        }
        let Some(line) = prepared.as_mut().and_then(|prepared| prepared.line(cell, &go_on)) else { return };
        if sender.send(Ok((cell, line))).is_err() {
            return;
        }
    }
}
