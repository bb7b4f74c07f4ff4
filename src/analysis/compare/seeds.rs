//! Number of seeds that would decide an open comparison of means.
//!
//! A difference of means is decided when its interval excludes zero, or lies within the margin that
//! counts as equal. The interval narrows with the number of pairs; the mean difference and the
//! spread are taken to stay as they are.

use crate::math::{Interval, share_difference_interval, student};

/// Number of pairs beyond which nothing is predicted (1).
const MOST: u64 = 1 << 20;

/// Smallest number of pairs for which the interval of a mean difference decides, for a mean and a
/// standard deviation `sd` of pairs, at the confidence `level`. Means up to `rounding` count as
/// zero, and those up to `margin` as equal.
pub(super) fn pairs_needed(mean: f64, sd: f64, (rounding, margin): (f64, f64), level: f64) -> Option<u64> {
    let allowed = (margin - mean.abs()).max(mean.abs() - rounding);
    if allowed <= 0.0 && sd > 0.0 {
        return None;
    }
    smallest(|n| student(level, n as f64 - 1.0) * sd <= allowed * (n as f64).sqrt())
}

/// The same for a difference of fractions, of which `n_only` of `n` pairs have the first property
/// alone and the second alone.
pub(super) fn pairs_needed_of_fractions(n_only: [u64; 2], n: u64, margin: f64, level: f64) -> Option<u64> {
    let decides = |interval: Interval| {
        let is_equal = interval.low >= -margin && interval.high <= margin;
        is_equal || interval.low > 0.0 || interval.high < 0.0
    };
    let scaled = |part: u64, of: u64| (part as f64 * of as f64 / n as f64).round() as u64;
    smallest(|of| share_difference_interval(n_only.map(|part| scaled(part, of)), of, level).is_some_and(decides))
}

/// Smallest number from two on for which a condition holds that holds for all larger ones.
fn smallest(holds: impl Fn(u64) -> bool) -> Option<u64> {
    let mut high = 2;
    while !holds(high) {
        high *= 2;
        if high > MOST {
            return None;
        }
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if holds(middle) { high = middle } else { low = middle }
    }
    Some(high.max(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With many pairs Student's t is the normal quantile z = 1.96: the interval 1.96 sd / sqrt(n)
    /// must fit between the mean and the nearer end that decides. At 1500 pairs, t^2 is larger by
    /// (z^2 + 1) / 2n = 0.16 %, and whole numbers by 0.07 %.
    #[test]
    fn the_interval_decides_from_the_number_that_is_found() {
        let n = pairs_needed(0.0, 1.0, (0.0, 0.05), 0.95).unwrap();
        assert!((n as f64 / (1.959_964f64 / 0.05).powi(2) - 1.0).abs() < 2.5e-3, "{n}");
        // Nearer to the margin than to zero: zero is excluded sooner.
        let n = pairs_needed(0.04, 1.0, (0.0, 0.05), 0.95).unwrap();
        assert!((n as f64 / (1.959_964f64 / 0.04).powi(2) - 1.0).abs() < 3e-3, "{n}");
        assert_eq!(pairs_needed(0.0, 0.0, (0.0, 0.05), 0.95), Some(2));
        assert_eq!(pairs_needed(0.0, 1.0, (0.0, 0.0), 0.95), None);
        // Equal fractions are known to 5 % from 56 pairs on at the level of twelve intervals.
        let level = 1.0 - 0.05 / 12.0;
        assert_eq!(pairs_needed_of_fractions([0, 0], 8, 0.05, level), Some(56));
    }
}
