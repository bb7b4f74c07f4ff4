//! Where Newton's method starts: the last increment of a load that goes on slipping or turning about a support, continued.

use serde::{Deserialize, Serialize};

use super::friction::Regime;
use super::increment::Increment;
use crate::math::Vec3;

/// What the next increment is likely to be: the last one, continued by how it differed from those before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Increments of the last four steps, all as of the length of the last (m, m, rad).
    last: Option<Vec3>,
    before: Option<Vec3>,
    #[serde(default)]
    earlier: Option<Vec3>,
    #[serde(default)]
    earliest: Option<Vec3>,
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
        // By the polynomial through them.
        let next = match (self.earlier, self.earliest) {
            (Some(earlier), Some(earliest)) if ratio == 1.0 => 4.0 * (last + earlier) - 6.0 * before - earliest,
            (Some(earlier), None) if ratio == 1.0 => 3.0 * (last - before) + earlier,
            _ => last + ratio * (last - before),
        };
        Some(ratio * next)
    }

    /// Takes the increment of a step of this length into account; rest and another regime end what was known.
    pub fn learn(&mut self, increment: &Increment, step: f64) {
        if increment.regime == Regime::Stick {
            return self.forget();
        }
        let goes_on = self.regime == Some(increment.regime);
        let ratio = self.ratio(step);
        let scaled = |increment: Option<Vec3>| increment.filter(|_| goes_on && !self.is_first).map(|increment| ratio * increment);
        let [earlier, earliest] = [self.before, self.earlier].map(|increment| increment.filter(|_| ratio == 1.0));
        *self = Self {
            last: Some(increment.twist),
            before: scaled(self.last),
            earlier: scaled(earlier),
            earliest: scaled(earliest),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::StepReport;
    use crate::math::Vec2;

    /// Increments that are a polynomial of the step's number are forecast exactly as soon as so many are known that it goes through them; steps of other lengths tell
    /// of two alone.
    #[test]
    fn increments_go_on_as_the_polynomial_through_the_last_ones() {
        let of_degree = |degree: i32, n: i32| Vec3::new(1.0, -0.5, 0.3) + f64::from(n).powi(degree) * Vec3::new(0.01, 0.02, -0.03);
        let learn = |forecast: &mut Forecast, twist, regime, step| {
            forecast.learn(&Increment { twist, shift: Vec2::zeros(), friction: 0.0, regime, report: StepReport::default() }, step);
        };
        for degree in 0..=3 {
            let mut forecast = Forecast::default();
            assert_eq!(forecast.increment(1.0), None);
            // The first of a regime tells nothing of how they change.
            learn(&mut forecast, Vec3::new(9.0, 9.0, 9.0), Regime::Slip, 1.0);
            (0..=degree).for_each(|n| learn(&mut forecast, of_degree(degree, n), Regime::Slip, 1.0));
            let next = forecast.increment(1.0).unwrap();
            // Roundings of sums of a few numbers of order one.
            assert!((next - of_degree(degree, degree + 1)).amax() < 1e-14, "{degree}: {next}");
            let shorter = forecast.increment(0.5).unwrap();
            let (last, before) = (of_degree(degree, degree), of_degree(degree, (degree - 1).max(0)));
            assert!((shorter - 0.5 * (last + 0.5 * (last - before))).amax() < 1e-14, "{degree}: {shorter}");
            learn(&mut forecast, of_degree(degree, 0), Regime::Pinned(1), 1.0);
            assert_eq!(forecast.increment(1.0), Some(of_degree(degree, 0)));
            learn(&mut forecast, of_degree(degree, 0), Regime::Stick, 1.0);
            assert_eq!(forecast.increment(1.0), None);
        }
    }
}
