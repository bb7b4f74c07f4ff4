//! Tables as text for people: aligned, or as Markdown.

use crate::output::table::{Field, Table};

/// Width of a terminal, which a table keeps to where its last column can wrap (letters).
const TERMINAL: usize = 80;
/// Narrowest last column that is wrapped (letters).
const NARROWEST: usize = 20;

impl Table {
    /// Aligned text, indented by two spaces, at most 80 letters wide where the last column can
    /// wrap. Numbers stand to the right. Names of columns stand above where there are any.
    pub fn text(&self) -> String {
        let rows = self.lines();
        let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |at: usize| rows.iter().filter_map(|row| row.get(at)).map(|cell| cell.chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..n_columns).map(width).collect();
        let start = widths.iter().take(n_columns.saturating_sub(1)).map(|width| width + 2).sum::<usize>() + 2;
        let is_numbers: Vec<bool> = (0..n_columns).map(|at| self.is_numbers(at)).collect();
        let mut text = String::new();
        for row in &rows {
            let mut line = String::from(" ");
            for (at, cell) in row.iter().enumerate() {
                let width = widths[at];
                match cell {
                    _ if is_numbers[at] => line.push_str(&format!(" {cell:>width$} ")),
                    _ if at + 1 == n_columns && start + NARROWEST <= TERMINAL => {
                        line.push_str(&format!(" {}", wrapped(cell, start, TERMINAL - start)));
                    }
                    _ => line.push_str(&format!(" {cell:<width$} ")),
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }

    /// A Markdown table; numbers stand to the right.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let escaped = |row: &Vec<String>| row.iter().map(|cell| cell.replace('|', "\\|").replace('\n', " ")).collect();
        let rule = (0..self.columns.len()).map(|at| if self.is_numbers(at) { "---:" } else { "---" }).collect::<Vec<_>>();
        let mut lines = self.lines().iter().map(|row| line(escaped(row))).collect::<Vec<_>>();
        lines.insert(1.min(lines.len()), format!("|{}|\n", rule.join("|")));
        lines.concat()
    }

    /// Names of the columns, if there are any, and fields as people read them.
    fn lines(&self) -> Vec<Vec<String>> {
        let unit = |at: usize| self.columns.get(at).map_or("", |column| column.unit);
        let names: Vec<String> = self.columns.iter().map(|column| column.name.clone()).collect();
        let head = names.iter().any(|name| !name.is_empty()).then_some(names);
        let row = |row: &Vec<Field>| row.iter().enumerate().map(|(at, field)| field.text(unit(at))).collect();
        head.into_iter().chain(self.rows.iter().map(row)).collect()
    }

    /// Whether a column holds numbers and nothing else.
    pub fn is_numbers(&self, at: usize) -> bool {
        let mut fields = self.rows.iter().filter_map(|row| row.get(at)).filter(|field| **field != Field::Empty).peekable();
        fields.peek().is_some() && fields.all(|field| field.number().is_some())
    }
}

/// `text` in lines of at most `width` letters, where words allow; all but the first are indented by
/// `indent`.
pub(crate) fn wrapped(text: &str, indent: usize, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is one");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.join(&format!("\n{}", " ".repeat(indent)))
}
