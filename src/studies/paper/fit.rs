//! Search for the parameters that the paper does not print.
//!
//! The sets of parameters are a Latin hypercube over speed, gain of force between two decisions,
//! half angle and sensing range, for each way to decide on releases. The score of a set is its
//! largest deviation from the printed numbers, relative to the limit that counts as near. A score
//! below one meets all printed numbers. The seeds of the search are not used elsewhere.

use serde::{Deserialize, Serialize};

use super::facts;
use super::facts::RunFacts;
use super::measures::Measure;
use super::sampling::Sample;
use super::trial::{Case, Trial};
use super::units::{Unit, units};
use crate::backend::BackendKind;
use crate::math::{RandomStreams, Stream};
use crate::model::behaviour::{ReleaseLaw, ReleasePace};
use crate::model::paper as printed;
use crate::scenario::AntDrive;
use crate::scenario::presets::{Preset, ants};

/// One set of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub release_pace: ReleasePace,
    pub pull_speed_m_per_s: f64,
    pub release_decision_period_s: f64,
    pub steering_half_angle_rad: f64,
    pub sensing_range_m: f64,
    /// Whose set it is, if any preset's.
    pub preset: Option<Preset>,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub pull_mean_n: f64,
    pub pull_sd_n: f64,
    pub pull_max_n: f64,
    pub n_pulls: u64,
    /// Of six to ten pulling ants of ten (1).
    pub size_shares: [f64; 5],
    /// Means over all runs, those that did not arrive with their longest time (s).
    pub time_four_s: f64,
    pub time_five_s: f64,
    pub time_ten_s: f64,
}

/// Seeds of the study begin here, far from those that are judged.
pub const FIRST_SEED: u64 = 1_000_001;
/// Ranges of speed (m/s), way of a tip between decisions (m), half angle (rad) and reach (m).
const RANGES: [(f64, f64); 4] = [(0.03, 0.08), (0.0055, 0.0095), (0.4, 1.2), (0.014, 0.024)];

/// The sets: those of the presets, then `n_points` for each pace.
pub fn points(n_points: usize) -> Vec<Point> {
    let mut found: Vec<Point> = [Preset::Default, Preset::PaperSpeed, Preset::Aged].into_iter().map(of_preset).collect();
    for (at, pace) in [ReleasePace::Hazard, ReleasePace::Aged].into_iter().enumerate() {
        let columns: Vec<Vec<f64>> = (0..RANGES.len()).map(|axis| column(n_points, (at * RANGES.len() + axis) as u32)).collect();
        found.extend((0..n_points).map(|i| {
            let value = |axis: usize| RANGES[axis].0 + (RANGES[axis].1 - RANGES[axis].0) * columns[axis][i];
            Point {
                release_pace: pace,
                pull_speed_m_per_s: value(0),
                release_decision_period_s: (value(1) / value(0) / TICK_S).round() * TICK_S,
                steering_half_angle_rad: value(2),
                sensing_range_m: value(3),
                preset: None,
            }
        }));
    }
    found
}

/// Periods are whole numbers of control ticks (s).
const TICK_S: f64 = 0.0025;

fn of_preset(preset: Preset) -> Point {
    let ants = ants(preset, 1);
    Point {
        release_pace: ants.release_pace,
        pull_speed_m_per_s: ants.pull_speed,
        release_decision_period_s: ants.release.period,
        steering_half_angle_rad: ants.steering_half_angle,
        sensing_range_m: ants.sensing_range,
        preset: Some(preset),
    }
}

/// One value in each of `n` equal parts of (0, 1), in a random order.
fn column(n: usize, axis: u32) -> Vec<f64> {
    let streams = RandomStreams::new(20_100);
    let mut values: Vec<f64> = (0..n).map(|i| (i as f64 + streams.uniform(Stream::Scene, axis, i as u64)) / n as f64).collect();
    for i in (1..n).rev() {
        let drawn = streams.uniform(Stream::Resample, axis, i as u64);
        values.swap(i, (drawn * (i + 1) as f64) as usize);
    }
    values
}

impl Point {
    fn drive(&self, n_ants: usize) -> AntDrive {
        let standard = ants(Preset::Default, n_ants);
        AntDrive {
            release_pace: self.release_pace,
            pull_speed: self.pull_speed_m_per_s,
            release: ReleaseLaw { period: self.release_decision_period_s, ..standard.release },
            steering_half_angle: self.steering_half_angle_rad,
            sensing_range: self.sensing_range_m,
            ..standard
        }
    }

    /// Runs 4/4, 5/10 and 10/10 at `n_seeds` seeds; `None` when `watch` said no.
    pub fn try_out(&self, n_seeds: u64, watch: impl Fn() -> bool) -> Option<Found> {
        let case = Case::new(Preset::Default, BackendKind::QuasiStatic);
        let mut runs: Vec<(Trial, u64, RunFacts)> = Vec::new();
        for trial in [Trial::FourFour, Trial::FIVE_TEN, Trial::TEN_TEN] {
            for seed in FIRST_SEED..FIRST_SEED + n_seeds {
                let scenario = trial.with_ants(self.drive(trial.n_ants()), seed);
                runs.push((trial, seed, facts::run_scenario(trial, &scenario, &case.options(&scenario), |_| watch())?));
            }
        }
        Some(Found::of(&units(runs.iter().map(|(trial, seed, run)| (*trial, *seed, run)))))
    }
}

impl Found {
    fn of(units: &[Unit]) -> Self {
        let of = |measure: Measure| measure.of(units).unwrap_or_default();
        let sample = || units.iter().flat_map(|unit| Sample::Printed.runs(unit));
        let time = |trial| {
            let times: Vec<f64> = units.iter().filter_map(|unit| Some(unit.of(trial)?.time_s)).collect();
            times.iter().sum::<f64>() / times.len().max(1) as f64
        };
        Self {
            pull_mean_n: of(Measure::PullMean(Sample::Printed)),
            pull_sd_n: of(Measure::PullSd(Sample::Printed)),
            pull_max_n: sample().map(|run| run.pulls.max()).fold(0.0, f64::max),
            n_pulls: sample().map(|run| run.pulls.n()).sum(),
            size_shares: std::array::from_fn(|at| of(Measure::SizeShare(printed::SMALLEST_OF_TEN + at))),
            time_four_s: time(Trial::FourFour),
            time_five_s: time(Trial::FIVE_TEN),
            time_ten_s: time(Trial::TEN_TEN),
        }
    }

    /// Deviations over the limit that counts as near (1): mean and standard deviation of pulls over
    /// 10 %, the largest fraction over 0.05, and the time of four ants over half a decade about 100
    /// s.
    pub fn deviations(&self) -> [f64; 4] {
        let share = |(at, share): (usize, &f64)| (share - printed::share_of_size(printed::SMALLEST_OF_TEN + at)).abs() / 0.05;
        [
            (self.pull_mean_n / printed::PULL_MEAN_N - 1.0).abs() / 0.1,
            (self.pull_sd_n / printed::PULL_SD_N - 1.0).abs() / 0.1,
            self.size_shares.iter().enumerate().map(share).fold(0.0, f64::max),
            (self.time_four_s / 100.0).log10().abs() / 0.5,
        ]
    }

    /// The worst of them (1).
    pub fn score(&self) -> f64 {
        self.deviations().into_iter().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hypercube_has_one_set_in_each_part_of_each_range() {
        let n = 20;
        let all = points(n);
        let sets = &all[3..3 + n];
        let parts = |of: fn(&Point) -> f64, (low, high): (f64, f64)| {
            let mut parts: Vec<usize> = sets.iter().map(|point| (n as f64 * (of(point) - low) / (high - low)) as usize).collect();
            parts.sort_unstable();
            parts
        };
        let each: Vec<usize> = (0..n).collect();
        assert_eq!(parts(|point| point.pull_speed_m_per_s, RANGES[0]), each);
        assert_eq!(parts(|point| point.sensing_range_m, RANGES[3]), each);
        assert!(all.len() == 3 + 2 * n && all[3 + n..].iter().all(|point| point.release_pace == ReleasePace::Aged));
    }
}
