//! CSV tables with units in the names of their columns, and their faults by line and column.

use std::fmt::Display;

use csv::StringRecord;

use crate::scenario::{Findings, ScenarioError, is_in_range};

/// Rows of a CSV file; lines that begin with `#` are comments.
pub struct Table {
    file: String,
    columns: Vec<String>,
    rows: Vec<StringRecord>,
    findings: Findings,
}

impl Table {
    /// Reads a table from the text of a file, which has this name in errors.
    ///
    /// # Errors
    /// When the text is no CSV, or has a column twice or one that is not in `known`. An empty list
    /// allows all columns.
    pub fn parse(text: &str, file: &str, known: &[&str]) -> Result<Self, ScenarioError> {
        // Spreadsheets put a byte-order mark before the first name.
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
        let mut table = Self { file: file.to_owned(), columns: Vec::new(), rows: Vec::new(), findings: Findings::default() };
        match reader.headers() {
            Ok(names) => table.columns = names.iter().map(str::to_owned).collect(),
            Err(error) => table.report("header", "must be CSV", error),
        }
        for (at, name) in table.columns.clone().iter().enumerate() {
            if !known.is_empty() && !known.contains(&name.as_str()) {
                table.report("header", &format!("must have columns of {} only", known.join(", ")), name);
            } else if table.columns[..at].contains(name) {
                table.report("header", "must name each column once", name);
            }
        }
        for row in reader.records() {
            match row {
                Ok(row) => table.rows.push(row),
                Err(error) => table.report("rows", "must be CSV with as many fields as the header", error),
            }
        }
        table.whole()
    }

    /// The table, if no fault was reported.
    ///
    /// # Errors
    ///
    /// All faults reported so far.
    pub fn whole(self) -> Result<Self, ScenarioError> {
        if self.findings.0.is_empty() { Ok(self) } else { Err(ScenarioError::Invalid { file: self.file, findings: self.findings.0 }) }
    }

    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }

    pub fn has(&self, column: &str) -> bool {
        self.columns.iter().any(|name| name == column)
    }

    /// Reports a fault unless all of these columns exist.
    pub fn require(&mut self, columns: &[&str]) {
        let missing: Vec<&str> = columns.iter().filter(|name| !self.has(name)).copied().collect();
        if !missing.is_empty() {
            let found = self.columns.join(", ");
            self.report("header", &format!("must have columns {}", missing.join(", ")), found);
        }
    }

    /// The field as text; empty if it does not exist.
    pub fn text(&self, row: usize, column: &str) -> &str {
        let at = self.columns.iter().position(|name| name == column);
        at.and_then(|at| self.rows[row].get(at)).unwrap_or_default()
    }

    pub fn is_empty_at(&self, row: usize, column: &str) -> bool {
        self.text(row, column).is_empty()
    }

    /// The field as a finite number; anything else is reported.
    pub fn number(&mut self, row: usize, column: &str) -> Option<f64> {
        let text = self.text(row, column).to_owned();
        let value = text.parse().ok().filter(|value: &f64| value.is_finite());
        match value {
            None => self.at(row, column, "must be a finite number", if text.is_empty() { "nothing" } else { &text }),
            Some(large) if !is_in_range(large) => self.at(row, column, "must be at most 1e50 in size", &text),
            Some(_) => {}
        }
        value
    }

    /// Reports a broken rule at a field.
    pub fn at(&mut self, row: usize, column: &str, rule: &str, found: impl Display) {
        let line = self.rows[row].position().map_or(0, csv::Position::line);
        self.report(format_args!("line {line}, {column}"), rule, found);
    }

    /// Reports a broken rule of the whole file.
    pub fn report(&mut self, path: impl Display, rule: &str, found: impl Display) {
        self.findings.report(path, rule, found);
    }
}
