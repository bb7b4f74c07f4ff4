//! `cohaul explain`.

use std::process::ExitCode;

use clap::Args;

use super::console::print;
use super::error::CliError;
use cohaul::formats;
use cohaul_report::glossary::{Entry, entries, entry};
use cohaul_report::table::wrapped;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul explain               (lists all terms)
  cohaul explain engine error
  cohaul explain formats       (lists names and versions of all formats)")]
pub struct ExplainArgs {
    /// A term as it is printed; without it, all terms are listed
    term: Vec<String>,
}

/// Columns of an explanation.
const WIDTH: usize = 78;
/// Names that are suggested in place of an unknown one.
const MOST_SUGGESTIONS: usize = 5;

pub fn explain(args: &ExplainArgs) -> Result<ExitCode, CliError> {
    if args.term.is_empty() {
        let terms: Vec<&str> = entries().iter().map(|entry| entry.term).collect();
        print(&format!("{}\n", wrapped(&terms.join(", "), 0, WIDTH)))?;
        return Ok(ExitCode::SUCCESS);
    }
    let term = args.term.join(" ");
    if term == "formats" {
        print(&versions())?;
        return Ok(ExitCode::SUCCESS);
    }
    let found = entry(&term).ok_or_else(|| unknown(&term))?;
    print(&explanation(found))?;
    Ok(ExitCode::SUCCESS)
}

/// Name and version of each format, one on each line.
fn versions() -> String {
    formats::ALL.iter().map(|format| format!("{:28}{}\n", format.name, format.version)).collect()
}

fn explanation(entry: &Entry) -> String {
    let also = if entry.aliases.is_empty() { String::new() } else { format!(" (also: {})", entry.aliases.join(", ")) };
    let page = entry.page.map(|page| format!("See docs/src/{page}.\n")).unwrap_or_default();
    format!("{}\n\n{}\n\n{page}", wrapped(&format!("{}{also}", entry.term), 0, WIDTH), wrapped(&entry.meaning, 0, WIDTH))
        .trim_end()
        .to_owned()
        + "\n"
}

fn unknown(term: &str) -> CliError {
    let mut names: Vec<(f64, &str)> =
        entries().iter().flat_map(Entry::names).map(|name| (likeness(term, name), name)).filter(|(likeness, _)| *likeness > 0.8).collect();
    names.sort_by(|one, other| other.0.total_cmp(&one.0));
    let names: Vec<&str> = names.into_iter().take(MOST_SUGGESTIONS).map(|(_, name)| name).collect();
    let hint = if names.is_empty() { "`cohaul explain` lists all terms".to_owned() } else { format!("did you mean {}?", names.join(", ")) };
    CliError::Usage(format!("TERM: no entry for \"{term}\"; {hint}"))
}

/// How alike two names are, from 0 to 1; a name that contains the other is nearly the same.
fn likeness(asked: &str, name: &str) -> f64 {
    let (asked, name) = (asked.to_lowercase(), name.to_lowercase());
    let is_part = asked.len() > 2 && name.contains(&asked);
    if is_part { 0.99 } else { strsim::jaro_winkler(&asked, &name) }
}
