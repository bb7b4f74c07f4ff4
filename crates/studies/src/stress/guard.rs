//! Panics as results: one broken cell must not end the map, nor write over the progress.

use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use cohaul::stop;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

static INSTALLED: Once = Once::new();

/// Result of `work`, or the message and place of its panic, which is not printed. Panics of other
/// threads are printed as usual. A stop of the work goes on to the caller.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    INSTALLED.call_once(|| {
        let others = take_hook();
        set_hook(Box::new(move |info| {
            if GUARDED.get() {
                let message = info.payload_as_str().unwrap_or("without a message");
                let place = info.location().map_or_else(String::new, |at| format!(" at {}:{}", at.file(), at.line()));
                LAST.set(format!("{message}{place}"));
            } else {
                others(info);
            }
        }));
    });
    let before = GUARDED.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    GUARDED.set(before);
    done.map_err(|payload| {
        stop::of_panic(payload);
        LAST.take()
    })
}
