//! Comparison of distributions over paired seeds: the closed-loop tier.

use serde::{Serialize, Serializer};

use super::doubt::Doubt;
use super::engine::EngineName;
use super::seed_runs::{EQUAL, MEASURES, Quantity, SeedRuns};
use super::seeds::{pairs_needed, pairs_needed_of_fractions};
use super::settings::Tier;
use super::verdict::{Answers, Verdict};
use crate::backend::Status;
use crate::math::{Interval, Summary, proportion_interval, share_difference_interval};
use crate::scenario::{Drive, Scenario};
use crate::simulation::Trace;
use crate::simulation::run_facts::unit_of;

/// Result of paired closed-loop runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    pub tier: Tier,
    /// The answers below have the key `engine`.
    #[serde(rename = "engine_name")]
    pub engine: EngineName,
    pub n_seeds: usize,
    pub first_seed: u64,
    pub measures: Vec<Measure>,
    pub first_different_decision: FirstDifferentDecision,
    /// The word that follows from the two answers on all measures.
    pub verdict: Verdict,
    #[serde(flatten)]
    pub answers: Answers,
    /// Verdict on each measure, in their order; JSON has them by name.
    #[serde(serialize_with = "by_name")]
    pub verdicts: Vec<MeasureVerdict>,
    /// Number of seeds that would decide all measures, if means and spreads stay; `null` if all are
    /// decided, or with one seed.
    pub n_seeds_needed: Option<u64>,
    /// Seeds in which an exact run is doubtful, and why it is first; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<SeedDoubt>,
    /// Worst status of a step in all runs.
    pub status: Status,
    /// Run of each backend at the first seed, for figures, in the order of
    /// [`BackendKind::COMPARED`](crate::backend::BackendKind::COMPARED).
    #[serde(skip)]
    pub traces: Vec<Trace>,
}

/// First reason to doubt an exact run of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeedDoubt {
    pub seed: u64,
    #[serde(flatten)]
    pub doubt: Doubt,
}

/// One quantity of a run, over all seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measure {
    /// Name that ends in the unit.
    pub name: &'static str,
    pub quasi_static: Distribution,
    pub inertial: Distribution,
    pub engine: Distribution,
    /// Inertial minus quasi-static.
    pub inertia_effect: PairedDifference,
    /// Engine minus inertial.
    pub engine_error: PairedDifference,
    /// Values of every seed, for figures, in the order of
    /// [`BackendKind::COMPARED`](crate::backend::BackendKind::COMPARED).
    #[serde(skip)]
    pub values: Vec<[Option<f64>; 3]>,
}

/// Verdict on the means of one measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasureVerdict {
    #[serde(skip)]
    pub name: &'static str,
    /// The word that follows from the two answers.
    pub verdict: Verdict,
    #[serde(flatten)]
    pub answers: Answers,
    /// Mean of inertial minus quasi-static, in the unit.
    pub inertia_effect: f64,
    /// Mean of engine minus inertial, in the unit.
    pub engine_error: f64,
    /// Half of the wider confidence interval of both, in the unit; `null` below two pairs.
    pub reference_error: Option<f64>,
    /// Largest difference of means that counts as equal, in the unit.
    pub tolerance: f64,
    pub unit: &'static str,
}

/// Mean and spread over the `n` seeds in which a quantity exists.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distribution {
    pub n: u64,
    pub mean: f64,
    pub sd: f64,
    /// Confidence interval of the mean, after Wilson for fractions; `null` below two seeds.
    pub mean_interval_95: Option<Interval>,
}

/// Paired differences of one quantity between two backends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairedDifference {
    pub n: u64,
    pub mean: f64,
    pub sd: f64,
    /// Confidence interval of the mean at `level`, after Student, or after Agresti and Min for
    /// fractions; `null` below two pairs.
    pub interval: Option<Interval>,
    /// Level of each interval that makes 95 % for all of them together (Bonferroni).
    pub level: f64,
    /// Whether the interval excludes zero by more than rounding.
    pub excludes_zero: bool,
    /// Whether the interval lies within 5 % of the inertial mean, or of 1 for fractions.
    pub is_equal: bool,
    /// Largest difference of means that counts as equal.
    pub tolerance: f64,
    /// Number of pairs that would show whether the means differ or are equal, if mean and spread
    /// stay; `null` if it is known, or below two pairs.
    pub n_needed: Option<u64>,
}

/// First time at which the decisions differ from those of the inertial run, over all seeds; `null`
/// if they never do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FirstDifferentDecision {
    /// (s)
    pub quasi_static_s: Option<f64>,
    /// (s)
    pub engine_s: Option<f64>,
}

/// Largest difference that rounding can cause, divided by the size of the terms of a measure (1).
const ROUNDING: f64 = 1e-9;

/// The comparison of all seeds, with the traces of the first.
pub(super) fn judge(scenario: &Scenario, engine: &EngineName, runs: &[SeedRuns], traces: [Trace; 3]) -> ClosedLoop {
    let measures: Vec<Measure> = (0..MEASURES.len()).map(|at| measure(at, scenario, runs)).collect();
    let earliest = |other: usize| runs.iter().filter_map(|run| run.first_different[other]).min_by(f64::total_cmp);
    let first_different_decision = FirstDifferentDecision { quasi_static_s: earliest(0), engine_s: earliest(1) };
    let status = runs.iter().flat_map(|run| run.statuses).max().unwrap_or_default();
    let doubts = doubts(scenario, runs);
    let (verdict, answers) = match status {
        Status::Failed => (Verdict::NotComputed, Answers::OPEN),
        _ => doubted(verdict(&measures, runs.len()), &doubts),
    };
    let of_measure = |measure: &Measure| {
        let found = measure.verdict(runs.len());
        let (verdict, answers) = doubted((found.verdict, found.answers), &doubts);
        MeasureVerdict { verdict, answers, ..found }
    };
    let verdicts = measures.iter().map(of_measure).collect();
    // More seeds do not end a doubt.
    let needed = |measure: &Measure| measure.n_seeds_needed(runs.len()).filter(|_| doubts.is_empty());
    let n_seeds_needed = measures.iter().filter_map(needed).max();
    let (n_seeds, first_seed) = (runs.len(), scenario.seed);
    ClosedLoop {
        tier: Tier::ClosedLoop,
        engine: engine.clone(),
        n_seeds,
        first_seed,
        measures,
        first_different_decision,
        verdict,
        answers,
        verdicts,
        n_seeds_needed,
        doubts,
        status,
        traces: traces.into(),
    }
}

/// Seeds in which an exact run is doubtful.
fn doubts(scenario: &Scenario, runs: &[SeedRuns]) -> Vec<SeedDoubt> {
    let seed = |at: usize| scenario.seed.wrapping_add(at as u64);
    runs.iter().enumerate().filter_map(|(at, run)| Some(SeedDoubt { seed: seed(at), doubt: run.doubt? })).collect()
}

/// Verdict on means over seeds, of which some are doubtful. Leaving these out would choose among
/// the seeds by what happens in them.
fn doubted(found: (Verdict, Answers), doubts: &[SeedDoubt]) -> (Verdict, Answers) {
    match found.0 {
        Verdict::NotComputed => found,
        _ if doubts.is_empty() => found,
        _ => (Verdict::Inconclusive, Answers::OPEN),
    }
}

fn by_name<S: Serializer>(verdicts: &[MeasureVerdict], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(verdicts.iter().map(|verdict| (verdict.name, verdict)))
}

fn measure(at: usize, scenario: &Scenario, runs: &[SeedRuns]) -> Measure {
    let Quantity { name, size, is_fraction, .. } = MEASURES[at];
    // Other drives have no closed loop.
    let rounding = if let Drive::Ants(drive) = &scenario.drive { ROUNDING * size(drive, scenario) } else { 0.0 };
    let of = |kind: usize| Distribution::of(runs.iter().filter_map(|run| run.values[kind][at]).collect(), is_fraction);
    let inertial = of(1);
    let paired = |a: usize, b: usize| {
        let difference = |run: &SeedRuns| Some(run.values[a][at]? - run.values[b][at]?);
        let differences: Vec<f64> = runs.iter().filter_map(difference).collect();
        match is_fraction {
            true => PairedDifference::of_fractions(&differences),
            false => PairedDifference::of_means(&differences, inertial.mean, rounding),
        }
    };
    let values = runs.iter().map(|run| run.values.each_ref().map(|values| values[at])).collect();
    let (inertia_effect, engine_error) = (paired(1, 0), paired(2, 1));
    Measure { name, quasi_static: of(0), inertial, engine: of(2), inertia_effect, engine_error, values }
}

impl Measure {
    /// Whether a run has this quantity. The time to the nest, for instance, exists only for runs
    /// that arrive.
    pub fn exists(&self) -> bool {
        [&self.quasi_static, &self.inertial, &self.engine].iter().any(|of| of.n > 0)
    }

    fn verdict(&self, n_seeds: usize) -> MeasureVerdict {
        let Self { name, inertia_effect: inertia, engine_error: engine, .. } = self;
        let half = |of: &PairedDifference| of.interval.map(|interval| 0.5 * (interval.high - interval.low));
        let answers = answers([inertia.differs(), engine.differs()], [inertia.is_equal, engine.is_equal]);
        let verdict = match () {
            () if !self.exists() => Verdict::NotComputed,
            () if n_seeds < 2 => Verdict::Decorrelated,
            () => answers.verdict(),
        };
        MeasureVerdict {
            name,
            verdict,
            answers,
            inertia_effect: inertia.mean,
            engine_error: engine.mean,
            reference_error: half(inertia).zip(half(engine)).map(|(a, b)| a.max(b)),
            tolerance: inertia.tolerance,
            unit: unit_of(name),
        }
    }

    /// Number of seeds that would decide this measure, from the share of the `n_seeds` that have
    /// pairs.
    fn n_seeds_needed(&self, n_seeds: usize) -> Option<u64> {
        let of = |paired: &PairedDifference| paired.n_needed.map(|n| (n as f64 * n_seeds as f64 / paired.n as f64).ceil() as u64);
        [&self.inertia_effect, &self.engine_error].into_iter().filter_map(of).max()
    }
}

impl Distribution {
    fn of(values: Vec<f64>, is_fraction: bool) -> Self {
        let summary = Summary::of(values.iter().copied());
        let n_hits = values.iter().filter(|value| **value == 1.0).count() as u64;
        let mean_interval_95 = match is_fraction {
            true => proportion_interval(n_hits, summary.n(), 0.95).filter(|_| values.len() > 1),
            false => summary.mean_interval(0.95),
        };
        Self { n: summary.n(), mean: summary.mean(), sd: summary.sd(), mean_interval_95 }
    }
}

impl PairedDifference {
    /// 95 % for all measures and both differences together.
    const LEVEL: f64 = 1.0 - 0.05 / (2 * MEASURES.len()) as f64;

    /// Differences with the inertial mean `reference`; those up to `rounding` count as zero.
    fn of_means(values: &[f64], reference: f64, rounding: f64) -> Self {
        let margin = (EQUAL * reference.abs()).max(rounding);
        let found = Self::within(values, Summary::of(values.iter().copied()).mean_interval(Self::LEVEL), rounding, margin);
        found.with_needed(|| pairs_needed(found.mean, found.sd, (rounding, margin), Self::LEVEL))
    }

    /// Differences of values that are 0 or 1. Few pairs have a wide interval even if all are equal.
    fn of_fractions(values: &[f64]) -> Self {
        let n_only = [1.0, -1.0].map(|only| values.iter().filter(|value| **value == only).count() as u64);
        let n = values.len() as u64;
        let interval = share_difference_interval(n_only, n, Self::LEVEL).filter(|_| n > 1);
        // A running sum would leave rounding where the mean is zero.
        let mean = if n > 0 { (n_only[0] as f64 - n_only[1] as f64) / n as f64 } else { 0.0 };
        let found = Self { mean, ..Self::within(values, interval, 0.0, EQUAL) };
        found.with_needed(|| pairs_needed_of_fractions(n_only, n, EQUAL, Self::LEVEL))
    }

    /// With the number of pairs that would decide, if there are pairs that do not.
    fn with_needed(self, needed: impl Fn() -> Option<u64>) -> Self {
        let is_open = self.interval.is_some() && !self.is_equal && !self.excludes_zero;
        Self { n_needed: is_open.then(needed).flatten(), ..self }
    }

    /// Whether the means differ by more than 5 %, as far as the interval shows.
    pub fn differs(&self) -> bool {
        self.excludes_zero && !self.is_equal
    }

    fn within(values: &[f64], interval: Option<Interval>, rounding: f64, margin: f64) -> Self {
        let summary = Summary::of(values.iter().copied());
        Self {
            n: summary.n(),
            mean: summary.mean(),
            sd: summary.sd(),
            interval,
            level: Self::LEVEL,
            excludes_zero: interval.is_some_and(|interval| interval.low > rounding || interval.high < -rounding),
            is_equal: interval.is_some_and(|interval| interval.low >= -margin && interval.high <= margin),
            tolerance: margin,
            n_needed: None,
        }
    }
}

/// Verdict on the differences of means. Too few seeds are inconclusive.
fn verdict(measures: &[Measure], n_seeds: usize) -> (Verdict, Answers) {
    let measures = || measures.iter().filter(|measure| measure.exists());
    let differ = [measures().any(|of| of.inertia_effect.differs()), measures().any(|of| of.engine_error.differs())];
    let equal = [measures().all(|of| of.inertia_effect.is_equal), measures().all(|of| of.engine_error.is_equal)];
    let answers = answers(differ, equal);
    (if n_seeds < 2 { Verdict::Decorrelated } else { answers.verdict() }, answers)
}

/// Answers on an inertia effect and an engine error that `differ` from zero or are `equal` to it.
fn answers(differ: [bool; 2], equal: [bool; 2]) -> Answers {
    // As a share of a tolerance: nothing, twice as much, or anything.
    let range = |at: usize| match (differ[at], equal[at]) {
        (true, _) => [2.0, 2.0],
        (false, true) => [0.0, 0.0],
        (false, false) => [0.0, 2.0],
    };
    Answers::of([range(0), range(1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means that differ by 1 %, from few seeds and from many, and means that differ by 10 %.
    #[test]
    fn a_difference_that_is_known_to_be_small_counts_as_equal() {
        let of = |mean: f64, n: u32| {
            let values: Vec<f64> = (0..n).map(|i| mean + if i % 2 == 0 { 0.02 } else { -0.02 }).collect();
            let difference = PairedDifference::of_means(&values, 1.0, 0.0);
            (difference.excludes_zero, difference.is_equal, difference.differs())
        };
        assert_eq!(of(0.01, 6), (false, false, false));
        assert_eq!(of(0.01, 100), (true, true, false));
        assert_eq!(of(0.1, 100), (true, false, true));
    }

    /// Wilson's interval of eleven of twelve ends below one; balanced pairs have the mean zero.
    #[test]
    fn fractions_have_the_intervals_and_the_means_of_fractions() {
        let mut values = vec![1.0; 11];
        values.push(0.0);
        let interval = Distribution::of(values, true).mean_interval_95.unwrap();
        // E. B. Wilson's formula with z = 1.959964, by hand.
        assert!((interval.low - 0.6461).abs() < 1e-4 && (interval.high - 0.9851).abs() < 1e-4, "{interval:?}");
        let pairs: Vec<f64> = (0..30).map(|i| f64::from(i % 3) - 1.0).collect();
        assert_eq!(PairedDifference::of_fractions(&pairs).mean, 0.0);
    }
}
