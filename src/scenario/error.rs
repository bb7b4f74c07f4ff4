//! Faults of a scenario, with their file, place, rule, and what was found there.

use std::fmt::{self, Display};
use std::io;

use serde::Serialize;

/// One broken rule, or for a warning, one that is better kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Place of the fault: keys joined by points, with indices in brackets, as in
    /// `springs[2].rest_length_m`. It is empty for the whole file.
    pub path: String,
    /// Rule that is broken.
    pub rule: String,
    /// Value or thing that was found.
    pub found: String,
}

/// Reasons why a scenario cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable { file: String, source: io::Error },
    /// The text is not JSON.
    #[error("{file}: line {line} column {column}: must be JSON: {reason}")]
    NotJson { file: String, line: usize, column: usize, reason: String },
    /// The file breaks rules.
    #[error("{}", lines(file, findings))]
    Invalid { file: String, findings: Vec<Finding> },
}

impl ScenarioError {
    /// All broken rules. The list is empty when the file could not be read as JSON.
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
        write!(f, "{}{separator}{}", self.path, self.rule)?;
        // A question ends its sentence.
        if self.rule.ends_with('?') { write!(f, " (found {})", self.found) } else { write!(f, ", found {}", self.found) }
    }
}

/// Equal faults that are listed one by one. Further ones are counted.
const MOST_LISTED: usize = 5;
/// Lines of faults that are listed at most. Further faults are counted.
const MOST_LINES: usize = 20;

/// One line per finding. Findings count as equal if they have the same rule, and paths that are the
/// same but for digits. Long lists end with the number of the findings that they leave out.
pub fn lines(file: &str, findings: &[Finding]) -> String {
    let mut lines = Vec::new();
    let mut counts: Vec<(String, &str, usize)> = Vec::new();
    let mut n_left_out = 0;
    for finding in findings {
        let (place, rule) =
            (finding.path.replace(|letter: char| letter.is_ascii_digit(), ""), finding.rule.split(',').next().unwrap_or_default());
        let known = counts.iter().position(|(p, r, _)| *p == place && *r == rule);
        if lines.len() == MOST_LINES && known.is_none_or(|at| counts[at].2 < MOST_LISTED) {
            n_left_out += 1;
            continue;
        }
        let at = known.unwrap_or_else(|| {
            counts.push((place, rule, 0));
            counts.len() - 1
        });
        counts[at].2 += 1;
        if counts[at].2 <= MOST_LISTED {
            lines.push(format!("{file}: {finding}"));
        }
    }
    let more = counts.iter().filter(|(_, _, n)| *n > MOST_LISTED);
    lines.extend(more.map(|(place, rule, n)| format!("{file}: {place}: {rule}: and {} more", n - MOST_LISTED)));
    if n_left_out > 0 {
        lines.push(format!("{file}: and {n_left_out} more faults"));
    }
    lines.join("\n")
}

/// Largest number in a scenario (1): products of a few such numbers are finite.
const LARGEST: f64 = 1e50;
/// Smallest length (m) or time (s) in a scenario, other than zero: its inverse is no larger than
/// the largest number.
const SMALLEST: f64 = 1e-50;

/// Longest text of a place, a rule and what was found in a message (characters). Keys and values
/// of a file may have any length.
const LONGEST: [usize; 3] = [200, 600, 200];

/// The text, cut with dots at the end if it is longer than `most` characters.
pub fn cut(mut text: String, most: usize) -> String {
    if let Some((end, _)) = text.char_indices().nth(most) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}

/// Whether a number is finite, and small enough to compute with.
pub fn is_in_range(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Findings in the order of their discovery, with the rules that many places share.
#[derive(Debug, Default)]
pub struct Findings(pub Vec<Finding>);

impl Findings {
    pub fn report(&mut self, path: impl Display, rule: impl Into<String>, found: impl Display) {
        let [path, rule, found] = [path.to_string(), rule.into(), found.to_string()];
        let [longest_path, longest_rule, longest_found] = LONGEST;
        let (path, rule) = (cut(path, longest_path), cut(rule, longest_rule));
        self.0.push(Finding { path, rule, found: cut(found, longest_found) });
    }

    /// Adds a finding unless the rule `holds`. A number that is not finite, or so large that its
    /// powers are not, breaks every rule.
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

    /// The same for a length (m) or a time (s), whose inverse must be in range too.
    pub fn positive_size(&mut self, path: impl Display, found: f64) {
        if found > 0.0 && found < SMALLEST {
            self.report(path, format!("must be at least {SMALLEST:e}"), number(found));
        } else {
            self.positive(path, found);
        }
    }

    pub fn not_negative(&mut self, path: impl Display, found: f64) {
        self.require(found >= 0.0, path, "must not be negative", found);
    }

    /// Whether there is at least one thing, and at most `most`, a limit that protects memory.
    pub fn count(&mut self, path: impl Display, found: usize, most: usize) -> bool {
        let holds = (1..=most).contains(&found);
        if !holds {
            self.report(path, format!("must be from 1 to {most}"), found);
        }
        holds
    }
}

/// Shortest digits that give the number back, as in `1e-9`.
pub fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A number as people read it: three digits, without trailing zeros.
pub fn short(value: f64) -> String {
    let text = format!("{value:.2e}");
    let plain: f64 = text.parse().expect("it is a number");
    if plain == 0.0 || (1e-3..1e6).contains(&plain.abs()) { format!("{plain}") } else { format!("{plain:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_list_ends_with_the_number_of_what_it_leaves_out() {
        let mut findings = Findings::default();
        for key in 0..30 {
            let name = char::from(b'a' + key % 26).to_string().repeat(1 + usize::from(key));
            (0..7).for_each(|_| findings.report(&name, "is unknown", 1));
        }
        let text = lines("a.json", &findings.0);
        // Four kinds of which five are shown and two are counted, and 26 that are only counted.
        assert_eq!(text.lines().count(), 20 + 4 + 1);
        assert_eq!(text.matches("is unknown: and 2 more").count(), 4);
        assert_eq!(text.lines().last(), Some("a.json: and 182 more faults"));
    }

    #[test]
    fn keys_and_values_of_any_length_are_cut() {
        let mut findings = Findings::default();
        let long = "ü".repeat(100_000);
        findings.report(&long, long.as_str(), &long);
        let Finding { path, rule, found } = &findings.0[0];
        assert_eq!([path, rule, found].map(|text| text.chars().count()), [203, 603, 203]);
        findings.report("load", "must be positive", -1);
        assert_eq!(findings.0[1].to_string(), "load: must be positive, found -1");
    }
}
