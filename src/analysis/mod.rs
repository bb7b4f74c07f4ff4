//! What inertia and the engine change: comparisons of runs, and an estimate from one run alone.

mod attribution;
pub mod compare;
pub mod estimate;
mod trigger;

pub use trigger::{ByTrigger, Trigger, TriggerKind};
