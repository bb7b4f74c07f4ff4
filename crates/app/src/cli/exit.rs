//! Exit codes of the program: one table for the code, the help text and the book.

use std::process::ExitCode;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// A check did not hold, or an engine of the user did not work.
    Failed = 1,
    /// The input: an option, a file that is read, or what is in it.
    Input = 2,
    /// A defect of the program.
    Internal = 3,
    /// What was found could not be written.
    Output = 5,
    /// Shells report the same number for a process that a keyboard interrupt ended.
    Interrupted = 130,
    /// Shells report the same number for a process that a closed pipe ended.
    Closed = 141,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// Every exit code of the program, with its meaning.
pub const EXIT_CODES: [(u8, &str); 7] = [
    (0, "done"),
    (Exit::Failed as u8, "a run failed, or a check did not hold"),
    (Exit::Input as u8, "wrong usage or input, or an input file that cannot be read"),
    (Exit::Internal as u8, "internal error; please report it"),
    (Exit::Output as u8, "output cannot be written: a full disk, or a missing permission"),
    (Exit::Interrupted as u8, "interrupted by Ctrl-C or by --stop-s"),
    (Exit::Closed as u8, "standard output was closed before the end, as by a pipe to head"),
];

/// The table as the help text has it.
pub fn table() -> String {
    EXIT_CODES.map(|(code, meaning)| format!("  {code:<4} {meaning}")).join("\n")
}
