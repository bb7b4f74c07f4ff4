//! Rows as they come, each on the file before the next: whatever ends the program, all rows but perhaps the last one are there, and no row is there twice.
//!
//! A file of text. Every line begins with eight digits of a hash of the rest of it, so that a line that was cut off, or that a disk has spoilt, is known. The first
//! line says what the sweep is; then comes a line a row, in the order in which runs ended. What follows the first bad line is dropped, and its cells run again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Table;
use super::error::{SweepError, at};
use super::plan::Identity;

/// What the rows of a file belong to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Always `cohaul sweep`.
    pub kind: String,
    pub sweep: Identity,
    /// The cells that belong here: from `begin` to before `end`.
    pub begin: u64,
    pub end: u64,
}

/// Most cells of one file: what it knows of each stays in memory.
const MOST_CELLS: u64 = 100_000_000;

impl Header {
    /// # Errors
    /// When there are too many cells for one file.
    pub fn check_size(&self) -> Result<(), SweepError> {
        let n_cells = self.end - self.begin;
        let rule = format!("must leave at most {MOST_CELLS} runs to one part");
        if n_cells <= MOST_CELLS { Ok(()) } else { Err(SweepError::axis("--shard", rule, n_cells)) }
    }

    pub fn new(sweep: Identity, begin: u64, end: u64) -> Self {
        Self { kind: "cohaul sweep".to_owned(), sweep, begin, end }
    }
}

/// A file of rows that is being added to. While it is open no other process can open it.
pub struct Journal {
    path: PathBuf,
    file: File,
    begin: u64,
    /// Where the line of each cell stands, if it is there: offset and length of the row's text.
    places: Vec<Option<(u64, u32)>>,
    n_done: u64,
    length: u64,
    /// Bytes that were cut off or spoilt when the file was opened.
    pub n_dropped: u64,
}

/// Digits of a line's hash, and the space behind them.
const MARK: usize = 9;

impl Journal {
    /// The journal at `path`, new or as a stopped program has left it.
    ///
    /// # Errors
    /// When another process is at work on it, it belongs to another sweep or is no journal, or the disk fails.
    pub fn open(path: &Path, header: &Header) -> Result<Self, SweepError> {
        header.check_size()?;
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(at(path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::Error(source)) => return Err(at(path)(source)),
            Err(TryLockError::WouldBlock) => {
                let what = "another process is at work on it; wait for that, or give this one another folder or shard";
                return Err(SweepError::journal(path, what));
            }
        }
        let n_cells = (header.end - header.begin) as usize;
        let mut journal =
            Self { path: path.to_owned(), file, begin: header.begin, places: vec![None; n_cells], n_done: 0, length: 0, n_dropped: 0 };
        journal.recover(header)?;
        Ok(journal)
    }

    /// Adds the row of a cell, whole.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn append(&mut self, cell: u64, row: &str) -> Result<(), SweepError> {
        let line = marked(row);
        self.file.write_all(line.as_bytes()).map_err(at(&self.path))?;
        self.note(cell, row.len());
        Ok(())
    }

    pub fn has(&self, cell: u64) -> bool {
        self.places[(cell - self.begin) as usize].is_some()
    }

    pub fn n_done(&self) -> u64 {
        self.n_done
    }

    pub fn is_complete(&self) -> bool {
        self.n_done == self.places.len() as u64
    }

    /// Puts everything on the disk.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), SweepError> {
        self.file.sync_all().map_err(at(&self.path))
    }

    /// Removes the file: its rows are elsewhere. Another process that finished the same rows may have removed it before.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn remove(self) -> Result<(), SweepError> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
            other => other.map_err(at(&self.path)),
        }
    }

    fn recover(&mut self, header: &Header) -> Result<(), SweepError> {
        let whole = self.file.metadata().map_err(at(&self.path))?.len();
        let mut reader = BufReader::new(self.file.try_clone().map_err(at(&self.path))?);
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line).map_err(at(&self.path))?;
        if line.last() == Some(&b'\n') {
            let found = parse_header(&line).ok_or_else(|| SweepError::journal(&self.path, "is no journal of a sweep"))?;
            check_header(&self.path, header, &found)?;
            self.length = line.len() as u64;
            self.read_rows(&mut reader)?;
        } else if !line.is_empty() && !header_line(header).as_bytes().starts_with(&line) {
            return Err(SweepError::journal(&self.path, "is no journal of a sweep"));
        }
        self.n_dropped = whole - self.length;
        self.file.set_len(self.length).map_err(at(&self.path))?;
        self.file.seek(SeekFrom::End(0)).map_err(at(&self.path))?;
        if self.length == 0 {
            let first = header_line(header);
            self.file.write_all(first.as_bytes()).map_err(at(&self.path))?;
            self.length = first.len() as u64;
        }
        Ok(())
    }

    /// All rows up to the first bad line.
    fn read_rows(&mut self, reader: &mut impl BufRead) -> Result<(), SweepError> {
        let mut line = Vec::new();
        loop {
            line.clear();
            reader.read_until(b'\n', &mut line).map_err(at(&self.path))?;
            let Some(row) = unmarked(&line) else { return Ok(()) };
            let Some(cell) = cell_of(row).filter(|cell| self.is_missing(*cell)) else { return Ok(()) };
            self.note(cell, row.len());
        }
    }

    fn is_missing(&self, cell: u64) -> bool {
        let at = cell.checked_sub(self.begin).and_then(|at| self.places.get(at as usize));
        at.is_some_and(Option::is_none)
    }

    fn note(&mut self, cell: u64, row_length: usize) {
        self.places[(cell - self.begin) as usize] = Some((self.length + MARK as u64, row_length as u32));
        self.n_done += 1;
        self.length += (MARK + row_length + 1) as u64;
    }
}

impl Table for Journal {
    fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError> {
        let mut file = BufReader::new(File::open(&self.path).map_err(at(&self.path))?);
        let (mut here, mut text) = (0u64, Vec::new());
        for (offset, length) in self.places.iter().flatten() {
            // Rows are nearly in order: most steps stay within the buffer.
            file.seek_relative(*offset as i64 - here as i64).map_err(at(&self.path))?;
            text.resize(*length as usize, 0);
            file.read_exact(&mut text).map_err(at(&self.path))?;
            here = offset + u64::from(*length);
            visit(std::str::from_utf8(&text).map_err(|_| SweepError::journal(&self.path, "was changed while it was read"))?)?;
        }
        Ok(())
    }
}

/// The first line of a file of rows.
///
/// # Errors
/// When it cannot be read, or is no such file.
pub fn header_of(path: &Path) -> Result<Header, SweepError> {
    let mut line = Vec::new();
    BufReader::new(File::open(path).map_err(at(path))?).read_until(b'\n', &mut line).map_err(at(path))?;
    parse_header(&line).ok_or_else(|| SweepError::journal(path, "is no file of rows of a sweep"))
}

/// Whether what was `found` at `path` belongs to what is asked.
pub fn check_header(path: &Path, asked: &Header, found: &Header) -> Result<(), SweepError> {
    let mut differences = asked.sweep.differences(&found.sweep);
    if differences.is_empty() && (asked.begin, asked.end) != (found.begin, found.end) {
        differences.push(format!("cells are {} to {}, not {} to {}", found.begin, found.end, asked.begin, asked.end));
    }
    if differences.is_empty() { Ok(()) } else { Err(SweepError::Other { path: path.to_owned(), differences }) }
}

pub fn header_line(header: &Header) -> String {
    marked(&serde_json::to_string(header).expect("a header is plain data"))
}

fn parse_header(line: &[u8]) -> Option<Header> {
    serde_json::from_str(unmarked(line)?).ok().filter(|header: &Header| header.kind == "cohaul sweep")
}

/// A line with its mark and end.
pub fn marked(text: &str) -> String {
    format!("{} {text}\n", mark(text))
}

/// The text of a whole line; `None` of one that is cut off or spoilt.
pub fn unmarked(line: &[u8]) -> Option<&str> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (found, text) = line.split_at_checked(MARK)?;
    (found.strip_suffix(' ') == Some(&mark(text))).then_some(text)
}

fn mark(text: &str) -> String {
    Sha256::digest(text)[..4].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The cell that a row begins with.
pub fn cell_of(row: &str) -> Option<u64> {
    row.split(',').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::sweep::plan::tests::identity;

    fn rows(journal: &Journal) -> Vec<String> {
        let mut rows = Vec::new();
        let keep = &mut |row: &str| {
            rows.push(row.to_owned());
            Ok(())
        };
        journal.visit(keep).unwrap();
        rows
    }

    /// Cut at every byte of the rows, and here and there in the first line: rows before the cut are kept, and those behind it run again to the same table.
    #[test]
    fn a_journal_cut_anywhere_goes_on_without_a_row_lost_or_doubled() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let header = Header::new(identity(), 2, 5);
        let all = ["2,two", "3,three, and ü", "4,four"];
        let mut journal = Journal::open(&path, &header).unwrap();
        for (cell, row) in [(3, all[1]), (2, all[0]), (4, all[2])] {
            journal.append(cell, row).unwrap();
        }
        assert!(journal.is_complete());
        assert_eq!(rows(&journal), all);
        drop(journal);
        let bytes = std::fs::read(&path).unwrap();
        let ends: Vec<usize> = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1).collect();
        for cut in (0..ends[0]).step_by(997).chain(ends[0] - 1..=bytes.len()) {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut journal = Journal::open(&path, &header).unwrap();
            let n_whole = ends.iter().filter(|end| **end <= cut).count();
            assert_eq!(journal.n_done(), n_whole.saturating_sub(1) as u64, "{cut}");
            assert_eq!(journal.n_dropped, (cut - ends[..n_whole].last().copied().unwrap_or(0)) as u64);
            for (cell, row) in (2..5).zip(all) {
                if !journal.has(cell) {
                    journal.append(cell, row).unwrap();
                }
            }
            assert_eq!(rows(&journal), all, "{cut}");
        }
    }

    #[test]
    fn a_spoilt_byte_costs_the_rows_from_there_on() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let header = Header::new(identity(), 0, 3);
        let mut journal = Journal::open(&path, &header).unwrap();
        for (cell, row) in [(0, "0,a"), (1, "1,b"), (2, "2,c")] {
            journal.append(cell, row).unwrap();
        }
        drop(journal);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("1,b", "1,x")).unwrap();
        let journal = Journal::open(&path, &header).unwrap();
        assert_eq!((journal.n_done(), rows(&journal)), (1, vec!["0,a".to_owned()]));
    }

    #[test]
    fn other_sweeps_other_files_and_other_processes_are_refused() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let header = Header::new(identity(), 0, 3);
        let journal = Journal::open(&path, &header).unwrap();
        let error = |header: &Header| Journal::open(&path, header).err().unwrap().to_string();
        assert!(error(&header).contains("another process is at work on it"));
        drop(journal);
        let other = Header::new(Identity { n_seeds: 9, ..identity() }, 0, 3);
        let text = error(&other);
        assert!(text.contains("is of another sweep: n_seeds is 2, not 9"), "{text}");
        std::fs::write(&path, "my thesis\n").unwrap();
        assert!(error(&header).contains("is no journal of a sweep"));
        std::fs::write(&path, "my thesis").unwrap();
        assert!(error(&header).contains("is no journal of a sweep"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "my thesis");
    }
}
