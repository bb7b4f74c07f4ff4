//! Computing without the interpreter's lock: interrupts, progress and panics.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use cohaul::stop::{self, Stop};
use pyo3::call::PyCallArgs;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Time between two looks for a signal, and between two calls of a progress function.
const PATIENCE: Duration = Duration::from_millis(50);

/// More threads than any machine has processors, and few enough to start.
const MOST_THREADS: usize = 1024;

/// What a computation and the thread that waits for it tell each other.
#[derive(Default)]
pub struct Watch {
    is_stopped: AtomicBool,
    /// Ends the work in the midst of a piece of it.
    stop: Stop,
    /// Bits of the fraction done (1).
    share: AtomicU64,
}

impl Watch {
    /// Takes note of the fraction done (1), and returns whether to continue.
    pub fn go_on(&self, share: f64) -> bool {
        self.share.store(share.to_bits(), Relaxed);
        !self.is_stopped.load(Relaxed)
    }

    pub fn stop(&self) {
        self.is_stopped.store(true, Relaxed);
        self.stop.ask();
    }
}

/// Runs `work` on a thread of its own without the lock, while this one waits for signals and calls
/// `progress` with the fraction done (1).
///
/// # Errors
/// With `KeyboardInterrupt` or what `progress` raised, after the work has stopped; with an
/// `InternalError` if the work panicked.
pub fn computed<T: Send>(py: Python, progress: Option<Py<PyAny>>, work: impl FnOnce(&Watch) -> T + Send) -> PyResult<T> {
    let watch = &Watch::default();
    let look = || {
        Python::with_gil(|py| {
            py.check_signals()?;
            let share = f64::from_bits(watch.share.load(Relaxed));
            progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (share,)).map(drop))
        })
    };
    py.allow_threads(|| {
        thread::scope(|scope| {
            let (sender, receiver) = sync_channel(1);
            let job = move || drop(sender.send(watch.stop.run(|| guarded(|| work(watch)))));
            let spawned = thread::Builder::new().name("cohaul".to_owned()).spawn_scoped(scope, job);
            spawned.map_err(|error| PyRuntimeError::new_err(format!("a thread cannot be started: {error}")))?;
            let mut interrupt = None;
            loop {
                match receiver.recv_timeout(PATIENCE) {
                    Ok(Some(done)) => return interrupt.map_or(done.map_err(internal), Err),
                    Ok(None) => return Err(interrupt.unwrap_or_else(|| internal("the work was stopped".to_owned()))),
                    Err(RecvTimeoutError::Disconnected) => return Err(internal("a thread ended without a result".to_owned())),
                    Err(RecvTimeoutError::Timeout) if interrupt.is_none() => {
                        interrupt = look().err();
                        interrupt.iter().for_each(|_| watch.stop());
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        })
    })
}

/// Result of `work`, or the message of its panic. A stop goes on to the caller.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| message_of(stop::of_panic(payload).as_ref()))
}

fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied().or(payload.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without a message").to_owned()
}

/// The exception for a defect of the library.
pub fn internal(message: String) -> PyErr {
    raised("InternalError", (format!("please report this defect: {message}"),))
}

/// An exception of a class in `cohaul._errors`.
pub fn raised(class: &str, arguments: impl for<'py> PyCallArgs<'py>) -> PyErr {
    Python::with_gil(|py| {
        let made = || -> PyResult<PyErr> { Ok(PyErr::from_value(py.import("cohaul._errors")?.getattr(class)?.call1(arguments)?)) };
        made().unwrap_or_else(|error| error)
    })
}

/// Threads of one call. They end with it, so that a process may fork between two calls.
///
/// # Errors
/// When the number is out of range, or the system has no more threads.
pub fn pool(threads: Option<usize>) -> PyResult<ThreadPool> {
    if let Some(n) = threads.filter(|n| !(1..=MOST_THREADS).contains(n)) {
        return Err(crate::options::refused("threads", &format!("must be from 1 to {MOST_THREADS}"), n));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    pool.map_err(|error| PyRuntimeError::new_err(format!("threads cannot be started: {error}")))
}
