//! What can be wrong with a scenario, and how it is said: file, place, rule, and what was found there.

use std::fmt::{self, Display};
use std::io;

/// One broken rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Where: keys joined by points, indices in brackets, as in `springs[2].rest_length_m`. Empty for the whole file.
    pub path: String,
    /// What must hold there.
    pub rule: String,
    /// What stands there instead.
    pub found: String,
}

/// Why there is no scenario.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    #[error("{file}: cannot be read: {source}")]
    Unreadable { file: String, source: io::Error },
    #[error("{file}: line {line} column {column}: must be JSON: {reason}")]
    NotJson { file: String, line: usize, column: usize, reason: String },
    /// Every broken rule, one a line.
    #[error("{}", lines(file, findings))]
    Invalid { file: String, findings: Vec<Finding> },
}

impl ScenarioError {
    /// The broken rules; none when there was nothing to hold rules against.
    pub fn findings(&self) -> &[Finding] {
        match self {
            ScenarioError::Invalid { findings, .. } => findings,
            _ => &[],
        }
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let separator = if self.path.is_empty() { "" } else { ": " };
        write!(f, "{}{separator}{}, found {}", self.path, self.rule, self.found)
    }
}

fn lines(file: &str, findings: &[Finding]) -> String {
    findings.iter().map(|finding| format!("{file}: {finding}")).collect::<Vec<_>>().join("\n")
}

/// Largest number in a scenario: products of a few of them are finite, and so is what is drawn of them.
const LARGEST: f64 = 1e50;

/// Findings as they come in, with the rules that many places share.
#[derive(Debug, Default)]
pub struct Findings(pub Vec<Finding>);

impl Findings {
    pub fn report(&mut self, path: impl Display, rule: impl Into<String>, found: impl Display) {
        self.0.push(Finding { path: path.to_string(), rule: rule.into(), found: found.to_string() });
    }

    /// Reports unless `holds`; a number that is not finite, or so large that its powers are not, breaks every rule.
    pub fn require(&mut self, holds: bool, path: impl Display, rule: &str, found: f64) {
        if !found.is_finite() {
            self.report(path, "must be a finite number", number(found));
        } else if found.abs() > LARGEST {
            self.report(path, format!("must be at most {LARGEST:e} in size"), number(found));
        } else if !holds {
            self.report(path, rule, number(found));
        }
    }

    pub fn finite(&mut self, path: impl Display, found: f64) {
        self.require(true, path, "", found);
    }

    pub fn finite_vector(&mut self, path: impl Display, found: &[f64]) {
        for (axis, value) in found.iter().enumerate() {
            self.finite(format_args!("{path}[{axis}]"), *value);
        }
    }

    pub fn positive(&mut self, path: impl Display, found: f64) {
        self.require(found > 0.0, path, "must be positive", found);
    }

    pub fn not_negative(&mut self, path: impl Display, found: f64) {
        self.require(found >= 0.0, path, "must not be negative", found);
    }

    /// Whether `found` things are at least one and not so many that memory runs out before anything else can be said.
    pub fn count(&mut self, path: impl Display, found: usize, most: usize) -> bool {
        let holds = (1..=most).contains(&found);
        if !holds {
            self.report(path, format!("must be from 1 to {most}"), found);
        }
        holds
    }
}

/// A number in the shortest digits that give it back: `1e-9`, not `0.000000001`.
pub fn number(value: f64) -> String {
    format!("{value:?}")
}
