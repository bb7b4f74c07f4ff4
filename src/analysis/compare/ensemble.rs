//! The closed-loop tier: paired seeds, compared as distributions.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;
use serde::Serialize;

use super::{Settings, Tier, Verdict};
use crate::backend::{BackendKind, BackendOptions, Status};
use crate::math::{Interval, Summary, mean_interval, proportion_interval, share_difference_interval};
use crate::scenario::{AntDrive, Drive, Scenario};
use crate::simulation::run_facts::{self as facts, fact};
use crate::simulation::{Keep, Make, Simulation, Trace, built, driver_of};

/// What paired closed-loop runs found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    pub tier: Tier,
    pub n_seeds: usize,
    pub first_seed: u64,
    pub measures: Vec<Measure>,
    /// First time (s) at which the decisions of the inertial run differ from those of another, over the seeds: earliest; `null` when they never do.
    pub decisions_part: DecisionsPart,
    pub verdict: Verdict,
    /// The worst ending of a step in all runs.
    pub status: Status,
    /// One run a backend at the first seed, in the order of [`BackendKind::ALL`], for figures.
    #[serde(skip)]
    pub traces: Vec<Trace>,
}

/// One quantity of a run, over seeds: mean of each backend, and of the paired differences, with 95 % intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measure {
    pub name: &'static str,
    pub quasi_static: Distribution,
    pub inertial: Distribution,
    pub rapier: Distribution,
    /// Inertial minus quasi-static.
    pub inertia_effect: Shift,
    /// Rapier minus inertial.
    pub engine_error: Shift,
    /// Of every seed, in the order of [`BackendKind::ALL`], for figures.
    #[serde(skip)]
    pub values: Vec<[Option<f64>; 3]>,
}

/// Mean, spread and interval of the mean; `n` counts the seeds in which the quantity exists.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distribution {
    pub n: u64,
    pub mean: f64,
    pub sd: f64,
    /// Wilson's of shares; `null` below two seeds.
    pub mean_interval_95: Option<Interval>,
}

/// Paired differences of one measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shift {
    pub n: u64,
    pub mean: f64,
    pub sd: f64,
    /// Interval of the mean at the confidence `level`, by Student's t, of shares by Agresti and Min; `null` below two pairs.
    pub interval: Option<Interval>,
    /// The level of each that makes 95 % for all measures, by inertia and by the engine, together (Bonferroni).
    pub level: f64,
    /// Whether the interval leaves out zero, by more than roundings.
    pub is_shifted: bool,
    /// Whether the interval lies within 5 % of the inertial mean, or roundings, on both sides of zero; of shares, within 5 % of all runs.
    pub is_equal: bool,
}

/// Means within this share of each other count as equal (1): half of what the printed force statistics of such runs are given to.
const EQUAL: f64 = 0.05;
/// Difference over the size of what a measure is made of that is none (1): far beyond roundings of runs, which may all have one sign, and far below what anybody counts.
const ROUNDING: f64 = 1e-9;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DecisionsPart {
    pub quasi_static_s: Option<f64>,
    pub rapier_s: Option<f64>,
}

/// One run's quantities; `None` where it has none.
struct Run {
    values: Vec<Option<f64>>,
    trace: Trace,
    status: Status,
}

/// What runs are compared by. SI units stand in the names.
struct Quantity {
    name: &'static str,
    /// The value in a run; that of a number of [`run_facts`](crate::simulation::run_facts) by its column.
    of: fn(&facts::Run, &Trace) -> Option<f64>,
    /// What it is made of, by order of magnitude: differences are those of numbers of this size.
    size: fn(&AntDrive, &Scenario) -> f64,
    /// Whether every run has it or not: its mean is a share.
    is_share: bool,
}

const MEASURES: [Quantity; 6] = [
    Quantity {
        name: "time_to_nest_s",
        of: |run, _| fact("time_to_nest_s").in_table(run).as_number(),
        size: |_, scenario| scenario.duration,
        is_share: false,
    },
    // Of all runs: those that do not arrive have no time.
    Quantity { name: "arrived_share", of: |run, _| fact("arrived").in_table(run).as_number(), size: |_, _| 1.0, is_share: true },
    Quantity {
        name: "mean_speed_m_per_s",
        of: |run, _| fact("mean_speed_m_per_s").in_table(run).as_number(),
        size: |drive, _| drive.pull_speed,
        is_share: false,
    },
    Quantity {
        name: "pull_mean_n",
        of: |run, _| fact("pull_mean_n").in_table(run).as_number(),
        size: |drive, _| drive.release.strong_pull,
        is_share: false,
    },
    Quantity {
        name: "pull_sd_n",
        of: |run, _| fact("pull_sd_n").in_table(run).as_number(),
        size: |drive, _| drive.release.strong_pull,
        is_share: false,
    },
    Quantity {
        name: "n_transporting",
        of: |_, trace| {
            let mut holders = Summary::default();
            holders.extend(trace.rows.iter().map(|row| row.tips.len() as f64));
            (holders.n() > 0).then(|| holders.mean())
        },
        size: |_, _| 1.0,
        is_share: false,
    },
];

/// Runs `n_seeds` seeds from the scenario's own on all backends. `watch` sees the share done (1) and says whether to go on; `None` when it said no.
///
/// # Panics
/// Without a seed.
pub fn closed_loop(scenario: &Scenario, settings: &Settings, n_seeds: usize, watch: impl Fn(f64) -> bool + Sync) -> Option<ClosedLoop> {
    closed_loop_with(scenario, settings, n_seeds, &built, watch)
}

/// The same with an engine of the caller's in rapier's place, as in [`prescribed_with`](super::prescribed_with); `engine` makes one for each seed.
///
/// # Panics
/// As [`closed_loop`].
pub fn closed_loop_with(
    scenario: &Scenario,
    settings: &Settings,
    n_seeds: usize,
    engine: &Make,
    watch: impl Fn(f64) -> bool + Sync,
) -> Option<ClosedLoop> {
    assert!(n_seeds > 0, "a comparison over seeds must have one");
    let n_runs = (BackendKind::ALL.len() * n_seeds) as f64;
    let n_done = AtomicUsize::new(0);
    let runs: Option<Vec<[Run; 3]>> = (0..n_seeds)
        .into_par_iter()
        .map(|at| {
            let seeded = Scenario { seed: scenario.seed.wrapping_add(at as u64), ..scenario.clone() };
            let run = |kind, make: &Make| {
                let mut run =
                    run_of(&seeded, &settings.options(&seeded, kind), make, |share| watch((n_done.load(Relaxed) as f64 + share) / n_runs))?;
                n_done.fetch_add(1, Relaxed);
                if at > 0 {
                    // Figures show the first seed only.
                    run.trace.rows = Vec::new();
                }
                Some(run)
            };
            Some([run(BackendKind::QuasiStatic, &built)?, run(BackendKind::Inertial, &built)?, run(BackendKind::Rapier, engine)?])
        })
        .collect();
    Some(judged(scenario, runs?))
}

fn run_of(scenario: &Scenario, options: &BackendOptions, make: &Make, watch: impl Fn(f64) -> bool) -> Option<Run> {
    let mut run = Simulation::on(scenario, options, Keep::Trace, driver_of(scenario), make(scenario, options));
    run.run(|time| watch(time / scenario.duration));
    if !run.is_finished() {
        return None;
    }
    let (trace, outcome) = run.into_results();
    let facts = facts::Run { scenario, options, outcome: &outcome, path_length: None, wall_time: None };
    let values = MEASURES.iter().map(|measure| (measure.of)(&facts, &trace)).collect();
    Some(Run { values, trace, status: outcome.steps.status })
}

fn judged(scenario: &Scenario, mut runs: Vec<[Run; 3]>) -> ClosedLoop {
    let measures: Vec<Measure> = (0..MEASURES.len()).map(|at| measure(at, scenario, &runs)).collect();
    let earliest = |other: usize| {
        let part = |run: &[Run; 3]| decisions_part(&run[1].trace, &run[other].trace);
        runs.iter().filter_map(part).min_by(f64::total_cmp)
    };
    let decisions_part = DecisionsPart { quasi_static_s: earliest(0), rapier_s: earliest(2) };
    let status = runs.iter().flatten().map(|run| run.status).max().unwrap_or_default();
    let verdict = if status == Status::Failed { Verdict::NotComputed } else { verdict(&measures, runs.len()) };
    let (n_seeds, first_seed) = (runs.len(), scenario.seed);
    let traces = runs.swap_remove(0).map(|run| run.trace).into();
    ClosedLoop { tier: Tier::ClosedLoop, n_seeds, first_seed, measures, decisions_part, verdict, status, traces }
}

fn measure(at: usize, scenario: &Scenario, runs: &[[Run; 3]]) -> Measure {
    let Quantity { name, size, is_share, .. } = MEASURES[at];
    // Other drives have no closed loop.
    let rounding = if let Drive::Ants(drive) = &scenario.drive { ROUNDING * size(drive, scenario) } else { 0.0 };
    let of = |kind: usize| Distribution::of(runs.iter().filter_map(|run| run[kind].values[at]).collect(), is_share);
    let inertial = of(1);
    let paired = |a: usize, b: usize| {
        let difference = |run: &[Run; 3]| Some(run[a].values[at]? - run[b].values[at]?);
        let differences: Vec<f64> = runs.iter().filter_map(difference).collect();
        if is_share { Shift::of_shares(&differences) } else { Shift::of_means(&differences, inertial.mean, rounding) }
    };
    let values = runs.iter().map(|run| run.each_ref().map(|run| run.values[at])).collect();
    let (inertia_effect, engine_error) = (paired(1, 0), paired(2, 1));
    Measure { name, quasi_static: of(0), inertial, rapier: of(2), inertia_effect, engine_error, values }
}

impl Measure {
    /// Whether some run has it. What none has, such as the time to a nest that nobody reaches, tells nothing.
    pub fn is_there(&self) -> bool {
        [&self.quasi_static, &self.inertial, &self.rapier].iter().any(|of| of.n > 0)
    }
}

impl Distribution {
    fn of(values: Vec<f64>, is_share: bool) -> Self {
        let mut summary = Summary::default();
        summary.extend(values.iter().copied());
        let n_hits = values.iter().filter(|value| **value == 1.0).count() as u64;
        let mean_interval_95 = match is_share {
            true => proportion_interval(n_hits, summary.n(), 0.95).filter(|_| values.len() > 1),
            false => mean_interval(&values, 0.95),
        };
        Self { n: summary.n(), mean: summary.mean(), sd: summary.sd(), mean_interval_95 }
    }
}

impl Shift {
    /// The level of each that makes 95 % for all measures, by inertia and by the engine, together.
    const LEVEL: f64 = 1.0 - 0.05 / (2 * MEASURES.len()) as f64;

    /// Of paired differences whose reference has the mean `reference`, and of which those up to `rounding` are none.
    fn of_means(values: &[f64], reference: f64, rounding: f64) -> Self {
        let margin = (EQUAL * reference.abs()).max(rounding);
        Self::within(values, mean_interval(values, Self::LEVEL), rounding, margin)
    }

    /// Of what each run of a pair has (1) or has not (0): that all pairs agree says little where there are few.
    fn of_shares(values: &[f64]) -> Self {
        let n_only = [1.0, -1.0].map(|only| values.iter().filter(|value| **value == only).count() as u64);
        let n = values.len() as u64;
        let interval = share_difference_interval(n_only, n, Self::LEVEL).filter(|_| n > 1);
        // A mean that is added up would leave roundings of nothing.
        let mean = if n > 0 { (n_only[0] as f64 - n_only[1] as f64) / n as f64 } else { 0.0 };
        Self { mean, ..Self::within(values, interval, 0.0, EQUAL) }
    }

    /// Whether means differ by what counts: what is known to lie within 5 % does not, however many seeds show that it is not zero.
    pub fn differs(&self) -> bool {
        self.is_shifted && !self.is_equal
    }

    fn within(values: &[f64], interval: Option<Interval>, rounding: f64, margin: f64) -> Self {
        let mut summary = Summary::default();
        summary.extend(values.iter().copied());
        Self {
            n: summary.n(),
            mean: summary.mean(),
            sd: summary.sd(),
            interval,
            level: Self::LEVEL,
            is_shifted: interval.is_some_and(|interval| interval.low > rounding || interval.high < -rounding),
            is_equal: interval.is_some_and(|interval| interval.low >= -margin && interval.high <= margin),
        }
    }
}

/// First time (s) at which the events of two runs differ.
fn decisions_part(a: &Trace, b: &Trace) -> Option<f64> {
    let mut events = a.events.iter().zip(&b.events);
    let differ = events.find(|(a, b)| (a.time, a.spring, a.ant, a.kind) != (b.time, b.spring, b.ant, b.kind));
    let beyond = || a.events.len().min(b.events.len());
    let first_unpaired = || a.events.get(beyond()).or(b.events.get(beyond())).map(|event| event.time);
    differ.map(|(a, b)| a.time.min(b.time)).or_else(first_unpaired)
}

/// Paths have decorrelated; what remains is whether means differ. Too few seeds to show a shift, or that there is none, are below their own error.
fn verdict(measures: &[Measure], n_seeds: usize) -> Verdict {
    let any = |is: fn(&Measure) -> bool| measures.iter().filter(|measure| measure.is_there()).any(is);
    if n_seeds < 2 {
        Verdict::Decorrelated
    } else if any(|measure| measure.inertia_effect.differs()) {
        Verdict::Inertia
    } else if any(|measure| measure.engine_error.differs()) {
        Verdict::Engine
    } else if any(|measure| !(measure.inertia_effect.is_equal && measure.engine_error.is_equal)) {
        Verdict::BelowOwnError
    } else {
        Verdict::Agree
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means a hundredth apart, told by few seeds and by many, and means a tenth apart: many seeds show that the first differ, and by how little.
    #[test]
    fn a_shift_that_is_known_to_be_small_decides_nothing() {
        let of = |mean: f64, n: u32| {
            let values: Vec<f64> = (0..n).map(|i| mean + if i % 2 == 0 { 0.02 } else { -0.02 }).collect();
            let shift = Shift::of_means(&values, 1.0, 0.0);
            (shift.is_shifted, shift.is_equal, shift.differs())
        };
        assert_eq!(of(0.01, 6), (false, false, false));
        assert_eq!(of(0.01, 100), (true, true, false));
        assert_eq!(of(0.1, 100), (true, false, true));
    }

    /// Eleven of twelve: Wilson's interval ends below one; and as many runs on either side leave no rounding.
    #[test]
    fn shares_have_the_intervals_and_the_means_of_shares() {
        let mut values = vec![1.0; 11];
        values.push(0.0);
        let interval = Distribution::of(values, true).mean_interval_95.unwrap();
        // E. B. Wilson's formula with z = 1.959964, by hand.
        assert!((interval.low - 0.6461).abs() < 1e-4 && (interval.high - 0.9851).abs() < 1e-4, "{interval:?}");
        let pairs: Vec<f64> = (0..30).map(|i| f64::from(i % 3) - 1.0).collect();
        assert_eq!(Shift::of_shares(&pairs).mean, 0.0);
    }
}
