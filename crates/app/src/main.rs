//! The program: parse, dispatch, exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    cohaul_report::manifest::built_from(option_env!("COHAUL_COMMIT"));
    cohaul_app::cli::main()
}
