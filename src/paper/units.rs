//! Units of resampling: the runs of one seed, one a trial. Ticks and pulls of a run are not independent; seeds are.
//!
//! Intervals are percentiles of the bootstrap over units. Backends share seeds, so that their differences are resampled in pairs.

use serde::Serialize;

use super::facts::RunFacts;
use super::trial::Trial;
use crate::math::{Chance, Interval, Stream};

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

/// Units from runs, in the order of seeds.
pub fn units<'a>(runs: impl IntoIterator<Item = (Trial, u64, &'a RunFacts)>) -> Vec<Unit<'a>> {
    let mut found = std::collections::BTreeMap::new();
    for (trial, seed, facts) in runs {
        found.entry(seed).or_insert(Unit { seed, runs: [None; Trial::COUNT] }).runs[trial.index()] = Some(facts);
    }
    found.into_values().collect()
}

/// A statistic with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    pub value: f64,
    /// `null` below two units, or where a resample had no value.
    pub interval_95: Option<Interval>,
    pub n_units: usize,
}

/// A statistic of a sample of units; `None` where it has no value.
pub type Statistic<'s> = dyn Fn(&[Unit]) -> Option<f64> + 's;

const N_RESAMPLES: u64 = 600;

/// `statistic` of all units, with its 95 % interval.
pub fn estimate(units: &[Unit], statistic: &Statistic) -> Option<Estimate> {
    let value = statistic(units)?;
    let of = |drawn: &[usize]| statistic(&drawn.iter().map(|i| units[*i]).collect::<Vec<_>>());
    Some(Estimate { value, interval_95: interval(units.len(), of), n_units: units.len() })
}

/// `statistic` of `a` minus that of `b`, over the seeds that both have.
pub fn difference(a: &[Unit], b: &[Unit], statistic: &Statistic) -> Option<Estimate> {
    let (a, b) = paired(a, b);
    let value = statistic(&a)? - statistic(&b)?;
    let of = |drawn: &[usize]| {
        let pick = |units: &[Unit]| statistic(&drawn.iter().map(|i| units[*i]).collect::<Vec<_>>());
        Some(pick(&a)? - pick(&b)?)
    };
    Some(Estimate { value, interval_95: interval(a.len(), of), n_units: a.len() })
}

/// The units of both whose seeds are in both.
pub fn paired<'a>(a: &[Unit<'a>], b: &[Unit<'a>]) -> (Vec<Unit<'a>>, Vec<Unit<'a>>) {
    let both = |unit: &Unit, other: &[Unit]| other.iter().any(|one| one.seed == unit.seed);
    let shared = |from: &[Unit<'a>], other: &[Unit]| from.iter().filter(|unit| both(unit, other)).copied().collect();
    (shared(a, b), shared(b, a))
}

/// Percentiles of `of` over resamples of `n` indices.
fn interval(n: usize, of: impl Fn(&[usize]) -> Option<f64>) -> Option<Interval> {
    if n < 2 {
        return None;
    }
    let chance = Chance::new(n as u64);
    let mut drawn = vec![0; n];
    let mut values = Vec::with_capacity(N_RESAMPLES as usize);
    for resample in 0..N_RESAMPLES {
        for (at, index) in drawn.iter_mut().enumerate() {
            *index = (chance.uniform(Stream::Resample, at as u32, resample) * n as f64) as usize;
        }
        values.push(of(&drawn)?);
    }
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
    Some(Interval { low: at(0.025), high: at(0.975) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Summary;

    fn facts(time_s: f64) -> RunFacts {
        RunFacts {
            arrived: true,
            time_s,
            displacement_m: 0.25,
            status: Default::default(),
            pulls: Summary::default(),
            n_grasps: 0,
            pulls_by_time: Summary::default(),
            by_size: Vec::new(),
            by_mean_size: Vec::new(),
            changes: Default::default(),
        }
    }

    fn mean_time(units: &[Unit]) -> Option<f64> {
        let times: Vec<f64> = units.iter().filter_map(|unit| Some(unit.of(Trial::FourFour)?.time_s)).collect();
        (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)
    }

    /// Against Student's interval of the same mean: the percentiles of 60 normal values are within 20 % of it.
    #[test]
    fn the_bootstrap_of_a_mean_is_nearly_students() {
        let chance = Chance::new(5);
        let runs: Vec<RunFacts> = (0..60).map(|i| facts(80.0 + 10.0 * chance.normal_pair(Stream::Scene, 1, i).x)).collect();
        let units = units(runs.iter().enumerate().map(|(seed, run)| (Trial::FourFour, seed as u64, run)));
        let found = estimate(&units, &mean_time).unwrap();
        let times: Vec<f64> = runs.iter().map(|run| run.time_s).collect();
        let (ours, students) = (found.interval_95.unwrap(), crate::math::mean_interval(&times, 0.95).unwrap());
        let half = 0.5 * (students.high - students.low);
        assert!((ours.low - students.low).abs() < 0.2 * half && (ours.high - students.high).abs() < 0.2 * half, "{ours:?} {students:?}");
    }

    /// Runs that differ by a constant differ by it exactly, however much they scatter; seeds of one side alone do not count.
    #[test]
    fn differences_are_taken_in_pairs() {
        let chance = Chance::new(6);
        let runs: Vec<RunFacts> = (0..20).map(|i| facts(80.0 + 30.0 * chance.normal_pair(Stream::Scene, 1, i).x)).collect();
        let later: Vec<RunFacts> = runs[..15].iter().map(|run| facts(run.time_s + 2.0)).collect();
        let of = |runs: &'_ [RunFacts]| -> Vec<(Trial, u64, RunFacts)> {
            runs.iter().enumerate().map(|(seed, run)| (Trial::FourFour, seed as u64, run.clone())).collect()
        };
        let (a, b) = (of(&later), of(&runs));
        let [a, b] = [&a, &b].map(|runs| units(runs.iter().map(|(trial, seed, run)| (*trial, *seed, run))));
        let found = difference(&a, &b, &mean_time).unwrap();
        let interval = found.interval_95.unwrap();
        // Rounding of means of order 100.
        assert!((found.value - 2.0).abs() < 1e-12 && (interval.high - interval.low).abs() < 1e-12 && found.n_units == 15, "{found:?}");
    }
}
