//! Rest of a load, so that its next step is known without computing it.
//!
//! A step is a function of the state of the load, of the tips, and of a warm start that affects
//! rounding alone. If the load is at rest at both ends of a step in which no tip moved, the next
//! step is therefore the same again. At rest means that the state has not changed by a bit, or that
//! it has shifted by less than [`STILL_SHIFT`] at a speed that changes no force by more than
//! rounding: a million such steps add up to 1e-15 m. A load that creeps faster is not at rest.
//! Neither is one under the engine defaults, whose creep is part of the result.

use super::joints::BodyState;
use super::step::Step;
use crate::backend::numerics::{ROUNDED_SPEED, STILL_SHIFT};

/// Whether a load of this `radius` (m) was at rest in `step`, from the state `before` to the state
/// `after`.
pub fn is_at_rest(step: &Step, before: &BodyState, after: &BodyState, radius: f64) -> bool {
    if before == after {
        return true;
    }
    let shift = step.end.pose.position - step.start.pose.position;
    let turn = step.end.pose.heading - step.start.pose.heading;
    let is_slow = |body: &BodyState| body.velocity.amax().max(radius * body.turn_rate.abs()) <= ROUNDED_SPEED;
    shift.amax().max(radius * turn.abs()) <= STILL_SHIFT && is_slow(before) && is_slow(after)
}
