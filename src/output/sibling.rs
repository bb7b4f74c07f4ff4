//! Hidden folders beside a target, and how processes that write to the same one keep out of each other's way.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::output::folder::FolderError;
use crate::output::folder::at;

/// A hidden folder that becomes an output.
#[derive(Debug)]
pub struct Partial {
    pub path: PathBuf,
    /// Says that somebody is at work in it, for as long as that is so; none where folders have no locks.
    _lock: Option<File>,
}

impl Partial {
    const ROLE: &str = "partial";

    /// A new one beside `target`, where those of killed processes are removed.
    pub fn beside(target: &Path) -> Result<Self, FolderError> {
        Self::remove_abandoned(target);
        loop {
            let path = make_sibling(target, Self::ROLE)?;
            let lock = lock(&path);
            // Whoever else removes the abandoned may have been faster than the lock.
            if path.exists() && !matches!(lock, Err(TryLockError::WouldBlock)) {
                return Ok(Self { path, _lock: lock.ok() });
            }
        }
    }

    /// Removes those in which nobody is at work any more: who has finished meanwhile has none of this name, and nobody else will. What cannot be locked, or removed,
    /// does no harm.
    fn remove_abandoned(target: &Path) {
        let start = sibling_name(target, Self::ROLE);
        for entry in target.parent().and_then(|parent| fs::read_dir(parent).ok()).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(&start)
                && let Ok(_lock) = lock(&entry.path())
            {
                drop(fs::remove_dir_all(entry.path()));
            }
        }
    }
}

/// Waits for other processes that look at or replace what stands beside `target`, and lets them wait until it is dropped; `None` where folders have no locks.
pub fn turn_at(target: &Path) -> Option<File> {
    let folder = target.parent().map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent });
    folder.and_then(|folder| File::open(folder).ok()).filter(|folder| folder.lock().is_ok())
}

/// Locks a folder until the file is dropped.
fn lock(folder: &Path) -> Result<File, TryLockError> {
    let file = File::open(folder).map_err(TryLockError::Error)?;
    file.try_lock().map(|()| file)
}

/// A new empty hidden folder beside `target`, named after it and this process, with a name that no other had before it.
pub fn make_sibling(target: &Path, role: &str) -> Result<PathBuf, FolderError> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let sibling = target.with_file_name(format!("{}{}-{number}", sibling_name(target, role), std::process::id()));
        match fs::create_dir(&sibling) {
            // Of a killed process with the same id.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(at(&sibling)(error)),
            Ok(()) => return Ok(sibling),
        }
    }
}

/// What the names of hidden folders beside `target` begin with.
fn sibling_name(target: &Path, role: &str) -> String {
    format!(".{}.{role}-", target.file_name().unwrap_or_default().to_string_lossy())
}
