//! Defects of the program: what is said of them, and whom it is said to.

use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

use super::console;
use super::output::command_line;
use cohaul_report::manifest::build_of_program;

/// Result of `work`; `None` if it panicked, on whatever thread. What the panic says is printed as
/// an internal error, with a backtrace if `RUST_BACKTRACE` asks for one.
pub fn caught<T>(work: impl FnOnce() -> T) -> Option<T> {
    let usual = take_hook();
    let with_backtrace = std::env::var_os("RUST_BACKTRACE").is_some_and(|asked| asked != "0");
    set_hook(Box::new(move |info| {
        let message = info.payload_as_str().unwrap_or("without a message");
        let place = info.location().map_or_else(String::new, |at| format!(", at {}:{}", at.file(), at.line()));
        console::error(format_args!("internal error: {message}{place}"));
        if with_backtrace {
            usual(info);
        }
    }));
    catch_unwind(AssertUnwindSafe(work)).ok()
}

/// Asks the user for a report, after an internal error was printed.
pub fn ask_for_report() {
    let (version, commit) = build_of_program();
    let commit = commit.map_or_else(String::new, |commit| format!(" ({commit})"));
    console::error(format_args!(
        "this is a defect of cohaul: please report it, with its input files and these two lines:\n  cohaul {version}{commit}\n  {}",
        command_line().join(" ")
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_on_any_thread_is_caught() {
        assert_eq!(caught(|| 7), Some(7));
        assert_eq!(caught(|| -> u32 { panic!("of a test") }), None);
        assert_eq!(caught(|| rayon::join(|| 1, || -> u32 { panic!("of a test, on another thread") })), None);
    }
}
