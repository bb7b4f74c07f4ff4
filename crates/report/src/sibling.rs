//! Writing beside a target first, so that nothing is ever half written at the target itself, and
//! how processes that write to the same target keep out of each other's way.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, TempDir};

/// A hidden folder that becomes an output. Dropped before that it leaves nothing.
#[derive(Debug)]
pub struct Partial {
    pub folder: TempDir,
    /// Says that a process works in the folder; none where folders have no locks.
    _lock: Option<File>,
}

impl Partial {
    const ROLE: &str = "partial";

    /// A new folder beside `target`; folders that killed processes left there are removed.
    pub fn beside(target: &Path) -> io::Result<Self> {
        Self::remove_abandoned(target);
        loop {
            let folder = folder_beside(target, Self::ROLE)?;
            let lock = lock(folder.path());
            // Another process that removes abandoned folders may have been faster than the lock.
            if folder.path().exists() && !matches!(lock, Err(TryLockError::WouldBlock)) {
                return Ok(Self { folder, _lock: lock.ok() });
            }
        }
    }

    /// Removes the folders in which no process works any more. One that cannot be locked or removed
    /// does no harm.
    fn remove_abandoned(target: &Path) {
        let start = prefix(target, Self::ROLE);
        for entry in fs::read_dir(parent(target)).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(&start)
                && let Ok(_lock) = lock(&entry.path())
            {
                drop(fs::remove_dir_all(entry.path()));
            }
        }
    }
}

/// Waits for other processes that look at or replace what stands beside `target`, and makes them
/// wait until the file is dropped; `None` where folders have no locks.
pub fn turn_at(target: &Path) -> Option<File> {
    File::open(parent(target)).ok().filter(|folder| folder.lock().is_ok())
}

/// Writes a file through `content`, completely or not at all, in place of an earlier one. Its
/// folder is made where it is missing.
///
/// # Errors
/// When `content` or the disk fails. The earlier file is then as it was.
pub fn write_whole<E: From<io::Error>>(path: &Path, content: impl FnOnce(&mut File) -> Result<(), E>) -> Result<(), E> {
    fs::create_dir_all(parent(path))?;
    let mut file = open_to_all(Builder::new().prefix(&prefix(path, Partial::ROLE)), 0o666).tempfile_in(parent(path))?;
    content(file.as_file_mut())?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| E::from(error.error)).map(drop)
}

/// A new empty hidden folder beside `target`, named after it.
pub fn folder_beside(target: &Path, role: &str) -> io::Result<TempDir> {
    open_to_all(Builder::new().prefix(&prefix(target, role)), 0o777).tempdir_in(parent(target))
}

/// Permissions as of any new file, and not for the owner alone; the system takes away what it is
/// told to.
#[cfg(unix)]
fn open_to_all<'a, 'b, 'c>(builder: &'c mut Builder<'a, 'b>, mode: u32) -> &'c mut Builder<'a, 'b> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn open_to_all<'a, 'b, 'c>(builder: &'c mut Builder<'a, 'b>, _: u32) -> &'c mut Builder<'a, 'b> {
    builder
}

/// Locks a folder until the file is dropped.
fn lock(folder: &Path) -> Result<File, TryLockError> {
    let file = File::open(folder).map_err(TryLockError::Error)?;
    file.try_lock().map(|()| file)
}

fn parent(target: &Path) -> PathBuf {
    let parent = target.parent().filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new(".")).to_owned()
}

/// Beginning of the names of what stands beside `target` in this role.
fn prefix(target: &Path, role: &str) -> String {
    format!(".{}.{role}-", target.file_name().unwrap_or_default().to_string_lossy())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_as_it_was() {
        use std::io::Write;
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("deep/a.json");
        write_whole(&path, |file| file.write_all(b"one")).unwrap();
        let failed = write_whole(&path, |file| file.write_all(b"tw").and(Err(io::Error::other("power cut"))));
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"one");
        assert_eq!(fs::read_dir(room.path().join("deep")).unwrap().count(), 1);
        // A folder cannot be replaced by a file.
        assert!(write_whole(&room.path().join("deep"), |file| file.write_all(b"one")).is_err());
        assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1);
    }
}
