//! CSV tables with units in the names of their columns, and their faults by line and column.

use std::fmt::Display;

use csv::StringRecord;

use cohaul::scenario::{Findings, ScenarioError, is_in_range};

/// Rows of a CSV file; lines that begin with `#` are comments.
pub struct Table {
    file: String,
    columns: Vec<String>,
    rows: Vec<StringRecord>,
    /// Line of the file on which each row begins, counted from 1 as editors do.
    lines: Vec<u64>,
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
        let mut table =
            Self { file: file.to_owned(), columns: Vec::new(), rows: Vec::new(), lines: Vec::new(), findings: Findings::default() };
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
                Ok(row) => {
                    table.lines.push(row.position().map_or(0, |at| line_of(text, at)));
                    table.rows.push(row);
                }
                Err(error) => table.report_row(text, &error),
            }
        }
        table.whole()
    }

    /// Reports a row that could not be read.
    fn report_row(&mut self, text: &str, error: &csv::Error) {
        let place = error.position().map_or("rows".to_owned(), |at| format!("line {}", line_of(text, at)));
        match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                self.report(place, &format!("must have {expected_len} fields, as the header"), len);
            }
            _ => self.report(place, "must be CSV with as many fields as the header", error),
        }
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

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
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
        let line = self.lines[row];
        self.report(format_args!("line {line}, {column}"), rule, found);
    }

    /// Reports a broken rule of the whole file.
    pub fn report(&mut self, path: impl Display, rule: &str, found: impl Display) {
        self.findings.report(path, rule, found);
    }
}

/// Line on which a row begins. The reader places a row where the one before it ends, before empty
/// lines and comments.
fn line_of(text: &str, at: &csv::Position) -> u64 {
    let rest = text.get(at.byte() as usize..).unwrap_or_default();
    let skipped = rest.split_inclusive('\n').take_while(|line| line.starts_with('#') || line.trim_end_matches(['\r', '\n']).is_empty());
    at.line() + skipped.count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faults of a table of one number column.
    fn faults(text: &str) -> String {
        let numbers = Table::parse(text, "a.csv", &[]).and_then(|mut table| {
            let _: Vec<_> = (0..table.n_rows()).map(|row| table.number(row, "x")).collect();
            table.whole()
        });
        numbers.err().map_or(String::new(), |error| error.to_string())
    }

    #[test]
    fn lines_are_those_of_the_file() {
        for (text, line) in [
            ("x,y\n1,2\nbad,2\n", 3),
            ("# camera 1\n# 2026\nx,y\n1,2\n\n# lost\nbad,2\n", 7),
            ("x,y\r\n1,2\r\n\r\nbad,2\r\n", 4),
            ("x,y\n1,\"two\nlines\"\nbad,2\n", 4),
            ("\u{feff}x,y\nbad,2\n", 2),
        ] {
            assert_eq!(faults(text), format!("a.csv: line {line}, x: must be a finite number, found bad"), "{text}");
        }
        let short = faults("x,y\n# a comment\n1,2\n\n1\n");
        assert_eq!(short, "a.csv: line 5: must have 2 fields, as the header, found 1");
    }
}
