//! What a backend reports, in words that all of it uses. Nothing here knows how a load moves.

mod balance;
mod doubt;
mod ledger;
mod saved_state;
mod side_contact;
mod skips;
mod step_report;
mod transition;

pub use crate::model::Motion;
pub use balance::{Balance, judge_exact};
pub use doubt::{Doubts, PoseError};
pub use ledger::{DefectParts, EnergyLedger, closed_share};
pub use saved_state::{RestoreError, SaveError, SavedState};
pub use side_contact::SideContact;
pub use skips::{Skip, SkipCounts, Skips};
pub use step_report::{Status, StepReport};
pub use transition::{ImpactLaw, Transition, TransitionCounts, TransitionKind};
