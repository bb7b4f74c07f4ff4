//! What is known of the load's contact with the ground.

use serde::{Deserialize, Serialize};

use crate::backend::friction::ContactMode;
use crate::backend::report::TransitionKind;

/// Knowledge of the contact between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroundContact {
    /// A spring was attached or released since the step that ended in mode `last`. Forces changed
    /// by more than the tolerance of the friction solver if a jump is pending.
    Unknown { last: ContactMode, jump_is_pending: bool },
    /// The last step ended in this mode.
    Known(ContactMode),
    /// Load and tips stood still in the last step. The next step repeats it unless a tip moves.
    Settled(ContactMode),
}

impl GroundContact {
    /// Mode in which the last step ended.
    pub fn last(&self) -> ContactMode {
        match *self {
            Self::Unknown { last, .. } | Self::Known(last) | Self::Settled(last) => last,
        }
    }

    /// Mode in which the last step ended; `None` when a spring was attached or released since.
    pub fn known(&self) -> Option<ContactMode> {
        if matches!(self, Self::Unknown { .. }) { None } else { Some(self.last()) }
    }

    /// Transition from a step that ended in mode `before` to the last one; `None` where nothing
    /// happens.
    pub fn transition_from(&self, before: ContactMode) -> Option<TransitionKind> {
        match (before, self.last()) {
            (before, after) if before == after => None,
            (_, ContactMode::Stick) => Some(TransitionKind::Stop),
            (ContactMode::Stick, _) => Some(TransitionKind::SlipOnset),
            (_, ContactMode::Pinned(support)) => Some(TransitionKind::Pinning { support }),
            (ContactMode::Pinned(support), ContactMode::Slip) => Some(TransitionKind::Unpinning { support }),
            (ContactMode::Slip, ContactMode::Slip) => None,
        }
    }

    /// Takes note of an attached or released spring, which changes the forces if it `pulls`.
    pub fn disturb(&mut self, pulls: bool) {
        let was_pending = matches!(self, Self::Unknown { jump_is_pending: true, .. });
        *self = Self::Unknown { last: self.last(), jump_is_pending: pulls || was_pending };
    }

    /// Whether a jump is pending; it is not from now on.
    pub fn take_jump(&mut self) -> bool {
        match self {
            Self::Unknown { jump_is_pending, .. } => std::mem::take(jump_is_pending),
            _ => false,
        }
    }
}
