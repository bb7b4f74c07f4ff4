//! Stopping work in its midst.
//!
//! A control period may last a day, and a start-up or a search may take minutes. The loops of such
//! work call [`point`]. Once a stop is asked for, `point` leaves the work by unwinding: as a panic
//! does, but without a message. [`caught`] and [`Stop::run`] end the unwinding. What was left half
//! done, such as a simulation in the midst of a step, is not used afterwards.
//!
//! Each thread asks one flag: that of the process, or the one that [`Stop::within`] has set for it.
//! Work that hands tasks to other threads hands them [`Stop::current`] too.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

static OF_PROCESS: AtomicBool = AtomicBool::new(false);
/// Whether any stop was ever asked for: until then no thread looks for its own flag.
static ANY: AtomicBool = AtomicBool::new(false);

thread_local! {
    static OF_THREAD: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// What unwinds from a stopped [`point`].
struct Stopped;

/// A request to stop that any thread may make.
///
/// In this example the work would last for ever, and another thread ends it.
///
/// ```
/// use cohaul::stop::{Stop, point};
///
/// let stop = Stop::default();
/// let ended = std::thread::scope(|scope| {
///     scope.spawn(|| stop.ask());
///     stop.run(|| loop {
///         point();
///     })
/// });
/// assert!(ended.is_none());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stop(Flag);

#[derive(Clone, Debug)]
enum Flag {
    Process,
    Own(Arc<AtomicBool>),
}

impl Default for Flag {
    fn default() -> Self {
        Flag::Own(Arc::default())
    }
}

impl Stop {
    /// The request that stops all work without one of its own.
    pub fn of_process() -> Self {
        Self(Flag::Process)
    }

    /// The request that stops the work of this thread.
    pub fn current() -> Self {
        Self(OF_THREAD.with_borrow(|flag| flag.clone().map_or(Flag::Process, Flag::Own)))
    }

    /// Asks the work to stop.
    pub fn ask(&self) {
        self.flag().store(true, Ordering::Relaxed);
        ANY.store(true, Ordering::Release);
    }

    pub fn is_asked(&self) -> bool {
        self.flag().load(Ordering::Relaxed)
    }

    /// Runs `work`, which this request can stop; `None` when it did.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> Option<T> {
        caught(|| self.within(work))
    }

    /// Runs `work`, which this request can stop. A stop goes on to the caller.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        /// Gives the thread its flag back, also when the work unwinds.
        struct Before(Option<Arc<AtomicBool>>);
        impl Drop for Before {
            fn drop(&mut self) {
                OF_THREAD.set(self.0.take());
            }
        }
        let flag = match &self.0 {
            Flag::Process => None,
            Flag::Own(flag) => Some(Arc::clone(flag)),
        };
        let _before = Before(OF_THREAD.replace(flag));
        work()
    }

    fn flag(&self) -> &AtomicBool {
        match &self.0 {
            Flag::Process => &OF_PROCESS,
            Flag::Own(flag) => flag,
        }
    }
}

/// Leaves the work of this thread if a stop was asked for. It costs a few instructions.
#[inline]
pub fn point() {
    if ANY.load(Ordering::Relaxed) {
        look();
    }
}

#[cold]
#[inline(never)]
fn look() {
    let is_asked = OF_THREAD.with_borrow(|flag| flag.as_deref().unwrap_or(&OF_PROCESS).load(Ordering::Relaxed));
    if is_asked {
        leave();
    }
}

fn leave() {
    // What a value does as it is dropped goes on while a thread unwinds.
    if !std::thread::panicking() {
        resume_unwind(Box::new(Stopped));
    }
}

/// Result of `work`; `None` when it was stopped.
pub fn caught<T>(work: impl FnOnce() -> T) -> Option<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => Some(result),
        Err(payload) if payload.is::<Stopped>() => None,
        Err(payload) => resume_unwind(payload),
    }
}

/// The payload of a caught panic. A stop is no panic, and goes on to the caller.
pub fn of_panic(payload: Box<dyn Any + Send>) -> Box<dyn Any + Send> {
    if payload.is::<Stopped>() { resume_unwind(payload) } else { payload }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn work_is_left_at_the_first_point_after_the_request() {
        let (stop, n_done) = (Stop::default(), Cell::new(0));
        let ended = stop.run(|| {
            loop {
                point();
                n_done.set(n_done.get() + 1);
                if n_done.get() == 10 {
                    stop.ask();
                }
            }
        });
        assert_eq!((ended, n_done.get()), (None::<()>, 10));
        // Other work of this thread goes on.
        point();
        assert_eq!(Stop::default().run(|| 1), Some(1));
    }

    #[test]
    fn tasks_on_other_threads_stop_with_the_work_that_handed_them_out() {
        let stop = Stop::default();
        let ended = std::thread::scope(|scope| {
            scope.spawn(|| stop.ask());
            stop.run(|| {
                let current = Stop::current();
                // Each task would last for ever.
                (0..64).into_par_iter().for_each(|_| current.within(|| (0..u64::MAX).for_each(|_| point())));
            })
        });
        assert_eq!(ended, None);
        (0..64).into_par_iter().for_each(|_| point());
    }

    #[test]
    fn a_panic_is_no_stop() {
        let caught_twice = catch_unwind(|| caught(|| resume_unwind(Box::new(3))));
        assert_eq!(caught_twice.err().and_then(|payload| payload.downcast_ref::<i32>().copied()), Some(3));
    }
}
