//! States of a run in memory, from which it is saved where a stop leaves it in the midst of a step.
//!
//! The trace of a run only grows. A checkpoint therefore has the lengths of its lists in place of a
//! copy.

use std::time::{Duration, Instant};

use super::saved_run::SavedRun;
use super::trace::Trace;

/// Time between two checkpoints at least.
const INTERVAL: Duration = Duration::from_secs(1);
/// The same, over the time that a checkpoint takes (1).
const INTERVAL_OVER_COST: u32 = 50;

/// The last checkpoint, and when the next one is due.
#[derive(Default)]
pub struct Checkpoints {
    /// A state without its trace, and the lengths of its lists.
    last: Option<(SavedRun, [usize; 5])>,
    due: Option<Instant>,
}

impl Checkpoints {
    /// Takes a checkpoint of what `now` returns, if one is due. The first one is due at once.
    pub(super) fn take_if_due<'a>(&mut self, now: impl FnOnce() -> Option<(SavedRun, &'a Trace)>) {
        let begin = Instant::now();
        if self.due.is_some_and(|due| begin < due) {
            return;
        }
        if let Some((state, trace)) = now() {
            self.last = Some((state, lengths(trace)));
        }
        let end = Instant::now();
        self.due = Some(end + INTERVAL.max(INTERVAL_OVER_COST * (end - begin)));
    }

    /// State of the last checkpoint, with its part of the trace of the run.
    pub(super) fn last(&self, trace: &Trace) -> Option<SavedRun> {
        let (state, [rows, events, between, transitions, companion]) = self.last.as_ref()?;
        let trace = Trace {
            rows: trace.rows[..*rows].to_vec(),
            events: trace.events[..*events].to_vec(),
            between: trace.between[..*between].to_vec(),
            transitions: trace.transitions[..*transitions].to_vec(),
            companion: trace.companion[..*companion].to_vec(),
        };
        Some(SavedRun { trace, ..state.clone() })
    }
}

fn lengths(trace: &Trace) -> [usize; 5] {
    let Trace { rows, events, between, transitions, companion } = trace;
    [rows.len(), events.len(), between.len(), transitions.len(), companion.len()]
}
