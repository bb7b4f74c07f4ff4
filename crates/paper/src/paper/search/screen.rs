//! First look at a set: a few seeds without inertia, and the distance to the printed numbers.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::plan::CLOSE;
use super::space::{Searched, TRIALS, case};
use crate::paper::{Measure, NEAR_PULL, NEAR_SHARE, RunFacts, Sample, Sampling, Trial, Unit, facts, largest, units};
use cohaul::backend::BackendKind;
use cohaul::model::open_choices::Chosen;
use cohaul::model::paper as printed;

/// Quantities of the first look, from trials of two and more ants.
pub const SCREENED: [Measure; 18] = [
    Measure::PULL_MEAN,
    Measure::PULL_SD,
    Measure::SizeShare(6),
    Measure::SizeShare(7),
    Measure::SizeShare(8),
    Measure::SizeShare(9),
    Measure::SizeShare(10),
    Measure::PullMean(Sample::Printed, Sampling::WithoutZeros),
    Measure::PullMean(Sample::Printed, Sampling::ByTime),
    Measure::LoadSpeed(2),
    Measure::LoadSpeed(3),
    Measure::LoadSpeed(5),
    Measure::LoadSpeed(10),
    Measure::Headway(2),
    Measure::Headway(5),
    Measure::Headway(10),
    Measure::TwoOverThree,
    Measure::LateGain,
];

/// Values of [`SCREENED`] and the largest pull (N); `null` where a run had none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Screened {
    pub values: Vec<Option<f64>>,
    pub largest_pull_n: Option<f64>,
    /// Worst deviation from the calibration targets, over what counts as near (1).
    pub distance: Option<f64>,
}

/// Worst deviation of the calibration targets, each over what counts as near (1): mean and standard
/// deviation of the pulls within 10 %, and the fractions of six to ten pulling ants within 0.05.
/// `None` where one of them has no value.
pub fn distance(units: &[Unit]) -> Option<f64> {
    Some(distance_of_pulls(units)?.max(distance_of_shares(units)?))
}

fn distance_of_pulls(units: &[Unit]) -> Option<f64> {
    let relative = |measure: Measure, printed: f64| Some((measure.of(units)? / printed - 1.0).abs() / NEAR_PULL);
    let mean = relative(Measure::PULL_MEAN, printed::PULL_MEAN_N)?;
    Some(mean.max(relative(Measure::PULL_SD, printed::PULL_SD_N)?))
}

fn distance_of_shares(units: &[Unit]) -> Option<f64> {
    let share = |size: usize| Some((Measure::SizeShare(size).of(units)? - printed::share_of_size(size)).abs() / NEAR_SHARE);
    (printed::SMALLEST_OF_TEN..=Trial::TEN_TEN.n_ants()).map(share).try_fold(0.0, |worst: f64, share| Some(worst.max(share?)))
}

/// A set: its values of the searched choices.
pub type Set<'a> = (&'a [Searched], &'a [Chosen]);

/// Runs of a set on one backend at `seeds`; `None` when `watch` said no.
pub fn runs(
    (searched, values): Set,
    backend: BackendKind,
    trials: &[Trial],
    seeds: Range<u64>,
    watch: &dyn Fn() -> bool,
) -> Option<Vec<(Trial, u64, RunFacts)>> {
    let case = case(searched, values, backend);
    let of = |trial: Trial, seed: u64| {
        let scenario = trial.scenario(&case, seed);
        Some((trial, seed, facts::run_scenario(trial, &scenario, &case.options(&scenario), |_| watch())?))
    };
    trials.iter().flat_map(|trial| seeds.clone().map(move |seed| (*trial, seed))).map(|(trial, seed)| of(trial, seed)).collect()
}

/// The first look at a set within the box: it ends where the fractions of ten ants, which take
/// least time, are too far off. `None` when `watch` said no.
pub fn screened_briefly(set: Set, seeds: Range<u64>, watch: &dyn Fn() -> bool) -> Option<Screened> {
    let runs = runs(set, BackendKind::QuasiStatic, &[Trial::TEN_TEN], seeds.clone(), watch)?;
    let distance = distance_of_shares(&units(&runs));
    if distance.is_none_or(|distance| distance > CLOSE) {
        return Some(Screened { values: vec![None; SCREENED.len()], largest_pull_n: None, distance });
    }
    screened(set, seeds, watch)
}

/// The first look at a set; `None` when `watch` said no.
pub fn screened(set: Set, seeds: Range<u64>, watch: &dyn Fn() -> bool) -> Option<Screened> {
    let runs = runs(set, BackendKind::QuasiStatic, &TRIALS[1..], seeds, watch)?;
    let units = units(&runs);
    Some(Screened {
        values: SCREENED.iter().map(|measure| measure.of(&units)).collect(),
        largest_pull_n: largest(&units, Sampling::AtDecisions).map(|found| found.expected),
        distance: distance(&units),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::OfSize;
    use cohaul::math::Summary;

    /// Runs whose pulls have the printed moments times a factor, and whose fractions are printed.
    fn at(factor: f64) -> Option<f64> {
        let (mean, sd) = (factor * printed::PULL_MEAN_N, printed::PULL_SD_N);
        // Two values with this mean and sample standard deviation.
        let half = sd / 2f64.sqrt();
        let pulls = Summary::of([mean - half, mean + half]);
        let by_size =
            (0..=10).map(|size| OfSize { time_s: if size < 6 { 0.0 } else { printed::share_of_size(size) }, way_m: 0.0 }).collect();
        let run = RunFacts { pulls, by_size, ..RunFacts::nothing() };
        let runs = [(Trial::FourFour, 1, run.clone()), (Trial::FIVE_TEN, 1, run.clone()), (Trial::TEN_TEN, 1, run)];
        distance(&units(&runs))
    }

    /// At the printed numbers the distance is rounding and the sd of four values in place of two,
    /// sqrt(2/3) of that: 18 %, 1.8 times near.
    #[test]
    fn the_distance_is_the_worst_deviation_over_near() {
        let sd_alone = (1.0 - (2.0f64 / 3.0).sqrt()) / NEAR_PULL;
        assert!((at(1.0).unwrap() - sd_alone).abs() < 1e-9, "{:?}", at(1.0));
        assert!((at(1.3).unwrap() - 3.0).abs() < 1e-9 && (at(0.7).unwrap() - 3.0).abs() < 1e-9);
        assert_eq!(distance(&[]), None);
    }
}
