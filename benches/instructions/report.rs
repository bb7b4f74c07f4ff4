//! What was counted and how it compares: a table for people, JSON for programs.

use std::fmt::Write;

use serde::Serialize;

use crate::ceilings::{Ceilings, Finding, ceiling};
use crate::paths::HotPath;

/// One hot path's count.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub name: &'static str,
    /// Calls that were counted.
    pub n_calls: u32,
    pub instructions_per_call: u64,
    /// What is stored, and what may not be exceeded; none without ceilings of this build.
    pub stored_per_call: Option<u64>,
    pub ceiling_per_call: Option<u64>,
    pub finding: Option<Finding>,
}

/// All counts of one call of the program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub build: String,
    pub compiler: String,
    /// Compiler of the ceilings; none without ceilings of this build.
    pub ceilings_compiler: Option<String>,
    pub paths: Vec<Line>,
    pub failed: bool,
}

impl Line {
    /// Of the instructions of all its calls, beside what `ceilings` have.
    pub fn new(path: &HotPath, n_instructions: u64, ceilings: Option<&Ceilings>) -> Self {
        let per_call = n_instructions.div_ceil(u64::from(path.n_calls));
        let stored = ceilings.and_then(|ceilings| ceilings.instructions_per_call.get(path.name).copied());
        Self {
            name: path.name,
            n_calls: path.n_calls,
            instructions_per_call: per_call,
            stored_per_call: stored,
            ceiling_per_call: ceilings.and_then(|ceilings| Some(ceiling(stored?, ceilings.margin))),
            finding: ceilings.map(|ceilings| Finding::of(per_call, stored, ceilings.margin)),
        }
    }

    fn text(&self) -> String {
        let or_none = |count: Option<u64>| count.map_or("-".to_owned(), |count| count.to_string());
        let ratio =
            self.stored_per_call.map_or("-".to_owned(), |stored| format!("{:.4}", self.instructions_per_call as f64 / stored as f64));
        let finding = match self.finding {
            Some(Finding::Above) => "SLOWER: above its ceiling",
            Some(Finding::WellBelow) => "faster: lower its ceiling with --accept",
            Some(Finding::NoCeiling) => "NO CEILING: store one with --accept",
            Some(Finding::Within) | None => "",
        };
        let (stored, ceiling) = (or_none(self.stored_per_call), or_none(self.ceiling_per_call));
        let line = format!("{:<26}{:>14}{stored:>12}{ceiling:>12}{ratio:>10}  {finding}", self.name, self.instructions_per_call);
        line.trim_end().to_owned()
    }
}

impl Report {
    pub fn new(build: String, compiler: String, ceilings: Option<&Ceilings>, paths: Vec<Line>) -> Self {
        let failed = paths.iter().any(|line| line.finding.is_some_and(Finding::fails));
        Self { build, compiler, ceilings_compiler: ceilings.map(|ceilings| ceilings.compiler.clone()), paths, failed }
    }

    /// The table, with a line end, and what else must be known to read it.
    pub fn text(&self) -> String {
        let mut text = format!("{}, {}\n", self.build, self.compiler);
        let _ = writeln!(text, "{:<26}{:>14}{:>12}{:>12}{:>10}", "hot path", "instructions", "stored", "ceiling", "ratio");
        self.paths.iter().for_each(|line| text.extend([line.text().as_str(), "\n"]));
        if let Some(compiler) = self.ceilings_compiler.as_ref().filter(|compiler| **compiler != self.compiler) {
            let _ = writeln!(text, "stored counts are of {compiler}: another compiler may cost or spare some per cent by itself");
        }
        text
    }
}
