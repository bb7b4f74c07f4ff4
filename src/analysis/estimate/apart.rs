//! How far the shadow is and has been from the load without inertia, and what that comes from.

use serde::{Deserialize, Serialize};

use super::shadow::Shadow;
use crate::math::{Pose, Vec2, rotation};

/// Where the displacement is largest, and what it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Largest {
    pub time_s: f64,
    pub cause: Cause,
    /// Spring of the grasp or the release that made the load jump; left out for other causes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<usize>,
    /// Of that jump, or of the change of speed (s).
    pub since_s: f64,
}

/// What sets a load with inertia apart from one without.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// It started with speed.
    Start,
    /// A grasp left it out of balance.
    Grasp,
    /// A release did.
    Release,
    /// Tips set it going or stopped it.
    Driving,
}

/// What the present displacement comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Occasion {
    pub cause: Cause,
    pub spring: Option<usize>,
    pub time: f64,
}

/// A load from the beginning of a stretch of time to its end, without inertia and with.
pub(super) struct Both<'a> {
    pub load: [&'a Pose; 2],
    pub shadow: [&'a Shadow; 2],
    /// (s)
    pub duration: f64,
    /// Whether that is a small part of an oscillation.
    pub is_short: bool,
}

/// Shifts and turns of the shadow from the load without inertia (m, rad).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Apart {
    pub shift: f64,
    pub turn: f64,
    /// Largest shift plus radius times turn, by what it came from (m).
    pub from_start: f64,
    pub from_jumps: f64,
    pub from_driving: f64,
    pub largest: Option<Largest>,
}

/// No crest within a short time is this many times as high as both of its sides (1).
const HIGHER: f64 = 1.1;

impl Apart {
    /// Largest shift plus radius times turn (m).
    pub fn displacement_max(&self) -> f64 {
        self.from_start.max(self.from_jumps).max(self.from_driving)
    }

    /// Notes how far the two are at the `time` (s) at which the stretch ends, and on the way there.
    pub fn note(&mut self, both: &Both, radius: f64, time: f64, occasion: &Occasion) {
        let offsets = [0, 1].map(|end| both.offset(end));
        let [shifts, turns] = [offsets.map(|offset| offset.0.norm()), offsets.map(|offset| offset.1.abs())];
        (self.shift, self.turn) = (shifts[1], turns[1]);
        let so_far = self.displacement_max();
        let part = match occasion.cause {
            Cause::Start => &mut self.from_start,
            Cause::Grasp | Cause::Release => &mut self.from_jumps,
            Cause::Driving => &mut self.from_driving,
        };
        let (shift, turn) = (shifts[0].max(shifts[1]), turns[0].max(turns[1]));
        if HIGHER * (shift + radius * turn) <= *part {
            return;
        }
        let [shift, turn] = if both.is_short { both.crests(offsets) } else { [self.shift, self.turn] };
        let displacement = shift + radius * turn;
        *part = part.max(displacement);
        if displacement > so_far {
            let Occasion { cause, spring, time: since } = *occasion;
            self.largest = Some(Largest { time_s: time, cause, spring, since_s: since });
        }
    }
}

impl Both<'_> {
    /// Shift (m, world) and turn (rad) at an end.
    fn offset(&self, end: usize) -> (Vec2, f64) {
        let (shadow, load) = (&self.shadow[end].pose, self.load[end]);
        (shadow.position - load.position, shadow.heading - load.heading)
    }

    /// Largest shift and turn at the end or before, if they were past their crest by then.
    fn crests(&self, offsets: [(Vec2, f64); 2]) -> [f64; 2] {
        let [before, after] = self.load;
        let (way, turn) = ((after.position - before.position) / self.duration, (after.heading - before.heading) / self.duration);
        let rates = self.shadow.map(|shadow| {
            let twist = shadow.twist();
            (rotation(shadow.pose.heading) * twist.xy() - way, twist.z - turn)
        });
        let grows = |i: usize| offsets[i].0.dot(&rates[i].0) / offsets[i].0.norm().max(f64::MIN_POSITIVE);
        let turns = |i: usize| offsets[i].1.signum() * rates[i].1;
        [
            crest([offsets[0].0.norm(), offsets[1].0.norm()], [grows(0), grows(1)], self.duration),
            crest([offsets[0].1.abs(), offsets[1].1.abs()], [turns(0), turns(1)], self.duration),
        ]
    }
}

/// The last of two values, or the crest between them of the cubic that goes on from the first at one rate (1/s) and arrives at the last at another.
fn crest([first, last]: [f64; 2], rates: [f64; 2], duration: f64) -> f64 {
    let [leave, arrive] = rates.map(|rate| rate * duration);
    if !(leave > 0.0 && arrive < 0.0) {
        return last;
    }
    let (square, cube) = (3.0 * (last - first) - 2.0 * leave - arrive, 2.0 * (first - last) + leave + arrive);
    // The only place between at which it ceases to grow.
    let at = leave / ((square * square - 3.0 * leave * cube).sqrt() - square);
    first + at * (leave + at * (square + at * cube))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cosine seen at two instants a quarter radian apart: the cubic misses by at most the fourth derivative, 0.25^4 / 384 = 1.02e-5.
    #[test]
    fn a_crest_between_two_looks_is_found() {
        for from in [-0.2, -0.125, -0.01] {
            let (ends, duration) = ([from, from + 0.25], 0.25 / 40.0);
            let found = crest(ends.map(f64::cos), ends.map(|phase: f64| -40.0 * phase.sin()), duration);
            assert!((found - 1.0).abs() < 1.1e-5, "{from}: {found}");
        }
        // Past the crest already, not there yet, and on the way down and up again: the value at the end.
        for (first, last) in [([1.0, -2.0], [0.5, -3.0]), ([0.5, 3.0], [1.0, 2.0]), ([1.0, -2.0], [1.0, 2.0])] {
            assert_eq!(crest([first[0], last[0]], [first[1], last[1]], 0.1), last[0]);
        }
    }
}
