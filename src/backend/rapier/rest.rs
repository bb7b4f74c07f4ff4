//! When a load rests, so that its next step is known without making it.
//!
//! A step is a function of the load's state, of the tips and of nothing else but a warm start, which touches rounding alone. Where the load stood
//! at both ends of a step in which no tip moved, the next one therefore is the same again. Standing means that its state has not changed by a bit, or that it has
//! shifted by less than [`STILL`] at a speed that changes no force by more than rounding: a million such steps make 1e-15 m. A load that creeps faster is
//! never held, and neither is one under the settings as shipped, whose creep is what they are run for.

use super::joints::BodyState;
use super::step::Step;

/// Shift of the load, on its rim as well, in a step that does not count as one (m).
const STILL: f64 = 1e-21;
/// Speed, on the rim as well, that is rounding (m/s): a gram loses it in a millisecond to 1e-15 N.
const SLOWEST: f64 = 1e-15;

/// Whether a load of this `radius` (m) stood in `step`, from the state `before` to the state `after`.
pub fn stood(step: &Step, before: &BodyState, after: &BodyState, radius: f64) -> bool {
    if before == after {
        return true;
    }
    let shift = step.end.pose.position - step.start.pose.position;
    let turn = step.end.pose.heading - step.start.pose.heading;
    let is_slow = |body: &BodyState| body.velocity.amax().max(radius * body.turn_rate.abs()) <= SLOWEST;
    shift.amax().max(radius * turn.abs()) <= STILL && is_slow(before) && is_slow(after)
}
