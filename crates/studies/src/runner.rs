//! Runner of all studies: many tasks on all threads, with progress, interruption and resumption.
//!
//! A study is a list of [`Tasks`]. The record of a task depends on the task alone, so records are
//! the same for any number of threads and after any interruption. [`Records`] keeps them in memory
//! and, if the study has an output folder, in a [`Journal`] beside it. Every record is on the file
//! before the next one, so that not even a killed process loses more than the tasks it was at.
//!
//! A study whose tasks are measured one after the other, such as `bench`, uses [`Records`] alone.
//! A study with too many records for the memory, such as `sweep`, uses [`work`] alone.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::journal::{Header, Journal, JournalError};
use cohaul::stop::Stop;

/// How much of a study is done. What it leaves out to be quick, each study says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    Full,
    Quick,
}

impl Effort {
    pub fn of(is_quick: bool) -> Self {
        if is_quick { Effort::Quick } else { Effort::Full }
    }
}

/// Receives the fraction of the work done (1) now and then, and returns whether to continue.
pub type Watch<'a> = dyn Fn(f64) -> bool + Sync + 'a;

/// Runs one task; `None` when the watch ended it.
pub type Run<'a, R> = dyn Fn(usize, &(dyn Fn() -> bool + Sync)) -> Option<R> + Sync + 'a;

/// Tasks of a study, numbered from zero.
pub struct Tasks<'a, R> {
    /// Expected cost of each task in any unit, for progress and order: expensive tasks start first.
    pub costs: Vec<f64>,
    pub run: Box<Run<'a, R>>,
}

impl<'a, R: Serialize + DeserializeOwned + Send> Tasks<'a, R> {
    /// Tasks of equal cost, which are run in their order.
    pub fn equal(n: usize, run: impl Fn(usize, &(dyn Fn() -> bool + Sync)) -> Option<R> + Sync + 'a) -> Self {
        Self { costs: vec![1.0; n], run: Box::new(run) }
    }

    /// Runs all tasks without a journal. Returns their records in order, or `None` when `watch`
    /// ended the work.
    pub fn finished(&self, watch: &Watch) -> Option<Vec<R>> {
        let mut records = Records::in_memory();
        self.run(&mut records, watch).expect("memory does not fail");
        records.complete(self.costs.len()).ok().map(|(records, _)| records)
    }

    /// Runs all tasks that have no record yet, until `watch` ends the work.
    ///
    /// # Errors
    /// When the journal cannot be written.
    pub fn run(&self, records: &mut Records<R>, watch: &Watch) -> Result<(), JournalError> {
        let whole: f64 = self.costs.iter().sum();
        let mut left: Vec<usize> = (0..self.costs.len()).filter(|task| records.get(*task).is_none()).collect();
        left.sort_by(|a, b| self.costs[*b].total_cmp(&self.costs[*a]));
        let mut spent = whole - left.iter().map(|task| self.costs[*task]).sum::<f64>();
        let share = AtomicU64::new((spent / whole).to_bits());
        let next = AtomicU64::new(0);
        work(
            || left.get(next.fetch_add(1, Relaxed) as usize).copied(),
            || |task, go_on: &(dyn Fn() -> bool + Sync)| (self.run)(task, go_on).map(Ok),
            || watch(f64::from_bits(share.load(Relaxed)).min(1.0)),
            |task, record| {
                spent += self.costs[task];
                share.store((spent / whole).to_bits(), Relaxed);
                records.keep(task, record)
            },
        )
    }
}

/// Runs every task that `next` gives out on all threads of the current rayon pool.
///
/// Each thread makes one function with `worker` and calls it task by task; the function returns
/// `None` when `go_on` ended it. A task that is stopped ends in the same way. `keep` receives the
/// results one at a time.
///
/// # Errors
/// With the first error of a task or of `keep`, which ends the work.
pub fn work<T: Copy, R, E: Send, Run>(
    next: impl Fn() -> Option<T> + Sync,
    worker: impl Fn() -> Run + Sync,
    go_on: impl Fn() -> bool + Sync,
    keep: impl FnMut(T, R) -> Result<(), E> + Send,
) -> Result<(), E>
where
    Run: FnMut(T, &(dyn Fn() -> bool + Sync)) -> Option<Result<R, E>>,
{
    let (keep, failure, has_failed) = (Mutex::new(keep), Mutex::new(None), AtomicBool::new(false));
    let go_on = || !has_failed.load(Relaxed) && go_on();
    let stop = Stop::current();
    rayon::broadcast(|_| {
        let mut run = worker();
        while go_on()
            && let Some(task) = next()
        {
            let Some(result) = stop.run(|| run(task, &go_on)).flatten() else { return };
            let kept = result.and_then(|record| (keep.lock().expect("keeping does not panic"))(task, record));
            if let Err(error) = kept {
                failure.lock().expect("nothing panics here").get_or_insert(error);
                return has_failed.store(true, Relaxed);
            }
        }
    });
    failure.into_inner().expect("nothing panics here").map_or(Ok(()), Err)
}

/// Records of the tasks that are done.
pub struct Records<R> {
    done: BTreeMap<usize, R>,
    journal: Option<Journal>,
    /// Run time of the calls before this one (s).
    earlier_s: f64,
    clock: Instant,
}

/// More tasks than any study that keeps its records in memory has.
const MOST_TASKS: u64 = 100_000_000;

impl<R: Serialize + DeserializeOwned> Records<R> {
    /// Records that last as long as the program.
    pub fn in_memory() -> Self {
        Self { done: BTreeMap::new(), journal: None, earlier_s: 0.0, clock: Instant::now() }
    }

    /// Records in the journal at `path`, with those that an earlier call left there.
    ///
    /// # Errors
    /// When the file belongs to another question, is not a journal, or cannot be read.
    pub fn open(path: &Path, study: &str, identity: &impl Serialize) -> Result<Self, JournalError> {
        let journal = Journal::open(path, &Header::new(study, identity, 0..MOST_TASKS))?;
        let mut records = Self::in_memory();
        journal.visit(|line| {
            let (task, text) = line.split_once(',').unwrap_or((line, ""));
            let bad = |error| JournalError::unusable(path, format!("has a record that is none of a {study}: {error}"));
            let (wall_s, record) = serde_json::from_str::<(f64, R)>(text).map_err(bad)?;
            records.earlier_s = records.earlier_s.max(wall_s);
            records.done.insert(task.parse().expect("records begin with their task"), record);
            Ok::<(), JournalError>(())
        })?;
        Ok(Self { journal: Some(journal), ..records })
    }

    pub fn get(&self, task: usize) -> Option<&R> {
        self.done.get(&task)
    }

    /// The error of a record that is not what its study expects.
    pub fn unfit(&self, task: usize, error: &serde_json::Error) -> JournalError {
        let path = self.path().unwrap_or(Path::new("memory"));
        JournalError::unusable(path, format!("record {task} is not what the study expects: {error}"))
    }

    pub fn n_done(&self) -> usize {
        self.done.len()
    }

    /// File that the records are kept in.
    pub fn path(&self) -> Option<&Path> {
        self.journal.as_ref().map(Journal::path)
    }

    /// Run time of this call and those before it (s).
    pub fn wall_s(&self) -> f64 {
        self.earlier_s + self.clock.elapsed().as_secs_f64()
    }

    /// Keeps the record of a task.
    ///
    /// # Errors
    /// When the journal cannot be written.
    pub fn keep(&mut self, task: usize, record: R) -> Result<(), JournalError> {
        let wall_s = self.wall_s();
        if let Some(journal) = &mut self.journal {
            let text = serde_json::to_string(&(wall_s, &record)).expect("a record is plain data");
            journal.append(task as u64, &format!("{task},{text}"))?;
        }
        self.done.insert(task, record);
        Ok(())
    }

    /// All `n` records in order and the journal, or what there is when some are missing.
    ///
    /// # Errors
    /// With itself, when a record is missing.
    pub fn complete(self, n: usize) -> Result<(Vec<R>, Option<Journal>), Box<Self>> {
        if self.done.len() < n { Err(Box::new(self)) } else { Ok((self.done.into_values().collect(), self.journal)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(n: usize) -> Tasks<'static, f64> {
        Tasks { costs: (0..n).map(|task| task as f64).collect(), run: Box::new(|task, go_on| go_on().then(|| (task as f64).powi(2) / 7.0)) }
    }

    #[test]
    fn records_are_in_order_and_expensive_tasks_run_first() {
        let order = Mutex::new(Vec::new());
        let run = |task: usize, _: &(dyn Fn() -> bool + Sync)| {
            order.lock().unwrap().push(task);
            Some(task)
        };
        let tasks = Tasks { costs: vec![1.0, 3.0, 2.0], run: Box::new(run) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(pool.install(|| tasks.finished(&|_| true)), Some(vec![0, 1, 2]));
        drop(tasks);
        assert_eq!(order.into_inner().unwrap(), [1, 2, 0]);
    }

    #[test]
    fn an_interrupted_study_continues_from_its_journal_to_the_same_records() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("out.journal");
        let whole = squares(50).finished(&|_| true).unwrap();
        let open = || Records::<f64>::open(&path, "squares", &serde_json::json!({ "n": 50 })).unwrap();
        let mut n_calls = 0;
        let complete = loop {
            let mut records = open();
            let (before, first) = (records.n_done(), AtomicU64::new(8));
            squares(50).run(&mut records, &|_| first.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_ok()).unwrap();
            n_calls += 1;
            match records.complete(50) {
                Ok(complete) => break complete,
                Err(records) => assert!(records.n_done() > before),
            }
        };
        assert!(n_calls > 5);
        assert_eq!(complete.0, whole);
        complete.1.unwrap().remove().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn an_error_ends_the_work() {
        let next = AtomicU64::new(0);
        let ended = work(
            || Some(next.fetch_add(1, Relaxed)),
            || |task, _: &(dyn Fn() -> bool + Sync)| Some(if task == 9 { Err("nine") } else { Ok(()) }),
            || true,
            |_, ()| Ok(()),
        );
        assert_eq!(ended, Err("nine"));
    }
}
