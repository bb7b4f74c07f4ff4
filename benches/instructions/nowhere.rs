//! Stands in for `stepper.rs` where there is no Linux on x86-64 to step a process: nothing is
//! counted, and that is said.

use std::process::ExitCode;

use crate::paths::HotPath;

/// The first argument of a child; here there are none.
pub const CHILD: &str = "--stepped-child";

/// Why there is no count.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    #[error("{0}")]
    Unavailable(&'static str),
}

pub fn fix_addresses() -> bool {
    true
}

/// # Errors
/// Always.
pub fn count(_: &HotPath) -> Result<u64, StepError> {
    Err(StepError::Unavailable("stepping a process needs Linux on x86-64"))
}

pub fn run_child(_: &str) -> ExitCode {
    ExitCode::from(2)
}
