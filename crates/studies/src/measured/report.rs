//! Medians over measured runs, the systematic part of the model error, and the answer.

use serde::Serialize;

use super::fit::{Fit, median};
use super::run::{Found, Question, RunRecord};
use cohaul::formats::{Format, MEASURED, Versioned};
use cohaul::math::Summary;
use cohaul_report::quantity::short_quantity;

/// Number of runs that are shown as the worst (1).
pub const N_WORST: usize = 10;
/// Share of the model error below which the other differences are no part of the problem (1).
const SMALL: f64 = 0.1;

/// What was found of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    pub scenario: String,
    /// Files of the recording.
    pub recording: Vec<String>,
    pub answer: String,
    pub question: Question,
    /// Runs that were simulated.
    pub n_runs: usize,
    /// Runs without a result.
    pub n_left_out: usize,
    /// Runs with a doubtful simulation, which are counted like all others.
    pub n_doubtful: usize,
    /// Medians and quartiles over the runs; `null` without a result.
    pub over_runs: Option<OverRuns>,
    /// What the measurement itself cannot tell (m); `null` if it is not known.
    pub own_limit: Option<OwnLimit>,
    /// Systematic part and spread of the model error; `null` without a result.
    pub bias: Option<Bias>,
    /// Runs with the largest model errors, the largest first.
    pub worst: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<Fit>,
    /// What was left out, put in order or converted.
    pub notes: Vec<String>,
    pub wall_s: f64,
    pub runs: Vec<RunRecord>,
}

impl Versioned for Measured {
    const FORMAT: Format = MEASURED;
}

/// Quantities over all runs with a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OverRuns {
    /// Measured edge displacement (m).
    pub displacement_m: Quartiles,
    /// Model error: edge displacement at the last pose (m).
    pub model_error_m: Quartiles,
    /// Model error: largest edge displacement at any pose (m).
    pub model_error_max_m: Quartiles,
    /// Model error: distance at the last pose (m).
    pub model_error_position_m: Quartiles,
    /// Size of the model error of the heading at the last pose (rad).
    pub model_error_heading_rad: Quartiles,
    /// Size of the model error of the mean force (N); `null` without measured forces.
    pub model_error_force_n: Option<Quartiles>,
    pub inertia_effect_m: Quartiles,
    /// `null` without an engine.
    pub engine_error_m: Option<Quartiles>,
    pub reference_error_m: Quartiles,
    /// Part of the reference error from smoothing (m).
    pub smoothing_m: Quartiles,
    /// Displacement of an obstacle that overlapped the load at the start (m).
    pub shift_m: Quartiles,
    /// Runs with such a displacement.
    pub n_shifted: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quartiles {
    pub median: f64,
    pub lower_quartile: f64,
    pub upper_quartile: f64,
    pub max: f64,
}

/// Error of the measurement as an edge displacement between the first and the last pose (m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OwnLimit {
    pub edge_displacement_m: f64,
    pub source: LimitSource,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitSource {
    /// Standard deviations of the table or of the options.
    Uncertainty,
    /// Median gap or overlap of load and obstacle where they touch: the agreement of camera and
    /// robot.
    Registration,
}

/// Mean and standard deviation of the model error over runs, along and across the measured
/// displacement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bias {
    pub along_m: Mean,
    pub across_m: Mean,
    pub heading_rad: Mean,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    pub mean: f64,
    pub standard_deviation: f64,
    /// Of the mean.
    pub standard_error: f64,
}

impl Quartiles {
    /// Quartiles by linear interpolation of the order statistics.
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (sorted.len() - 1) as f64;
            let (low, part) = (place.floor() as usize, place.fract());
            sorted[low] + if part > 0.0 { part * (sorted[low + 1] - sorted[low]) } else { 0.0 }
        };
        Self { median: at(0.5), lower_quartile: at(0.25), upper_quartile: at(0.75), max: at(1.0) }
    }
}

impl Mean {
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let summary = Summary::of(values);
        let deviation = if summary.n() > 1 { summary.sd() } else { 0.0 };
        Self { mean: summary.mean(), standard_deviation: deviation, standard_error: deviation / (summary.n() as f64).sqrt() }
    }
}

impl OverRuns {
    fn of(found: &[&Found]) -> Self {
        let over = |of: &dyn Fn(&Found) -> f64| Quartiles::of(found.iter().map(|found| of(found)));
        let over_some = |of: &dyn Fn(&Found) -> Option<f64>| {
            let values: Vec<f64> = found.iter().filter_map(|found| of(found)).collect();
            (!values.is_empty()).then(|| Quartiles::of(values))
        };
        Self {
            displacement_m: over(&|of| of.displacement_m),
            model_error_m: over(&|of| of.model_error.edge_displacement_m),
            model_error_max_m: over(&|of| of.model_error.edge_displacement_max_m),
            model_error_position_m: over(&|of| of.model_error.position_m),
            model_error_heading_rad: over(&|of| of.model_error.heading_rad.abs()),
            model_error_force_n: over_some(&|of| of.model_error.mean_force_n.map(f64::abs)),
            inertia_effect_m: over(&|of| of.inertia_effect_m),
            engine_error_m: over_some(&|of| of.engine_error_m),
            reference_error_m: over(&|of| of.reference_error_m),
            smoothing_m: over(&|of| of.smoothing_m),
            shift_m: over(&|of| of.shift_m),
            n_shifted: found.iter().filter(|of| of.shift_m > 0.0).count(),
        }
    }
}

/// What is known beside the records.
pub struct Beside {
    pub scenario: String,
    pub recording: Vec<String>,
    pub question: Question,
    pub notes: Vec<String>,
    pub fit: Option<Fit>,
    /// Standard deviation of positions (m) and headings (rad) of the load.
    pub uncertainty: Option<[f64; 2]>,
    /// Radius of the load (m).
    pub radius: f64,
    pub wall_s: f64,
}

impl Measured {
    pub fn new(records: Vec<RunRecord>, beside: Beside) -> Self {
        let found: Vec<&Found> = records.iter().filter_map(|record| record.found.as_ref()).collect();
        let over_runs = (!found.is_empty()).then(|| OverRuns::of(&found));
        let own_limit = own_limit(&found, &beside);
        let mean = |of: &dyn Fn(&Found) -> f64| Mean::of(found.iter().map(|found| of(found)));
        let bias = (!found.is_empty()).then(|| Bias {
            along_m: mean(&|of| of.model_error.along_m),
            across_m: mean(&|of| of.model_error.across_m),
            heading_rad: mean(&|of| of.model_error.heading_rad),
        });
        let error = |record: &RunRecord| record.found.map_or(f64::NEG_INFINITY, |found| found.model_error.edge_displacement_max_m);
        let mut worst: Vec<&RunRecord> = records.iter().filter(|record| record.found.is_some()).collect();
        worst.sort_by(|a, b| error(b).total_cmp(&error(a)));
        let worst = worst.iter().take(N_WORST).map(|record| record.run.clone()).collect();
        Self {
            answer: answer(over_runs.as_ref(), own_limit),
            scenario: beside.scenario,
            recording: beside.recording,
            question: beside.question,
            n_runs: records.len(),
            n_left_out: records.len() - found.len(),
            n_doubtful: found.iter().filter(|found| !found.is_sure).count(),
            over_runs,
            own_limit,
            bias,
            worst,
            fit: beside.fit,
            notes: beside.notes,
            wall_s: beside.wall_s,
            runs: records,
        }
    }

    /// Runs with a result.
    pub fn found(&self) -> impl Iterator<Item = (&str, &Found)> {
        self.runs.iter().filter_map(|record| Some((record.run.as_str(), record.found.as_ref()?)))
    }
}

/// By the standard deviations, if there are any: those of two poses count. Else by the gaps of load
/// and obstacle at the last pose, where the simulated load touches the obstacle.
fn own_limit(found: &[&Found], beside: &Beside) -> Option<OwnLimit> {
    if let Some([position, heading]) = beside.uncertainty {
        let edge_displacement_m = 2.0 * position + std::f64::consts::SQRT_2 * beside.radius * heading;
        return Some(OwnLimit { edge_displacement_m, source: LimitSource::Uncertainty });
    }
    let gaps: Vec<f64> = found.iter().filter_map(|found| found.end_gap_m.map(f64::abs)).collect();
    (!gaps.is_empty()).then(|| OwnLimit { edge_displacement_m: median(gaps), source: LimitSource::Registration })
}

/// The answer in one sentence: sizes first, then what the problem is.
fn answer(over: Option<&OverRuns>, limit: Option<OwnLimit>) -> String {
    let Some(over) = over else { return "No run has a result.".to_owned() };
    let length = |value: f64| short_quantity(value, "m");
    let (model, inertia) = (over.model_error_m.median, over.inertia_effect_m.median);
    let engine = over.engine_error_m.map(|engine| engine.median);
    let reference = over.reference_error_m.median;
    let engine_text = engine.map_or(String::new(), |engine| format!("engine {}, ", length(engine)));
    let limit_text = limit.map_or(String::new(), |limit| format!(" (the measurement's own limit {})", length(limit.edge_displacement_m)));
    let mechanics = inertia.max(engine.unwrap_or(0.0));
    let cause = match () {
        () if limit.is_some_and(|limit| model <= limit.edge_displacement_m) => "the model is as close as the measurement can tell",
        () if mechanics.max(reference) < SMALL * model => "here the ground is the problem, not the mechanics",
        () if reference >= SMALL * model && reference > mechanics => "smoothing and numerical error leave open what the problem is",
        () if inertia >= SMALL * model => "inertia is not negligible beside the model error",
        () => "the engine error is not negligible beside the model error",
    };
    format!(
        "Inertia {}, {engine_text}model {} of {}{limit_text}: {cause}.",
        length(inertia),
        length(model),
        length(over.displacement_m.median)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_the_order_statistics() {
        let found = Quartiles::of([4.0, 1.0, 3.0, 2.0, 10.0]);
        assert_eq!(found, Quartiles { median: 3.0, lower_quartile: 2.0, upper_quartile: 4.0, max: 10.0 });
        assert_eq!(Quartiles::of([1.0, 2.0]).lower_quartile, 1.25);
        assert_eq!(Quartiles::of([7.0]).upper_quartile, 7.0);
    }
}
