//! All results of a colony as data.

use serde::Serialize;

use super::ants::FittedKey;
use super::measures::Measures;
use super::recorded::Recorded;
use super::suite::{Plan, RunRecord};
use crate::calibrate::behaviour::BehaviourReport;
use crate::paper::Changes;
use cohaul::backend::{BackendKind, Status};
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::{Interval, Summary, Vec2, student};
use cohaul::model::paper as printed;
use cohaul_report::quantity::{quantity, short};

/// What `cohaul colony --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Colony {
    /// In two sentences.
    pub answer: String,
    /// Name of the scenario that gave load, ground, springs and search.
    pub scenario: String,
    pub recording: RecordingFacts,
    pub behaviour: BehaviourReport,
    /// Fitted keys of `drive`, beside the scenario's and the paper's values.
    pub keys: Vec<FittedKey>,
    pub quantities: Vec<Quantity>,
    /// Where the series of the recording change their mean, as in the paper's Fig. 11.
    pub changes: Changes,
    /// Load speed by the number of pulling ants, as in the paper's Fig. 9.
    pub group_size: Vec<GroupSpeed>,
    pub backends: Vec<BackendRuns>,
    /// Longest time of a run (s).
    pub run_duration_s: f64,
    pub first_seed: u64,
    pub warnings: Vec<String>,
    pub wall_s: f64,
}

impl Versioned for Colony {
    const FORMAT: Format = formats::COLONY;
}

/// A recording in a few numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingFacts {
    pub n_frames: usize,
    /// Frames without tips, which the table does not have (1).
    pub n_frames_filled: usize,
    pub frame_period_s: f64,
    pub duration_s: f64,
    /// Largest number of tips that are held at once (1).
    pub most_held: usize,
}

/// A number of the recording beside the runs of the fitted ants and the paper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    pub name: &'static str,
    pub unit: &'static str,
    pub recorded: Option<f64>,
    /// Mean over the runs of the first backend.
    pub fitted: Option<f64>,
    /// Range in which 95 % of further runs are expected (Student's t).
    pub fitted_95: Option<Interval>,
    /// Whether the recorded number is within that range.
    pub is_within: Option<bool>,
    /// What the paper measured on ants.
    pub paper_measured: Option<f64>,
    /// What the paper prints of its simulation.
    pub paper_simulated: Option<f64>,
}

/// Load speed while so many ants pulled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupSpeed {
    pub n_pulling: usize,
    pub recorded: Option<Speed>,
    /// Over all runs of the first backend.
    pub fitted: Option<Speed>,
    /// Sizes of the paper's samples; `null` where it prints none.
    pub paper_measured_samples: Option<u64>,
    pub paper_simulated_samples: Option<u64>,
}

/// Load speed over windows of half a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Speed {
    pub mean_m_per_s: f64,
    pub sd_m_per_s: f64,
    pub n_windows: u64,
    /// Share of the windows with at least one pulling ant (1).
    pub share: f64,
}

/// Runs of one backend in a few numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BackendRuns {
    pub backend: BackendKind,
    pub n_runs: usize,
    pub n_failed: usize,
    pub n_arrived: usize,
    /// The worst of all runs.
    pub status: Status,
    pub pull_mean_n: f64,
    pub load_speed_m_per_s: f64,
}

/// Share of further runs in the stated range (1).
const LEVEL: f64 = 0.95;

/// A quantity as a function of measures.
type Of = fn(&Measures) -> Option<f64>;

/// Name, unit, function, and what the paper measured on ants and simulated.
const QUANTITIES: [(&str, &str, Of, [Option<f64>; 2]); 9] = [
    ("mean pull", "N", |of| some(of.pulls.mean()), [Some(printed::MEASURED_PULL_MEAN_N), Some(printed::PULL_MEAN_N)]),
    ("sd of pulls", "N", |of| some(of.pulls.sd()), [Some(printed::MEASURED_PULL_SD_N), Some(printed::PULL_SD_N)]),
    ("largest pull", "N", |of| some(of.pulls.max()), [None, Some(printed::PULL_MAX_N)]),
    ("pulls of at most 30 mN", "", |of| share(of.n_within_limit, of.pulls.n()), [Some(printed::MEASURED_SHARE_BELOW), None]),
    ("load speed", "m/s", |of| some(of.speed.mean()), [None; 2]),
    ("turn rate", "rad/s", |of| some(of.turn_rate.mean()), [None; 2]),
    ("interaction forces", "N", |of| some(of.interaction.mean()), [None; 2]),
    (
        "interaction, late over early",
        "",
        |of| Some(of.changes.interaction?.change).map(|at| at.mean_after / at.mean_before),
        [Some(0.5), None],
    ),
    ("straight displacement", "m", |of| some(of.displacement_m), [None; 2]),
];

fn some(value: f64) -> Option<f64> {
    Some(value)
}

fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// What a colony's results are made of.
pub struct Parts<'a> {
    pub scenario: &'a str,
    /// Number of ants of the scenario (1).
    pub n_ants: usize,
    /// (m)
    pub nest: Option<Vec2>,
    pub recorded: &'a Recorded,
    pub behaviour: BehaviourReport,
    pub keys: Vec<FittedKey>,
    pub plan: &'a Plan,
    pub runs: &'a [RunRecord],
    pub wall_s: f64,
}

impl Colony {
    pub fn new(parts: Parts) -> Self {
        let Parts { recorded, behaviour, plan, runs, .. } = parts;
        let measures = Measures::of(&recorded.rows, recorded.period, parts.nest, plan.first_seed);
        let of_backends = plan.of_backends(runs);
        let first: Vec<&Measures> = of_backends.iter().take(1).flat_map(|(_, runs)| runs.iter().map(|run| &run.measures)).collect();
        let most_held = recorded.rows.iter().map(|row| row.tips.len()).max().unwrap_or(0);
        let quantities = quantities(&measures, &first);
        let mut warnings = behaviour.warnings.clone();
        if most_held > parts.n_ants {
            warnings.push(format!("{most_held} ants pull at once in the recording, and the scenario has {}", parts.n_ants));
        }
        let open: Vec<&str> = parts.keys.iter().filter(|key| !key.is_determined).map(|key| key.symbol).collect();
        if !open.is_empty() {
            warnings
                .push(format!("not determined by this recording: {}; the scenario has the likeliest or its own values", open.join(", ")));
        }
        Self {
            answer: answer(&quantities, first.len(), plan),
            scenario: parts.scenario.to_owned(),
            recording: RecordingFacts {
                n_frames: recorded.n_frames,
                n_frames_filled: recorded.n_filled,
                frame_period_s: recorded.period,
                duration_s: measures.duration_s,
                most_held,
            },
            group_size: group_speeds(&measures, &first),
            backends: of_backends.iter().map(|(kind, runs)| of_backend(*kind, runs)).collect(),
            run_duration_s: plan.duration_s,
            first_seed: plan.first_seed,
            behaviour,
            keys: parts.keys,
            quantities,
            warnings,
            changes: measures.changes,
            wall_s: parts.wall_s,
        }
    }
}

fn quantities(recorded: &Measures, runs: &[&Measures]) -> Vec<Quantity> {
    let of = |(name, unit, value, [paper_measured, paper_simulated]): (&'static str, &'static str, Of, [Option<f64>; 2])| {
        let fitted = Summary::of(runs.iter().filter_map(|run| value(run)).filter(|value| value.is_finite()));
        let recorded = value(recorded).filter(|value| value.is_finite());
        let fitted_95 = range_of_runs(&fitted);
        Quantity {
            name,
            unit,
            recorded,
            fitted: (fitted.n() > 0).then(|| fitted.mean()),
            fitted_95,
            is_within: recorded.zip(fitted_95).map(|(value, range)| (range.low..=range.high).contains(&value)),
            paper_measured,
            paper_simulated,
        }
    };
    QUANTITIES.into_iter().map(of).collect()
}

/// Range in which a further run is expected at [`LEVEL`]: the mean and Student's t times the
/// standard deviation times sqrt(1 + 1/n). No quantity is negative.
fn range_of_runs(runs: &Summary) -> Option<Interval> {
    let n = runs.n() as f64;
    let half = || student(LEVEL, n - 1.0) * runs.sd() * (1.0 + 1.0 / n).sqrt();
    (runs.n() > 1).then(|| Interval { low: (runs.mean() - half()).max(0.0), high: runs.mean() + half() })
}

fn group_speeds(recorded: &Measures, runs: &[&Measures]) -> Vec<GroupSpeed> {
    let largest = runs.iter().copied().chain([recorded]).map(|of| of.speed_by_size.len()).max().unwrap_or(0);
    let measured = |size: usize| printed::MEASURED_SAMPLES.get(size.checked_sub(printed::SMALLEST_MEASURED)?).copied();
    (1..largest)
        .map(|size| GroupSpeed {
            n_pulling: size,
            recorded: speed(&[recorded], size),
            fitted: speed(runs, size),
            paper_measured_samples: measured(size),
            paper_simulated_samples: printed::SIMULATED_SAMPLES.get(size - 1).copied(),
        })
        .collect()
}

/// Speed with so many pulling ants over all windows of these recordings or runs.
fn speed(all: &[&Measures], size: usize) -> Option<Speed> {
    let of_size = |of: &&Measures, size: usize| of.speed_by_size.get(size).copied().unwrap_or_default();
    let windows = |size: usize| all.iter().map(|of| of_size(of, size).n()).sum::<u64>();
    let n = windows(size);
    let largest = all.iter().map(|of| of.speed_by_size.len()).max()?;
    let whole: u64 = (1..largest).map(windows).sum();
    let mean = all.iter().map(|of| of_size(of, size)).map(|own| own.n() as f64 * own.mean()).sum::<f64>() / n as f64;
    // The squares of all windows about the common mean, from those about the means of the runs.
    let squares = |own: Summary| own.n().saturating_sub(1) as f64 * own.sd().powi(2) + own.n() as f64 * (own.mean() - mean).powi(2);
    let sd = (all.iter().map(|of| squares(of_size(of, size))).sum::<f64>() / n.saturating_sub(1).max(1) as f64).sqrt();
    (n > 0).then(|| Speed { mean_m_per_s: mean, sd_m_per_s: sd, n_windows: n, share: n as f64 / whole as f64 })
}

fn of_backend(backend: BackendKind, runs: &[RunRecord]) -> BackendRuns {
    let mean = |of: fn(&Measures) -> f64| Summary::of(runs.iter().map(|run| of(&run.measures))).mean();
    BackendRuns {
        backend,
        n_runs: runs.len(),
        n_failed: runs.iter().filter(|run| run.status == Status::Failed).count(),
        n_arrived: runs.iter().filter(|run| run.arrived == Some(true)).count(),
        status: runs.iter().map(|run| run.status).max().unwrap_or_default(),
        pull_mean_n: mean(|of| of.pulls.mean()),
        load_speed_m_per_s: mean(|of| of.speed.mean()),
    }
}

/// The answer: how far the fitted ants are from the recorded ones.
fn answer(quantities: &[Quantity], n_runs: usize, plan: &Plan) -> String {
    let outside: Vec<&str> = quantities.iter().filter(|of| of.is_within == Some(false)).map(|of| of.name).collect();
    let n = quantities.iter().filter(|of| of.is_within.is_some()).count();
    let within = match (n, outside.len()) {
        (0, _) => "The runs are too few to be compared with the recording".to_owned(),
        (n, 0) => format!("All {n} numbers of the recording are within the range of {n_runs} runs of the fitted ants"),
        (n, out) => {
            format!(
                "{} of {n} numbers of the recording are within the range of {n_runs} runs of the fitted ants; not: {}",
                n - out,
                outside.join(", ")
            )
        }
    };
    let both = |name: &str| {
        let found = quantities.iter().find(|of| of.name == name)?;
        let shown = |value: f64| if found.unit.is_empty() { short(value) } else { quantity(value, found.unit) };
        Some(format!("{} {} (fitted ants: {})", found.name, shown(found.recorded?), shown(found.fitted?)))
    };
    let beside: Vec<String> = ["load speed", "mean pull"].into_iter().filter_map(both).collect();
    format!("{within}. In {} of the recording: {}.", quantity(plan.duration_s, "s"), beside.join(", "))
}
