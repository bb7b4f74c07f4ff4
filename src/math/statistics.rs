//! Summaries of samples: moments that add without cancelling, and Student intervals of a mean.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Mean, spread and extremes of a sample, updated one value at a time (Welford 1962).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    n: u64,
    mean: f64,
    squares: f64,
    max: f64,
}

impl Summary {
    pub fn add(&mut self, value: f64) {
        self.n += 1;
        let before = value - self.mean;
        self.mean += before / self.n as f64;
        self.squares += before * (value - self.mean);
        self.max = if self.n == 1 { value } else { self.max.max(value) };
    }

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

/// The interval of the mean of `values` at the confidence `level` (0.95, say) by Student's t; `None` below two values.
pub fn mean_interval(values: &[f64], level: f64) -> Option<Interval> {
    let mut summary = Summary::default();
    summary.extend(values.iter().copied());
    let student = StudentsT::new(0.0, 1.0, summary.n().checked_sub(1)? as f64).ok()?;
    let half = student.inverse_cdf(0.5 * (1.0 + level)) * summary.sd() / (summary.n() as f64).sqrt();
    Some(Interval { low: summary.mean() - half, high: summary.mean() + half })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_survives_a_large_offset() {
        let mut summary = Summary::default();
        summary.extend([1e9 + 4.0, 1e9 + 7.0, 1e9 + 13.0, 1e9 + 16.0]);
        assert_eq!((summary.n(), summary.mean(), summary.max()), (4, 1e9 + 10.0, 1e9 + 16.0));
        // Variance 30 exactly; the textbook formula would lose all digits here.
        assert!((summary.sd() - 30f64.sqrt()).abs() < 1e-9);
    }

    /// Three values 1, 2, 3: mean 2, sd 1, t(0.975; 2) = 4.302653 (tables).
    #[test]
    fn the_interval_of_a_small_sample_uses_student() {
        let interval = mean_interval(&[1.0, 2.0, 3.0], 0.95).unwrap();
        assert!((interval.high - (2.0 + 4.302_653 / 3f64.sqrt())).abs() < 1e-6);
        assert!((interval.low + interval.high - 4.0).abs() < 1e-12);
        assert_eq!(mean_interval(&[1.0], 0.95), None);
        assert_eq!(mean_interval(&[], 0.95), None);
    }
}
