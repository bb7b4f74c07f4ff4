//! An output folder that appears complete or not at all.
//!
//! Files go into a hidden folder beside the target, which takes the target's name at the end. An
//! error before that removes the hidden folder and leaves the target as it was. The next output of
//! the same name removes what a killed process has left. `manifest.json` is written last and lists
//! every other file with its hash. A later run replaces a folder that matches its manifest, and
//! refuses to replace one with files of the user, or with files that were changed since.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use twox_hash::XxHash3_128;

pub use crate::earlier::{FolderError, MANIFEST, check_files, check_target};
use crate::earlier::{at, check_in_turn, in_text};
use crate::json;
use crate::manifest::Manifest;
use crate::sibling::{Partial, folder_beside, turn_at};
use cohaul::formats::{Versioned, stamped};

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

#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    manifest: &'a Manifest,
    files: &'a BTreeMap<String, String>,
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
    pub fn write<E>(&mut self, name: &str, content: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), E>) -> Result<(), FolderError>
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let mut out = self.open(name)?;
        content(&mut out).map_err(|error| self.in_content(name, error))?;
        self.close(out)
    }

    /// Writes `data` as indented JSON, with their format as the first key.
    ///
    /// # Errors
    /// When a number is not finite, or the disk fails; the error names the file.
    ///
    /// # Panics
    /// As [`OutputFolder::open`] does.
    pub fn write_json(&mut self, name: &str, data: &impl Versioned) -> Result<(), FolderError> {
        let text = json::pretty(&stamped(data)).map_err(|error| self.in_content(name, error))?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::manifest;

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

    #[test]
    fn an_output_that_was_edited_stays() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        output(&target, "one").unwrap();
        fs::write(target.join("a.txt"), "one, and what I think of it").unwrap();
        let error = output(&target, "two").unwrap_err();
        assert!(matches!(&error, FolderError::Changed { path, .. } if path.ends_with("out/a.txt")), "{error}");
        // Changed back, or removed, nothing of the user is lost.
        fs::write(target.join("a.txt"), "one").unwrap();
        output(&target, "two").unwrap();
        fs::remove_file(target.join("a.txt")).unwrap();
        output(&target, "three").unwrap();
        // An edit during a run counts as one before it.
        let mut folder = OutputFolder::create(&target).unwrap();
        folder.write("a.txt", |out| out.write_all(b"four")).unwrap();
        fs::write(target.join("a.txt"), "mine").unwrap();
        assert!(matches!(folder.finish(&manifest()), Err(FolderError::Changed { .. })));
        assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), "mine");
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
