//! One slope from several trials, with its interval.
//!
//! Every law here is a slope s times a known function g of the displacement: s = E for the
//! pseudo-rigid-body model, s = kappa for the linear law. Each trial has its own least-squares
//! slope s_t = sum(w g F) / sum(w g^2). Springs and mountings differ from trial to trial, so that
//! the readings of one trial have a common error. An interval from single readings would be far too
//! narrow. Hence
//!
//! ```text
//! s_t = s + b_t + e_t      b_t: between trials, variance tau^2
//!                          e_t: within a trial, variance v_t = sigma^2 / sum(w g^2)
//! s   = sum(s_t / (tau^2 + v_t)) / sum(1 / (tau^2 + v_t))
//! ```
//!
//! tau^2 is such that the weighted squares have their expected sum (Paule and Mandel 1982), or zero
//! if they stay below it. The interval is that of Hartung and Knapp (2001): Student's t with T - 1
//! degrees of freedom times the spread of the trials about s. For equally exact trials this is
//! exactly the mean of the trials and its usual interval. If one trial is far more exact than the
//! others, it has nearly all of the weight. tau^2 is then often estimated as zero although it is
//! not, and the interval is too narrow ([`Estimate::largest_weight`]).

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use cohaul::math::{Interval, Summary, bisected, student};

/// One reading for a fit: the force (N), and the value `basis` of the law with slope 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub basis: f64,
    pub force: f64,
    /// 1 / sd^2 (1/N^2), or 1 where errors are not known.
    pub weight: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// Stated error bars.
    Stated,
    /// Equal weights; the scatter within trials gives the error of a point.
    FromScatter,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrialSlope {
    pub slope: f64,
    /// sum(w g^2)
    pub information: f64,
    /// sum(w (F - s g)^2)
    pub scatter: f64,
    pub n_points: usize,
}

impl TrialSlope {
    /// `None` if no point determines the slope.
    pub fn of(points: impl Iterator<Item = Point> + Clone) -> Option<Self> {
        let information: f64 = points.clone().map(|point| point.weight * point.basis * point.basis).sum();
        let moment: f64 = points.clone().map(|point| point.weight * point.basis * point.force).sum();
        let slope = moment / information;
        let residual = |point: Point| point.force - slope * point.basis;
        let scatter = points.clone().map(|point| point.weight * residual(point).powi(2)).sum();
        (information > 0.0).then_some(Self { slope, information, scatter, n_points: points.count() })
    }
}

/// A fitted number. Its unit is in the name of the field that contains it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    pub value: f64,
    /// Standard error between trials; for one trial, from its scatter or its error bars.
    pub standard_error: f64,
    pub degrees_of_freedom: f64,
    /// Interval between trials; `null` for one trial.
    pub interval: Option<Interval>,
    /// Interval for independent readings; it is too narrow if trials differ.
    pub interval_within_trials: Option<Interval>,
    /// Standard deviation of the slope between trials; `null` for one trial.
    pub between_trials_sd: Option<f64>,
    pub n_trials: usize,
    pub n_points: usize,
    /// Largest weight of one trial over the sum of weights (1); `null` for one trial, and for a
    /// mean of cases.
    #[serde(default)]
    pub largest_weight: Option<f64>,
}

/// Weight above which one of at least three trials dominates (1).
const HALF: f64 = 0.5;
/// Weight above which one of two trials dominates (1).
const MOST_OF_TWO: f64 = 0.75;

impl Estimate {
    /// Whether one trial dominates, so that the others hardly determine the spread between trials.
    pub fn is_of_one_trial(&self) -> bool {
        let most = if self.n_trials == 2 { MOST_OF_TWO } else { HALF };
        self.largest_weight.is_some_and(|weight| weight > most)
    }

    pub fn is_finite(&self) -> bool {
        let intervals = [self.interval, self.interval_within_trials];
        let ends = intervals.iter().flatten().flat_map(|interval| [interval.low, interval.high]);
        ends.chain([self.value, self.standard_error, self.degrees_of_freedom]).chain(self.between_trials_sd).all(f64::is_finite)
    }
}

/// The slope of all `trials`; `None` without any.
pub fn pool(trials: &[TrialSlope], weighting: Weighting, level: f64) -> Option<Estimate> {
    if trials.is_empty() {
        return None;
    }
    let n_points: usize = trials.iter().map(|trial| trial.n_points).sum();
    let information: f64 = trials.iter().map(|trial| trial.information).sum();
    let within = within_trials(trials, weighting, level);
    let together = trials.iter().map(|trial| trial.information * trial.slope).sum::<f64>() / information;
    let one = Estimate {
        value: together,
        standard_error: within.map_or(0.0, |(error, _)| error),
        degrees_of_freedom: n_points as f64 - 1.0,
        interval: None,
        interval_within_trials: within.map(|(_, interval)| interval),
        between_trials_sd: None,
        n_trials: trials.len(),
        n_points,
        largest_weight: None,
    };
    if trials.len() == 1 {
        return Some(one);
    }
    let variance = |trial: &TrialSlope| point_variance(trials, weighting) / trial.information;
    let slopes: Vec<(f64, f64)> = trials.iter().map(|trial| (trial.slope, variance(trial))).collect();
    let between = between_trials(&slopes);
    let (value, weight, squares) = weighted(&slopes, between);
    let largest_weight = slopes.iter().map(|slope| weighted(&[*slope], between).1 / weight).reduce(f64::max);
    let degrees_of_freedom = trials.len() as f64 - 1.0;
    let standard_error = (squares / (degrees_of_freedom * weight)).sqrt();
    let interval = Some(about(value, standard_error * student(level, degrees_of_freedom)));
    Some(Estimate { value, standard_error, degrees_of_freedom, interval, between_trials_sd: Some(between.sqrt()), largest_weight, ..one })
}

/// Variance of a point with unit weight: 1 with error bars, else the scatter within all trials.
fn point_variance(trials: &[TrialSlope], weighting: Weighting) -> f64 {
    let free = trials.iter().map(|trial| trial.n_points).sum::<usize>() - trials.len();
    match weighting {
        Weighting::Stated => 1.0,
        Weighting::FromScatter if free == 0 => 0.0,
        Weighting::FromScatter => trials.iter().map(|trial| trial.scatter).sum::<f64>() / free as f64,
    }
}

/// Standard error and interval of one slope through all points as independent readings; `None` for
/// a single point without an error bar.
fn within_trials(trials: &[TrialSlope], weighting: Weighting, level: f64) -> Option<(f64, Interval)> {
    let information: f64 = trials.iter().map(|trial| trial.information).sum();
    let slope = trials.iter().map(|trial| trial.information * trial.slope).sum::<f64>() / information;
    let about_slope = |trial: &TrialSlope| trial.scatter + trial.information * (trial.slope - slope).powi(2);
    let free = trials.iter().map(|trial| trial.n_points).sum::<usize>() as f64 - 1.0;
    let (variance, factor) = match weighting {
        Weighting::Stated => (1.0, Normal::standard().inverse_cdf(0.5 * (1.0 + level))),
        Weighting::FromScatter if free < 1.0 => return None,
        Weighting::FromScatter => (trials.iter().map(about_slope).sum::<f64>() / free, student(level, free)),
    };
    let error = (variance / information).sqrt();
    Some((error, about(slope, factor * error)))
}

/// tau^2 from the slope and the variance within each trial.
fn between_trials(slopes: &[(f64, f64)]) -> f64 {
    let expected = slopes.len() as f64 - 1.0;
    let mut summary = Summary::default();
    summary.extend(slopes.iter().map(|(slope, _)| *slope));
    // The variances within trials are subtracted, so that the sum of squares at this end is at most
    // the expected one.
    let most = summary.sd().powi(2);
    let excess = |between: f64| weighted(slopes, between).2 - expected;
    if most == 0.0 || excess(0.0) <= 0.0 { 0.0 } else { bisected([0.0, most], 80, |between| excess(between) > 0.0)[1] }
}

/// Mean, sum of weights, and weighted squares about the mean.
fn weighted(slopes: &[(f64, f64)], between: f64) -> (f64, f64, f64) {
    // Trials without scatter differ at least by rounding.
    let largest = slopes.iter().map(|(slope, _)| slope.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let weight = |variance: f64| 1.0 / (between + variance.max((1e-14 * largest).powi(2)).max(f64::MIN_POSITIVE));
    let total: f64 = slopes.iter().map(|(_, variance)| weight(*variance)).sum();
    let mean = slopes.iter().map(|(slope, variance)| weight(*variance) * slope).sum::<f64>() / total;
    let squares = slopes.iter().map(|(slope, variance)| weight(*variance) * (slope - mean).powi(2)).sum();
    (mean, total, squares)
}

/// Mean of cases with equal weights, for a law that is a compromise between them. Its interval has
/// Satterthwaite's degrees of freedom.
pub fn mean_of_cases(cases: &[Estimate], level: f64) -> Option<Estimate> {
    let n = cases.len() as f64;
    let [first, _, ..] = cases else { return cases.first().copied() };
    let value = cases.iter().map(|case| case.value).sum::<f64>() / n;
    let variances = cases.iter().map(|case| case.standard_error.powi(2));
    let standard_error = variances.clone().sum::<f64>().sqrt() / n;
    let fourth: f64 = cases.iter().map(|case| case.standard_error.powi(4) / case.degrees_of_freedom).sum();
    let degrees_of_freedom = if fourth > 0.0 { variances.sum::<f64>().powi(2) / fourth } else { first.degrees_of_freedom };
    let is_known = cases.iter().all(|case| case.interval.is_some());
    let interval = is_known.then(|| about(value, standard_error * student(level, degrees_of_freedom)));
    Some(Estimate {
        value,
        standard_error,
        degrees_of_freedom,
        interval,
        interval_within_trials: None,
        between_trials_sd: None,
        n_trials: cases.iter().map(|case| case.n_trials).sum(),
        n_points: cases.iter().map(|case| case.n_points).sum(),
        largest_weight: None,
    })
}

/// Probability of estimates that differ as much, if all had the same true value (Welch 1951);
/// `None` if fewer than two have an interval.
pub fn agreement(estimates: &[Estimate]) -> Option<f64> {
    let known: Vec<&Estimate> = estimates.iter().filter(|estimate| estimate.interval.is_some()).collect();
    let n = known.len() as f64;
    let largest = known.iter().map(|estimate| estimate.value.abs()).fold(0.0, f64::max);
    if known.len() < 2 {
        return None;
    }
    // Rounding errors do not count.
    let weight = |estimate: &Estimate| 1.0 / estimate.standard_error.max(1e-12 * largest).powi(2);
    let total: f64 = known.iter().map(|estimate| weight(estimate)).sum();
    let mean = known.iter().map(|estimate| weight(estimate) * estimate.value).sum::<f64>() / total;
    let squares: f64 = known.iter().map(|estimate| weight(estimate) * (estimate.value - mean).powi(2)).sum();
    let few: f64 = known.iter().map(|estimate| (1.0 - weight(estimate) / total).powi(2) / estimate.degrees_of_freedom).sum();
    let ratio = squares / (n - 1.0) / (1.0 + 2.0 * (n - 2.0) / (n * n - 1.0) * few);
    let fisher = FisherSnedecor::new(n - 1.0, (n * n - 1.0) / (3.0 * few)).ok()?;
    Some(fisher.sf(ratio))
}

/// Probability of an estimate as far from zero, if the true value were zero; `None` for one trial.
pub(super) fn chance_of_none(estimate: &Estimate) -> Option<f64> {
    estimate.interval?;
    let student = StudentsT::new(0.0, 1.0, estimate.degrees_of_freedom).ok()?;
    let ratio = estimate.value.abs() / estimate.standard_error;
    Some(if ratio.is_nan() { 1.0 } else { 2.0 * student.sf(ratio.min(1e6)) })
}

fn about(value: f64, half: f64) -> Interval {
    Interval { low: value - half, high: value + half }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(slope: f64, information: f64) -> TrialSlope {
        TrialSlope { slope, information, scatter: 0.02, n_points: 5 }
    }

    /// Equally exact trials give the classical interval of a mean, whatever the weights.
    #[test]
    fn equal_trials_have_the_interval_of_their_mean() {
        let slopes = [1.66, 1.71, 1.58, 1.69];
        let trials = slopes.map(|slope| trial(slope, 40.0));
        for weighting in [Weighting::Stated, Weighting::FromScatter] {
            let found = pool(&trials, weighting, 0.95).unwrap();
            let (interval, expected) = (found.interval.unwrap(), Summary::of(slopes.iter().copied()).mean_interval(0.95).unwrap());
            assert!((found.value - 1.66).abs() < 1e-14);
            // Both quantiles are exact to about 1e-12, and tau^2 cancels.
            assert!((interval.low - expected.low).abs() < 1e-10 && (interval.high - expected.high).abs() < 1e-10, "{found:?}");
        }
    }

    #[test]
    fn a_trial_that_knows_little_counts_little() {
        let trials = [trial(1.0, 1e4), trial(1.1, 1e4), trial(9.0, 1e-3)];
        let found = pool(&trials, Weighting::Stated, 0.95).unwrap();
        // Its variance is 1000, that of the others 5e-3: a weight of 5e-6 times a difference of 8.
        assert!((found.value - 1.05).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn one_trial_has_no_interval_but_its_own_scatter() {
        let found = pool(&[trial(1.66, 40.0)], Weighting::FromScatter, 0.95).unwrap();
        assert_eq!((found.interval, found.between_trials_sd, found.n_trials), (None, None, 1));
        // sqrt(0.02 / 4 / 40), times t(0.975; 4) = 2.776445 (tables).
        let half = 2.776_445 * (0.005f64 / 40.0).sqrt();
        assert!((found.interval_within_trials.unwrap().high - 1.66 - half).abs() < 1e-8);
    }

    #[test]
    fn estimates_agree_or_do_not() {
        let near = |value| pool(&[trial(value - 0.1, 1e6), trial(value + 0.1, 1e6), trial(value, 1e6)], Weighting::Stated, 0.95).unwrap();
        assert!(agreement(&[near(1.0), near(1.02)]).unwrap() > 0.5);
        assert!(agreement(&[near(1.0), near(2.0)]).unwrap() < 1e-3);
        assert_eq!(agreement(&[near(1.0)]), None);
    }
}
