//! Journal of a study: one file that keeps every finished record, whatever ends the program.
//!
//! A journal is a text file that only grows. Every line begins with eight digits of a hash of the
//! rest of the line, so that a line that was cut off or damaged on the disk is recognised. The
//! first line is the [`Header`]: it says which study the records belong to. Every further line is
//! one record: the number of its task, a comma, and the content, in the order in which tasks ended.
//! What follows the first damaged line is dropped, and its tasks run again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use super::journal_text::{
    Header, JournalError, at, at_reading, build, differences, load_single, marked, save_single, task_of, unmarked,
};
use super::journal_text::{MARK, not_a_journal};

/// A journal that is open for new records. No other process can open it meanwhile.
pub struct Journal {
    path: PathBuf,
    file: File,
    range: Range<u64>,
    /// Offset and length of the record of each task, if it is there.
    places: Vec<Option<(u64, u32)>>,
    n_done: u64,
    length: u64,
    /// Bytes that were cut off or damaged when the file was opened.
    pub n_dropped: u64,
}

impl Drop for Journal {
    /// A program that another thread is starting holds a copy of the file until it runs. The lock
    /// would last as long if it ended with the last copy only.
    fn drop(&mut self) {
        // An error leaves the lock to the end of the last copy, as without this call.
        let _ = self.file.unlock();
    }
}

impl Journal {
    /// Opens the journal at `path`, which is new or was left by a program that was stopped.
    ///
    /// # Errors
    /// When another process uses it, it belongs to another question, it is not a journal, or the
    /// disk fails.
    pub fn open(path: &Path, header: &Header) -> Result<Self, JournalError> {
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(at(parent))?;
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(at(path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::Error(source)) => return Err(at(path)(source)),
            Err(TryLockError::WouldBlock) => {
                let what = "another process uses it; wait for that process, or choose another folder or shard";
                return Err(JournalError::unusable(path, what));
            }
        }
        let (path, range) = (path.to_owned(), header.begin..header.end);
        let mut journal = Self { path, file, range, places: Vec::new(), n_done: 0, length: 0, n_dropped: 0 };
        journal.recover(header)?;
        Ok(journal)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds the record of a task. The record begins with the task's number and a comma.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn append(&mut self, task: u64, record: &str) -> Result<(), JournalError> {
        debug_assert_eq!(task_of(record), Some(task));
        self.file.write_all(marked(record).as_bytes()).map_err(at(&self.path))?;
        self.note(task, record.len());
        Ok(())
    }

    /// Whether the record of a task is there.
    pub fn has(&self, task: u64) -> bool {
        self.places.get((task - self.range.start) as usize).is_some_and(Option::is_some)
    }

    /// Number of records.
    pub fn n_done(&self) -> u64 {
        self.n_done
    }

    /// Number of tasks without a record.
    pub fn n_left(&self) -> u64 {
        self.range.end - self.range.start - self.n_done
    }

    /// Writes everything through to the disk.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), JournalError> {
        self.file.sync_all().map_err(at(&self.path))
    }

    /// Removes the file once its records are elsewhere. A file that is already gone is no error.
    ///
    /// # Errors
    /// When the file cannot be removed.
    pub fn remove(self) -> Result<(), JournalError> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            other => other.map_err(at(&self.path)),
        }
    }

    /// Shows all records to `visit`, in the order of their tasks.
    ///
    /// # Errors
    /// When the file cannot be read, or `visit` fails.
    pub fn visit<E: From<JournalError>>(&self, mut visit: impl FnMut(&str) -> Result<(), E>) -> Result<(), E> {
        let mut file = BufReader::new(File::open(&self.path).map_err(at(&self.path))?);
        let (mut here, mut text) = (0u64, Vec::new());
        for (offset, length) in self.places.iter().flatten() {
            // Records are nearly in order: most seeks stay within the buffer.
            file.seek_relative(*offset as i64 - here as i64).map_err(at(&self.path))?;
            text.resize(*length as usize, 0);
            file.read_exact(&mut text).map_err(at(&self.path))?;
            here = offset + u64::from(*length);
            let changed = |_| JournalError::unusable(&self.path, "was changed while it was read");
            visit(std::str::from_utf8(&text).map_err(changed)?)?;
        }
        Ok(())
    }

    fn recover(&mut self, header: &Header) -> Result<(), JournalError> {
        let whole = self.file.metadata().map_err(at(&self.path))?.len();
        let mut reader = BufReader::new(self.file.try_clone().map_err(at(&self.path))?);
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line).map_err(at(&self.path))?;
        if line.last() == Some(&b'\n') {
            let found = Header::parse(&line).ok_or_else(|| not_a_journal(&self.path))?;
            header.check(&self.path, &found)?;
            self.length = line.len() as u64;
            self.read_records(&mut reader)?;
        } else if !header.line().as_bytes().starts_with(&line) {
            return Err(not_a_journal(&self.path));
        }
        self.n_dropped = whole - self.length;
        self.file.set_len(self.length).map_err(at(&self.path))?;
        self.file.seek(SeekFrom::End(0)).map_err(at(&self.path))?;
        if self.length == 0 {
            let first = header.line();
            self.file.write_all(first.as_bytes()).map_err(at(&self.path))?;
            self.length = first.len() as u64;
        }
        Ok(())
    }

    /// Reads all records up to the first damaged line.
    fn read_records(&mut self, reader: &mut impl BufRead) -> Result<(), JournalError> {
        let mut line = Vec::new();
        loop {
            line.clear();
            reader.read_until(b'\n', &mut line).map_err(at(&self.path))?;
            let Some(record) = unmarked(&line) else { return Ok(()) };
            let is_missing = |task: &u64| self.range.contains(task) && !self.has(*task);
            let Some(task) = task_of(record).filter(is_missing) else { return Ok(()) };
            self.note(task, record.len());
        }
    }

    fn note(&mut self, task: u64, length: usize) {
        let index = (task - self.range.start) as usize;
        if self.places.len() <= index {
            self.places.resize(index + 1, None);
        }
        self.places[index] = Some((self.length + MARK as u64, length as u32));
        self.n_done += 1;
        self.length += (MARK + length + 1) as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(n_seeds: u64, range: Range<u64>) -> Header {
        Header::new("sweep", &serde_json::json!({ "n_seeds": n_seeds, "step_s": 0.1 }), range)
    }

    fn records(journal: &Journal) -> Vec<String> {
        let mut records = Vec::new();
        let mut keep = |record: &str| -> Result<(), JournalError> {
            records.push(record.to_owned());
            Ok(())
        };
        journal.visit(&mut keep).unwrap();
        records
    }

    /// A child that is being started has such a copy until it runs.
    #[test]
    fn a_copy_of_the_file_elsewhere_does_not_keep_a_dropped_journal_locked() {
        let room = tempfile::tempdir().unwrap();
        let (path, header) = (room.path().join("journal"), header(2, 0..3));
        let journal = Journal::open(&path, &header).unwrap();
        let copy = journal.file.try_clone().unwrap();
        assert!(Journal::open(&path, &header).is_err(), "an open journal is not opened again");
        drop(journal);
        Journal::open(&path, &header).unwrap();
        drop(copy);
    }

    /// Cut at every byte of the records, and here and there in the first line: records before the
    /// cut are kept, and those behind it run again to the same table.
    #[test]
    fn a_journal_cut_anywhere_goes_on_without_a_record_lost_or_doubled() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let header = header(2, 2..5);
        let all = ["2,two", "3,three, and ü", "4,four"];
        let mut journal = Journal::open(&path, &header).unwrap();
        for (task, record) in [(3, all[1]), (2, all[0]), (4, all[2])] {
            journal.append(task, record).unwrap();
        }
        assert_eq!(journal.n_left(), 0);
        assert_eq!(records(&journal), all);
        drop(journal);
        let bytes = std::fs::read(&path).unwrap();
        let ends: Vec<usize> = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1).collect();
        for cut in (0..ends[0]).step_by(31).chain(ends[0] - 1..=bytes.len()) {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let mut journal = Journal::open(&path, &header).unwrap();
            let n_whole = ends.iter().filter(|end| **end <= cut).count();
            assert_eq!(journal.n_done(), n_whole.saturating_sub(1) as u64, "{cut}");
            assert_eq!(journal.n_dropped, (cut - ends[..n_whole].last().copied().unwrap_or(0)) as u64);
            for (task, record) in (2..5).zip(all) {
                if !journal.has(task) {
                    journal.append(task, record).unwrap();
                }
            }
            assert_eq!(records(&journal), all, "{cut}");
        }
    }

    #[test]
    fn a_damaged_byte_costs_the_records_from_there_on() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let mut journal = Journal::open(&path, &header(2, 0..3)).unwrap();
        for (task, record) in [(0, "0,a"), (1, "1,b"), (2, "2,c")] {
            journal.append(task, record).unwrap();
        }
        drop(journal);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("1,b", "1,x")).unwrap();
        let journal = Journal::open(&path, &header(2, 0..3)).unwrap();
        assert_eq!((journal.n_done(), records(&journal)), (1, vec!["0,a".to_owned()]));
    }

    #[test]
    fn other_questions_other_files_and_other_processes_are_refused() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("journal");
        let journal = Journal::open(&path, &header(2, 0..3)).unwrap();
        let error = |header: &Header| Journal::open(&path, header).err().unwrap().to_string();
        assert!(error(&header(2, 0..3)).contains("another process uses it"));
        drop(journal);
        let text = error(&header(9, 0..3));
        assert!(text.contains("is of another sweep: n_seeds is 2, not 9"), "{text}");
        assert!(error(&header(2, 0..4)).contains("tasks are 0 to 3, not 0 to 4"));
        assert!(error(&Header { study: "stress".into(), ..header(2, 0..3) }).contains("it is sweep, not stress"));
        for thesis in ["my thesis\n", "my thesis", "{\"asked\": 1}"] {
            std::fs::write(&path, thesis).unwrap();
            assert!(error(&header(2, 0..3)).contains("is not a journal that this version of cohaul reads"));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), thesis);
        }
    }
}
