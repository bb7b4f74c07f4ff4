//! Start of Newton's method: the last increments of a load that goes on slipping or turning about a
//! support, continued.

use serde::{Deserialize, Serialize};

use crate::backend::friction::ContactMode;
use crate::backend::increment::Increment;
use crate::math::Vec3;

/// Likely next increment: the last one, continued by its difference from those before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Increments of the last four steps, all scaled to the length of the last step (m, m, rad).
    last: Option<Vec3>,
    before: Option<Vec3>,
    #[serde(default)]
    earlier: Option<Vec3>,
    #[serde(default)]
    earliest: Option<Vec3>,
    /// Whether the last step was the first in its contact mode. The mode may have begun within the
    /// step, so that it tells nothing of how increments change.
    #[serde(default)]
    is_first: bool,
    /// Length of the last step, in a unit that the caller chooses.
    step: f64,
    /// Contact mode of all these steps.
    mode: Option<ContactMode>,
}

impl Forecast {
    /// Body-twist increment of the next step, of length `step` (m, m, rad); `None` where nothing is
    /// known.
    pub fn increment(&self, step: f64) -> Option<Vec3> {
        let (last, before) = (self.last?, self.before.unwrap_or(self.last?));
        let ratio = self.ratio(step);
        // The polynomial through them.
        let next = match (self.earlier, self.earliest) {
            (Some(earlier), Some(earliest)) if ratio == 1.0 => 4.0 * (last + earlier) - 6.0 * before - earliest,
            (Some(earlier), None) if ratio == 1.0 => 3.0 * (last - before) + earlier,
            _ => last + ratio * (last - before),
        };
        Some(ratio * next)
    }

    /// Takes the increment of a step of this length into account. Rest and another contact mode end
    /// what was known.
    pub fn learn(&mut self, increment: &Increment, step: f64) {
        if increment.mode == ContactMode::Stick {
            return self.forget();
        }
        let goes_on = self.mode == Some(increment.mode);
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
            mode: Some(increment.mode),
        };
    }

    /// Whether two steps are known.
    pub fn has_two(&self) -> bool {
        self.before.is_some()
    }

    /// Length of a step over that of the last one (1). It is exactly one where they are equal up to
    /// rounding, so that a path at another speed is the same to the last bit.
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

    /// Increments that are a polynomial of the number of the step are forecast exactly as soon as
    /// enough of them are known. A step of another length uses two of them only.
    #[test]
    fn increments_go_on_as_the_polynomial_through_the_last_ones() {
        let of_degree = |degree: i32, n: i32| Vec3::new(1.0, -0.5, 0.3) + f64::from(n).powi(degree) * Vec3::new(0.01, 0.02, -0.03);
        let learn = |forecast: &mut Forecast, twist, mode, step| {
            forecast.learn(&Increment { twist, shift: Vec2::zeros(), friction: 0.0, mode, report: StepReport::default() }, step);
        };
        for degree in 0..=3 {
            let mut forecast = Forecast::default();
            assert_eq!(forecast.increment(1.0), None);
            // The first one in a contact mode tells nothing of how they change.
            learn(&mut forecast, Vec3::new(9.0, 9.0, 9.0), ContactMode::Slip, 1.0);
            (0..=degree).for_each(|n| learn(&mut forecast, of_degree(degree, n), ContactMode::Slip, 1.0));
            let next = forecast.increment(1.0).unwrap();
            // Roundings of sums of a few numbers of order one.
            assert!((next - of_degree(degree, degree + 1)).amax() < 1e-14, "{degree}: {next}");
            let shorter = forecast.increment(0.5).unwrap();
            let (last, before) = (of_degree(degree, degree), of_degree(degree, (degree - 1).max(0)));
            assert!((shorter - 0.5 * (last + 0.5 * (last - before))).amax() < 1e-14, "{degree}: {shorter}");
            learn(&mut forecast, of_degree(degree, 0), ContactMode::Pinned(1), 1.0);
            assert_eq!(forecast.increment(1.0), Some(of_degree(degree, 0)));
            learn(&mut forecast, of_degree(degree, 0), ContactMode::Stick, 1.0);
            assert_eq!(forecast.increment(1.0), None);
        }
    }
}
