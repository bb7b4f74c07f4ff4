//! The state of a backend as JSON, and why it cannot be saved or restored.

use std::fmt::Display;

use serde::{Deserialize, Serialize};

use crate::backend::numerics::LARGEST_ENTRY;
use crate::model::Motion;
use crate::scenario::cut;

/// State of a backend as a JSON value. Floats keep all their digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SavedState(pub serde_json::Value);

impl SavedState {
    /// State with the fields of `state`. A number that is not finite becomes `null`, which cannot
    /// be restored.
    ///
    /// # Panics
    /// When JSON cannot hold `state`.
    pub fn of<T: Serialize>(state: &T) -> Self {
        SavedState(serde_json::to_value(state).expect("a backend's state is plain data"))
    }

    /// # Errors
    /// When the value has another shape than `T`.
    pub fn read<T: for<'de> Deserialize<'de>>(&self) -> Result<T, RestoreError> {
        T::deserialize(&self.0).map_err(RestoreError::unreadable)
    }
}

/// Refusal of a backend or a controller to be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this backend or controller cannot be saved")]
pub struct SaveError;

/// Reason why a saved state cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("saved state does not fit this run: {0}")]
pub struct RestoreError(pub String);

impl RestoreError {
    /// For a state that is no data of the kind that was saved. The error may quote a text of any
    /// length from a file.
    pub fn unreadable(error: impl Display) -> Self {
        const LONGEST: usize = 500;
        Self(cut(error.to_string(), LONGEST))
    }

    /// # Errors
    /// When a restored motion is none to compute with.
    pub(in crate::backend) fn check_motion(motion: &Motion) -> Result<(), Self> {
        let far = motion.entries().into_iter().find(|entry| entry.abs() > LARGEST_ENTRY);
        far.map_or(Ok(()), |entry| Err(Self(format!("a motion with the entry {entry:e}"))))
    }
}
