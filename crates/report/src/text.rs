//! Text for terminals: labelled rows in sections, wrapped at 80 columns.

use crate::table::{Layout, wrapped};

/// How much a command prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The answer and at most 15 lines of evidence.
    Brief,
    /// Everything (`--verbose`).
    Full,
}

/// Width of a line (columns).
pub const WIDTH: usize = 80;

/// Rows of a label and a value, in sections.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    pub text: String,
}

impl Lines {
    /// Column at which values begin.
    pub const VALUE: usize = 20;

    /// The answer, and an empty line after it.
    pub fn answer(&mut self, answer: &str) {
        self.section(answer);
        self.text.push('\n');
    }

    /// A line, or a paragraph, of its own.
    pub fn section(&mut self, name: &str) {
        self.text += &format!("{}\n", wrapped(name, 0, WIDTH));
    }

    /// A label and its value, which continues below itself.
    pub fn row(&mut self, label: &str, value: &str) {
        let (label, column) = (format!("  {label}"), Self::VALUE);
        let gap = if label.chars().count() < column { "" } else { "  " };
        let line = format!("{label:<column$}{gap}{}", wrapped(value, column, WIDTH - column));
        self.text += &format!("{}\n", line.trim_end());
    }
}

/// Rows of cells, indented by two spaces: in columns where these fit, and else a paragraph for each
/// row, its first cell on lines of its own.
pub fn listed(rows: &[Vec<String>]) -> String {
    const INDENT: usize = 2;
    let layout = Layout { rows: rows.to_vec(), indent: INDENT, ..Layout::default() };
    if layout.fits() {
        return layout.text();
    }
    let lines = |text: &str, indent: usize| format!("{}{}\n", " ".repeat(indent), wrapped(text, indent, WIDTH - indent));
    let row = |row: &Vec<String>| {
        let (first, others) = row.split_first().expect("a row has cells");
        let others: Vec<&str> = others.iter().map(String::as_str).filter(|cell| !cell.is_empty()).collect();
        lines(first, INDENT) + &if others.is_empty() { String::new() } else { lines(&others.join("; "), INDENT + 2) }
    };
    rows.iter().map(row).collect()
}

/// Markdown whose paragraphs and list items, a line each in `page`, continue below themselves at
/// 100 columns. Headings, tables and pictures keep their lines.
pub fn wrapped_markdown(page: &str) -> String {
    const WIDTH: usize = 100;
    let line = |line: &str| match line.strip_prefix("- ") {
        _ if line.starts_with(['#', '|', '!']) => format!("{line}\n"),
        Some(item) => format!("- {}\n", wrapped(item, 2, WIDTH - 2)),
        None => format!("{}\n", wrapped(line, 0, WIDTH)),
    };
    page.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_continue_below_themselves() {
        let mut lines = Lines::default();
        lines.row("label", &"word ".repeat(13));
        lines.row("a label that is too long", "value");
        let expected =
            format!("  label             {}word\n{}word\n  a label that is too long  value\n", "word ".repeat(11), " ".repeat(20));
        assert_eq!(lines.text, expected);
    }

    #[test]
    fn prose_wraps_and_tables_do_not() {
        let (words, table) = ("word ".repeat(30), format!("| {} |", "cell ".repeat(30)));
        let page = wrapped_markdown(&format!("# Title\n\n{}\n- {}\n\n{table}\n", words.trim(), words.trim()));
        let (first, second) = ("word ".repeat(20), "word ".repeat(19));
        let expected = format!(
            "# Title\n\n{}\n{}\n- {}\n  {}\n\n{table}\n",
            first.trim(),
            "word ".repeat(10).trim(),
            second.trim(),
            "word ".repeat(11).trim()
        );
        assert_eq!(page, expected);
    }
}
