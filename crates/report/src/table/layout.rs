//! Rows of cells in columns that fit a terminal.
//!
//! Where the columns are too wide together, cells continue below themselves: those of the last
//! column first, then those of the widest one. Where that is not enough, the columns stand in
//! several blocks, and the columns that say what a row is of stand in each block.

use std::ops::Range;

use crate::quantity::is_unit;

/// Width of a terminal (letters).
const TERMINAL: usize = 80;
/// Spaces between two columns.
const GAP: usize = 2;
/// Narrowest last column before other columns wrap too (letters).
const NARROWEST: usize = 20;
/// Narrowest column that is wrapped for the sake of another one beside it, and the same for the
/// columns that each block repeats (letters).
const NARROW: usize = 16;
const NARROW_KEY: usize = 26;

/// Cells, and how they stand.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    pub rows: Vec<Vec<String>>,
    /// Whether the first row names the columns.
    pub has_head: bool,
    /// Columns that stand to the right.
    pub are_numbers: Vec<bool>,
    /// Spaces before each line.
    pub indent: usize,
    /// Number of columns that each block repeats.
    pub n_keys: usize,
}

impl Layout {
    /// The lines of all rows.
    pub fn text(&self) -> String {
        self.blocks().iter().map(|columns| self.block(columns)).collect::<Vec<_>>().join("\n")
    }

    /// Whether no cell has to be wrapped.
    pub fn fits(&self) -> bool {
        self.width((0..self.n_columns()).map(|at| self.natural(at))) <= TERMINAL
    }

    fn n_columns(&self) -> usize {
        self.rows.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The columns of each block.
    fn blocks(&self) -> Vec<Vec<usize>> {
        let n_columns = self.n_columns();
        let keys = 0..self.n_keys.min(n_columns);
        let mut blocks = vec![keys.clone().collect::<Vec<_>>()];
        for column in keys.end..n_columns {
            let block = blocks.last_mut().expect("there is one");
            block.push(column);
            if block.len() > keys.len() + 1 && self.width(block.iter().map(|at| self.comfortable(*at))) > TERMINAL {
                block.pop();
                blocks.push(keys.clone().chain([column]).collect());
            }
        }
        blocks
    }

    /// Width of a line whose columns have these widths (letters).
    fn width(&self, widths: impl Iterator<Item = usize>) -> usize {
        self.indent + widths.map(|width| width + GAP).sum::<usize>().saturating_sub(GAP)
    }

    /// Width of a column whose cells are not wrapped (letters).
    fn natural(&self, column: usize) -> usize {
        self.cells(column).map(|(_, cell)| length(cell)).max().unwrap_or(0)
    }

    /// Width of a column whose cells are wrapped at every word (letters).
    fn least(&self, column: usize) -> usize {
        self.cells(column).flat_map(|(row, cell)| pieces(cell, self.is_head(row))).map(|piece| length(piece.text)).max().unwrap_or(0)
    }

    /// Width of a column beside which another one still finds room, its name on several lines
    /// (letters).
    fn comfortable(&self, column: usize) -> usize {
        let narrow = if column < self.n_keys { NARROW_KEY } else { NARROW };
        let fields = self.cells(column).filter(|(row, _)| !self.is_head(*row)).map(|(_, cell)| length(cell));
        fields.max().unwrap_or(0).min(narrow).max(self.least(column))
    }

    fn cells(&self, column: usize) -> impl Iterator<Item = (usize, &str)> {
        self.rows.iter().enumerate().filter_map(move |(row, cells)| Some((row, cells.get(column)?.as_str())))
    }

    fn is_head(&self, row: usize) -> bool {
        self.has_head && row == 0
    }

    fn block(&self, columns: &[usize]) -> String {
        let widths = self.widths(columns);
        (0..self.rows.len()).map(|row| self.row(row, columns, &widths)).collect()
    }

    /// Widths at which the columns fit side by side, as near as words allow (letters).
    fn widths(&self, columns: &[usize]) -> Vec<usize> {
        let mut widths: Vec<usize> = columns.iter().map(|at| self.natural(*at)).collect();
        let least: Vec<usize> = columns.iter().map(|at| self.least(*at)).collect();
        while self.width(widths.iter().copied()) > TERMINAL {
            let last = widths.len() - 1;
            let is_last_free = widths[last] > NARROWEST.max(least[last]);
            let widest = (0..=last).filter(|at| widths[*at] > least[*at]).max_by_key(|at| widths[*at]);
            match if is_last_free { Some(last) } else { widest } {
                Some(at) => widths[at] -= 1,
                None => break,
            }
        }
        widths
    }

    /// The lines of a row. Names of columns stand above their last lines.
    fn row(&self, row: usize, columns: &[usize], widths: &[usize]) -> String {
        let is_head = self.is_head(row);
        let cell = |at: &usize| self.rows[row].get(*at).map_or("", String::as_str);
        let cells: Vec<Vec<String>> = columns.iter().zip(widths).map(|(at, width)| lines(cell(at), *width, is_head)).collect();
        let height = cells.iter().map(Vec::len).max().unwrap_or(0);
        let shift = |lines: &Vec<String>| if is_head { height - lines.len() } else { 0 };
        let piece = |at: usize, line: usize| {
            let text = line.checked_sub(shift(&cells[at])).and_then(|line| cells[at].get(line)).map_or("", String::as_str);
            let (width, is_number) = (widths[at], self.are_numbers.get(columns[at]).is_some_and(|is_number| *is_number));
            if is_number { format!("{text:>width$}") } else { format!("{text:<width$}") }
        };
        let line = |line: usize| {
            let pieces: Vec<String> = (0..cells.len()).map(|at| piece(at, line)).collect();
            let text = format!("{}{}", " ".repeat(self.indent), pieces.join(&" ".repeat(GAP)));
            format!("{}\n", text.trim_end())
        };
        (0..height).map(line).collect()
    }
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// Part of a cell that stays on one line.
struct Piece<'a> {
    text: &'a str,
    /// Whether a space stands before it.
    is_apart: bool,
}

/// Words of a cell. A number stays with its unit and with `+-` before it; names of columns may also
/// part at the dots of a key.
fn pieces(cell: &str, is_head: bool) -> Vec<Piece<'_>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    for word in cell.split(' ') {
        let range = start..start + word.len();
        start = range.end + 1;
        match ranges.last_mut() {
            Some(last) if are_one(&cell[last.clone()], word) => last.end = range.end,
            _ => ranges.push(range),
        }
    }
    let parts = |range: Range<usize>| {
        let word = &cell[range];
        let parts: Vec<&str> = if is_head { word.split_inclusive('.').collect() } else { vec![word] };
        parts.into_iter().enumerate().map(|(at, text)| Piece { text, is_apart: at == 0 })
    };
    ranges.into_iter().flat_map(parts).collect()
}

/// Whether a word stays on the line of the words before it.
fn are_one(before: &str, word: &str) -> bool {
    let last = before.rsplit(' ').next().unwrap_or_default();
    let is_number = || last.trim_start_matches('(').parse::<f64>().is_ok();
    last == "+-" || (is_unit(word.trim_end_matches([',', ';', ')'])) && (is_number() || is_unit(last)))
}

/// `text` in lines of at most `width` letters, where words allow; all but the first are indented by
/// `indent`. A number stays with its unit.
pub fn folded(text: &str, indent: usize, width: usize) -> String {
    lines(text, width, false).join(&format!("\n{}", " ".repeat(indent)))
}

/// The lines of a cell, at most `width` letters long where its words allow.
fn lines(cell: &str, width: usize, is_head: bool) -> Vec<String> {
    let mut lines = vec![String::new()];
    for Piece { text, is_apart } in pieces(cell, is_head) {
        let line = lines.last_mut().expect("there is one");
        let gap = if is_apart && !line.is_empty() { " " } else { "" };
        if line.is_empty() || length(line) + gap.len() + length(text) <= width {
            *line += &format!("{gap}{text}");
        } else {
            lines.push(text.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(rows: &[&[&str]]) -> Layout {
        let rows = rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect();
        Layout { rows, has_head: true, are_numbers: Vec::new(), indent: 2, n_keys: 1 }
    }

    fn widest(text: &str) -> usize {
        text.lines().map(length).max().unwrap_or(0)
    }

    #[test]
    fn cells_wrap_where_the_columns_are_too_wide_and_numbers_keep_their_units() {
        let words = "word ".repeat(12);
        let text = layout(&[&["load.mass_kg", "time"], &[words.trim(), "1.500 s +- 0.2500 s"]]).text();
        assert!(text.contains("  load.mass_kg  ") && !text.contains("1.500\n"), "{text}");
        let text = layout(&[&["load.mass_kg", "time"], &["1", &"40.50 s +- 147.6 s ".repeat(9)]]).text();
        assert!(text.lines().skip(1).all(|line| line.ends_with(" s")), "{text}");
        assert!((60..=80).contains(&widest(&text)), "{text}");
    }

    #[test]
    fn names_part_at_dots_and_stand_above_their_last_lines() {
        let row = ["0.1"; 8];
        let text = layout(&[&["load.mass_kg"; 8], &row]).text();
        assert!(text.starts_with("  load.    "), "{text}");
        assert!(text.lines().nth(1).unwrap().starts_with("  mass_kg  "), "{text}");
        assert!(widest(&text) <= 80, "{text}");
    }

    #[test]
    fn more_columns_than_fit_stand_in_blocks_with_their_keys() {
        let (head, row): (Vec<String>, Vec<String>) = (0..12).map(|at| (format!("column-{at}"), format!("value-{at}"))).unzip();
        let all = Layout { rows: vec![head, row], n_keys: 2, ..layout(&[]) };
        let text = all.text();
        assert_eq!(text.matches("value-1 ").count(), text.split("\n\n").count(), "{text}");
        assert!((0..12).all(|at| text.contains(&format!("value-{at}"))), "{text}");
        assert!(text.contains("\n\n") && widest(&text) <= 80, "{text}");
    }
}
