//! A part of the cells, finished: one file that is there whole or not at all. Several of them, each
//! cell in exactly one, are one table.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use sha2::{Digest, Sha256};

use super::column::Table;
use super::error::SweepError;
use super::plan::{FORMAT, Identity};
use crate::journal::{Header, Journal, JournalError, at, at_reading, marked, task_of, unmarked};
use cohaul_report::sibling::write_whole;

/// Part `index` of `n`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    pub index: u64,
    pub n: u64,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let part = text.split_once('/').and_then(|(index, n)| Some(Self { index: index.parse().ok()?, n: n.parse().ok()? }));
        part.filter(|part| (1..=part.n).contains(&part.index)).ok_or_else(|| format!("must be I/N from 1/N to N/N, found {text}"))
    }
}

impl Part {
    /// Its cells: parts differ by one cell at most.
    pub fn cells(&self, n_cells: u64) -> Range<u64> {
        let from = |index: u64| (u128::from(index) * u128::from(n_cells) / u128::from(self.n)) as u64;
        from(self.index - 1)..from(self.index)
    }

    /// Its name, such that names sort as parts do.
    pub fn name(&self) -> String {
        let width = self.n.to_string().len();
        format!("{:0width$}-of-{}", self.index, self.n)
    }

    /// The part of this name.
    pub fn of_name(name: &OsStr) -> Option<Self> {
        name.to_str()?.replacen("-of-", "/", 1).parse().ok()
    }
}

/// The last line of a finished shard: number of rows, and a hash of all before it.
fn end_of(n_rows: u64, hash: Sha256) -> String {
    let digits: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    format!("end {n_rows} {digits}")
}

/// Writes the rows of a complete journal to `path`, in order, all or nothing.
///
/// # Errors
/// When the disk fails.
pub fn finish_shard(path: &Path, header: &Header, journal: &Journal) -> Result<(), SweepError> {
    write_whole(path, |file| write_shard(file, header, journal)).map_err(|error| match error {
        SweepError::Io(source) => at(path)(source).into(),
        of_journal => of_journal,
    })
}

fn write_shard(file: &mut File, header: &Header, journal: &Journal) -> Result<(), SweepError> {
    let mut out = BufWriter::new(file);
    let (mut hash, mut n_rows) = (Sha256::new(), 0);
    let mut put = |line: &str| {
        hash.update(line);
        out.write_all(line.as_bytes())
    };
    put(&header.line())?;
    journal.visit(|row| {
        n_rows += 1;
        Ok::<_, SweepError>(put(&marked(row))?)
    })?;
    out.write_all(marked(&end_of(n_rows, hash)).as_bytes())?;
    Ok(out.flush()?)
}

/// Whether the finished shard at `path` is whole and belongs to what is asked; `false` when there
/// is none.
///
/// # Errors
/// When it belongs to another sweep, or is not whole.
pub fn verified(path: &Path, asked: &Header) -> Result<bool, SweepError> {
    if !path.exists() {
        return Ok(false);
    }
    asked.check(path, &Header::read(path)?)?;
    read_shard(path, &mut |_| Ok(()))?;
    Ok(true)
}

/// Shows the rows of one finished shard.
fn read_shard(path: &Path, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError> {
    let damaged = |n: u64| {
        let what = format!("line {n} is cut off or damaged; remove the file and run its shard again");
        SweepError::from(JournalError::unusable(path, what))
    };
    let mut reader = BufReader::with_capacity(1 << 16, File::open(path).map_err(at_reading(path))?);
    let (mut hash, mut line, mut n_lines) = (Sha256::new(), Vec::new(), 0u64);
    let header = Header::read(path)?;
    loop {
        line.clear();
        reader.read_until(b'\n', &mut line).map_err(at_reading(path))?;
        let text = unmarked(&line).ok_or_else(|| damaged(n_lines + 1))?;
        if text.starts_with("end ") {
            let is_right = text == end_of(n_lines - 1, hash) && n_lines - 1 == header.end - header.begin;
            return if is_right { Ok(()) } else { Err(damaged(n_lines + 1)) };
        }
        hash.update(&line);
        if n_lines > 0 {
            if task_of(text) != Some(header.begin + n_lines - 1) {
                return Err(damaged(n_lines + 1));
            }
            visit(text)?;
        }
        n_lines += 1;
    }
}

/// Finished shards that together are one table.
pub struct Shards {
    pub identity: Identity,
    /// In the order of their cells.
    pub paths: Vec<PathBuf>,
}

/// How many faults are named.
const MOST_FAULTS: usize = 20;

impl Shards {
    /// The shards in `sources`: files, or folders whose `shards` they are in.
    ///
    /// # Errors
    /// When a file is no shard, shards belong to different sweeps or programs, or a cell is missing
    /// or double: every fault, up to some number.
    pub fn gather(sources: &[PathBuf]) -> Result<Self, SweepError> {
        let (mut found, mut first, mut faults) = (Vec::new(), None::<Identity>, Vec::new());
        for path in shard_files(sources)? {
            let (sweep, cells) = Identity::read(&path)?;
            let identity = first.get_or_insert_with(|| sweep.clone());
            if *identity == sweep {
                found.push((cells.start, cells.end, path));
            } else if faults.len() < MOST_FAULTS {
                let differences = identity.differences(&sweep);
                faults.push(JournalError::Other { differences, path, study: "sweep".to_owned() }.to_string());
            }
        }
        let Some(identity) = first else {
            let sources: Vec<String> = sources.iter().map(|path| path.display().to_string()).collect();
            return Err(SweepError::Shards { faults: vec![format!("{}: no finished shard found", sources.join(", "))] });
        };
        if identity.format != FORMAT {
            faults = vec![format!("rows are of format {}, this program reads {FORMAT}", identity.format)];
        } else if faults.is_empty() {
            found.sort();
            faults = uncovered(identity.n_cells, &found);
        }
        if !faults.is_empty() {
            return Err(SweepError::Shards { faults });
        }
        Ok(Self { identity, paths: found.into_iter().map(|(.., path)| path).collect() })
    }
}

impl Table for Journal {
    fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError> {
        Journal::visit(self, visit)
    }
}

impl Table for Shards {
    fn visit(&self, visit: &mut dyn FnMut(&str) -> Result<(), SweepError>) -> Result<(), SweepError> {
        self.paths.iter().try_for_each(|path| read_shard(path, visit))
    }
}

/// Every finished shard that `sources` name: files, or folders whose `shards` they are in.
pub fn shard_files(sources: &[PathBuf]) -> Result<Vec<PathBuf>, SweepError> {
    let mut files = Vec::new();
    for source in sources {
        if !source.is_dir() {
            files.push(source.clone());
            continue;
        }
        let inner = source.join("shards");
        let folder = if inner.is_dir() { &inner } else { source };
        let mut inside = Vec::new();
        for entry in fs::read_dir(folder).map_err(at_reading(folder))? {
            let path = entry.map_err(at_reading(folder))?.path();
            if path.extension().is_some_and(|extension| extension == "rows") {
                inside.push(path);
            }
        }
        inside.sort();
        files.append(&mut inside);
    }
    Ok(files)
}

/// Cells that no shard has, and those that several have; `found` says where each begins and ends.
fn uncovered(n_cells: u64, found: &[(u64, u64, PathBuf)]) -> Vec<String> {
    let (mut faults, mut next, mut last) = (Vec::new(), 0, None::<&PathBuf>);
    for (begin, end, path) in found.iter().filter(|(begin, end, _)| begin < end) {
        if *begin > next {
            faults.push(format!("cells {next} to {} are missing", begin - 1));
        }
        if *begin < next {
            let (until, before) = (next.min(*end) - 1, last.unwrap_or(path).display());
            faults.push(format!("cells {begin} to {until} are double: in {before} and {}", path.display()));
        }
        if *end > next {
            (next, last) = (*end, Some(path));
        }
    }
    if next < n_cells {
        faults.push(format!("cells {next} to {} are missing", n_cells - 1));
    }
    faults.truncate(MOST_FAULTS);
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::plan::tests::identity;

    #[test]
    fn parts_cover_all_cells_once_and_are_alike() {
        for (n_cells, n) in [(10, 3), (2, 5), (1_000_000_007, 1000), (0, 2)] {
            let mut next = 0;
            for index in 1..=n {
                let cells = Part { index, n }.cells(n_cells);
                assert_eq!(cells.start, next);
                assert!((n_cells / n..=n_cells.div_ceil(n)).contains(&(cells.end - cells.start)));
                next = cells.end;
            }
            assert_eq!(next, n_cells);
        }
        assert_eq!("7/100".parse::<Part>().unwrap().name(), "007-of-100");
        for text in ["0/3", "4/3", "1", "1/0", "-1/2", "a/b"] {
            assert!(text.parse::<Part>().unwrap_err().contains("from 1/N to N/N"), "{text}");
        }
    }

    fn shard(folder: &Path, name: &str, identity: &Identity, cells: Range<u64>) -> PathBuf {
        let header = identity.header(cells.clone()).unwrap();
        let mut journal = Journal::open(&folder.join(format!("{name}.journal")), &header).unwrap();
        cells.rev().for_each(|cell| journal.append(cell, &format!("{cell},row")).unwrap());
        let path = folder.join(format!("{name}.rows"));
        finish_shard(&path, &header, &journal).unwrap();
        path
    }

    #[test]
    fn cells_that_are_missing_or_double_are_named() {
        for (shards, faults) in [
            (&[(0, 2), (2, 4), (4, 6)][..], ""),
            (&[(0, 2), (4, 6)], "cells 2 to 3 are missing"),
            (&[(2, 4)], "cells 0 to 1 are missing\ncells 4 to 5 are missing"),
            (&[(0, 2), (2, 4), (2, 4), (4, 6)], "cells 2 to 3 are double: in 2.rows and 2.rows"),
            (&[(0, 2), (1, 5), (4, 6)], "cells 1 to 1 are double: in 0.rows and 1.rows\ncells 4 to 4 are double: in 1.rows and 4.rows"),
        ] {
            let found: Vec<_> = shards.iter().map(|(begin, end)| (*begin, *end, format!("{begin}.rows").into())).collect();
            assert_eq!(uncovered(6, &found).join("\n"), faults);
        }
        assert!(Shards::gather(&[]).err().unwrap().to_string().contains("no finished shard"));
    }

    #[test]
    fn a_shard_that_was_cut_or_changed_is_not_whole() {
        let room = tempfile::tempdir().unwrap();
        let identity = Identity { n_cells: 3, ..identity() };
        let path = shard(room.path(), "a", &identity, 0..3);
        let header = Header::read(&path).unwrap();
        assert!(verified(&path, &header).unwrap());
        assert!(!verified(&room.path().join("none.rows"), &header).unwrap());
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let without = |at: usize| lines.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, line)| *line).collect::<String>();
        for damaged in [without(2), without(4), text.replace("1,row", "1,raw"), text[..text.len() - 3].to_owned()] {
            fs::write(&path, damaged).unwrap();
            assert!(verified(&path, &header).unwrap_err().to_string().contains("cut off or damaged"));
        }
    }
}
