//! Lines of a CSV table, written as fast as numbers are turned into text.
//!
//! A number with the same bits as the one above it keeps its text: a load at rest repeats itself
//! for thousands of lines. Text is collected in one block of memory and written when that is full.

use std::io::{self, Write};

use crate::json::NotFinite;

#[derive(Debug, thiserror::Error)]
pub enum TableError {
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// Bytes that are written together: few calls, and still in the processor's cache.
const BLOCK: usize = 1 << 16;

/// Longest text of a field: `-2.2250738585072014e-308`.
const WIDTH: usize = 24;

/// A table that is being written to `out`.
pub struct Lines<W> {
    out: W,
    /// Names of the columns, with commas between them.
    head: String,
    block: Vec<u8>,
    /// How much of the block is filled.
    filled: usize,
    /// The last number of each column.
    last: Vec<Field>,
    column: usize,
}

/// Bytes that are copied for a field: a fixed number, which is faster than one of any length. What
/// follows its comma is overwritten.
const PIECE: usize = 32;

#[derive(Clone, Copy)]
struct Field {
    bits: u64,
    /// With its comma.
    text: [u8; PIECE],
    length: usize,
}

impl Field {
    /// What is no number.
    const EMPTY: Field = Field { bits: f64::NAN.to_bits(), text: [b','; PIECE], length: 1 };
}

/// Puts a text of at most [`WIDTH`] bytes at the beginning of `place`: two pieces of a fixed length
/// that overlap are faster than one of any length.
#[inline]
fn put(text: &[u8], place: &mut [u8]) {
    let n = text.len();
    if n >= 16 {
        place[..16].copy_from_slice(&text[..16]);
        place[n - 8..n].copy_from_slice(&text[n - 8..]);
    } else if n >= 8 {
        place[..8].copy_from_slice(&text[..8]);
        place[n - 8..n].copy_from_slice(&text[n - 8..]);
    } else if n >= 4 {
        place[..4].copy_from_slice(&text[..4]);
        place[n - 4..n].copy_from_slice(&text[n - 4..]);
    } else {
        place[..n].copy_from_slice(text);
    }
}

impl<W: Write> Lines<W> {
    /// Begins a table with the names of its columns, which need no quotes.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn new(mut out: W, names: &[impl AsRef<str>]) -> io::Result<Self> {
        let mut head = String::new();
        for name in names {
            head.push_str(name.as_ref());
            head.push(',');
        }
        head.pop();
        writeln!(out, "{head}")?;
        let n_columns = names.len();
        let block = vec![0; BLOCK + n_columns * (WIDTH + 1) + PIECE];
        Ok(Self { out, head, block, filled: 0, last: vec![Field::EMPTY; n_columns], column: 0 })
    }

    /// Begins a line.
    ///
    /// # Errors
    /// When the table's `out` fails.
    pub fn begin(&mut self) -> io::Result<()> {
        self.column = 0;
        if self.filled < BLOCK {
            return Ok(());
        }
        self.out.write_all(&self.block[..std::mem::take(&mut self.filled)])
    }

    /// Writes the next fields: numbers.
    ///
    /// # Errors
    /// When one of them is not finite.
    #[inline]
    pub fn numbers(&mut self, values: &[f64]) -> Result<(), NotFinite> {
        // All at once is faster than one after the other.
        if !values.iter().fold(true, |all, value| all & value.is_finite()) {
            return Err(self.not_finite(values));
        }
        self.fields(values);
        Ok(())
    }

    /// Writes the next fields: numbers, or nothing where a value is NaN.
    ///
    /// # Errors
    /// When a value is infinite.
    #[inline]
    pub fn numbers_or_nothing(&mut self, values: &[f64]) -> Result<(), NotFinite> {
        if values.iter().fold(false, |any, value| any | value.is_infinite()) {
            return Err(self.not_finite(&values.iter().map(|value| if value.is_nan() { 0.0 } else { *value }).collect::<Vec<_>>()));
        }
        self.fields(values);
        Ok(())
    }

    fn not_finite(&self, values: &[f64]) -> NotFinite {
        let at = values.iter().position(|value| !value.is_finite()).expect("one is not");
        let name = self.head.split(',').nth(self.column + at).expect("every field has a column");
        NotFinite { path: name.to_owned(), value: values[at] }
    }

    /// All texts are made before the first is copied into the block: a processor waits where it
    /// reads in one piece what was just written in several.
    fn fields(&mut self, values: &[f64]) {
        let fields = &mut self.last[self.column..][..values.len()];
        self.column += values.len();
        for (field, value) in fields.iter_mut().zip(values) {
            if field.bits != value.to_bits() {
                let mut buffer = zmij::Buffer::new();
                let text = if value.is_nan() { "" } else { buffer.format_finite(*value) };
                put(text.as_bytes(), &mut field.text);
                field.text[text.len()] = b',';
                (field.bits, field.length) = (value.to_bits(), text.len() + 1);
            }
        }
        for field in fields {
            self.block[self.filled..][..PIECE].copy_from_slice(&field.text);
            self.filled += field.length;
        }
    }

    /// Writes the next field: a whole number.
    pub fn count(&mut self, value: usize) {
        let n_digits = if value < 10 { 1 } else { value.ilog10() as usize + 1 };
        let mut rest = value;
        for digit in self.block[self.filled..][..n_digits].iter_mut().rev() {
            *digit = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        self.filled += n_digits;
        self.part();
    }

    /// Writes the next field: a word of at most 24 letters that needs no quotes.
    pub fn word(&mut self, word: &str) {
        self.block[self.filled..][..word.len()].copy_from_slice(word.as_bytes());
        self.filled += word.len();
        self.part();
    }

    /// Leaves the next fields empty.
    pub fn nothing(&mut self, n_fields: usize) {
        (0..n_fields).for_each(|_| self.part());
    }

    fn part(&mut self) {
        self.block[self.filled] = b',';
        self.filled += 1;
        self.column += 1;
    }

    /// Ends the line in place of the last field's comma.
    pub fn end(&mut self) {
        self.block[self.filled - 1] = b'\n';
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// When the table's `out` fails.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.write_all(&self.block[..self.filled])?;
        self.out.flush()?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of a table, each written by `fields` from its number.
    fn table(n_columns: usize, n_rows: usize, fields: impl Fn(&mut Lines<&mut Vec<u8>>, usize)) -> String {
        let mut out = Vec::new();
        let mut lines = Lines::new(&mut out, &vec![""; n_columns]).unwrap();
        for row in 0..n_rows {
            lines.begin().unwrap();
            fields(&mut lines, row);
            lines.end();
        }
        lines.finish().unwrap();
        String::from_utf8(out).unwrap().split_once('\n').unwrap().1.to_owned()
    }

    #[test]
    fn fields_are_the_shortest_text_and_repeat_only_what_is_the_same_bits() {
        // A shorter number after a longer one, zero after minus zero, and a gap in between.
        let rows = [[-f64::MIN_POSITIVE, 0.0], [0.1, -0.0], [0.1, f64::NAN], [1e-7, -0.0], [1e20, 2.0], [5e-324, 2.5e-5]];
        let text = table(2, rows.len(), |lines, row| lines.numbers_or_nothing(&rows[row]).unwrap());
        let lines = ["-2.2250738585072014e-308,0.0", "0.1,-0.0", "0.1,", "1e-7,-0.0", "1e+20,2.0", "5e-324,0.000025"];
        assert_eq!(text, format!("{}\n", lines.join("\n")));
    }

    #[test]
    fn many_numbers_are_written_as_one_by_one() {
        // Every third column stays as it is above, every seventh is missing now and then.
        let n_columns = 21;
        let value = |row: usize, column: usize| match (column % 3, column % 7) {
            (_, 0) if row % 4 == 1 => f64::NAN,
            (0, _) => column as f64 + 0.1,
            // Now and then a whole line stays.
            _ => ((row - row % 3 / 2) * n_columns + column) as f64 / 7.0 - 40.0,
        };
        let together = table(n_columns, 800, |lines, row| {
            lines.numbers_or_nothing(&(0..n_columns).map(|column| value(row, column)).collect::<Vec<_>>()).unwrap();
        });
        let one_by_one = table(n_columns, 800, |lines, row| {
            for column in 0..n_columns {
                match value(row, column) {
                    value if value.is_nan() => lines.nothing(1),
                    value => lines.numbers(&[value]).unwrap(),
                }
            }
        });
        assert!(together == one_by_one && together.len() > 2 * BLOCK);
        for (row, line) in together.lines().enumerate() {
            let is_there = |(column, field): (usize, &str)| match value(row, column) {
                value if value.is_nan() => field.is_empty(),
                value => field.parse() == Ok(value),
            };
            assert!(line.split(',').enumerate().all(is_there), "{row}: {line}");
        }
    }

    #[test]
    fn a_number_that_comes_back_after_a_block_without_it_is_itself() {
        // Of other length than what has been written over it since.
        let text = table(2, 10_000, |lines, row| {
            lines.numbers_or_nothing(&[1.5 / (row + 1) as f64, if row % 9_999 == 0 { 12_345.678 } else { f64::NAN }]).unwrap();
        });
        assert!(text.len() > 2 * BLOCK);
        assert_eq!((text.lines().next(), text.lines().last()), (Some("1.5,12345.678"), Some("0.00015,12345.678")));
    }

    #[test]
    fn counts_have_all_their_digits_and_words_stand_as_they_are() {
        let counts = [0, 9, 10, 99, 100, usize::MAX];
        let text = table(2, counts.len(), |lines, row| {
            lines.count(counts[row]);
            lines.word("release");
        });
        assert_eq!(text, counts.map(|count| format!("{count},release\n")).concat());
    }
}
