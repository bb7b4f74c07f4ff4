//! Units of resampling: the runs of one seed, one for each trial. Ticks and pulls of a run are not
//! independent, but seeds are.
//!
//! An interval is Student's t times the standard error of the bootstrap over units. Percentiles
//! would be far too narrow for few units, for which t is exact for means. Units that a statistic
//! does not depend on, such as seeds without a run of its trial, do not count. Backends share
//! seeds, so that their differences are between pairs.

use std::borrow::Borrow;

use serde::{Deserialize, Serialize};

use super::facts::RunFacts;
use super::trial::Trial;
use cohaul::math::{Interval, RandomStreams, Stream, Summary, student};
use cohaul_report::quantity::quantity;

/// The runs of one seed, at most one a trial.
#[derive(Clone, Copy, Debug)]
pub struct Unit<'a> {
    pub seed: u64,
    runs: [Option<&'a RunFacts>; Trial::COUNT],
}

impl<'a> Unit<'a> {
    pub fn of(&self, trial: Trial) -> Option<&'a RunFacts> {
        self.runs[trial.index()]
    }
}

/// Units from runs with their trials and seeds, in the order of seeds.
pub fn units<R: Borrow<RunFacts>>(runs: &[(Trial, u64, R)]) -> Vec<Unit<'_>> {
    let mut found = std::collections::BTreeMap::new();
    for (trial, seed, facts) in runs {
        let unit = found.entry(*seed).or_insert(Unit { seed: *seed, runs: [None; Trial::COUNT] });
        unit.runs[trial.index()] = Some(facts.borrow());
    }
    found.into_values().collect()
}

pub(super) fn runs<'a>(units: &[Unit<'a>], trial: Trial) -> impl Iterator<Item = &'a RunFacts> {
    units.iter().filter_map(move |unit| unit.of(trial))
}

/// A statistic with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    pub value: f64,
    /// `null` below two units, or where a resample had no value.
    pub interval_95: Option<Interval>,
    /// Scatter of the value over samples of as many units; `null` where there is no interval.
    pub standard_error: Option<f64>,
    /// Number of units that the value depends on.
    pub n_units: usize,
}

impl Estimate {
    /// A value with its standard error over `n_units` units and Student's interval.
    pub fn students(value: f64, standard_error: Option<f64>, n_units: usize) -> Self {
        let interval_95 = standard_error.filter(|_| n_units > 1).map(|error| {
            let half = student(0.95, (n_units - 1) as f64) * error;
            Interval { low: value - half, high: value + half }
        });
        Self { value, interval_95, standard_error, n_units }
    }

    /// Whether the interval leaves out zero.
    pub fn is_not_zero(&self) -> bool {
        self.interval_95.is_some_and(|interval| interval.low > 0.0 || interval.high < 0.0)
    }
}

/// A value with its interval, for people; a dash where there is none.
pub fn with_interval(estimate: &Option<Estimate>, unit: &str) -> String {
    let Some(Estimate { value, interval_95, .. }) = *estimate else { return "-".to_owned() };
    let between = |Interval { low, high }| format!(" ({} to {})", quantity(low, unit), quantity(high, unit));
    quantity(value, unit) + &interval_95.map_or_else(String::new, between)
}

/// A statistic of a sample of units; `None` where it has no value.
pub type Statistic<'s> = dyn Fn(&[Unit]) -> Option<f64> + 's;

const N_RESAMPLES: u64 = 600;

/// `statistic` of all units, with its 95 % interval.
pub fn estimate(units: &[Unit], statistic: &Statistic) -> Option<Estimate> {
    let value = statistic(units)?;
    let counting: Vec<usize> = (0..units.len()).filter(|at| counts(units, *at, statistic)).collect();
    let error = standard_error(&counting, |drawn| statistic(&picked(units, drawn)));
    Some(Estimate::students(value, error, counting.len()))
}

/// `statistic` of `a` minus that of `b`, over the seeds that both have.
pub fn difference(a: &[Unit], b: &[Unit], statistic: &Statistic) -> Option<Estimate> {
    let (a, b) = paired(a, b);
    let value = statistic(&a)? - statistic(&b)?;
    let counting: Vec<usize> = (0..a.len()).filter(|at| counts(&a, *at, statistic) || counts(&b, *at, statistic)).collect();
    let of = |drawn: &[usize]| Some(statistic(&picked(&a, drawn))? - statistic(&picked(&b, drawn))?);
    Some(Estimate::students(value, standard_error(&counting, of), counting.len()))
}

fn picked<'a>(units: &[Unit<'a>], drawn: &[usize]) -> Vec<Unit<'a>> {
    drawn.iter().map(|at| units[*at]).collect()
}

/// Whether a statistic depends on one of the units.
fn counts(units: &[Unit], at: usize, statistic: &Statistic) -> bool {
    let others: Vec<usize> = (0..units.len()).filter(|other| *other != at).collect();
    statistic(&picked(units, &others)) != statistic(units)
}

/// The units of both whose seeds are in both.
pub fn paired<'a>(a: &[Unit<'a>], b: &[Unit<'a>]) -> (Vec<Unit<'a>>, Vec<Unit<'a>>) {
    let both = |unit: &Unit, other: &[Unit]| other.iter().any(|one| one.seed == unit.seed);
    let shared = |from: &[Unit<'a>], other: &[Unit]| from.iter().filter(|unit| both(unit, other)).copied().collect();
    (shared(a, b), shared(b, a))
}

/// Scatter of a statistic over resamples of the `counting` units; `None` below two of them, or
/// where a resample has no value.
fn standard_error(counting: &[usize], of: impl Fn(&[usize]) -> Option<f64>) -> Option<f64> {
    let n = counting.len();
    if n < 2 {
        return None;
    }
    let streams = RandomStreams::new(n as u64);
    let (mut drawn, mut values) = (vec![0; n], Summary::default());
    for resample in 0..N_RESAMPLES {
        for (at, index) in drawn.iter_mut().enumerate() {
            *index = counting[(streams.uniform(Stream::Resample, at as u32, resample) * n as f64) as usize];
        }
        values.add(of(&drawn)?);
    }
    // Resamples scatter as a mean does that divides by n where its standard error divides by n - 1.
    Some(values.sd() * (n as f64 / (n - 1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs of four ants that took these times (s), a seed each.
    fn runs_of(times: impl IntoIterator<Item = f64>) -> Vec<(Trial, u64, RunFacts)> {
        let runs = times.into_iter().map(|time_s| RunFacts { time_s, ..RunFacts::nothing() });
        runs.zip(0..).map(|(run, seed)| (Trial::FourFour, seed, run)).collect()
    }

    fn mean_time(units: &[Unit]) -> Option<f64> {
        let times: Vec<f64> = units.iter().filter_map(|unit| Some(unit.of(Trial::FourFour)?.time_s)).collect();
        (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)
    }

    /// The standard error of 600 resamples is known to 3 % (1 / sqrt(2 * 600)), and three times
    /// that is allowed. Units without a run do not count.
    #[test]
    fn the_interval_of_a_mean_is_students() {
        let streams = RandomStreams::new(5);
        let times: Vec<f64> = (0..60).map(|i| 80.0 + 10.0 * streams.normal_pair(Stream::Scene, 1, i).x).collect();
        for n in [2, 3, 12, 60] {
            let mut runs = runs_of(times.iter().copied());
            runs[n..].iter_mut().for_each(|(trial, ..)| *trial = Trial::OneOne);
            let found = estimate(&units(&runs), &mean_time).unwrap();
            let (ours, students) = (found.interval_95.unwrap(), Summary::of(times[..n].iter().copied()).mean_interval(0.95).unwrap());
            let half = 0.5 * (students.high - students.low);
            assert!(
                (ours.low - students.low).abs() < 0.1 * half && (ours.high - students.high).abs() < 0.1 * half,
                "{ours:?} {students:?}"
            );
            assert_eq!(found.n_units, n);
        }
    }

    /// Runs that differ by a constant have exactly this difference, whatever their scatter. Seeds
    /// of one side alone do not count.
    #[test]
    fn differences_are_taken_in_pairs() {
        let streams = RandomStreams::new(6);
        let times: Vec<f64> = (0..20).map(|i| 80.0 + 30.0 * streams.normal_pair(Stream::Scene, 1, i).x).collect();
        let (later, runs) = (runs_of(times[..15].iter().map(|time| time + 2.0)), runs_of(times));
        let found = difference(&units(&later), &units(&runs), &mean_time).unwrap();
        let interval = found.interval_95.unwrap();
        // Rounding of means of order 100.
        assert!((found.value - 2.0).abs() < 1e-12 && (interval.high - interval.low).abs() < 1e-12 && found.n_units == 15, "{found:?}");
    }
}
