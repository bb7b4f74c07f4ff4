//! Where Newton's method starts: the last increment of a load that goes on slipping or turning about a support, continued.

use serde::{Deserialize, Serialize};

use super::friction::Regime;
use super::increment::Increment;
use crate::math::Vec3;

/// What the next increment is likely to be: the last one, continued by how it differed from those before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Increments of the last three steps, all as of the length of the last (m, m, rad).
    last: Option<Vec3>,
    before: Option<Vec3>,
    #[serde(default)]
    earlier: Option<Vec3>,
    /// Whether the last step was the first of its regime, which may have begun within it: it tells nothing of how increments change.
    #[serde(default)]
    is_first: bool,
    /// Length of the last step, by a measure that is the caller's.
    step: f64,
    /// That of all.
    regime: Option<Regime>,
}

impl Forecast {
    /// Body-twist increment of the next step, of length `step`; `None` where nothing is known.
    pub fn increment(&self, step: f64) -> Option<Vec3> {
        let (last, before) = (self.last?, self.before.unwrap_or(self.last?));
        let ratio = self.ratio(step);
        let change = match self.earlier {
            Some(earlier) if ratio == 1.0 => 2.0 * last - 3.0 * before + earlier,
            _ => ratio * (last - before),
        };
        Some((last + change) * ratio)
    }

    /// Takes the increment of a step of this length into account; rest and another regime end what was known.
    pub fn learn(&mut self, increment: &Increment, step: f64) {
        if increment.regime == Regime::Stick {
            return self.forget();
        }
        let goes_on = self.regime == Some(increment.regime);
        let ratio = self.ratio(step);
        let scaled = |increment: Option<Vec3>| increment.filter(|_| goes_on && !self.is_first).map(|increment| ratio * increment);
        let earlier = self.before.filter(|_| ratio == 1.0);
        *self = Self {
            last: Some(increment.twist),
            before: scaled(self.last),
            earlier: scaled(earlier),
            is_first: !goes_on,
            step,
            regime: Some(increment.regime),
        };
    }

    /// Whether it rests on two steps.
    pub fn has_two(&self) -> bool {
        self.before.is_some()
    }

    /// Of a step's length to that of the last one; exactly one where they are equal but for rounding, so that a path at another pace is the same to the last bit.
    fn ratio(&self, step: f64) -> f64 {
        if (step - self.step).abs() <= 1e-6 * step { 1.0 } else { step / self.step }
    }

    pub fn forget(&mut self) {
        *self = Self::default();
    }
}
