//! Summaries of samples, and confidence intervals.

use serde::{Deserialize, Serialize};
use statrs::distribution::{Beta, ContinuousCDF, Normal, StudentsT};

/// Mean, spread and extremes of a sample, updated one value at a time (Welford 1962).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    n: u64,
    mean: f64,
    squares: f64,
    max: f64,
}

impl Summary {
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut summary = Self::default();
        summary.extend(values);
        summary
    }

    pub fn add(&mut self, value: f64) {
        self.n += 1;
        let before = value - self.mean;
        self.mean += before / self.n as f64;
        self.squares += before * (value - self.mean);
        self.max = if self.n == 1 { value } else { self.max.max(value) };
    }

    /// Number of values (1).
    pub fn n(&self) -> u64 {
        self.n
    }

    /// Mean; zero for an empty sample.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Sample standard deviation (divisor n - 1); zero below two values.
    pub fn sd(&self) -> f64 {
        if self.n < 2 { 0.0 } else { (self.squares / (self.n - 1) as f64).sqrt() }
    }

    /// Largest value; zero for an empty sample.
    pub fn max(&self) -> f64 {
        self.max
    }

    /// Interval of the mean at the confidence `level`, for example 0.95, by Student's t; `None`
    /// below two values.
    pub fn mean_interval(&self, level: f64) -> Option<Interval> {
        if self.n < 2 {
            return None;
        }
        let half = student(level, (self.n - 1) as f64) * self.sd() / (self.n as f64).sqrt();
        Some(Interval { low: self.mean - half, high: self.mean + half })
    }
}

/// Two-sided quantile of Student's t at the confidence `level`, for example 0.95.
///
/// # Panics
/// When the degrees of freedom are not positive.
pub fn student(level: f64, degrees_of_freedom: f64) -> f64 {
    let student = StudentsT::new(0.0, 1.0, degrees_of_freedom).expect("degrees of freedom are positive");
    student.inverse_cdf(0.5 * (1.0 + level))
}

impl Extend<f64> for Summary {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, values: T) {
        values.into_iter().for_each(|value| self.add(value));
    }
}

/// A two-sided confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// The interval of a probability at the confidence `level`, from `n_hits` in `n` trials (E. B.
/// Wilson 1927); `None` without a trial.
pub fn proportion_interval(n_hits: u64, n: u64, level: f64) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (n, share) = (n as f64, n_hits as f64 / n as f64);
    let z = Normal::new(0.0, 1.0).ok()?.inverse_cdf(0.5 * (1.0 + level));
    let (widening, middle) = (1.0 + z * z / n, share + 0.5 * z * z / n);
    let half = z * (share * (1.0 - share) / n + 0.25 * z * z / (n * n)).sqrt();
    // At the ends the two terms cancel up to rounding.
    let low = if n_hits == 0 { 0.0 } else { (middle - half) / widening };
    let high = if share == 1.0 { 1.0 } else { (middle + half) / widening };
    Some(Interval { low, high })
}

/// The interval of Clopper and Pearson of a proportion: it misses the true proportion on either
/// side in at most half of the cases outside of `level`. `None` without trials.
pub fn exact_proportion_interval(n_hits: u64, n: u64, level: f64) -> Option<Interval> {
    let quantile = |a: u64, b: u64, share: f64| Some(Beta::new(a as f64, b as f64).ok()?.inverse_cdf(share));
    let outside = 0.5 * (1.0 - level);
    (n > 0).then_some(())?;
    let low = if n_hits == 0 { 0.0 } else { quantile(n_hits, n - n_hits + 1, outside)? };
    let high = if n_hits == n { 1.0 } else { quantile(n_hits + 1, n - n_hits, 1.0 - outside)? };
    Some(Interval { low, high })
}

/// The interval of the difference of two proportions in the same `n` trials, at the confidence
/// `level`; `None` without a trial. `n_only` counts the trials that have the first property alone,
/// and those that have the second alone. Half a trial is added to each of the four outcomes (A.
/// Agresti, Y. Min 2005).
pub fn share_difference_interval(n_only: [u64; 2], n: u64, level: f64) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (n, [a, b]) = (n as f64 + 2.0, n_only.map(|n_only| n_only as f64 + 0.5));
    let z = Normal::new(0.0, 1.0).ok()?.inverse_cdf(0.5 * (1.0 + level));
    let (middle, half) = ((a - b) / n, z * (a + b - (a - b) * (a - b) / n).sqrt() / n);
    Some(Interval { low: (middle - half).max(-1.0), high: (middle + half).min(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_survives_a_large_offset() {
        let summary = Summary::of([1e9 + 4.0, 1e9 + 7.0, 1e9 + 13.0, 1e9 + 16.0]);
        assert_eq!((summary.n(), summary.mean(), summary.max()), (4, 1e9 + 10.0, 1e9 + 16.0));
        // Variance 30 exactly; the textbook formula would lose all digits here.
        assert!((summary.sd() - 30f64.sqrt()).abs() < 1e-9);
    }

    /// Three values 1, 2, 3: mean 2, sd 1, t(0.975; 2) = 4.302653 (tables).
    #[test]
    fn the_interval_of_a_small_sample_uses_student() {
        let interval = Summary::of([1.0, 2.0, 3.0]).mean_interval(0.95).unwrap();
        assert!((interval.high - (2.0 + 4.302_653 / 3f64.sqrt())).abs() < 1e-6);
        assert!((interval.low + interval.high - 4.0).abs() < 1e-12);
        assert_eq!(Summary::of([1.0]).mean_interval(0.95), None);
        assert_eq!(Summary::of([]).mean_interval(0.95), None);
    }

    /// 8 of 10 at 95 %: 0.49016 to 0.94332 (tables). None and all of 10 reach 0 and 1, and
    /// z^2 / (n + z^2) = 0.2775 from there.
    #[test]
    fn the_interval_of_a_share_stays_within_zero_and_one() {
        // Clopper and Pearson: 3 of 40, and the rule of 1 - 0.025^(1/n) for none.
        let exact = exact_proportion_interval(3, 40, 0.95).unwrap();
        assert!((exact.low - 0.0157).abs() < 1e-4 && (exact.high - 0.2039).abs() < 1e-4, "{exact:?}");
        let none = exact_proportion_interval(0, 40, 0.95).unwrap();
        assert!(none.low == 0.0 && (none.high - (1.0 - 0.025f64.powf(1.0 / 40.0))).abs() < 1e-6, "{none:?}");
        let interval = proportion_interval(8, 10, 0.95).unwrap();
        assert!((interval.low - 0.49016).abs() < 5e-6 && (interval.high - 0.94332).abs() < 5e-6, "{interval:?}");
        let none = proportion_interval(0, 10, 0.95).unwrap();
        assert!(none.low == 0.0 && (none.high - 0.2775).abs() < 5e-5, "{none:?}");
        assert!(proportion_interval(10, 10, 0.95).unwrap().high == 1.0);
        assert_eq!(proportion_interval(0, 0, 0.95), None);
    }

    /// 12 and 4 of 40 by the published formula, p12 - p21 +- z sqrt(p12 + p21 - (p12 - p21)^2) /
    /// sqrt(n) with p = (n_ij + 1/2) / (n + 2): 0.1905 +- 0.1791. Trials that all agree leave an
    /// interval, which narrows with their number.
    #[test]
    fn shares_of_few_trials_may_differ_by_much() {
        let interval = share_difference_interval([12, 4], 40, 0.95).unwrap();
        let (p, q) = (12.5f64 / 42.0, 4.5f64 / 42.0);
        let half = 1.959_963_985 * ((p + q - (p - q) * (p - q)) / 42.0).sqrt();
        assert!((interval.low - (p - q - half)).abs() < 1e-8 && (interval.high - (p - q + half)).abs() < 1e-8, "{interval:?}");
        let same = |n| share_difference_interval([0, 0], n, 0.95).unwrap().high;
        assert!(same(2) > 0.45 && same(100) < 0.02 && same(37) > 0.05 && same(38) < 0.05);
        assert_eq!(share_difference_interval([2, 0], 2, 0.95).unwrap().high, 1.0);
        assert_eq!(share_difference_interval([0, 0], 0, 0.95), None);
    }
}
