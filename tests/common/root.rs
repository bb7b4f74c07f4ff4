//! The root of the repository, and the program that runs there.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::Path;
use std::process::Command;

/// The root of the repository: tests of the program are started elsewhere.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the program stands two folders below the root")
}

/// The program, which starts at the root of the repository.
pub fn cohaul() -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_cohaul"));
    program.current_dir(root());
    program
}
