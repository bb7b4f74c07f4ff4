//! Tables as text for people: aligned, or as Markdown.

use super::layout::Layout;
use crate::table::{Field, Table};

impl Table {
    /// Aligned text, indented by two spaces, at most 80 letters wide where words allow. Numbers
    /// stand to the right. Names of columns stand above where there are any.
    pub fn text(&self) -> String {
        self.layout().text()
    }

    /// The same, where the first `n_keys` columns say what a row is of: a table that is too wide
    /// for one block repeats them in each.
    pub fn text_by(&self, n_keys: usize) -> String {
        Layout { n_keys, ..self.layout() }.text()
    }

    /// A block for each group of rows whose first `n` fields are equal; these stand above it.
    pub fn text_in_groups(&self, n: usize) -> String {
        let block = |rows: &[Vec<Field>]| {
            let title: Vec<String> = rows[0][..n].iter().map(|field| field.text("")).collect();
            let rows = rows.iter().map(|row| row[n..].to_vec()).collect();
            let part = Self { caption: String::new(), columns: self.columns[n..].to_vec(), rows };
            format!("  {}\n{}", title.join(", "), Layout { indent: 4, ..part.layout() }.text())
        };
        self.rows.chunk_by(|one, other| one[..n] == other[..n]).map(block).collect()
    }

    fn layout(&self) -> Layout {
        let rows = self.lines();
        let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let are_numbers = (0..n_columns).map(|at| self.is_numbers(at)).collect();
        Layout { has_head: rows.len() > self.rows.len(), rows, are_numbers, indent: 2, n_keys: 1 }
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
pub fn wrapped(text: &str, indent: usize, width: usize) -> String {
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
