//! Lines of a CSV table of numbers, written as fast as numbers are turned into text.
//!
//! A number that is the one above it, to the last bit, takes its text from there: a load at rest repeats itself for thousands of lines. Text is collected in one
//! block of memory and goes out when that is full.

use std::io::{self, Write};

/// Bytes that go out together: few calls, and still in the processor's cache.
const BLOCK: usize = 1 << 16;

/// Longest text of a number: `-2.2250738585072014e-308`.
const WIDTH: usize = 24;

/// A table on its way to `out`.
pub struct Lines<W> {
    out: W,
    block: Vec<u8>,
    /// How much of the block is filled.
    filled: usize,
    /// The last number of each column in this block.
    above: Vec<Written>,
    column: usize,
}

/// A number that stands in the block.
#[derive(Clone, Copy)]
struct Written {
    bits: u64,
    at: usize,
    length: usize,
}

impl Written {
    /// Of no finite number.
    const NONE: Written = Written { bits: u64::MAX, at: 0, length: 0 };
}

/// Puts a text of at most [`WIDTH`] bytes at the beginning of `place`: two pieces of a fixed length that overlap are faster than one of any length.
fn put(text: &[u8], place: &mut [u8]) {
    let n = text.len();
    if n >= 16 {
        place[..16].copy_from_slice(&text[..16]);
        place[n - 8..n].copy_from_slice(&text[n - 8..]);
    } else if n >= 8 {
        place[..8].copy_from_slice(&text[..8]);
        place[n - 8..n].copy_from_slice(&text[n - 8..]);
    } else {
        place.iter_mut().zip(text).for_each(|(place, byte)| *place = *byte);
    }
}

impl<W: Write> Lines<W> {
    pub fn new(out: W, n_columns: usize) -> Self {
        let block = vec![0; BLOCK + n_columns * (WIDTH + 1)];
        Self { out, block, filled: 0, above: vec![Written::NONE; n_columns], column: 0 }
    }

    /// Names need no quotes.
    pub fn head(&mut self, names: &[String]) -> io::Result<()> {
        writeln!(self.out, "{}", names.join(","))
    }

    pub fn begin(&mut self) -> io::Result<()> {
        self.column = 0;
        if self.filled < BLOCK {
            return Ok(());
        }
        self.above.fill(Written::NONE);
        self.out.write_all(&self.block[..std::mem::take(&mut self.filled)])
    }

    /// The next field of a line: a finite number.
    pub fn number(&mut self, value: f64) {
        let above = &mut self.above[self.column];
        if above.bits == value.to_bits() {
            // All that a number may take, as that is faster than a part of unknown length; what follows the number is overwritten.
            self.block.copy_within(above.at..above.at + WIDTH, self.filled);
        } else {
            let mut number = zmij::Buffer::new();
            let text = number.format_finite(value).as_bytes();
            put(text, &mut self.block[self.filled..self.filled + WIDTH]);
            (above.bits, above.length) = (value.to_bits(), text.len());
        }
        above.at = self.filled;
        self.filled += above.length;
        self.part();
    }

    /// The next field: a whole number.
    pub fn count(&mut self, value: usize) {
        let field = &mut self.block[self.filled..];
        let room = field.len();
        let mut rest = field;
        write!(rest, "{value}").expect("a line has room for it");
        self.filled += room - rest.len();
        self.part();
    }

    /// Empty fields.
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

    pub fn finish(mut self) -> io::Result<()> {
        self.out.write_all(&self.block[..self.filled])?;
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(rows: &[[f64; 2]]) -> String {
        let mut out = Vec::new();
        let mut lines = Lines::new(&mut out, 3);
        lines.head(&["a", "b", "n"].map(str::to_owned)).unwrap();
        for (row, [a, b]) in rows.iter().enumerate() {
            lines.begin().unwrap();
            lines.number(*a);
            if b.is_nan() {
                lines.nothing(1)
            } else {
                lines.number(*b)
            }
            lines.count(row);
            lines.end();
        }
        lines.finish().unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn fields_are_the_shortest_text_and_repeat_only_what_is_the_same_bits() {
        // A shorter number after a longer one, zero after minus zero, and a gap in between.
        let text = written(&[[-f64::MIN_POSITIVE, 0.0], [0.1, -0.0], [0.1, f64::NAN], [1e-7, -0.0], [1e20, 2.0], [5e-324, 2.5e-5]]);
        let lines = ["-2.2250738585072014e-308,0.0,0", "0.1,-0.0,1", "0.1,,2", "1e-7,-0.0,3", "1e+20,2.0,4", "5e-324,0.000025,5"];
        assert_eq!(text, format!("a,b,n\n{}\n", lines.join("\n")));
    }

    #[test]
    fn blocks_join_without_a_seam() {
        // Many blocks of lines that all have another length than a power of two.
        let rows: Vec<[f64; 2]> = (0..20_000).map(|k| [f64::from(k).sqrt(), f64::from(k % 7)]).collect();
        let text = written(&rows);
        assert!(text.len() > 6 * BLOCK);
        let mut n = 0;
        for ((k, [a, b]), line) in rows.iter().enumerate().zip(text.lines().skip(1)) {
            let fields: Vec<&str> = line.split(',').collect();
            assert_eq!((fields[0].parse(), fields[1].parse(), fields[2].parse()), (Ok(*a), Ok(*b), Ok(k)));
            n += 1;
        }
        assert_eq!(n, rows.len());
    }
}
