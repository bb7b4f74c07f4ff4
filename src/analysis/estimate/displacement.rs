//! Displacement of the reduced model from the quasi-static load, and its triggers.

use serde::{Deserialize, Serialize};

use super::reduced_model::ReducedModel;
use crate::analysis::trigger::{ByTrigger, Trigger};
use crate::math::{Pose, Vec2, rotation};

/// The largest displacement and its trigger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Largest {
    /// Time of the largest displacement (s).
    pub time_s: f64,
    pub trigger: Trigger,
}

/// The load without and with inertia, at the start and at the end of an interval.
pub(super) struct Ends<'a> {
    pub load: [&'a Pose; 2],
    pub model: [&'a ReducedModel; 2],
    /// (s)
    pub duration: f64,
    /// Whether the interval is a small part of an oscillation.
    pub is_short: bool,
}

/// Displacements of the model from the load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Displacements {
    /// Shift now (m).
    pub shift: f64,
    /// Turn now (rad).
    pub turn: f64,
    /// Largest edge displacements.
    pub by_trigger: ByTrigger,
    pub largest: Option<Largest>,
}

/// Largest ratio of a crest within a short interval to both of its ends (1).
const HIGHER: f64 = 1.1;

impl Displacements {
    /// Adds an interval that ends at `time` (s), crests within it included.
    pub fn add(&mut self, ends: &Ends, radius: f64, time: f64, trigger: &Trigger) {
        let offsets = [0, 1].map(|end| ends.offset(end));
        let [shifts, turns] = [offsets.map(|offset| offset.0.norm()), offsets.map(|offset| offset.1.abs())];
        (self.shift, self.turn) = (shifts[1], turns[1]);
        let so_far = self.by_trigger.max();
        let part = self.by_trigger.of(trigger.kind);
        let (shift, turn) = (shifts[0].max(shifts[1]), turns[0].max(turns[1]));
        if HIGHER * (shift + radius * turn) <= part {
            return;
        }
        let [shift, turn] = if ends.is_short { ends.crests(offsets) } else { [self.shift, self.turn] };
        let displacement = shift + radius * turn;
        self.by_trigger.add(trigger.kind, displacement);
        if displacement > so_far {
            self.largest = Some(Largest { time_s: time, trigger: *trigger });
        }
    }
}

impl Ends<'_> {
    /// Shift (m, world) and turn (rad) of the model from the load at an end.
    fn offset(&self, end: usize) -> (Vec2, f64) {
        let (model, load) = (&self.model[end].pose, self.load[end]);
        (model.position - load.position, model.heading - load.heading)
    }

    /// Largest shift and turn at the end, or at a crest before it.
    fn crests(&self, offsets: [(Vec2, f64); 2]) -> [f64; 2] {
        let [before, after] = self.load;
        let (velocity, turn_rate) = ((after.position - before.position) / self.duration, (after.heading - before.heading) / self.duration);
        let rates = self.model.map(|model| {
            let twist = model.twist();
            (rotation(model.pose.heading) * twist.xy() - velocity, twist.z - turn_rate)
        });
        let shift_rate = |i: usize| offsets[i].0.dot(&rates[i].0) / offsets[i].0.norm().max(f64::MIN_POSITIVE);
        let turn_rate = |i: usize| offsets[i].1.signum() * rates[i].1;
        [
            crest([offsets[0].0.norm(), offsets[1].0.norm()], [shift_rate(0), shift_rate(1)], self.duration),
            crest([offsets[0].1.abs(), offsets[1].1.abs()], [turn_rate(0), turn_rate(1)], self.duration),
        ]
    }
}

/// The last of two values, or the crest between them of the cubic with these values and these rates
/// (1/s) at its ends.
fn crest([first, last]: [f64; 2], rates: [f64; 2], duration: f64) -> f64 {
    let [leave, arrive] = rates.map(|rate| rate * duration);
    if !(leave > 0.0 && arrive < 0.0) {
        return last;
    }
    let (square, cube) = (3.0 * (last - first) - 2.0 * leave - arrive, 2.0 * (first - last) + leave + arrive);
    // The only maximum between the ends.
    let at = leave / ((square * square - 3.0 * leave * cube).sqrt() - square);
    first + at * (leave + at * (square + at * cube))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a cosine over a quarter radian, the cubic is wrong by at most 0.25^4 / 384 = 1.02e-5.
    #[test]
    fn a_crest_between_two_instants_is_found() {
        for from in [-0.2, -0.125, -0.01] {
            let (ends, duration) = ([from, from + 0.25], 0.25 / 40.0);
            let found = crest(ends.map(f64::cos), ends.map(|phase: f64| -40.0 * phase.sin()), duration);
            assert!((found - 1.0).abs() < 1.1e-5, "{from}: {found}");
        }
        // After the crest, before it, and around a trough: the value at the end.
        for (first, last) in [([1.0, -2.0], [0.5, -3.0]), ([0.5, 3.0], [1.0, 2.0]), ([1.0, -2.0], [1.0, 2.0])] {
            assert_eq!(crest([first[0], last[0]], [first[1], last[1]], 0.1), last[0]);
        }
    }
}
