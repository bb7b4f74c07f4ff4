//! The command line. Each command is one file; what all commands share has files of its own.

mod bench;
mod calibrate;
mod check;
mod choice;
mod colony;
mod compare;
mod conformance;
mod console;
mod cost;
mod deadlocks;
mod engine;
mod error;
mod exit;
mod explain;
mod foreign;
mod gate;
mod generate;
mod help;
mod import;
mod input;
mod internal;
mod measured;
mod merge;
mod new;
mod output;
mod paper;
mod regime;
mod render;
mod resumable;
mod run;
mod scenario;
mod stress;
mod subject;
mod sweep;
mod threads;
mod threshold;
mod vary;
mod verify;
mod view;
mod watch;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use error::CliError;
pub use exit::EXIT_CODES;
use exit::Exit;

#[derive(Parser)]
#[command(name = "cohaul", version, about, long_about = LONG_ABOUT, after_help = after_help(), max_term_width = 80)]
struct Cli {
    #[command(flatten)]
    console: console::ConsoleArgs,
    #[command(subcommand)]
    command: Command,
}

const LONG_ABOUT: &str = "Simulates how ants or robots carry a load together, by three methods: a quasi-static solver, a reference solver with \
inertia, and the rigid-body engine rapier2d. It reports where the three agree, what inertia changes, and how large the engine's error is.";
const EXAMPLES: &str = "\
Examples:
  cohaul run scenarios/paper/four-ants-four-springs.json --report --out out/run
  cohaul compare scenarios/analytic/release-jump.json
  cohaul help compare
  cohaul explain 'engine error'

SCENARIO may be - for standard input.";

fn after_help() -> String {
    format!("{EXAMPLES}\n\nExit codes:\n{}", exit::table())
}

/// Makes the enum of commands, and what runs each, from one table.
macro_rules! commands {
    ($($(#[$about:meta])* $name:ident($args:ty) => $run:expr,)*) => {
        #[derive(Subcommand)]
        enum Command {
            $($(#[$about])* $name($args),)*
        }

        impl Command {
            fn run(&self) -> Result<ExitCode, CliError> {
                match self {
                    $(Command::$name(args) => {
                        let run: fn(&$args) -> Result<ExitCode, CliError> = $run;
                        run(args)
                    })*
                }
            }
        }
    };
}

commands! {
    /// Run one scenario on one backend
    Run(run::RunArgs) => run::run,
    /// Run one scenario on all backends and explain the differences
    Compare(compare::CompareArgs) => compare::compare,
    /// Play, change and drag a scene in the browser
    View(view::ViewArgs) => view::view,
    /// Draw a scene or a run as a film or a picture
    Render(render::RenderArgs) => render::render,
    /// Compare measured runs with simulated ones
    Measured(measured::MeasuredArgs) => measured::measured,
    /// Run a scenario over seeds and parameters into one table
    Sweep(sweep::SweepArgs) => sweep::sweep,
    /// Join the shards of a sweep into one table
    Merge(merge::MergeArgs) => merge::merge,
    /// Compare this build with stored baselines
    Check(check::CheckArgs) => check::check,
    /// Compare every backend with known answers
    Verify(verify::VerifyArgs) => verify::verify,
    /// Put questions with closed answers to any engine
    Conformance(conformance::ConformanceArgs) => conformance::conformance,
    /// Compare a build of an engine with the errors of an earlier one
    Gate(gate::GateArgs) => gate::gate,
    /// Measure run time and error of every method
    Bench(bench::BenchArgs) => bench::bench,
    /// Find where each backend breaks, and why
    Stress(stress::StressArgs) => stress::stress,
    /// Map where inertia matters
    Regime(regime::RegimeArgs) => regime::regime,
    /// Reproduce the paper's results
    Paper(paper::PaperArgs) => paper::paper,
    /// Use springs as force sensors: fit, design, read forces
    #[command(subcommand)]
    Calibrate(calibrate::CalibrateCommand) => calibrate::calibrate,
    /// Fit the ants of a recording, with the paper's figures
    Colony(colony::ColonyArgs) => colony::colony,
    /// Check and show scenario files
    #[command(subcommand)]
    Scenario(scenario::ScenarioCommand) => scenario::scenario,
    /// Explain a term that cohaul prints
    Explain(explain::ExplainArgs) => explain::explain,
    /// Print a completion script for a shell
    Completions(generate::CompletionsArgs) => |args| generate::completions(args, &mut command()),
    /// Print or write man pages
    Man(generate::ManArgs) => |args| generate::man(args, command()),
}

/// Parses the command line, runs the command and returns its exit code.
pub fn main() -> ExitCode {
    internal::caught(called).unwrap_or_else(|| {
        internal::ask_for_report();
        Exit::Internal.into()
    })
}

fn called() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let command = command().color(console::apply_color(&arguments));
    let cli = match command.try_get_matches_from(arguments).and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(told) => {
            return match told.print() {
                // A closed standard error is no reason to fail otherwise.
                _ if told.use_stderr() => Exit::Input.into(),
                Ok(()) => ExitCode::SUCCESS,
                Err(error) => ended(&error.into()),
            };
        }
    };
    cli.console.apply();
    threads::bound_environment();
    watch::unless_stopped(|| cli.command.run()).unwrap_or(Err(CliError::Interrupted)).unwrap_or_else(|error| ended(&error))
}

/// Says why a command ended without its result.
fn ended(error: &CliError) -> ExitCode {
    let exit = error.exit();
    match exit {
        // A reader that has seen enough, such as `head`, needs no message.
        Exit::Closed => {}
        Exit::Interrupted => console::note(error),
        _ => console::fault(error),
    }
    if exit == Exit::Internal {
        internal::ask_for_report();
    }
    exit.into()
}

/// The whole command line, for parsing, completions and man pages.
fn command() -> clap::Command {
    help::arranged(with_negative_numbers(Cli::command()))
}

/// Lets every option with a value take a negative number, so that its own check can refuse it.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| if arg.get_action().takes_values() { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}
