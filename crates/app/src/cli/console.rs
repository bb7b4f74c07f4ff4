//! What the program prints. Results go to standard output, everything else to standard error.
//!
//! How much and in which colours is chosen once, at the start of the process.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::Write;
use std::sync::OnceLock;

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};
use clap::Args;

use super::error::CliError;
use cohaul::scenario::ScenarioError;
use cohaul::simulation::Health;
use cohaul_report::text::Detail;

/// Options of every command that decide what is printed.
#[derive(Args)]
#[command(next_help_heading = "Global options")]
pub struct ConsoleArgs {
    /// Colour of the output: auto, always or never
    ///
    /// With auto, output to a terminal is coloured unless NO_COLOR is set.
    #[arg(long, global = true, value_name = "WHEN", value_parser = ["auto", "always", "never"], hide_possible_values = true)]
    color: Option<String>,
    /// Print errors only: no warnings, no progress
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Print all details
    #[arg(short, long, global = true)]
    verbose: bool,
}

/// Whether `--quiet` and `--verbose` are given.
static GIVEN: OnceLock<[bool; 2]> = OnceLock::new();

impl ConsoleArgs {
    /// Makes these options count for the rest of the process.
    pub fn apply(&self) {
        let _ = GIVEN.set([self.quiet, self.verbose]);
    }
}

/// Reads `--color` before the other options, because help and usage errors are coloured too.
pub fn apply_color(arguments: &[OsString]) -> clap::ColorChoice {
    let text = |argument: &OsString| argument.to_str().unwrap_or_default().to_owned();
    let is_last = |at: usize| arguments.get(at + 1).map(text);
    let asked = arguments.iter().enumerate().find_map(|(at, argument)| match text(argument).split_once('=') {
        Some(("--color", when)) => Some(when.to_owned()),
        None if argument == "--color" => is_last(at),
        _ => None,
    });
    let (own, clap) = match asked.as_deref() {
        Some("always") => (ColorChoice::Always, clap::ColorChoice::Always),
        Some("never") => (ColorChoice::Never, clap::ColorChoice::Never),
        _ => (ColorChoice::Auto, clap::ColorChoice::Auto),
    };
    own.write_global();
    clap
}

pub fn is_quiet() -> bool {
    GIVEN.get().is_some_and(|[quiet, _]| *quiet)
}

fn is_verbose() -> bool {
    GIVEN.get().is_some_and(|[_, verbose]| *verbose)
}

/// How much of a result is printed.
pub fn detail() -> Detail {
    if is_verbose() { Detail::Full } else { Detail::Brief }
}

/// What the answer of a command is to the reader, which decides its colour.
#[derive(Clone, Copy)]
pub enum Tone {
    /// As hoped.
    Good,
    /// Worth a second look.
    Caution,
    /// Something failed.
    Bad,
}

impl Tone {
    /// Tone of results of which the worst is so.
    pub fn of(worst: Health) -> Self {
        match worst {
            Health::Ok => Tone::Good,
            Health::Doubtful => Tone::Caution,
            Health::Failed => Tone::Bad,
        }
    }

    fn style(self) -> Style {
        let colour = match self {
            Tone::Good => AnsiColor::Green,
            Tone::Caution => AnsiColor::Yellow,
            Tone::Bad => AnsiColor::Red,
        };
        colour.on_default().bold()
    }
}

/// Prints a result as it is: JSON, or a text without an answer.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    out.flush()?;
    Ok(())
}

/// Prints a result for people. A short first paragraph is its answer, which is coloured.
pub fn print_answer(text: &str, tone: Tone) -> Result<(), CliError> {
    let mut out = anstream::stdout().lock();
    match text.split_once("\n\n").filter(|(answer, _)| answer.lines().count() <= MOST_ANSWER_LINES) {
        Some((answer, rest)) => {
            let style = tone.style();
            write!(out, "{style}{answer}{style:#}\n\n{rest}")?;
        }
        None => write!(out, "{text}")?,
    }
    out.flush()?;
    Ok(())
}

/// Prints an error, which no option silences.
pub fn error(text: impl Display) {
    say("error: ", Tone::Bad, text);
}

/// Prints an error, and the command that puts a scenario right if only the load's outline is wrong.
pub fn fault(fault: &CliError) {
    error(fault);
    let CliError::Scenario(ScenarioError::Invalid { file, findings }) = fault else { return };
    if findings.iter().all(|finding| finding.path.starts_with("load.outline")) {
        note(format_args!("`cohaul scenario import {file} --out right.json` puts such outlines right"));
    }
}

pub fn warn(text: impl Display) {
    if !is_quiet() {
        say("warning: ", Tone::Caution, text);
    }
}

/// Most lines of an answer.
const MOST_ANSWER_LINES: usize = 8;
/// Most warnings that are printed one by one.
const MOST_WARNINGS: usize = 10;

/// Prints the first few of many warnings and the number of the others.
pub fn warn_all(warnings: &[String]) {
    let shown = if is_verbose() { warnings.len() } else { MOST_WARNINGS.min(warnings.len()) };
    warnings[..shown].iter().for_each(warn);
    if shown < warnings.len() {
        warn(format_args!("and {} more (--verbose prints all)", warnings.len() - shown));
    }
}

/// Prints what the user may want to know about the course of the command.
pub fn note(text: impl Display) {
    if !is_quiet() {
        let _ = writeln!(anstream::stderr(), "{text}");
    }
}

/// A closed standard error is no reason to end.
fn say(label: &str, tone: Tone, text: impl Display) {
    let style = tone.style();
    let _ = writeln!(anstream::stderr(), "{style}{label}{style:#}{text}");
}
