//! An output folder that appears complete or not at all.
//!
//! Files go into a hidden folder beside the target, which takes the target's name at the end. An
//! error before that removes the hidden folder and leaves the target as it was. The next output of
//! the same name removes what a killed process has left. `manifest.json` is written last and lists
//! every other file with its hash. A later run replaces a folder that matches its manifest, and
//! refuses to replace one with files of the user.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_128;

use crate::output::json;
use crate::output::manifest::Manifest;
use crate::output::manifest::PROGRAM;
use crate::output::sibling::{Partial, folder_beside, turn_at};

pub const MANIFEST: &str = "manifest.json";

/// Why an output folder was not written.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {source}", path.display())]
    Content { path: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("{}: is a file; an output folder needs a name of its own", path.display())]
    IsFile { path: PathBuf },
    #[error("{}: is not empty and no earlier output of this program: it has no {MANIFEST} of it", path.display())]
    Foreign { path: PathBuf },
    #[error("{}: is not part of the earlier output beside it; move it away, or write to another folder", path.display())]
    ForeignFile { path: PathBuf },
    #[error("{}: is a link to what is not there; write to a folder, or to a link to one", path.display())]
    DanglingLink { path: PathBuf },
    #[error("{}: is a mount point, in whose place no folder can be put; write to a folder inside it", path.display())]
    MountPoint { path: PathBuf },
    #[error("{}: must be as it was written, found {found}; move the folder away, or write to another", path.display())]
    Changed { path: PathBuf, found: &'static str },
    #[error("{}: is or holds the working folder; write to a folder inside it", path.display())]
    WorkingFolder { path: PathBuf },
}

/// A folder being written. Dropped before [`OutputFolder::finish`] it leaves nothing.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    partial: Partial,
    /// Whether every file is on the disk before the next one.
    is_synced: bool,
    /// Of each file written so far, as [`in_text`] has it.
    files: BTreeMap<String, String>,
    /// Folders above the target that were made for it, the innermost first.
    made: Vec<PathBuf>,
}

/// The manifest as written, and as much of it as is read back.
#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    manifest: &'a Manifest,
    files: &'a BTreeMap<String, String>,
}

#[derive(Deserialize)]
struct Earlier {
    program: String,
    files: BTreeMap<String, String>,
}

/// Whether an output may be written to `target`: it is missing, empty, or an earlier output that
/// holds nothing else. Changes nothing: ask before a long run.
///
/// # Errors
/// When it may not.
pub fn check_target(target: &Path) -> Result<(), FolderError> {
    let _turn = turn_at(target);
    check_in_turn(target)
}

fn check_in_turn(target: &Path) -> Result<(), FolderError> {
    let metadata = match fs::metadata(target) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            // Without a slash at its end, which stands for where a link leads.
            let is_link = fs::symlink_metadata(target.components().as_path()).is_ok();
            return if is_link { Err(FolderError::DanglingLink { path: target.to_owned() }) } else { Ok(()) };
        }
        other => other.map_err(at(target))?,
    };
    if !metadata.is_dir() {
        return Err(FolderError::IsFile { path: target.to_owned() });
    }
    let whole = fs::canonicalize(target).map_err(at(target))?;
    if std::env::current_dir().is_ok_and(|here| here.starts_with(&whole)) {
        return Err(FolderError::WorkingFolder { path: target.to_owned() });
    }
    if is_mount_point(&whole, &metadata) {
        return Err(FolderError::MountPoint { path: target.to_owned() });
    }
    let mut names = Vec::new();
    for entry in fs::read_dir(target).map_err(at(target))? {
        names.push(entry.map_err(at(target))?.file_name());
    }
    if names.is_empty() {
        return Ok(());
    }
    let earlier = earlier_output(target).ok_or_else(|| FolderError::Foreign { path: target.to_owned() })?;
    let belongs = |name: &str| name == MANIFEST || earlier.files.contains_key(name);
    match names.iter().find(|name| !name.to_str().is_some_and(belongs)) {
        Some(foreign) => Err(FolderError::ForeignFile { path: target.join(foreign) }),
        None => Ok(()),
    }
}

/// Whether another file system begins with this folder, as far as the system tells.
#[cfg(unix)]
fn is_mount_point(folder: &Path, metadata: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    folder.parent().and_then(|parent| fs::metadata(parent).ok()).is_none_or(|parent| parent.dev() != metadata.dev())
}

#[cfg(not(unix))]
fn is_mount_point(_: &Path, _: &fs::Metadata) -> bool {
    false
}

/// Whether all files of an earlier output are there as its manifest has them.
///
/// # Errors
/// When one of them is missing, cannot be read, or is another.
pub fn check_files(folder: &Path) -> Result<(), FolderError> {
    let earlier = earlier_output(folder).ok_or_else(|| FolderError::Foreign { path: folder.to_owned() })?;
    for (name, hash) in &earlier.files {
        let path = folder.join(name);
        let mut file = match File::open(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(FolderError::Changed { path, found: "nothing" }),
            file => file.map_err(at(&path))?,
        };
        let mut hashed = Hashed(XxHash3_128::new());
        io::copy(&mut file, &mut hashed).map_err(at(&path))?;
        if in_text(hashed.0.finish_128()) != *hash {
            return Err(FolderError::Changed { path, found: "another hash than its manifest's" });
        }
    }
    Ok(())
}

/// What is written to it is only hashed.
struct Hashed(XxHash3_128);

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn earlier_output(folder: &Path) -> Option<Earlier> {
    let text = fs::read(folder.join(MANIFEST)).ok()?;
    serde_json::from_slice(&text).ok().filter(|earlier: &Earlier| earlier.program == PROGRAM)
}

impl OutputFolder {
    /// Begins an output that will stand at `target`. Folders above it are made when they are
    /// missing.
    ///
    /// # Errors
    /// When [`check_target`] says no, or the folder beside the target cannot be made.
    pub fn create(target: &Path) -> Result<Self, FolderError> {
        check_target(target)?;
        // The folder itself, not a link to it, is what gets replaced.
        let target = fs::canonicalize(target).or_else(|_| std::path::absolute(target)).map_err(at(target))?;
        let parent = target.parent().ok_or_else(|| FolderError::Foreign { path: target.clone() })?;
        let made = parent.ancestors().take_while(|folder| !folder.exists()).map(Path::to_owned).collect();
        fs::create_dir_all(parent).map_err(at(parent))?;
        let partial = Partial::beside(&target).map_err(at(&target))?;
        Ok(Self { target, partial, is_synced: true, files: BTreeMap::new(), made })
    }

    /// The same without waiting for the disk, for what is sooner done again than waited for: whole
    /// or not at all whatever ends this process, but a machine that loses its power within the next
    /// half minute or so may keep files cut short. An earlier output is still replaced only by one
    /// that is on the disk.
    pub fn unsynced(mut self) -> Self {
        self.is_synced = self.target.exists();
        self
    }

    /// Writes one file through `content`.
    ///
    /// # Errors
    /// When `content` or the disk fails; the error names the file.
    ///
    /// # Panics
    /// As [`OutputFolder::open`] does.
    pub fn write<E>(&mut self, name: &str, content: impl FnOnce(&mut dyn Write) -> Result<(), E>) -> Result<(), FolderError>
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let mut out = self.open(name)?;
        content(&mut out).map_err(|error| self.in_content(name, error))?;
        self.close(out)
    }

    /// Writes `data` as indented JSON.
    ///
    /// # Errors
    /// When a number is not finite, or the disk fails; the error names the file.
    ///
    /// # Panics
    /// As [`OutputFolder::open`] does.
    pub fn write_json(&mut self, name: &str, data: &impl Serialize) -> Result<(), FolderError> {
        let text = json::pretty(data).map_err(|error| self.in_content(name, error))?;
        self.write(name, |out| out.write_all(text.as_bytes()))
    }

    /// Begins a file that is written piece by piece, until [`OutputFolder::close`].
    ///
    /// # Errors
    /// When the disk fails.
    ///
    /// # Panics
    /// When `name` is not a plain file name, is taken, or is the manifest's.
    pub fn open(&self, name: &str) -> Result<OutputFile, FolderError> {
        assert!(Path::new(name).file_name().is_some_and(|plain| plain == name), "{name:?} is a plain file name");
        assert!(name != MANIFEST && !self.files.contains_key(name), "{name} is written once");
        self.open_any(name)
    }

    /// Ends it, and lists it in the manifest.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn close(&mut self, file: OutputFile) -> Result<(), FolderError> {
        let (name, hash) = self.close_any(file)?;
        self.files.insert(name, hash);
        Ok(())
    }

    /// The error of who cannot go on writing the file of this name.
    pub fn in_content(&self, name: &str, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> FolderError {
        FolderError::Content { path: self.target.join(name), source: error.into() }
    }

    /// Writes the manifest and puts the folder in its place; an earlier output there is gone
    /// afterwards.
    ///
    /// # Errors
    /// When the disk fails. The target is then as it was.
    pub fn finish(mut self, manifest: &Manifest) -> Result<(), FolderError> {
        let text = json::pretty(&Listed { manifest, files: &self.files }).map_err(|error| self.in_content(MANIFEST, error))?;
        let mut file = self.open_any(MANIFEST)?;
        file.write_all(text.as_bytes()).map_err(at(&self.target.join(MANIFEST)))?;
        self.close_any(file)?;
        let _turn = turn_at(&self.target);
        // Again: somebody may have put a file there during the run.
        check_in_turn(&self.target)?;
        self.replace_target()
    }

    fn open_any(&self, name: &str) -> Result<OutputFile, FolderError> {
        let file = File::create(self.partial.folder.path().join(name)).map_err(at(&self.target.join(name)))?;
        Ok(OutputFile { name: name.to_owned(), hash: XxHash3_128::new(), file: BufWriter::new(file) })
    }

    /// Its name and its hash.
    fn close_any(&self, mut file: OutputFile) -> Result<(String, String), FolderError> {
        let synced = |file: &mut OutputFile| if self.is_synced { file.file.get_ref().sync_all() } else { Ok(()) };
        file.flush().and_then(|()| synced(&mut file)).map_err(at(&self.target.join(&file.name)))?;
        Ok((file.name, in_text(file.hash.finish_128())))
    }

    fn replace_target(&mut self) -> Result<(), FolderError> {
        let target = self.target.clone();
        if !target.exists() {
            return fs::rename(self.partial.folder.path(), &target).map_err(at(&target));
        }
        let aside = folder_beside(&target, "replaced").map_err(at(&target))?;
        fs::rename(&target, aside.path()).map_err(at(&target))?;
        // On failure the earlier output goes back to where it was.
        fs::rename(self.partial.folder.path(), &target).inspect_err(|_| drop(fs::rename(aside.path(), &target))).map_err(at(&target))?;
        aside.close().map_err(at(&target))
    }
}

impl Drop for OutputFolder {
    /// After a rename there is nothing left to remove, and the folders made for it are no longer
    /// empty.
    fn drop(&mut self) {
        drop(fs::remove_dir_all(self.partial.folder.path()));
        self.made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

/// A file of an output folder that is being written: through a buffer to the disk, hashed on the
/// way.
pub struct OutputFile {
    name: String,
    hash: XxHash3_128,
    file: BufWriter<File>,
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.hash.write(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Text of a file's hash in a manifest. XXH3 detects a truncated or changed file as reliably as a
/// cryptographic hash, in far less time. It does not protect against forgery, which the unsigned
/// manifest could not do with any hash.
fn in_text(hash: u128) -> String {
    format!("xxh128:{hash:032x}")
}

pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_owned();
    move |source| FolderError::Io { path, source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::manifest::tests::manifest;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn output(target: &Path, text: &str) -> Result<(), FolderError> {
        let mut folder = OutputFolder::create(target)?;
        folder.write("a.txt", |out| out.write_all(text.as_bytes()))?;
        folder.finish(&manifest())
    }

    #[test]
    fn an_output_is_whole_and_its_manifest_hashes_it() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("deep/out");
        output(&target, "one").unwrap();
        assert_eq!(names(&target), ["a.txt", MANIFEST]);
        assert_eq!(names(&room.path().join("deep")), ["out"]);
        let manifest: serde_json::Value = serde_json::from_slice(&fs::read(target.join(MANIFEST)).unwrap()).unwrap();
        assert_eq!(manifest["files"]["a.txt"], in_text(XxHash3_128::oneshot(b"one")));
        // The published hash of nothing, high half first as in `xxhsum -H2`.
        assert_eq!(in_text(XxHash3_128::oneshot(b"")), "xxh128:99aa06d3014798d86001c324468d497f");
        assert_eq!((&manifest["program"], &manifest["scenario"]["name"]), (&"cohaul".into(), &"four ants".into()));
    }

    #[test]
    fn an_error_in_the_middle_leaves_nothing_new_and_the_earlier_output_whole() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        for earlier in [None, Some("one")] {
            if let Some(text) = earlier {
                output(&target, text).unwrap();
            }
            let mut folder = OutputFolder::create(&target).unwrap();
            folder.write("a.txt", |out| out.write_all(b"two")).unwrap();
            let error = folder.write("b.txt", |out| out.write_all(b"half of it").and(Err(io::Error::other("power cut"))));
            drop(folder);
            let text = error.unwrap_err().to_string();
            assert!(text.contains("out/b.txt") && text.contains("power cut"), "{text}");
            assert_eq!(names(room.path()), earlier.map_or(vec![], |_| vec!["out".to_owned()]));
            assert_eq!(fs::read_to_string(target.join("a.txt")).ok().as_deref(), earlier);
        }
    }

    #[test]
    fn an_earlier_output_is_replaced_and_an_empty_folder_is_used() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        fs::create_dir(&target).unwrap();
        for text in ["one", "two"] {
            output(&target, text).unwrap();
            assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), text);
            assert_eq!(names(room.path()), ["out"]);
        }
    }

    #[test]
    fn what_is_not_an_earlier_output_stays() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        fs::write(&target, "mine").unwrap();
        assert!(matches!(output(&target, ""), Err(FolderError::IsFile { .. })));
        fs::remove_file(&target).unwrap();
        fs::create_dir(&target).unwrap();
        for manifest in [None, Some("{}"), Some(r#"{"program": "other", "files": {}}"#), Some("not json")] {
            fs::write(target.join("thesis.txt"), "mine").unwrap();
            if let Some(text) = manifest {
                fs::write(target.join(MANIFEST), text).unwrap();
            }
            assert!(matches!(output(&target, ""), Err(FolderError::Foreign { .. })), "{manifest:?}");
        }
        fs::remove_dir_all(&target).unwrap();
        output(&target, "one").unwrap();
        fs::write(target.join("notes.txt"), "mine").unwrap();
        let error = output(&target, "two").unwrap_err();
        assert!(matches!(&error, FolderError::ForeignFile { path } if path.ends_with("out/notes.txt")), "{error}");
        assert_eq!(names(&target), ["a.txt", MANIFEST, "notes.txt"]);
        assert_eq!(names(room.path()), ["out"]);
    }

    /// Of two at work on the same output neither loses its files to the other; of a killed one, and
    /// only of this output, nothing stays.
    #[test]
    fn what_a_killed_process_left_is_removed_and_what_a_living_one_writes_is_not() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        let left = [".out.partial-1-0", ".out.partial-1-1", ".outer.partial-1-0", ".out.replaced-1-0"];
        for name in left {
            fs::create_dir(room.path().join(name)).unwrap();
            fs::write(room.path().join(name).join("a.txt"), "half of").unwrap();
        }
        let mut living = OutputFolder::create(&target).unwrap();
        living.write("a.txt", |out| out.write_all(b"one")).unwrap();
        output(&target, "two").unwrap();
        living.finish(&manifest()).unwrap();
        assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), "one");
        assert_eq!(names(room.path()), [left[3], left[2], "out"]);
    }

    /// One after the other takes the place of the one before, whoever is faster, and nothing else
    /// stays.
    #[test]
    fn many_at_once_replace_each_other() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        std::thread::scope(|scope| {
            for writer in 0..4 {
                let target = &target;
                scope.spawn(move || (0..25).for_each(|round| output(target, &format!("{writer} {round}")).unwrap()));
            }
        });
        assert_eq!(names(room.path()), ["out"]);
        assert!(fs::read_to_string(target.join("a.txt")).unwrap().ends_with(" 24"));
        assert_eq!(names(&target), ["a.txt", MANIFEST]);
    }

    #[test]
    fn the_working_folder_is_not_pulled_away() {
        let here = std::env::current_dir().unwrap();
        for target in [here.as_path(), Path::new("."), Path::new("..")] {
            assert!(matches!(check_target(target), Err(FolderError::WorkingFolder { .. })), "{}", target.display());
        }
    }
}
