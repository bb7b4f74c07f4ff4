//! The stored counts and the rule by which new ones are held against them.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// What the hot paths may cost, and for which build that holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ceilings {
    /// What counts depend on altogether: counts of another build are not compared.
    pub build: String,
    /// What they depend on by some per cent: counts of another compiler are compared, and a failure
    /// names it.
    pub compiler: String,
    /// How far above its stored count a path may be (1). The same build repeats its counts exactly,
    /// so what this forgives is the allocator, sines and copies of another libc.
    pub margin: f64,
    /// By hot path, as counted when it was accepted.
    pub instructions_per_call: BTreeMap<String, u64>,
}

/// Margin of a file that is written for the first time (1).
pub const USUAL_MARGIN: f64 = 0.05;
/// Below this share of the stored count (1), a path has got so much faster that its ceiling would
/// let half of that go again unseen.
const WELL_BELOW: f64 = 0.9;

/// How a count compares with the stored one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// Above the ceiling: the path has become slower.
    Above,
    Within,
    /// A tenth or more below what is stored: the ceiling should come down.
    WellBelow,
    /// Nothing is stored under this name.
    NoCeiling,
}

impl Finding {
    /// Of a path that takes `count` instructions a call, where `stored` is on file.
    pub fn of(count: u64, stored: Option<u64>, margin: f64) -> Self {
        match stored {
            None => Finding::NoCeiling,
            Some(stored) if count > ceiling(stored, margin) => Finding::Above,
            Some(stored) if (count as f64) < WELL_BELOW * stored as f64 => Finding::WellBelow,
            Some(_) => Finding::Within,
        }
    }

    /// Whether it fails the check. A path without a ceiling does: renaming one must not drop its
    /// ceiling unseen.
    pub fn fails(self) -> bool {
        matches!(self, Finding::Above | Finding::NoCeiling)
    }
}

/// Most instructions that a path may take a call.
pub fn ceiling(stored: u64, margin: f64) -> u64 {
    (stored as f64 * (1.0 + margin)).floor() as u64
}

/// Why the file of ceilings cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CeilingsError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {source}", path.display())]
    Format { path: PathBuf, source: serde_json::Error },
    #[error("{}: margin: must be finite and not negative, found {found}", path.display())]
    Margin { path: PathBuf, found: f64 },
}

impl Ceilings {
    /// The ceilings on file; `None` when there is no file.
    ///
    /// # Errors
    /// When the file cannot be read or breaks the format.
    pub fn read(path: &Path) -> Result<Option<Self>, CeilingsError> {
        let text = match fs::read_to_string(path) {
            Err(source) if source.kind() == io::ErrorKind::NotFound => return Ok(None),
            text => text.map_err(|source| CeilingsError::Io { path: path.to_owned(), source })?,
        };
        let ceilings: Self = serde_json::from_str(&text).map_err(|source| CeilingsError::Format { path: path.to_owned(), source })?;
        if !(0.0..f64::INFINITY).contains(&ceilings.margin) {
            return Err(CeilingsError::Margin { path: path.to_owned(), found: ceilings.margin });
        }
        Ok(Some(ceilings))
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), CeilingsError> {
        let partial = path.with_extension("partial");
        let text = serde_json::to_string_pretty(self).map_err(|source| CeilingsError::Format { path: path.to_owned(), source })?;
        let written = fs::write(&partial, text + "\n").and_then(|()| fs::rename(&partial, path));
        written.map_err(|source| {
            // Failing twice is no worse than failing once.
            let _ = fs::remove_file(&partial);
            CeilingsError::Io { path: path.to_owned(), source }
        })
    }

    /// Takes over counts of the build and compiler that these ceilings are of. The others stay,
    /// unless `counts` are of all paths there are.
    pub fn accept(&mut self, counts: &BTreeMap<String, u64>, are_all: bool) {
        if are_all {
            self.instructions_per_call.clear();
        }
        self.instructions_per_call.extend(counts.iter().map(|(name, count)| (name.clone(), *count)));
    }
}
