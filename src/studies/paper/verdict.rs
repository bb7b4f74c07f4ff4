//! How far a number of ours is from a printed one.

use serde::{Deserialize, Serialize};

use super::units::Estimate;
use crate::math::Interval;

/// Match: the printed number lies in the 95 % interval, or the computed number rounds to it. Near:
/// the computed number is within the limit of near. Differs: neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    Match,
    Near,
    Differs,
}

/// A printed number, and how it is judged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Printed {
    pub value: f64,
    /// Half a unit of its last digit.
    pub rounding: f64,
    /// Distance up to which a number of ours is near.
    pub near: f64,
}

impl Printed {
    /// A number that is near within 10 %.
    pub fn new(value: f64, rounding: f64) -> Self {
        Self { value, rounding, near: 0.1 * value.abs() }
    }

    /// A share (1), near within 0.05.
    pub fn share(value: f64, rounding: f64) -> Self {
        Self { value, rounding, near: 0.05 }
    }
}

/// The grade of our number against the printed one.
pub fn grade(printed: &Printed, ours: &Estimate) -> Grade {
    graded(printed, ours.value, ours.interval_95)
}

/// The same of a number and the interval in which the printed one may lie.
pub fn graded(printed: &Printed, ours: f64, interval: Option<Interval>) -> Grade {
    let apart = (ours - printed.value).abs();
    let is_inside = interval.is_some_and(|interval| interval.low <= printed.value && printed.value <= interval.high);
    if is_inside || apart <= printed.rounding {
        Grade::Match
    } else if apart <= printed.near {
        Grade::Near
    } else {
        Grade::Differs
    }
}

impl Grade {
    pub fn name(self) -> &'static str {
        match self {
            Grade::Match => "match",
            Grade::Near => "near",
            Grade::Differs => "differs",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hair on both sides of each boundary.
    #[test]
    fn grades_change_at_interval_rounding_and_a_tenth() {
        let printed = Printed::new(5.0, 0.05);
        let graded = |value, low, high| grade(&printed, &Estimate { value, interval_95: Some(Interval { low, high }), n_units: 9 });
        assert_eq!(graded(4.8, 4.6, 5.0), Grade::Match);
        assert_eq!(graded(4.8, 4.6, 4.999), Grade::Near);
        assert_eq!(graded(4.951, 4.94, 4.96), Grade::Match);
        assert_eq!(graded(4.949, 4.94, 4.96), Grade::Near);
        assert_eq!(graded(4.501, 4.4, 4.6), Grade::Near);
        assert_eq!(graded(4.499, 4.4, 4.6), Grade::Differs);
        assert_eq!(graded(5.501, 5.4, 5.6), Grade::Differs);
        // Without an interval only rounding makes a match.
        assert_eq!(grade(&printed, &Estimate { value: 4.9, interval_95: None, n_units: 1 }), Grade::Near);
    }
}
