//! Floor 6: the command line. One subcommand, one function.
//!
//! Exit codes: 0 done, 1 a run failed or missed what it was asked to check, 2 usage or input, 3 internal, 130 interrupted. Results go to standard output, everything
//! else to standard error.

/// Says a line on standard error. That nobody can hear it is no reason to end.
macro_rules! say {
    ($($text:tt)*) => {{
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{}\n", format_args!($($text)*)));
    }};
}

mod bench;
mod calibrate;
mod check;
mod compare;
mod interrupt;
mod merge;
mod paper;
mod regime;
mod resumable;
mod run;
mod scenario;
mod stress;
mod sweep;
mod verify;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
use crate::backend::{BackendKind, Integrator, RapierOptions, RestoreError, SaveError};
use crate::output::folder::{FolderError, check_target};
use crate::output::json::NotFinite;
use crate::output::page::REPORT;
use crate::scenario::{Drive, Scenario, ScenarioError};
use crate::studies::journal::JournalError;
use crate::studies::sweep::SweepError;

#[derive(Parser)]
#[command(name = "cohaul", version, about, long_about = LONG_ABOUT, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const LONG_ABOUT: &str = "Collective transport of a load by ants: runs one behaviour model on a quasi-static solver, on a reference with inertia and on the \
rigid-body engine rapier2d, and says where they agree, where inertia makes them differ, and how much is only a solver's error.";
const EXIT_CODES: &str =
    "Exit codes: 0 done; 1 a run failed or missed what it was asked to check; 2 usage or input; 3 internal; 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    /// Run one scenario on one backend
    Run(run::RunArgs),
    /// Run one scenario on all backends and say why they differ
    Compare(compare::CompareArgs),
    /// Hold this build, or a changed scenario, against stored runs
    Check(check::CheckArgs),
    /// Put questions with known answers to the backends and say whether they hold
    Verify(verify::VerifyArgs),
    /// Measure run time against error, method by method
    Bench(bench::BenchArgs),
    /// Run scenes far beyond what they are made for and say where which backend breaks, and why
    Stress(stress::StressArgs),
    /// Springs as force sensors: fit them to measurements, design them, read forces off recorded tips
    #[command(subcommand)]
    Calibrate(calibrate::CalibrateCommand),
    /// Run one scenario over seeds and parameters into one table
    Sweep(sweep::SweepArgs),
    /// Make one table of the shards of a sweep
    Merge(merge::MergeArgs),
    /// Make the paper's results again and judge each beside what it prints
    Paper(paper::PaperArgs),
    /// Map where inertia matters: tip speed against time between events, and where theory is off
    Regime(regime::RegimeArgs),
    /// Look at scenario files
    #[command(subcommand)]
    Scenario(scenario::ScenarioCommand),
}

/// Options of all commands that run something.
#[derive(Args)]
struct EngineArgs {
    /// Friction under rapier's load; without it aligned, and box with the settings as shipped
    #[arg(long, value_name = "MODEL")]
    friction: Option<FrictionModel>,
    /// Springs on rapier's load; without it joint
    #[arg(long, value_name = "MODEL")]
    springs: Option<SpringModel>,
    /// Floating point of rapier; without it f64
    #[arg(long, value_name = "WIDTH")]
    precision: Option<Precision>,
    /// Sweeps and substeps of rapier; without it recommended
    #[arg(long, value_name = "SET")]
    settings: Option<EngineSettings>,
}

impl EngineArgs {
    fn options(&self) -> RapierOptions {
        let usual = match self.settings {
            None | Some(EngineSettings::Recommended) => RapierOptions::default(),
            Some(EngineSettings::EngineDefaults) => RapierOptions::engine_defaults(),
        };
        RapierOptions {
            friction: self.friction.unwrap_or(usual.friction),
            springs: self.springs.unwrap_or(usual.springs),
            precision: self.precision.unwrap_or(usual.precision),
            ..usual
        }
    }
}

/// Warns of options that were given for a backend that is not asked for: they change nothing.
fn warn_of_idle(backends: &[BackendKind], integrator: Option<Integrator>, engine: &EngineArgs) {
    let options = [
        ("--integrator", BackendKind::Inertial, integrator.is_some()),
        ("--friction", BackendKind::Rapier, engine.friction.is_some()),
        ("--springs", BackendKind::Rapier, engine.springs.is_some()),
        ("--precision", BackendKind::Rapier, engine.precision.is_some()),
        ("--settings", BackendKind::Rapier, engine.settings.is_some()),
    ];
    for (name, of, _) in options.iter().filter(|(_, of, is_given)| *is_given && !backends.contains(of)) {
        let names: Vec<&str> = backends.iter().map(|backend| backend.name()).collect();
        warn_idle(name, of.name(), &names.join(", "));
    }
}

/// Warns of options that change what only other drives and backends than these have: seeds the chance of ants, inertia all but quasi-static.
fn warn_of_idle_points(scenario: &Scenario, backends: &[BackendKind], n_seeds: u64, scales_inertia: bool) {
    if n_seeds > 1 && matches!(scenario.drive, Drive::Tips(_)) {
        warn_idle("--seeds", "ants", "tips");
    }
    if scales_inertia && backends.iter().all(|backend| *backend == BackendKind::QuasiStatic) {
        warn_idle("--scale-inertia", "inertial and rapier", "quasi-static");
    }
}

/// Warns of an option `of` something that is not there, but what was `found` in its place.
fn warn_idle(option: &str, of: &str, found: &str) {
    say!("warning: {option}: changes nothing, as it is of {of}, found {found}");
}

/// Why a command ended without its result.
#[derive(Debug, thiserror::Error)]
enum CliError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error("{path}: {source}")]
    File { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Journal(#[from] JournalError),
    #[error("{path}: {source}")]
    Restore { path: PathBuf, source: RestoreError },
    #[error(transparent)]
    Save(#[from] SaveError),
    #[error("{0}")]
    Usage(String),
    #[error(transparent)]
    Sweep(SweepError),
    #[error("interrupted")]
    Interrupted,
    #[error("stopped after {work}; the same command goes on from {}", path.display())]
    Stopped { work: String, path: PathBuf },
    #[error("a result is not finite: {0}")]
    NotFinite(#[from] NotFinite),
    #[error("cannot write to standard output: {0}")]
    Output(#[from] std::io::Error),
}

impl CliError {
    fn exit_code(&self) -> u8 {
        match self {
            CliError::NotFinite(_) | CliError::Output(_) => 3,
            // As shells count a process that a keyboard interrupt ended.
            CliError::Interrupted | CliError::Stopped { .. } => 130,
            _ => 2,
        }
    }
}

/// Parses the command line, runs the command and says how it went.
pub fn main() -> ExitCode {
    let command = with_negative_numbers(Cli::command());
    let cli = match command.try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            // Nobody is left to tell when standard error is closed.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let done = match &cli.command {
        Command::Run(args) => run::run(args),
        Command::Compare(args) => compare::compare(args),
        Command::Check(args) => check::check(args),
        Command::Verify(args) => verify::verify(args),
        Command::Bench(args) => bench::bench(args),
        Command::Stress(args) => stress::stress(args),
        Command::Calibrate(command) => calibrate::calibrate(command),
        Command::Sweep(args) => sweep::sweep(args),
        Command::Merge(args) => merge::merge(args),
        Command::Paper(args) => paper::paper(args),
        Command::Regime(args) => regime::regime(args),
        Command::Scenario(command) => scenario::scenario(command),
    };
    match done {
        Ok(code) => code,
        // A reader that has seen enough, such as `head`, is no failure.
        Err(CliError::Output(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let severity = if error.exit_code() == 130 { "" } else { "error: " };
            say!("{severity}{error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// The same with options that take negative numbers for values, and not for other options, so that they can say what they must be.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| if arg.get_action().takes_values() { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}

/// Reads a scenario, with the seed of the command line if it has one.
fn read_scenario(path: &Path, seed: Option<u64>) -> Result<Scenario, ScenarioError> {
    let scenario = Scenario::read(path)?;
    Ok(Scenario { seed: seed.unwrap_or(scenario.seed), ..scenario })
}

/// A step or an instant that a user may ask for (s).
fn step(text: &str) -> Result<f64, String> {
    positive(text).map_err(|error| error.replace("a number", "a number of seconds"))
}

/// Most steps in a control period (1): an interrupt is heard, and progress shown, between two of these.
const MOST_STEPS: f64 = 1e6;

/// Warns of a step that is longer than the control period, with which each step ends at the latest.
///
/// # Errors
/// When the step that a user asks for is so short that a control period takes minutes.
fn check_step(step_s: Option<f64>, scenario: &Scenario) -> Result<(), CliError> {
    if let Some(step) = step_s.filter(|step| *step > scenario.control_period) {
        say!("warning: --step-s: steps end with the control period, {} s, found {step} s", scenario.control_period);
    }
    let least = scenario.control_period / MOST_STEPS;
    match step_s.filter(|step| *step < least) {
        Some(step) => Err(CliError::Usage(format!("--step-s: must be at least {least:e} s, 1e-6 of the control period, found {step:e}"))),
        None => Ok(()),
    }
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("must be a number, found {text}"))?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(format!("must be positive and finite, found {text}")) }
}

/// Whether a command may write its output to this folder: as [`check_target`] says, and never in place of a finished sweep, which may have taken days.
fn check_out(out: &Path) -> Result<(), CliError> {
    check_target(out)?;
    match sweep::identity_in(out) {
        Some(_) => Err(CliError::Usage(format!("{}: must not hold a finished sweep; write to another folder", out.display()))),
        None => Ok(()),
    }
}

/// Says where the report in the folder `out` is.
fn print_report(out: &Path) -> Result<(), CliError> {
    print(&format!("report\n  {}\n", out.join(REPORT).display()))
}

/// The command as it was called; what is no text in it is told as near as text can.
fn command_line() -> Vec<String> {
    std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// Writes a result to standard output.
fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()?;
    Ok(())
}
