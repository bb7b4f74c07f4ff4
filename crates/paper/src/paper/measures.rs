//! All compared quantities as statistics of units.

use super::by_size::{instants, speed_of, sum_of_size};
use super::facts::Changes;
use super::mixture::{mixture, printed_share};
use super::sampling::{Pool, Sample, Sampling};
use super::trial::Trial;
use super::units::{Estimate, Unit, difference, estimate, paired, runs};
use super::verdict::{Grade, Own, Printed};
use cohaul::math::{exact_proportion_interval, proportion_interval, share_difference_interval};
use cohaul::model::paper as printed;

/// A quantity of a set of seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Of the pulls in some trials (N).
    PullMean(Sample, Sampling),
    PullSd(Sample, Sampling),
    /// Share of the time at which so many of ten ants pulled, of that with six or more (1).
    SizeShare(usize),
    /// Share of samples with so many pulling ants, of those with two or more, in the mixture of the
    /// trials that is closest to the printed counts (1).
    MixtureShare(usize),
    /// Fraction of the runs of a trial with a significant change as printed (1).
    Phase(PhaseSign, Trial),
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
    /// Load speed while on average two ants pulled, over that while three did (1).
    TwoOverThree,
    /// Speed that each further ant adds beyond five on ten springs, over what ants from two to five
    /// add (1).
    LateGain,
    /// Curvature of the load speed over two to ten pulling ants, over its slope (1): both of the
    /// parabola that is closest to all of these speeds.
    Curvature,
    /// Share of the runs of a trial that last longer than the printed time of the phase change (1).
    Lasts(Trial),
    /// Share of all samples with one pulling ant, if each trial has as many runs (1).
    ShareOfOne,
    /// Load speed with ten pulling ants over that with nine (1).
    TenOverNine,
    /// Time to nest of ten ants over that of five (1).
    TenOverFive,
    /// Time to nest of five ants over that of four on four springs (1).
    FiveOverFour,
}

/// A change of mean in the direction that the paper prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseSign {
    SpeedRises,
    TurnRateRises,
    InteractionFalls,
    AllAtOnce,
}

impl PhaseSign {
    /// Whether a run shows it; `None` where the run is too short to tell.
    pub(super) fn is_in(self, changes: &Changes) -> Option<bool> {
        let (change, is_up) = match self {
            PhaseSign::SpeedRises => (changes.speed, true),
            PhaseSign::TurnRateRises => (changes.turn_rate, true),
            PhaseSign::InteractionFalls => (changes.interaction, false),
            PhaseSign::AllAtOnce => return changes.phase.map(|at| at.change.is_significant()),
        };
        change.map(|at| at.change.is_significant() && (at.change.mean_after > at.change.mean_before) == is_up)
    }

    fn name(self) -> &'static str {
        match self {
            PhaseSign::SpeedRises => "the load speed rises",
            PhaseSign::TurnRateRises => "the turn rate rises",
            PhaseSign::InteractionFalls => "the interaction forces fall",
            PhaseSign::AllAtOnce => "speed and turn rate rise and interaction forces fall at once",
        }
    }
}

/// All quantities of the table, in its order.
pub fn measures() -> Vec<Measure> {
    let pulls = |sample, sampling| [Measure::PullMean(sample, sampling), Measure::PullSd(sample, sampling)];
    let by_sampling = Sampling::ALL.into_iter().flat_map(|sampling| pulls(Sample::Printed, sampling));
    let by_trial = Trial::ALL.into_iter().flat_map(|trial| pulls(Sample::One(trial), Sampling::AtDecisions));
    let sizes = (6..=10).map(Measure::SizeShare).chain((2..=10).map(Measure::MixtureShare));
    let times = Trial::ALL.into_iter().flat_map(|trial| [Measure::TimeToNest(trial), Measure::Arrived(trial)]);
    let ratios = [Measure::TenOverFive, Measure::FiveOverFour, Measure::TenOverNine];
    let signs = [PhaseSign::SpeedRises, PhaseSign::TurnRateRises, PhaseSign::InteractionFalls, PhaseSign::AllAtOnce];
    let phases = signs.map(|sign| Measure::Phase(sign, Trial::FourFour));
    let of_time = [Measure::ShareOfOne, Measure::Lasts(Trial::FourFour)];
    by_sampling.chain(by_trial).chain(sizes).chain(times).chain(of_time).chain(ratios).chain(phases).collect()
}

impl Measure {
    pub const PULL_MEAN: Measure = Measure::PullMean(Sample::Printed, Sampling::AtDecisions);
    pub const PULL_SD: Measure = Measure::PullSd(Sample::Printed, Sampling::AtDecisions);
    /// Quantities that inertia may move.
    pub const MOVABLE: [Measure; 6] = [
        Measure::TimeToNest(Trial::OneOne),
        Measure::TimeToNest(Trial::FourFour),
        Measure::TimeToNest(Trial::FIVE_TEN),
        Measure::TimeToNest(Trial::TEN_TEN),
        Measure::PULL_MEAN,
        Measure::PULL_SD,
    ];

    pub fn name(self) -> String {
        let of_pulls = |sample: Sample, sampling| match sampling {
            Sampling::AtDecisions => sample.name(),
            other => other.name().to_owned(),
        };
        match self {
            Measure::PullMean(sample, sampling) => format!("pull, mean, {}", of_pulls(sample, sampling)),
            Measure::PullSd(sample, sampling) => format!("pull, standard deviation, {}", of_pulls(sample, sampling)),
            Measure::SizeShare(size) => format!("share of {size} pulling ants of ten"),
            Measure::MixtureShare(size) => format!("share of {size} pulling ants, mixture of the trials"),
            Measure::Phase(sign, trial) => format!("share of runs in which {}, {}", sign.name(), trial.name()),
            Measure::TimeToNest(trial) => format!("time to nest, {}", trial.name()),
            Measure::Arrived(trial) => format!("share of runs that arrive, {}", trial.name()),
            Measure::LoadSpeed(size) => format!("load speed, {size} pulling ants"),
            Measure::SpeedOfOne => "speed of one ant over that of four".to_owned(),
            Measure::Headway(n_ants) => format!("speed towards the nest, {n_ants}/10"),
            Measure::TwoOverThree => "load speed with two pulling ants over that with three".to_owned(),
            Measure::Curvature => "curvature of the load speed over 2 to 10 pulling ants, over its slope".to_owned(),
            Measure::Lasts(trial) => format!("share of runs that last longer than {} s, {}", printed::PHASE_CHANGE_S, trial.name()),
            Measure::ShareOfOne => "share of samples with one pulling ant, equal numbers of runs".to_owned(),
            Measure::TenOverNine => "load speed with ten pulling ants over that with nine".to_owned(),
            Measure::LateGain => "speed gained per ant from 5/10 to 10/10 over that from 2/10 to 5/10".to_owned(),
            Measure::TenOverFive => "time to nest of ten ants over that of five".to_owned(),
            Measure::FiveOverFour => "time to nest, 5/10 over 4/4".to_owned(),
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Measure::PullMean(..) | Measure::PullSd(..) => "N",
            Measure::TimeToNest(_) => "s",
            Measure::LoadSpeed(_) | Measure::Headway(_) => "m/s",
            _ => "",
        }
    }

    /// What the paper prints for it. Parameters were fitted to the pulls at decisions with zeros,
    /// and to the shares of six to ten ants.
    pub fn printed(self) -> Option<Printed> {
        match self {
            Measure::PULL_MEAN => Some(Printed::new(printed::PULL_MEAN_N, 0.05e-3).calibrated()),
            Measure::PULL_SD => Some(Printed::new(printed::PULL_SD_N, 0.05e-3).calibrated()),
            Measure::PullMean(Sample::Printed, _) => Some(Printed::new(printed::PULL_MEAN_N, 0.05e-3)),
            Measure::PullSd(Sample::Printed, _) => Some(Printed::new(printed::PULL_SD_N, 0.05e-3)),
            Measure::SizeShare(size) => Some(Printed::share(printed::share_of_size(size), 0.5e-5).calibrated()),
            Measure::MixtureShare(size) => {
                let share = Printed::share(printed_share(size), 0.5e-5);
                Some(if size < printed::SMALLEST_OF_TEN { share } else { share.calibrated() })
            }
            Measure::ShareOfOne => Some(Printed::share(printed::share_of_one(), 0.5e-5)),
            _ => None,
        }
    }

    /// Estimate of all units, and its grade beside the printed number. The share of samples with
    /// one ant has no grade: that each trial has as many runs is a guess.
    pub fn graded(self, units: &[Unit]) -> (Option<Estimate>, Option<Grade>) {
        let ours = self.estimate(units);
        (ours, ours.and_then(|ours| self.grade(units, &ours)))
    }

    /// Grade of `ours` beside the printed number. The latter's own sampling error is that of a
    /// sample of the printed size, taken from runs that scatter as these.
    fn grade(self, units: &[Unit], ours: &Estimate) -> Option<Grade> {
        let printed = self.printed()?;
        let [n, n_printed] = self.sample_sizes(units)?;
        let own = ours.standard_error.map_or(Own::default(), |error| Own::of_error(error * (n / n_printed).sqrt()));
        Some(printed.grade(ours, own))
    }

    /// Number of samples in these units, and in the printed sample (1). Instants are counted at
    /// every control period.
    fn sample_sizes(self, units: &[Unit]) -> Option<[f64; 2]> {
        let pulls = |sampling| [Pool::of(units, Sample::Printed, sampling).n, printed::N_PULLS as f64];
        let instants = |trials: &[Trial], least: usize| {
            let n = trials.iter().map(|trial| instants(units, *trial, least)).sum();
            [n, printed::SIMULATED_SAMPLES[least - 1..].iter().sum::<u64>() as f64]
        };
        match self {
            Measure::PullMean(_, sampling) | Measure::PullSd(_, sampling) => Some(pulls(sampling)),
            Measure::SizeShare(_) => Some(instants(&[Trial::TEN_TEN], printed::SMALLEST_OF_TEN)),
            Measure::MixtureShare(_) => Some(instants(&Trial::ALL, 2)),
            _ => None,
        }
    }

    /// Trials that every seed must have for it.
    pub(super) fn trials(self) -> Vec<Trial> {
        match self {
            Measure::LateGain => vec![Trial::OnTen(2), Trial::FIVE_TEN, Trial::TEN_TEN],
            _ => Vec::new(),
        }
    }

    /// For a fraction of runs: whether each run of its trial counts.
    fn hits<'u>(self, units: &'u [Unit<'u>]) -> Option<Vec<Option<bool>>> {
        match self {
            Measure::Arrived(trial) => Some(units.iter().map(|unit| Some(unit.of(trial)?.arrived)).collect()),
            Measure::Lasts(trial) => Some(units.iter().map(|unit| Some(unit.of(trial)?.time_s > printed::PHASE_CHANGE_S)).collect()),
            Measure::Phase(sign, trial) => Some(units.iter().map(|unit| sign.is_in(&unit.of(trial)?.changes)).collect()),
            _ => None,
        }
    }

    /// Statistic of all units with its interval. The interval of a fraction of runs is Wilson's,
    /// which is useful even if all runs end alike, and that of changes Clopper's and Pearson's.
    pub fn estimate(self, units: &[Unit]) -> Option<Estimate> {
        let Some(hits) = self.hits(units) else { return estimate(units, &|units| self.of(units)) };
        let (n, n_hits) = hits.iter().flatten().fold((0, 0), |(n, hits), is_hit| (n + 1, hits + u64::from(*is_hit)));
        let value = self.of(units)?;
        let standard_error = (n > 1).then(|| (value * (1.0 - value) / n as f64).sqrt());
        // A claim needs a limit that chance passes in 2.5 % at most, even for rare changes.
        let of_hits = if matches!(self, Measure::Phase(..) | Measure::Lasts(_)) { exact_proportion_interval } else { proportion_interval };
        let interval_95 = of_hits(n_hits, n, 0.95).filter(|_| n > 1);
        Some(Estimate { value, interval_95, standard_error, n_units: n as usize })
    }

    /// Of `a` minus that of `b`, over the seeds that both have; a fraction of runs by Agresti and
    /// Min.
    pub fn difference(self, a: &[Unit], b: &[Unit]) -> Option<Estimate> {
        let (of_a, of_b) = paired(a, b);
        let (Some(in_a), Some(in_b)) = (self.hits(&of_a), self.hits(&of_b)) else { return difference(a, b, &|units| self.of(units)) };
        let both: Vec<[bool; 2]> = in_a.into_iter().zip(in_b).filter_map(|(a, b)| Some([a?, b?])).collect();
        let n_only = [[true, false], [false, true]].map(|only| both.iter().filter(|pair| **pair == only).count() as u64);
        let n = both.len() as u64;
        let value = (n_only[0] as f64 - n_only[1] as f64) / n as f64;
        let interval_95 = share_difference_interval(n_only, n, 0.95).filter(|_| n > 1);
        (n > 0).then_some(Estimate { value, interval_95, standard_error: None, n_units: n as usize })
    }

    pub fn of(self, units: &[Unit]) -> Option<f64> {
        match self {
            Measure::PullMean(sample, sampling) => Pool::of(units, sample, sampling).mean(),
            Measure::PullSd(sample, sampling) => Pool::of(units, sample, sampling).sd(),
            // The weights do not depend on the period at which samples are counted.
            Measure::MixtureShare(size) => mixture(units, 1.0).map(|found| found.share_of_two_or_more(size)),
            Measure::SizeShare(size) => {
                let counted = printed::SMALLEST_OF_TEN..=Trial::TEN_TEN.n_ants();
                let all: f64 = counted.map(|size| sum_of_size(units, Trial::TEN_TEN, size).time_s).sum();
                (all > 0.0).then(|| sum_of_size(units, Trial::TEN_TEN, size).time_s / all)
            }
            Measure::TimeToNest(trial) => mean(arrivals(units, trial)),
            Measure::Arrived(_) | Measure::Lasts(_) | Measure::Phase(..) => {
                mean(self.hits(units)?.into_iter().flatten().map(|is_hit| f64::from(u8::from(is_hit))))
            }
            Measure::LoadSpeed(size) => speed_of(units, size),
            Measure::SpeedOfOne => Some(headway(units, Trial::OneOne)? / headway(units, Trial::FourFour)?),
            Measure::Headway(n_ants) => headway(units, Trial::OnTen(n_ants)),
            Measure::TwoOverThree => Some(speed_of(units, 2)? / speed_of(units, 3)?),
            Measure::Curvature => curvature(units),
            Measure::ShareOfOne => share_of_one(units),
            Measure::LateGain => {
                let speed = |n_ants| headway(units, Trial::OnTen(n_ants));
                let gain = |from: u8, to: u8| Some((speed(to)? - speed(from)?) / f64::from(to - from));
                Some(gain(5, 10)? / gain(2, 5)?)
            }
            Measure::TenOverNine => Some(speed_of(units, 10)? / speed_of(units, 9)?),
            Measure::TenOverFive => Some(mean(arrivals(units, Trial::TEN_TEN))? / mean(arrivals(units, Trial::FIVE_TEN))?),
            Measure::FiveOverFour => Some(mean(arrivals(units, Trial::FIVE_TEN))? / mean(arrivals(units, Trial::FourFour))?),
        }
        .filter(|value| value.is_finite())
    }
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

/// Quadratic over linear coefficient of the parabola closest to the load speeds with two to ten
/// pulling ants, by least squares (1). About the mean size, powers of zero, one and two are
/// independent but for the mean of the squares.
fn curvature(units: &[Unit]) -> Option<f64> {
    const SIZES: std::ops::RangeInclusive<usize> = 2..=10;
    let n = SIZES.count() as f64;
    let (mut linear, mut quadratic) = ([0.0; 2], [0.0; 2]);
    let mean_square = (n * n - 1.0) / 12.0;
    for size in SIZES {
        let x = size as f64 - 0.5 * (SIZES.start() + SIZES.end()) as f64;
        let (square, speed) = (x * x - mean_square, speed_of(units, size)?);
        linear = [linear[0] + x * speed, linear[1] + x * x];
        quadratic = [quadratic[0] + square * speed, quadratic[1] + square * square];
    }
    Some((quadratic[0] / quadratic[1]) / (linear[0] / linear[1]))
}

/// Time with one pulling ant over that with one or more, in as many runs of each trial (1).
fn share_of_one(units: &[Unit]) -> Option<f64> {
    let (mut of_one, mut of_any) = (0.0, 0.0);
    for trial in Trial::ALL {
        let n = runs(units, trial).count() as f64;
        let times = |least: usize, most: usize| (least..=most).map(|size| sum_of_size(units, trial, size).time_s).sum::<f64>() / n;
        of_one += times(1, 1);
        of_any += times(1, trial.n_ants());
    }
    (of_any > 0.0).then(|| of_one / of_any)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::units::units;
    use crate::paper::{OfSize, RunFacts, WINDOWS};

    /// Speeds of a parabola through 2 to 10 pulling ants, in runs of five and of ten ants.
    #[test]
    fn the_curvature_is_that_of_a_parabola() {
        let speed = |size: usize| 0.02 + 3e-3 * (size as f64 - 6.0) - 2e-4 * (size as f64 - 6.0).powi(2);
        let run = |n_ants: usize| {
            let by_size: Vec<OfSize> = (0..=n_ants).map(|size| OfSize { time_s: 2.0, way_m: 2.0 * speed(size) }).collect();
            RunFacts { by_window: WINDOWS.map(|_| by_size.clone()), by_size, ..RunFacts::nothing() }
        };
        let runs = [(Trial::FIVE_TEN, 1, run(5)), (Trial::TEN_TEN, 1, run(10))];
        let found = Measure::Curvature.of(&units(&runs)).unwrap();
        assert!((found + 2e-4 / 3e-3).abs() < 1e-12, "{found}");
        // Five and ten ants spend 1 of 15 parts of their time with one; one and four ants are not
        // there.
        assert_eq!(Measure::ShareOfOne.of(&units(&runs)), None);
        let all = [&runs[..], &[(Trial::OneOne, 1, run(1)), (Trial::FourFour, 1, run(4))]].concat();
        assert!((Measure::ShareOfOne.of(&units(&all)).unwrap() - 4.0 / 20.0).abs() < 1e-12);
    }

    /// If every run of one set arrives and none of the other, all resamples are equal. Fractions
    /// have intervals of their own.
    #[test]
    fn a_share_that_is_another_in_every_pair_is_a_shift() {
        let runs = |arrived| (0..25).map(|seed| (Trial::FourFour, seed, RunFacts { arrived, ..RunFacts::nothing() })).collect::<Vec<_>>();
        let [all, none] = [runs(true), runs(false)];
        let [all, none] = [units(&all), units(&none)];
        let share = Measure::Arrived(Trial::FourFour);
        let found = share.estimate(&all).unwrap();
        // E. B. Wilson's interval of 25 of 25: 1 / (1 + z^2 / 25).
        assert!((found.interval_95.unwrap().low - 0.8668).abs() < 1e-4 && found.value == 1.0 && found.n_units == 25, "{found:?}");
        let shift = share.difference(&none, &all).unwrap();
        assert!(shift.value == -1.0 && shift.interval_95.unwrap().high < -0.8 && shift.n_units == 25, "{shift:?}");
        assert!(share.difference(&none, &[]).is_none() && Measure::Arrived(Trial::OneOne).difference(&none, &all).is_none());
    }
}
