//! How a duration is divided into steps.

use super::exact::Control;
use super::numerics::IGNORED_EXCESS;

/// How an exact backend divides an advance into steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// The fewest equal steps of at most this length (s).
    Fixed(f64),
    /// Macro-steps under error control.
    Controlled(Control),
}

/// Number of the fewest equal steps of at most `longest` (s) that make up `duration` (s). An excess
/// of 1e-9 of a step is ignored, so that a multiple of the step up to rounding is divided exactly.
pub fn n_steps_in(duration: f64, longest: f64) -> u64 {
    if duration <= (1.0 + IGNORED_EXCESS) * longest {
        return 1;
    }
    (duration / longest - IGNORED_EXCESS).ceil().max(1.0) as u64
}
