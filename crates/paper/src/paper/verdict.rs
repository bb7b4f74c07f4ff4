//! Grades of a computed number beside a printed one.
//!
//! Both numbers have a sampling error. The grade asks whether the distance of the two is certainly
//! within a margin, so that a larger error of the computed number never makes a better grade:
//!
//! ```text
//! distance  = |computed - printed|
//! error     = half of the 95 % interval of the computed number, by the scatter of the seeds
//! own       = distance that sampling and rounding of the printed number explain in 95 % of cases
//! near      = 10 % of the printed number, or 0.05 of a fraction
//!
//! match       distance + error <= own
//! near        distance + error <= own + near
//! differs     distance - error >  own + near
//! undecided   none of these, or no error known
//! ```
//!
//! The printed number's sampling error is that of a sample of the printed size, drawn from runs
//! that scatter as the computed ones do. It has no factor for few seeds, which would widen the
//! margin.

use serde::{Deserialize, Serialize};

use super::units::Estimate;

/// How a computed number stands beside a printed one, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// The two are as close as two samples of the same runs.
    Match,
    /// The two are certainly within the limit of near.
    Near,
    /// The two are certainly within the limit of near, since parameters were fitted to this number.
    Calibrated,
    /// The two are certainly farther apart than the limit of near.
    Differs,
    /// The seeds do not tell.
    Undecided,
}

/// A printed number, and how it is judged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Printed {
    pub value: f64,
    /// Half a unit of its last digit.
    pub rounding: f64,
    /// Distance up to which a computed number is near.
    pub near: f64,
    /// Whether parameters were fitted to it.
    pub is_calibrated: bool,
}

/// Distances below and above a computed number within which the printed one lies in 95 % of samples
/// of its size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Own {
    pub below: f64,
    pub above: f64,
}

/// Two-sided 95 % quantile of a normal variable (1).
pub const NORMAL: f64 = 1.959_963_984_540_054;

impl Own {
    /// The same on both sides, from the standard error of the printed number.
    pub fn of_error(standard_error: f64) -> Self {
        Self { below: NORMAL * standard_error, above: NORMAL * standard_error }
    }
}

impl Printed {
    /// A number that is near within 10 %.
    pub fn new(value: f64, rounding: f64) -> Self {
        Self { value, rounding, near: 0.1 * value.abs(), is_calibrated: false }
    }

    /// A fraction (1), near within 0.05.
    pub fn share(value: f64, rounding: f64) -> Self {
        Self { near: 0.05, ..Self::new(value, rounding) }
    }

    /// The same number where parameters were fitted to it.
    pub fn calibrated(self) -> Self {
        Self { is_calibrated: true, ..self }
    }

    /// Grade of `ours`, where the printed number has sampling errors of its `own`.
    pub fn grade(&self, ours: &Estimate, own: Own) -> Grade {
        let half = ours.interval_95.map(|interval| 0.5 * (interval.high - interval.low));
        self.graded(ours.value, half, own)
    }

    /// The same of a value with half of its 95 % interval.
    pub fn graded(&self, ours: f64, error: Option<f64>, own: Own) -> Grade {
        let Some(error) = error else { return Grade::Undecided };
        let own = self.rounding + if self.value < ours { own.below } else { own.above };
        let distance = (self.value - ours).abs();
        match distance {
            _ if distance + error <= own + self.near && self.is_calibrated => Grade::Calibrated,
            _ if distance + error <= own => Grade::Match,
            _ if distance + error <= own + self.near => Grade::Near,
            _ if distance - error > own + self.near => Grade::Differs,
            _ => Grade::Undecided,
        }
    }
}

impl Grade {
    pub fn name(self) -> &'static str {
        match self {
            Grade::Match => "match",
            Grade::Near => "near",
            Grade::Calibrated => "calibrated",
            Grade::Differs => "differs",
            Grade::Undecided => "undecided",
        }
    }

    /// Whether the printed number is reproduced, or was fitted.
    pub fn is_met(self) -> bool {
        self <= Grade::Calibrated
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::math::{Interval, RandomStreams, Stream, Summary};

    /// A hair on both sides of each boundary.
    #[test]
    fn grades_change_at_own_error_and_near() {
        let printed = Printed::new(5.0, 0.05);
        let own = Own { below: 0.1, above: 0.2 };
        let graded = |ours: f64, error: f64| printed.graded(ours, Some(error), own);
        // The printed number above ours: 0.25 in all.
        assert_eq!((graded(4.85, 0.0999), graded(4.85, 0.1001)), (Grade::Match, Grade::Near));
        // Below ours: 0.15 in all.
        assert_eq!((graded(5.1, 0.0499), graded(5.1, 0.0501)), (Grade::Match, Grade::Near));
        assert_eq!((graded(4.45, 0.1999), graded(4.45, 0.2001)), (Grade::Near, Grade::Undecided));
        assert_eq!((graded(4.05, 0.1999), graded(4.05, 0.2001)), (Grade::Differs, Grade::Undecided));
        assert_eq!(printed.calibrated().graded(4.99, Some(0.01), own), Grade::Calibrated);
        assert_eq!(printed.calibrated().graded(4.0, Some(0.01), own), Grade::Differs);
        // One run has no error that is known.
        assert_eq!(printed.graded(5.0, None, own), Grade::Undecided);
    }

    /// With the same value, a wider interval never makes a better grade.
    #[test]
    fn a_wider_interval_never_makes_a_better_grade() {
        for printed in [Printed::new(5.0, 0.05), Printed::new(5.0, 0.05).calibrated()] {
            for at in 0..400 {
                let value = 3.0 + 0.01 * f64::from(at);
                let graded = |error: u32| printed.graded(value, Some(0.01 * f64::from(error)), Own::of_error(0.1));
                let is_met = |error: u32| graded(error).is_met();
                assert!((0..200).all(|error| graded(error) <= graded(error + 1) || !is_met(error + 1)), "{value}");
                assert!((0..200).all(|error| is_met(error) || !is_met(error + 1)), "{value}");
            }
        }
    }

    /// Whatever the truth, a study of 3, 10 or 40 of 160 seeds does not meet the printed number
    /// more often than one of all: 400 generated studies for each truth, of which three standard
    /// deviations, 0.06, are allowed. Nor does it more often call a number a match.
    #[test]
    fn leaving_seeds_out_does_not_improve_a_grade() {
        let printed = Printed::new(5.0, 0.05);
        for (at, truth) in [5.0, 5.1, 5.3, 5.5, 5.6, 5.8, 6.5].into_iter().enumerate() {
            let shares = |n: u64| {
                let (mut n_met, mut n_match) = (0, 0);
                for study in 0..400 {
                    let streams = RandomStreams::new(1000 * at as u64 + study);
                    let values = (0..n).map(|seed| truth + 0.5 * streams.normal_pair(Stream::Scene, 0, seed).x);
                    let found = Summary::of(values);
                    let error = found.sd() / (n as f64).sqrt();
                    let estimate = Estimate::students(found.mean(), Some(error), n as usize);
                    // A printed sample of 100 runs that scatter as ours.
                    let grade = printed.grade(&estimate, Own::of_error(found.sd() / 10.0));
                    n_met += u32::from(grade.is_met());
                    n_match += u32::from(grade == Grade::Match);
                }
                [f64::from(n_met) / 400.0, f64::from(n_match) / 400.0]
            };
            let all = shares(160);
            for n in [3, 10, 40] {
                let some = shares(n);
                assert!(some[0] <= all[0] + 0.06 && some[1] <= all[1] + 0.06, "truth {truth}: {some:?} of {n}, {all:?} of all");
            }
        }
    }

    #[test]
    fn an_interval_gives_the_error() {
        let interval_95 = Some(Interval { low: 4.9, high: 5.0 });
        let ours = Estimate { value: 4.95, interval_95, standard_error: None, n_units: 9 };
        assert_eq!(Printed::new(5.0, 0.05).grade(&ours, Own::default()), Grade::Near);
        assert_eq!(Printed::new(5.0, 0.05).grade(&ours, Own::of_error(0.05)), Grade::Match);
    }
}
