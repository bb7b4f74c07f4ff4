//! All compared quantities as statistics of units, and the claims of the paper.

use serde::Serialize;

use super::facts::{OfSize, RunFacts};
use super::trial::Trial;
use super::units::{Estimate, Unit, difference, estimate, paired};
use super::verdict::Printed;
use crate::math::{proportion_interval, share_difference_interval};
use crate::model::paper as printed;

/// A quantity of a set of seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Of the pulls at decisions in some trials (N).
    PullMean(Sample),
    PullSd(Sample),
    /// Share of the time at which so many of ten ants pulled, of that with six or more (1).
    SizeShare(usize),
    /// Mean over the runs that arrived (s).
    TimeToNest(Trial),
    /// Share of the runs that arrived (1).
    Arrived(Trial),
    /// Displacement of the load over time while so many ants pulled (m/s), with ten springs.
    LoadSpeed(usize),
    /// Speed towards the nest of so many ants on ten springs (m/s).
    Headway(u8),
    /// Speed towards the nest of one ant on one spring over that of four on four (1).
    SpeedOfOne,
    /// Load speed while on average so many of five ants pulled, over that while all five did (1).
    OverFive(usize),
    /// Speed that each further ant adds beyond five on ten springs, over what ants from two to five
    /// add (1).
    LateGain,
    /// Time to nest of ten ants over that of five (1).
    TenOverFive,
    /// Time to nest of five ants over that of four on four springs (1).
    FiveOverFour,
}

/// Which trials a sample of pulls comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sample {
    /// 4/4 and 5/10: the groups of two to five ants make up nearly the printed size of the sample.
    Printed,
    One(Trial),
}

impl Sample {
    pub fn trials(self) -> Vec<Trial> {
        match self {
            Sample::Printed => vec![Trial::FourFour, Trial::FIVE_TEN],
            Sample::One(trial) => vec![trial],
        }
    }

    pub fn runs<'a>(self, unit: &Unit<'a>) -> Vec<&'a RunFacts> {
        self.trials().into_iter().filter_map(|trial| unit.of(trial)).collect()
    }

    fn name(self) -> String {
        match self {
            Sample::Printed => "4/4 and 5/10".to_owned(),
            Sample::One(trial) => trial.name(),
        }
    }
}

/// All quantities of the table, in its order.
pub const MEASURES: [Measure; 25] = [
    Measure::PullMean(Sample::Printed),
    Measure::PullSd(Sample::Printed),
    Measure::PullMean(Sample::One(Trial::OneOne)),
    Measure::PullSd(Sample::One(Trial::OneOne)),
    Measure::PullMean(Sample::One(Trial::FourFour)),
    Measure::PullSd(Sample::One(Trial::FourFour)),
    Measure::PullMean(Sample::One(Trial::FIVE_TEN)),
    Measure::PullSd(Sample::One(Trial::FIVE_TEN)),
    Measure::PullMean(Sample::One(Trial::TEN_TEN)),
    Measure::PullSd(Sample::One(Trial::TEN_TEN)),
    Measure::SizeShare(6),
    Measure::SizeShare(7),
    Measure::SizeShare(8),
    Measure::SizeShare(9),
    Measure::SizeShare(10),
    Measure::TimeToNest(Trial::OneOne),
    Measure::Arrived(Trial::OneOne),
    Measure::TimeToNest(Trial::FourFour),
    Measure::Arrived(Trial::FourFour),
    Measure::TimeToNest(Trial::FIVE_TEN),
    Measure::Arrived(Trial::FIVE_TEN),
    Measure::TimeToNest(Trial::TEN_TEN),
    Measure::Arrived(Trial::TEN_TEN),
    Measure::TenOverFive,
    Measure::FiveOverFour,
];

impl Measure {
    pub fn name(self) -> String {
        match self {
            Measure::PullMean(sample) => format!("pull, mean, {}", sample.name()),
            Measure::PullSd(sample) => format!("pull, standard deviation, {}", sample.name()),
            Measure::SizeShare(size) => format!("share of {size} pulling ants of ten"),
            Measure::TimeToNest(trial) => format!("time to nest, {}", trial.name()),
            Measure::Arrived(trial) => format!("share of runs that arrive, {}", trial.name()),
            Measure::LoadSpeed(size) => format!("load speed, {size} pulling ants"),
            Measure::SpeedOfOne => "speed of one ant over that of four".to_owned(),
            Measure::Headway(n_ants) => format!("speed towards the nest, {n_ants}/10"),
            Measure::OverFive(size) => format!("load speed with {size} pulling ants over that with five"),
            Measure::LateGain => "speed gained per ant from 5/10 to 10/10 over that from 2/10 to 5/10".to_owned(),
            Measure::TenOverFive => "time to nest of ten ants over that of five".to_owned(),
            Measure::FiveOverFour => "time to nest, 5/10 over 4/4".to_owned(),
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Measure::PullMean(_) | Measure::PullSd(_) => "N",
            Measure::TimeToNest(_) => "s",
            Measure::LoadSpeed(_) | Measure::Headway(_) => "m/s",
            _ => "",
        }
    }

    /// What the paper prints for it.
    pub fn printed(self) -> Option<Printed> {
        match self {
            Measure::PullMean(Sample::Printed) => Some(Printed::new(printed::PULL_MEAN_N, 0.05e-3)),
            Measure::PullSd(Sample::Printed) => Some(Printed::new(printed::PULL_SD_N, 0.05e-3)),
            Measure::SizeShare(size) => Some(Printed::share(printed::share_of_size(size), 0.5e-5)),
            _ => None,
        }
    }

    /// Trials that every seed must have for it.
    fn trials(self) -> Vec<Trial> {
        match self {
            Measure::LateGain => vec![Trial::OnTen(2), Trial::FIVE_TEN, Trial::TEN_TEN],
            _ => Vec::new(),
        }
    }

    /// Statistic of all units with its interval. The interval of a fraction is Wilson's, which is
    /// useful even if all runs end alike.
    pub fn estimate(self, units: &[Unit]) -> Option<Estimate> {
        let Measure::Arrived(trial) = self else { return estimate(units, &|units| self.of(units)) };
        let (n, n_arrived) = runs(units, trial).fold((0, 0), |(n, hits), run| (n + 1, hits + u64::from(run.arrived)));
        let interval_95 = proportion_interval(n_arrived, n, 0.95).filter(|_| n > 1);
        Some(Estimate { value: self.of(units)?, interval_95, n_units: n as usize })
    }

    /// Of `a` minus that of `b`, over the seeds that both have; a share by Agresti and Min.
    pub fn difference(self, a: &[Unit], b: &[Unit]) -> Option<Estimate> {
        let Measure::Arrived(trial) = self else { return difference(a, b, &|units| self.of(units)) };
        let (a, b) = paired(a, b);
        let both: Vec<[bool; 2]> = a.iter().zip(&b).filter_map(|(a, b)| Some([a.of(trial)?.arrived, b.of(trial)?.arrived])).collect();
        let n_only = [[true, false], [false, true]].map(|only| both.iter().filter(|pair| **pair == only).count() as u64);
        let n = both.len() as u64;
        let value = (n_only[0] as f64 - n_only[1] as f64) / n as f64;
        let interval_95 = share_difference_interval(n_only, n, 0.95).filter(|_| n > 1);
        (n > 0).then_some(Estimate { value, interval_95, n_units: n as usize })
    }

    pub fn of(self, units: &[Unit]) -> Option<f64> {
        match self {
            Measure::PullMean(sample) => Pool::of(units, sample).mean(),
            Measure::PullSd(sample) => Pool::of(units, sample).sd(),
            Measure::SizeShare(size) => {
                let counted = printed::SMALLEST_OF_TEN..=Trial::TEN_TEN.n_ants();
                let all: f64 = counted.map(|size| sum_of_size(units, Trial::TEN_TEN, size).time_s).sum();
                (all > 0.0).then(|| sum_of_size(units, Trial::TEN_TEN, size).time_s / all)
            }
            Measure::TimeToNest(trial) => mean(arrivals(units, trial)),
            Measure::Arrived(trial) => mean(runs(units, trial).map(|run| f64::from(u8::from(run.arrived)))),
            Measure::LoadSpeed(size) => speed_of(units, size),
            Measure::SpeedOfOne => Some(headway(units, Trial::OneOne)? / headway(units, Trial::FourFour)?),
            Measure::Headway(n_ants) => headway(units, Trial::OnTen(n_ants)),
            Measure::OverFive(size) => Some(speed_of(units, size)? / speed_of(units, 5)?),
            Measure::LateGain => {
                let speed = |n_ants| headway(units, Trial::OnTen(n_ants));
                let gain = |from: u8, to: u8| Some((speed(to)? - speed(from)?) / f64::from(to - from));
                Some(gain(5, 10)? / gain(2, 5)?)
            }
            Measure::TenOverFive => Some(mean(arrivals(units, Trial::TEN_TEN))? / mean(arrivals(units, Trial::FIVE_TEN))?),
            Measure::FiveOverFour => Some(mean(arrivals(units, Trial::FIVE_TEN))? / mean(arrivals(units, Trial::FourFour))?),
        }
        .filter(|value| value.is_finite())
    }
}

/// A sample of pulls from many runs.
#[derive(Clone, Copy, Debug, Default)]
struct Pool {
    n: f64,
    sum: f64,
    squares: f64,
}

impl Pool {
    fn of(units: &[Unit], sample: Sample) -> Self {
        let mut pool = Self::default();
        for run in units.iter().flat_map(|unit| sample.runs(unit)) {
            let (n, mean, sd) = (run.pulls.n() as f64, run.pulls.mean(), run.pulls.sd());
            pool.n += n;
            pool.sum += n * mean;
            pool.squares += (n - 1.0).max(0.0) * sd * sd + n * mean * mean;
        }
        pool
    }

    fn mean(&self) -> Option<f64> {
        (self.n > 0.0).then(|| self.sum / self.n)
    }

    fn sd(&self) -> Option<f64> {
        let mean = self.mean()?;
        (self.n > 1.0).then(|| ((self.squares - self.n * mean * mean).max(0.0) / (self.n - 1.0)).sqrt())
    }
}

fn runs<'a>(units: &[Unit<'a>], trial: Trial) -> impl Iterator<Item = &'a RunFacts> {
    units.iter().filter_map(move |unit| unit.of(trial))
}

fn arrivals<'a>(units: &[Unit<'a>], trial: Trial) -> impl Iterator<Item = f64> {
    runs(units, trial).filter(|run| run.arrived).map(|run| run.time_s)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value));
    (n > 0.0).then(|| sum / n)
}

/// Distance covered over time in all runs (m/s), arrived or not.
fn headway(units: &[Unit], trial: Trial) -> Option<f64> {
    let (way, time) = runs(units, trial).fold((0.0, 0.0), |(way, time), run| (way + run.displacement_m, time + run.time_s));
    (time > 0.0).then(|| way / time)
}

/// Time and way of all runs of `trial` while `size` ants pulled.
fn sum_of_size(units: &[Unit], trial: Trial, size: usize) -> OfSize {
    let found = runs(units, trial).filter_map(|run| run.by_size.get(size));
    found.fold(OfSize::default(), |sum, one| OfSize { time_s: sum.time_s + one.time_s, way_m: sum.way_m + one.way_m })
}

/// Trial with groups of a size on ten springs: up to five in the trial of five ants, larger groups
/// in that of ten.
fn trial_of_size(size: usize) -> Trial {
    if size < printed::SMALLEST_OF_TEN { Trial::FIVE_TEN } else { Trial::TEN_TEN }
}

/// Speed (m/s) in windows in which on average `size` ants pulled, with ten springs.
fn speed_of(units: &[Unit], size: usize) -> Option<f64> {
    let found = runs(units, trial_of_size(size)).filter_map(|run| run.by_mean_size.get(size));
    let (way, time) = found.fold((0.0, 0.0), |(way, time), one| (way + one.way_m, time + one.time_s));
    (time > 0.0).then(|| way / time)
}

/// Load speed by group size, as in the paper's ninth figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Speeds {
    pub n_transporting: usize,
    pub trial: Trial,
    /// Over windows in which on average so many pulled.
    pub load_speed_m_per_s: Option<Estimate>,
    /// Standard deviation over runs (m/s).
    pub sd_over_runs_m_per_s: Option<f64>,
    /// Mean over the ticks at which so many ants pulled (m/s). The jump after a release then counts
    /// for the smaller group.
    pub load_speed_by_tick_m_per_s: Option<f64>,
    /// Of those ticks: time (s), number, and the number printed.
    pub time_s: f64,
    pub n_instants: u64,
    pub printed_instants: u64,
    /// Of so many ants on ten springs, however many of them pull (m/s, towards the nest).
    pub headway_m_per_s: Option<Estimate>,
}

/// Speed by the number of ants that pull, and by that of ants, from one to ten.
pub fn load_speeds(units: &[Unit], control_period: f64) -> Vec<Speeds> {
    let of_size = |size: usize| {
        let trial = trial_of_size(size);
        let of_ticks = sum_of_size(units, trial, size);
        let mut over_runs = crate::math::Summary::default();
        over_runs.extend(units.iter().filter_map(|unit| speed_of(std::slice::from_ref(unit), size)));
        Speeds {
            n_transporting: size,
            trial,
            load_speed_m_per_s: Measure::LoadSpeed(size).estimate(units),
            sd_over_runs_m_per_s: (over_runs.n() > 1).then(|| over_runs.sd()),
            load_speed_by_tick_m_per_s: (of_ticks.time_s > 0.0).then(|| of_ticks.way_m / of_ticks.time_s),
            time_s: of_ticks.time_s,
            n_instants: (of_ticks.time_s / control_period).round() as u64,
            printed_instants: printed::SIMULATED_SAMPLES[size - 1],
            headway_m_per_s: Measure::Headway(size as u8).estimate(units),
        }
    };
    (1..=Trial::TEN_TEN.n_ants()).map(of_size).collect()
}

/// Something that the paper says in words, as a statistic on one side of a limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    pub claim: &'static str,
    pub statistic: String,
    pub below: bool,
    pub limit: f64,
    pub found: Option<Estimate>,
    /// Whether the whole interval is on the side of the claim: `null` when the limit lies in it.
    pub holds: Option<bool>,
}

/// Claim, statistic, whether it must be below the limit, and the limit. The paper gives no limits.
const CLAIMS: [(&str, Measure, bool, f64); 6] = [
    ("one ant hardly moves the load", Measure::SpeedOfOne, true, 1.0 / 3.0),
    ("two ants are not enough for speed", Measure::OverFive(2), true, 0.5),
    ("three ants are", Measure::OverFive(3), false, 0.5),
    ("each further ant adds less", Measure::LateGain, true, 0.5),
    ("speed saturates between five and ten ants", Measure::TenOverFive, false, 0.75),
    ("five ants on ten springs are faster than four on four", Measure::FiveOverFour, true, 0.75),
];

/// The claims on these units.
pub fn claims(units: &[Unit]) -> Vec<Claim> {
    let judged = |(claim, measure, below, limit): (&'static str, Measure, bool, f64)| {
        // Not all seeds have all numbers of ants.
        let trials = measure.trials();
        let complete: Vec<Unit> = units.iter().filter(|unit| trials.iter().all(|trial| unit.of(*trial).is_some())).copied().collect();
        let found = measure.estimate(&complete);
        let holds = found.and_then(|found| {
            let interval = found.interval_95?;
            let (is_below, is_above) = (interval.high < limit, interval.low > limit);
            (is_below || is_above).then_some(is_below == below)
        });
        Claim { claim, statistic: measure.name(), below, limit, found, holds }
    };
    CLAIMS.into_iter().map(judged).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::paper::units::units;

    /// If every run of one set arrives and none of the other, all resamples are equal. Fractions
    /// have intervals of their own.
    #[test]
    fn a_share_that_is_another_in_every_pair_is_a_shift() {
        let runs = |arrived: bool| -> Vec<RunFacts> { (0..25).map(|_| RunFacts { arrived, ..RunFacts::nothing() }).collect() };
        let (all, none) = (runs(true), runs(false));
        let of = |runs: &'_ [RunFacts]| {
            runs.iter().enumerate().map(|(seed, run)| (Trial::FourFour, seed as u64, run.clone())).collect::<Vec<_>>()
        };
        let (all, none) = (of(&all), of(&none));
        let [all, none] = [&all, &none].map(|runs| units(runs.iter().map(|(trial, seed, run)| (*trial, *seed, run))));
        let share = Measure::Arrived(Trial::FourFour);
        let found = share.estimate(&all).unwrap();
        // E. B. Wilson's interval of 25 of 25: 1 / (1 + z^2 / 25).
        assert!((found.interval_95.unwrap().low - 0.8668).abs() < 1e-4 && found.value == 1.0 && found.n_units == 25, "{found:?}");
        let shift = share.difference(&none, &all).unwrap();
        assert!(shift.value == -1.0 && shift.interval_95.unwrap().high < -0.8 && shift.n_units == 25, "{shift:?}");
        assert!(share.difference(&none, &units([])).is_none() && Measure::Arrived(Trial::OneOne).difference(&none, &all).is_none());
    }
}
