//! Text of any separator as rows of cells.

use csv::StringRecord;

use cohaul::scenario::{Findings, ScenarioError, is_in_range};
use cohaul::stop;

/// Rows of a table, the first of which is its header. Lines that begin with `#` are comments.
pub struct Cells {
    file: String,
    rows: Vec<(u64, StringRecord)>,
    /// Whether a comma may be a decimal point.
    has_decimal_commas: bool,
    pub n_decimal_commas: usize,
    findings: Findings,
}

/// Words for a number that is not there.
const NOTHING: [&str; 8] = ["", "nan", "na", "n/a", "none", "null", "-", "#n/a"];

impl Cells {
    /// Rows of the text of a file. The separator is a tab, a semicolon or a comma, whichever comes
    /// first in this list and in the first line; without any of them it is white space.
    ///
    /// # Errors
    /// When the text is no table.
    pub fn parse(bytes: &[u8], file: &str) -> Result<Self, ScenarioError> {
        let mut cells =
            Self { file: file.to_owned(), rows: Vec::new(), has_decimal_commas: false, n_decimal_commas: 0, findings: Findings::default() };
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}'),
            Err(error) => {
                let line = 1 + bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
                cells.report(
                    format_args!("line {line}"),
                    "must be text in UTF-8",
                    format_args!("the byte {:#04x}", bytes[error.valid_up_to()]),
                );
                return cells.whole();
            }
        };
        let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
        match ['\t', ';', ','].into_iter().find(|separator| first.contains(*separator)) {
            Some(separator) => {
                cells.has_decimal_commas = separator != ',';
                cells.read_separated(text, separator as u8);
            }
            None => {
                let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
                cells.rows = lines.map(|(at, line)| (at as u64 + 1, line.split_whitespace().collect())).collect();
            }
        }
        if cells.rows.len() < 2 && cells.findings.0.is_empty() {
            cells.report("rows", "must be a table with a header and rows below it", format_args!("{} lines", cells.rows.len()));
        }
        cells.whole()
    }

    fn read_separated(&mut self, text: &str, separator: u8) {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .delimiter(separator)
            .flexible(true)
            .has_headers(false)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        // Counted along with the rows: the reader's own lines begin before comments.
        let (mut byte, mut line) = (0, 1);
        for row in reader.records() {
            stop::point();
            match row {
                Ok(row) => {
                    let mut at = row.position().map_or(byte, |position| position.byte() as usize).max(byte);
                    let rest = text.get(at..).unwrap_or_default();
                    let is_skipped = |line: &&str| line.starts_with('#') || line.trim_end_matches(['\r', '\n']).is_empty();
                    at += rest.split_inclusive('\n').take_while(is_skipped).map(str::len).sum::<usize>();
                    let passed = text.as_bytes().get(byte..at).unwrap_or_default();
                    line += passed.iter().filter(|byte| **byte == b'\n').count() as u64;
                    byte = at;
                    if row.iter().any(|cell| !cell.is_empty()) {
                        self.rows.push((line, row));
                    }
                }
                Err(error) => self.report("rows", "must be a table of text", error),
            }
        }
    }

    /// All rows, if no fault was reported.
    ///
    /// # Errors
    /// All faults reported so far.
    pub fn whole(self) -> Result<Self, ScenarioError> {
        if self.findings.0.is_empty() { Ok(self) } else { Err(ScenarioError::Invalid { file: self.file, findings: self.findings.0 }) }
    }

    pub fn file(&self) -> &str {
        &self.file
    }

    /// Number of rows with all header rows (1).
    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }

    /// Cells of a row as text.
    pub fn row(&self, row: usize) -> Vec<&str> {
        self.rows.get(row).map(|(_, row)| row.iter().collect()).unwrap_or_default()
    }

    /// Line of a row, from 1.
    pub fn line(&self, row: usize) -> u64 {
        self.rows[row].0
    }

    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].1.get(column).unwrap_or_default()
    }

    /// Reports rows from `first` on that do not have the `n` fields of the header. Empty fields at
    /// the end do not count.
    pub fn require_fields(&mut self, first: usize, n: usize) {
        for at in first..self.rows.len() {
            let row = &self.rows[at].1;
            let found = row.len();
            if found < n || row.iter().skip(n).any(|cell| !cell.is_empty()) {
                let line = self.rows[at].0;
                self.report(format_args!("line {line}"), &format!("must have {n} fields, as the header"), found);
            }
        }
    }

    /// The number in a cell; `None` where there is none, such as NaN, an infinity or nothing.
    /// Anything else is reported.
    pub fn number(&mut self, row: usize, column: usize, name: &str) -> Option<f64> {
        let text = self.rows[row].1.get(column).unwrap_or_default();
        if NOTHING.iter().any(|nothing| text.eq_ignore_ascii_case(nothing)) {
            return None;
        }
        let is_decimal_comma = self.has_decimal_commas && text.contains(',') && !text.contains('.');
        let value = if is_decimal_comma { text.replace(',', ".").parse() } else { text.parse::<f64>() };
        let found = text.to_owned();
        self.n_decimal_commas += usize::from(is_decimal_comma);
        match value {
            Ok(value) if !value.is_finite() => None,
            Ok(value) if is_in_range(value) => Some(value),
            Ok(_) => {
                self.at(row, name, "must be at most 1e50 in size", found);
                None
            }
            Err(_) => {
                self.at(row, name, "must be a number, or empty where nothing was seen", found);
                None
            }
        }
    }

    /// The number in a cell that must hold one.
    pub fn required(&mut self, row: usize, column: usize, name: &str) -> Option<f64> {
        let n_before = self.findings.0.len();
        let value = self.number(row, column, name);
        if value.is_none() && self.findings.0.len() == n_before {
            let found = self.text(row, column).to_owned();
            self.at(row, name, "must be a finite number", if found.is_empty() { "nothing".to_owned() } else { found });
        }
        value
    }

    /// Reports a broken rule at a cell.
    pub fn at(&mut self, row: usize, name: &str, rule: &str, found: impl std::fmt::Display) {
        let line = self.rows[row].0;
        self.report(format_args!("line {line}, {name}"), rule, found);
    }

    /// Reports a broken rule of the whole file.
    pub fn report(&mut self, path: impl std::fmt::Display, rule: &str, found: impl std::fmt::Display) {
        self.findings.report(path, rule, found);
    }
}
