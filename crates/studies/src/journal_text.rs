//! Text of a journal: its lines with their marks, its header, and whole journals of one record.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use cohaul::formats::JOURNAL;
use cohaul::scenario::bounded::MOST_BYTES;
use cohaul::scenario::cut;
use cohaul_report::manifest::build_of_program;
use cohaul_report::sibling::write_whole;

/// Why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The disk fails.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// A file that was named cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// A record of one build is no record of another one.
    #[error("{}: was saved by another version of cohaul: {}; go on with that one, or remove the file", path.display(), differences.join("; "))]
    OtherBuild { path: PathBuf, differences: Vec<String> },
    /// The file is damaged, is in use, or is not a journal.
    #[error("{}: {what}", path.display())]
    Unusable { path: PathBuf, what: String },
    /// The journal was written for another question or by another build.
    #[error("{}: is of another {study}: {}; finish that one, or remove the file", path.display(), differences.join("; "))]
    Other { path: PathBuf, study: String, differences: Vec<String> },
}

impl JournalError {
    pub fn unusable(path: &Path, what: impl Into<String>) -> Self {
        Self::Unusable { path: path.to_owned(), what: what.into() }
    }
}

/// Adds the path of a file to an error of the system, for `map_err`.
pub fn at(path: &Path) -> impl FnOnce(io::Error) -> JournalError {
    let path = path.to_owned();
    move |source| JournalError::Io { path, source }
}

/// Adds the path of a file to an error of reading it, for `map_err`.
pub fn at_reading(path: &Path) -> impl FnOnce(io::Error) -> JournalError {
    let path = path.to_owned();
    move |source| JournalError::Unreadable { path, source }
}

/// What the records of a file belong to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Name of the study.
    pub study: String,
    /// Everything that a record depends on: the build, the question and the options.
    pub identity: Value,
    /// First task of the file.
    pub begin: u64,
    /// First task after those of the file.
    pub end: u64,
}

impl Header {
    /// Header of the tasks `range` of a study.
    ///
    /// # Panics
    /// When `identity` is not plain data.
    pub fn new(study: &str, identity: &impl Serialize, range: Range<u64>) -> Self {
        let identity = serde_json::to_value(identity).expect("an identity is plain data");
        Self { study: study.to_owned(), identity, begin: range.start, end: range.end }
    }

    /// The line of the header, with mark and end.
    pub fn line(&self) -> String {
        marked(&serde_json::to_string(self).expect("a header is plain data"))
    }

    pub(super) fn parse(line: &[u8]) -> Option<Self> {
        serde_json::from_str(unmarked(line)?).ok()
    }

    /// Header of the file at `path`.
    ///
    /// # Errors
    /// When the file cannot be read, or does not begin with a header.
    pub fn read(path: &Path) -> Result<Self, JournalError> {
        let mut file = BufReader::new(File::open(path).map_err(at_reading(path))?);
        Self::read_from(&mut file).map_err(at_reading(path))?.ok_or_else(|| not_a_journal(path))
    }

    /// The header at the beginning of a file; `None` if there is none.
    fn read_from(file: &mut impl BufRead) -> io::Result<Option<Self>> {
        let mut line = Vec::new();
        file.take(LONGEST).read_until(b'\n', &mut line)?;
        Ok(Self::parse(&line))
    }

    /// Compares the header that was `found` at `path` with this one.
    ///
    /// # Errors
    /// When the records belong to another question; the error lists the differences.
    pub fn check(&self, path: &Path, found: &Header) -> Result<(), JournalError> {
        let (study, mut differences) = if self.study == found.study {
            (self.study.clone(), differences(&self.identity, &found.identity))
        } else {
            ("study".to_owned(), vec![format!("it is {}, not {}", found.study, self.study)])
        };
        if differences.is_empty() && (self.begin, self.end) != (found.begin, found.end) {
            differences.push(format!("tasks are {} to {}, not {} to {}", found.begin, found.end, self.begin, self.end));
        }
        if differences.is_empty() { Ok(()) } else { Err(JournalError::Other { path: path.to_owned(), study, differences }) }
    }
}

pub(super) fn not_a_journal(path: &Path) -> JournalError {
    JournalError::unusable(path, "is not a journal that this version of cohaul reads; remove the file to begin again")
}

/// Keys whose values differ, each with the value that was `found` and the one `asked` for.
pub fn differences(asked: &Value, found: &Value) -> Vec<String> {
    let of = |value: &Value, key: &str| value.get(key).map_or_else(|| "absent".to_owned(), shortened);
    let keys: BTreeSet<&String> = [asked, found].into_iter().filter_map(Value::as_object).flat_map(|map| map.keys()).collect();
    let differing = keys.into_iter().filter(|key| asked.get(*key) != found.get(*key));
    differing.map(|key| format!("{key} is {}, not {}", of(found, key), of(asked, key))).collect()
}

fn shortened(value: &Value) -> String {
    const MOST: usize = 160;
    let text = value.to_string();
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// Largest size of a header (bytes): it holds a scenario at most.
const LONGEST: u64 = 2 * MOST_BYTES;

/// Longest reason of an error (characters). It may quote a text of any length from a file.
const LONGEST_REASON: usize = 500;
/// Digits of a line's hash, and the space behind them.
pub(super) const MARK: usize = 9;

/// Format of a journal, and the build of the program that writes it: a part of every identity.
pub fn build() -> Value {
    let (version, commit) = build_of_program();
    json!({ "format": JOURNAL.version, "version": version, "commit": commit })
}

/// Writes a journal of one record to `path`, completely or not at all.
///
/// # Errors
/// When the disk fails.
///
/// # Panics
/// When the record is not plain data.
pub fn save_single(path: &Path, study: &str, record: &impl Serialize) -> Result<(), JournalError> {
    let text = serde_json::to_string(record).expect("a record is plain data");
    let text = Header::new(study, &build(), 0..1).line() + &marked(&format!("0,{text}"));
    write_whole(path, |file| file.write_all(text.as_bytes())).map_err(at(path))
}

/// Reads the record of a journal that [`save_single`] wrote; `None` if there is no file.
///
/// # Errors
/// When the file cannot be read, is not a whole journal of such a record, or was written by another
/// build of the program.
pub fn load_single<R: DeserializeOwned>(path: &Path, study: &str) -> Result<Option<R>, JournalError> {
    let mut file = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        file => BufReader::new(file.map_err(at_reading(path))?),
    };
    let not_saved = |why: &str| JournalError::unusable(path, format!("is not a saved {study}{why}"));
    let nothing = || not_saved("; remove the file to begin again");
    let header = Header::read_from(&mut file).map_err(at_reading(path))?;
    let header = header.filter(|header| header.study == study).ok_or_else(nothing)?;
    let found = if header.identity.is_object() { header.identity } else { json!({}) };
    let differences = differences(&build(), &found);
    if !differences.is_empty() {
        return Err(JournalError::OtherBuild { path: path.to_owned(), differences });
    }
    let mut line = Vec::new();
    file.read_until(b'\n', &mut line).map_err(at_reading(path))?;
    let record = unmarked(&line).and_then(|line| line.strip_prefix("0,")).ok_or_else(nothing)?;
    serde_json::from_str(record).map(Some).map_err(|error| not_saved(&cut(format!(": {error}"), LONGEST_REASON)))
}

/// A line with its mark and end.
pub fn marked(text: &str) -> String {
    format!("{} {text}\n", mark(text))
}

/// Text of a whole line, or `None` if the line was cut off or damaged.
pub fn unmarked(line: &[u8]) -> Option<&str> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (found, text) = line.split_at_checked(MARK)?;
    (found.strip_suffix(' ') == Some(&mark(text))).then_some(text)
}

fn mark(text: &str) -> String {
    Sha256::digest(text)[..4].iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Number of the task that a record begins with.
pub fn task_of(record: &str) -> Option<u64> {
    record.split(',').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_record_is_written_whole_or_not_at_all() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("deep/run");
        assert_eq!(load_single::<Vec<f64>>(&file, "run").unwrap(), None);
        for state in [vec![1.5], vec![2.5, 0.1 + 0.2]] {
            save_single(&file, "run", &state).unwrap();
            assert_eq!(load_single(&file, "run").unwrap(), Some(state));
        }
        assert!(load_single::<Vec<f64>>(&file, "walk").unwrap_err().to_string().contains("is not a saved walk"));
        // What cannot take its name is removed again.
        let taken = room.path().join("deep");
        assert!(matches!(save_single(&taken, "run", &0), Err(JournalError::Io { path, .. }) if path == taken));
        assert_eq!(std::fs::read_dir(room.path()).unwrap().count(), 1);
    }

    /// As the program wrote them before records had a version, too.
    #[test]
    fn a_record_of_another_build_is_refused_by_name() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("run");
        let mut other = build();
        other["version"] = "0.0.9".into();
        for (identity, why) in [(other, "version is \"0.0.9\", not"), (Value::Null, "version is absent, not")] {
            std::fs::write(&file, Header::new("run", &identity, 0..1).line() + &marked("0,1")).unwrap();
            let error = load_single::<u32>(&file, "run").unwrap_err().to_string();
            assert!(error.contains("was saved by another version of cohaul: ") && error.contains(why), "{error}");
        }
        // What never ends is no header.
        let endless = load_single::<u32>(Path::new("/dev/zero"), "run");
        assert!(cfg!(not(unix)) || endless.unwrap_err().to_string().contains("is not a saved run"));
    }
}
