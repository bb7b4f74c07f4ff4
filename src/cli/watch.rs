//! Progress and interrupts of work that lasts.
//!
//! The first Ctrl-C ends the work in good order, so that nothing is lost or half written. The
//! second one ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};

use super::console;
use super::error::CliError;
use crate::output::progress::Progress;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<bool> = OnceLock::new();

/// Has Ctrl-C end the program in good order from here on. What must not be left half written is
/// begun only after this.
pub fn catch_interrupts() {
    // Where no handler can be set, Ctrl-C ends the program as it always does.
    HANDLER.get_or_init(|| {
        let handler = || {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        };
        ctrlc::set_handler(handler).is_ok()
    });
}

/// Whether the user asked to stop; interrupts are caught from the first call on.
pub fn is_interrupted() -> bool {
    catch_interrupts();
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Takes the amount of work done and returns whether to go on; any thread may call it.
pub type Watch<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// Runs `work` under a progress bar of the share done (1).
pub fn watched<T>(label: &str, work: impl FnOnce(Watch) -> T) -> T {
    watched_by(Progress::of_share(label), work)
}

/// The same for work that ends early, with `None`, when the user asks to stop.
pub fn watched_to_end<T>(label: &str, work: impl FnOnce(Watch) -> Option<T>) -> Result<T, CliError> {
    watched(label, work).ok_or(CliError::Interrupted)
}

pub fn watched_by<T>(progress: Progress, work: impl FnOnce(Watch) -> T) -> T {
    let progress = (!console::is_quiet()).then(|| Mutex::new(progress));
    let watch = |done: f64| {
        // Only one thread draws; the others need not wait for it.
        if let Some(Ok(mut progress)) = progress.as_ref().map(Mutex::try_lock) {
            progress.at(done);
        }
        !is_interrupted()
    };
    let result = work(&watch);
    if let Some(progress) = progress {
        progress.into_inner().expect("no thread panicked while it drew").finish();
    }
    result
}
