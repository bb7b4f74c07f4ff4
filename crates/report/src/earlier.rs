//! What may stand where an output goes: an earlier output that its manifest tells from other files.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use twox_hash::XxHash3_128;

use crate::manifest::PROGRAM;
use crate::sibling::turn_at;
use cohaul::formats::{self, Found};

pub const MANIFEST: &str = "manifest.json";

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
    #[error("{}: {why}; move the folder away, or write to another", path.display())]
    OtherVersion { path: PathBuf, why: String },
    #[error("{}: is a link to what is not there; write to a folder, or to a link to one", path.display())]
    DanglingLink { path: PathBuf },
    #[error("{}: is a mount point, in whose place no folder can be put; write to a folder inside it", path.display())]
    MountPoint { path: PathBuf },
    #[error("{}: must be as it was written, found {found}; move the folder away, or write to another", path.display())]
    Changed { path: PathBuf, found: &'static str },
    #[error("{}: is or holds the working folder; write to a folder inside it", path.display())]
    WorkingFolder { path: PathBuf },
}

/// What was found in place of a file as it was written.
const CHANGED: &str = "another hash than its manifest's, so that it was changed since";

/// The part of a manifest that is read back.
#[derive(Deserialize)]
struct Earlier {
    /// `None` in a manifest that was written before there were versions.
    format: Option<Found>,
    program: String,
    files: BTreeMap<String, String>,
}

/// Whether an output may be written to `target`: it is missing, empty, or an earlier output that
/// holds nothing else, and whose files are as they were written. Changes nothing: ask before a long
/// run.
///
/// # Errors
/// When it may not.
pub fn check_target(target: &Path) -> Result<(), FolderError> {
    let _turn = turn_at(target);
    check_in_turn(target)
}

pub(super) fn check_in_turn(target: &Path) -> Result<(), FolderError> {
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
    let names = fs::read_dir(target).and_then(|all| all.map(|entry| Ok(entry?.file_name())).collect::<io::Result<Vec<_>>>());
    let names = names.map_err(at(target))?;
    if names.is_empty() {
        return Ok(());
    }
    let earlier = earlier_output(target)?;
    let belongs = |name: &str| name == MANIFEST || earlier.files.contains_key(name);
    if let Some(foreign) = names.iter().find(|name| !name.to_str().is_some_and(belongs)) {
        return Err(FolderError::ForeignFile { path: target.join(foreign) });
    }
    // A file that the user removed is not lost with the others.
    let present = earlier.files.iter().map(|(name, hash)| (target.join(name), hash)).filter(|(path, _)| path.exists());
    for (path, hash) in present {
        if !path.is_file() || hash_of(&path).map_err(at(&path))? != *hash {
            return Err(FolderError::Changed { path, found: CHANGED });
        }
    }
    Ok(())
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
    let earlier = earlier_output(folder)?;
    for (name, hash) in &earlier.files {
        let path = folder.join(name);
        let found = match hash_of(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(FolderError::Changed { path, found: "nothing" }),
            found => found.map_err(at(&path))?,
        };
        if found != *hash {
            return Err(FolderError::Changed { path, found: CHANGED });
        }
    }
    Ok(())
}

/// Text of a file's hash, as a manifest has it.
fn hash_of(path: &Path) -> io::Result<String> {
    let mut hashed = Hashed(XxHash3_128::new());
    io::copy(&mut File::open(path)?, &mut hashed)?;
    Ok(in_text(hashed.0.finish_128()))
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

/// # Errors
/// When the folder has no manifest of this program, or one of a version that is not read.
fn earlier_output(folder: &Path) -> Result<Earlier, FolderError> {
    let text = fs::read(folder.join(MANIFEST)).ok();
    let earlier = text.and_then(|text| serde_json::from_slice(&text).ok()).filter(|earlier: &Earlier| earlier.program == PROGRAM);
    let earlier = earlier.ok_or_else(|| FolderError::Foreign { path: folder.to_owned() })?;
    let check = earlier.format.as_ref().map_or(Ok(()), |found| formats::MANIFEST.check_found(found));
    check.map_err(|why| FolderError::OtherVersion { path: folder.join(MANIFEST), why })?;
    Ok(earlier)
}

/// Text of a file's hash in a manifest. XXH3 detects a truncated or changed file as reliably as a
/// cryptographic hash, in far less time. It does not protect against forgery, which the unsigned
/// manifest could not do with any hash.
pub(super) fn in_text(hash: u128) -> String {
    format!("xxh128:{hash:032x}")
}

pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_owned();
    move |source| FolderError::Io { path, source }
}
