//! What an interrupted command leaves beside its output folder, for the same command to go on from.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::CliError;

/// The file beside the folder `out`.
pub fn file_beside(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".state.json");
    out.with_file_name(name)
}

/// What is kept in a file; `None` where there is none.
pub fn read<S: DeserializeOwned>(file: &Path) -> Result<Option<S>, CliError> {
    let path = || file.to_owned();
    match fs::read_to_string(file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(CliError::File { path: path(), source }),
        Ok(text) => serde_json::from_str(&text).map(Some).map_err(|source| CliError::NotASavedRun { path: path(), source }),
    }
}

/// What the same command has left, by what `is_same` says of it; `None` where there is nothing.
pub fn saved<S: DeserializeOwned>(file: &Path, is_same: impl FnOnce(&S) -> bool) -> Result<Option<S>, CliError> {
    let Some(state) = read(file)? else { return Ok(None) };
    if !is_same(&state) {
        let what = "was left by another command or build; run that again, or remove the file";
        return Err(CliError::Usage(format!("{}: {what}", file.display())));
    }
    say!("goes on from {}", file.display());
    Ok(Some(state))
}

/// Keeps what is done, whole or not at all.
pub fn keep(file: &Path, state: &impl Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string(state).expect("what is done is plain data");
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let partial = file.with_file_name(format!(".{name}.partial-{}", std::process::id()));
    let write = || {
        fs::create_dir_all(file.parent().unwrap_or(Path::new("")))?;
        fs::write(&partial, text)?;
        fs::rename(&partial, file)
    };
    let kept = write().inspect_err(|_| drop(fs::remove_file(&partial)));
    kept.map_err(|source| CliError::File { path: file.to_owned(), source })
}

/// Ends an interrupted command, whose state is kept if there is a file for it.
pub fn interrupted(file: Option<&Path>, state: &impl Serialize) -> Result<ExitCode, CliError> {
    let Some(file) = file else { return Err(CliError::Interrupted) };
    keep(file, state)?;
    say!("stopped; the same command goes on from {}", file.display());
    Ok(ExitCode::from(130))
}

/// Removes the state of a command that is done.
pub fn remove(file: Option<PathBuf>) -> Result<(), CliError> {
    match file.filter(|file| file.exists()) {
        Some(file) => fs::remove_file(&file).map_err(|source| CliError::File { path: file, source }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_kept_whole_or_not_at_all() {
        let room = tempfile::tempdir().unwrap();
        let file = room.path().join("deep/run.json");
        for state in [vec![1.5], vec![2.5, 3.5]] {
            keep(&file, &state).unwrap();
            assert_eq!(saved(&file, |_: &Vec<f64>| true).unwrap(), Some(state));
        }
        // What cannot take its name is removed again.
        let taken = room.path().join("deep");
        assert!(matches!(keep(&taken, &0), Err(CliError::File { path, .. }) if path == taken));
        assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1);
    }
}
