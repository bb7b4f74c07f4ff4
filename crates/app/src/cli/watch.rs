//! Progress and interrupts of work that lasts.
//!
//! The first Ctrl-C ends the work in good order, so that nothing is lost or half written. Work that
//! asks between two pieces ends there. Where a piece lasts longer, it is stopped in its midst, by
//! [`stop`]. The second Ctrl-C ends the program at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::console;
use super::cost::duration_in_words;
use super::error::CliError;
use cohaul::stop::{self, Stop};
use cohaul_report::progress::Progress;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether the work has begun to end since the interrupt.
static ENDS: AtomicBool = AtomicBool::new(false);
/// Whether the work has a state to save.
static HAS_STATE: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<bool> = OnceLock::new();

/// Time in which work may come to the end of a piece after an interrupt.
const TO_END_A_PIECE: Duration = Duration::from_millis(50);
/// Time after which work that has not begun to end is ended with the program. Nothing is lost then:
/// output appears whole or not at all, and journals are whole at every instant.
const TO_BEGIN_TO_END: Duration = Duration::from_millis(120);
/// The same for work with a state to save, of which a single step may take as long.
const TO_BEGIN_TO_SAVE: Duration = Duration::from_secs(5);

/// Has Ctrl-C end the program in good order from here on. What must not be left half written is
/// begun only after this.
pub fn catch_interrupts() {
    // Where no handler can be set, Ctrl-C ends the program as it always does.
    HANDLER.get_or_init(|| {
        let handler = || {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                end_at_once();
            }
            thread::spawn(end_the_work);
        };
        ctrlc::set_handler(handler).is_ok()
    });
}

/// Ends the program, and the engines that it has started.
fn end_at_once() -> ! {
    cohaul_engines::pipe::end_all();
    std::process::exit(130);
}

/// What follows the first interrupt.
fn end_the_work() {
    thread::sleep(TO_END_A_PIECE);
    Stop::of_process().ask();
    let all = if HAS_STATE.load(Ordering::Relaxed) { TO_BEGIN_TO_SAVE } else { TO_BEGIN_TO_END };
    thread::sleep(all - TO_END_A_PIECE);
    if !ENDS.load(Ordering::Relaxed) {
        console::note(CliError::Interrupted);
        end_at_once();
    }
}

/// Says that the work has a state to save when it is interrupted.
pub fn keep_state() {
    HAS_STATE.store(true, Ordering::Relaxed);
}

/// Whether the user asked to stop; interrupts are caught from the first call on. Who hears so ends.
pub fn is_interrupted() -> bool {
    catch_interrupts();
    let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
    if is_interrupted {
        ENDS.store(true, Ordering::Relaxed);
    }
    is_interrupted
}

/// Result of `work`; `None` when an interrupt stopped it in its midst.
pub fn unless_stopped<T>(work: impl FnOnce() -> T) -> Option<T> {
    let result = stop::caught(work);
    if result.is_none() {
        ENDS.store(true, Ordering::Relaxed);
    }
    result
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

/// Runs `work` under a progress bar. It says so when work with an expected time turns out to be
/// long.
pub fn watched_by<T>(progress: Progress, work: impl FnOnce(Watch) -> T) -> T {
    if console::is_quiet() {
        return work(&|_| !is_interrupted());
    }
    let too_long = |whole_s| console::warn(format_args!("this takes about {} in all; Ctrl-C ends it", duration_in_words(whole_s)));
    progress.shown(&too_long, |at| {
        work(&|done| {
            at(done);
            !is_interrupted()
        })
    })
}
