//! What inertia and the engine change: comparisons of runs, and an estimate from one run alone.

mod advice;
mod attribution;
pub mod compare;
pub mod estimate;
mod expected_cost;
mod trigger;

pub use advice::{Advice, ExpectedTimes, Mode, Pull};
pub use expected_cost::{CostLimit, DEFAULT_SEEDS, ExpectedCost, fastest_rate};

pub use trigger::{ByTrigger, Trigger, TriggerKind};
