//! Instants at which the load's motion stops being smooth: it starts, stops, is caught on a support or comes free of it, or jumps.

use serde::{Deserialize, Serialize};

use super::friction::Regime;

/// One such instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// In a backend since the start of the advance, in a trace since the start of the run (s). Fixed steps name their end.
    pub time: f64,
    #[serde(flatten)]
    pub kind: TransitionKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "transition", rename_all = "snake_case")]
pub enum TransitionKind {
    /// The load begins to move, with all its supports or about one of them.
    Onset,
    /// It comes to rest.
    Stop,
    /// A support stops slipping, and the load turns about it.
    Capture { support: usize },
    /// The support that the load turned about, since its capture or since the onset, slips again.
    Freed { support: usize },
    /// A load without inertia moves a finite way in no time.
    Jump {
        /// Shift of the load's origin (m).
        shift: f64,
        /// (rad)
        turn: f64,
        /// Energy that a load with inertia would have got into motion (J).
        energy: f64,
    },
}

/// How many there were of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransitionCounts {
    pub n_onset: u64,
    pub n_stop: u64,
    pub n_capture: u64,
    pub n_freed: u64,
    pub n_jumps: u64,
    /// Largest shift in a jump (m); `None` without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_jump: Option<f64>,
}

impl TransitionCounts {
    pub fn add(&mut self, kind: &TransitionKind) {
        match kind {
            TransitionKind::Onset => self.n_onset += 1,
            TransitionKind::Stop => self.n_stop += 1,
            TransitionKind::Capture { .. } => self.n_capture += 1,
            TransitionKind::Freed { .. } => self.n_freed += 1,
            TransitionKind::Jump { shift, .. } => {
                self.n_jumps += 1;
                self.largest_jump = Some(self.largest_jump.map_or(*shift, |largest| largest.max(*shift)));
            }
        }
    }
}

impl TransitionKind {
    /// What happens where one regime follows another; `None` where nothing does.
    pub(super) fn between(before: Regime, after: Regime) -> Option<Self> {
        match (before, after) {
            (before, after) if before == after => None,
            (_, Regime::Stick) => Some(TransitionKind::Stop),
            (Regime::Stick, _) => Some(TransitionKind::Onset),
            (_, Regime::Pinned(support)) => Some(TransitionKind::Capture { support }),
            (Regime::Pinned(support), Regime::Slip) => Some(TransitionKind::Freed { support }),
            (Regime::Slip, Regime::Slip) => None,
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            TransitionKind::Onset => "onset",
            TransitionKind::Stop => "stop",
            TransitionKind::Capture { .. } => "capture",
            TransitionKind::Freed { .. } => "freed",
            TransitionKind::Jump { .. } => "jump",
        }
    }
}
