//! Ctrl-C, or a polite request to end: the first one ends work in good order, so that nothing is lost or left half-written; the second one ends the program at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);
static INSTALLED: OnceLock<bool> = OnceLock::new();

/// Whether the user asked to stop. Listens from the first call on.
pub fn asked() -> bool {
    // Where no handler can be set, Ctrl-C ends the program as it always does.
    INSTALLED.get_or_init(|| {
        let handler = || {
            if ASKED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        };
        ctrlc::set_handler(handler).is_ok()
    });
    ASKED.load(Ordering::Relaxed)
}
