//! Errors in words.

use serde::{Deserialize, Serialize};

/// How large a relative error is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Grade {
    /// Rounding: at most 1e-9.
    #[serde(rename = "exact")]
    Exact,
    /// At most 0.01.
    #[serde(rename = "to 1 %")]
    OnePercent,
    /// At most 0.1.
    #[serde(rename = "to 10 %")]
    TenPercent,
    #[serde(rename = "beyond")]
    Beyond,
}

/// Largest relative error that is rounding (1). Ten thousand steps in double precision lose four of
/// its sixteen digits, and pulls are differences that lose a few more. Whatever depends on the step
/// is larger.
pub const ROUNDING: f64 = 1e-9;
/// The tolerance of the path in `cohaul compare` (1): a smaller engine error is agreement there.
pub const ONE_PERCENT: f64 = 0.01;
/// How well coefficients of friction are known at best (1): a smaller error is hidden by them.
pub const TEN_PERCENT: f64 = 0.1;

impl Grade {
    pub const ALL: [Grade; 4] = [Grade::Exact, Grade::OnePercent, Grade::TenPercent, Grade::Beyond];

    /// Grade of a relative error (1).
    pub fn of(relative: f64) -> Self {
        match relative.abs() {
            error if error <= ROUNDING => Grade::Exact,
            error if error <= ONE_PERCENT => Grade::OnePercent,
            error if error <= TEN_PERCENT => Grade::TenPercent,
            _ => Grade::Beyond,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Grade::Exact => "exact",
            Grade::OnePercent => "to 1 %",
            Grade::TenPercent => "to 10 %",
            Grade::Beyond => "beyond",
        }
    }
}

/// What the words mean, and why.
pub const MEANING: &str = "exact: relative error at most 1e-9, which is rounding. To 1 %: the tolerance of the path in cohaul compare. To \
10 %: coefficients of friction are hardly known better, so that they hide such an error. Beyond: a larger error.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades_change_a_hair_above_their_limits() {
        for (limit, at, above) in [
            (ROUNDING, Grade::Exact, Grade::OnePercent),
            (ONE_PERCENT, Grade::OnePercent, Grade::TenPercent),
            (TEN_PERCENT, Grade::TenPercent, Grade::Beyond),
        ] {
            assert_eq!((Grade::of(-limit), Grade::of(limit * (1.0 + 1e-12))), (at, above));
        }
        assert_eq!(Grade::of(f64::NAN), Grade::Beyond);
        for grade in Grade::ALL {
            assert_eq!(serde_json::to_value(grade).unwrap(), grade.name());
        }
    }
}
