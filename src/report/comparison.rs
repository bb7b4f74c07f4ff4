//! A comparison for programs, for people and as files.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::figure::{self, Labelled, Scene};
use super::text::Lines;
use super::{FolderError, Manifest, NotFinite, OutputFolder, number, quantity, table};
use crate::backend::{BackendKind, RapierOptions};
use crate::compare::{ClosedLoop, Difference, Distribution, OccasionKind, Parting, Pathwise, Settings};
use crate::scenario::Scenario;
use crate::simulation::Trace;

/// What `compare --json` prints: per tier what was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub scenario: String,
    pub seed: u64,
    pub rapier: RapierOptions,
    pub tiers: Tiers,
    pub wall_s: f64,
}

/// A tier that was not asked for is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tiers {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prescribed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replayed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<ClosedLoop>,
}

impl Comparison {
    pub fn new(scenario: &Scenario, settings: &Settings) -> Self {
        Self { scenario: scenario.name.clone(), seed: scenario.seed, rapier: settings.rapier, tiers: Tiers::default(), wall_s: 0.0 }
    }

    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a comparison is plain data");
        text.push('\n');
        text
    }

    /// # Errors
    /// When a number that is not finite would be printed: JSON would make it a `null` without a word.
    pub fn check_finite(&self) -> Result<(), NotFinite> {
        let value = serde_json::to_value(self).expect("a comparison is plain data");
        match unexpected_null(&value, "") {
            Some(field) => Err(NotFinite { field, value: f64::NAN }),
            None => Ok(()),
        }
    }
}

/// Path of a `null` where a number belongs: in all fields but those that are documented to be absent at times.
fn unexpected_null(value: &Value, path: &str) -> Option<String> {
    const MAY_BE_NULL: [&str; 12] = [
        "epsilon",
        "phi",
        "while_driven_m",
        "where_tips_stop_m",
        "coasting_m",
        "by_inertia",
        "by_engine",
        "after",
        "spring",
        "mean_interval_95",
        "quasi_static_s",
        "rapier_s",
    ];
    match value {
        Value::Null if !MAY_BE_NULL.iter().any(|name| path.ends_with(&format!(".{name}"))) => Some(path.to_owned()),
        Value::Object(fields) => fields.iter().find_map(|(key, value)| unexpected_null(value, &format!("{path}.{key}"))),
        Value::Array(items) => items.iter().enumerate().find_map(|(i, value)| unexpected_null(value, &format!("{path}[{i}]"))),
        _ => None,
    }
}

/// Writes `summary.json`, `overview-TIER.svg`, `trace-TIER-BACKEND.csv`, `events-TIER-BACKEND.csv` and `manifest.json` to the folder `target`, all or
/// nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_comparison(
    target: &Path,
    comparison: &Comparison,
    scene: &Scene,
    n_springs: usize,
    manifest: &Manifest,
) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("summary.json", |out| out.write_all(comparison.to_json().as_bytes()))?;
    for (tier, pathwise) in [("prescribed", &comparison.tiers.prescribed), ("replayed", &comparison.tiers.replayed)] {
        if let Some(pathwise) = pathwise {
            let traces: Vec<_> = pathwise.solutions.iter().map(|solution| (solution.kind, &solution.trace)).collect();
            write_tier(&mut folder, tier, &traces, scene, n_springs)?;
        }
    }
    if let Some(closed_loop) = &comparison.tiers.closed_loop {
        let traces: Vec<_> = BackendKind::ALL.into_iter().zip(&closed_loop.traces).collect();
        write_tier(&mut folder, "closed-loop", &traces, scene, n_springs)?;
    }
    folder.finish(manifest)
}

fn write_tier(
    folder: &mut OutputFolder,
    tier: &str,
    traces: &[(BackendKind, &Trace)],
    scene: &Scene,
    n_springs: usize,
) -> Result<(), FolderError> {
    for (kind, trace) in traces {
        folder.write(&format!("trace-{tier}-{}.csv", kind.name()), |out| table::write_trace(trace, n_springs, out))?;
        folder.write(&format!("events-{tier}-{}.csv", kind.name()), |out| table::write_events(trace, out))?;
    }
    let labelled: Vec<_> = traces.iter().map(|(kind, trace)| Labelled { label: kind.name(), trace }).collect();
    folder.write(&format!("overview-{tier}.svg"), |out| out.write_all(figure::overview(&labelled, scene).as_bytes()))
}

/// The comparison over aligned lines, verdicts first.
pub fn compare_text(comparison: &Comparison) -> String {
    let mut lines = Lines::default();
    lines.section("compare");
    lines.row("scenario", &comparison.scenario);
    lines.row("seed", &comparison.seed.to_string());
    lines.row("wall time", &quantity(comparison.wall_s, "s"));
    for pathwise in [&comparison.tiers.prescribed, &comparison.tiers.replayed].into_iter().flatten() {
        of_paths(pathwise, &mut lines);
    }
    if let Some(closed_loop) = &comparison.tiers.closed_loop {
        of_ensemble(closed_loop, &mut lines);
    }
    lines.text
}

fn of_paths(found: &Pathwise, lines: &mut Lines) {
    let name = if found.tier == crate::compare::Tier::Prescribed { "prescribed tips" } else { "replayed grasps, releases and tips" };
    lines.section(name);
    lines.row("verdict", found.verdict.text());
    let within = format!("{} on a path of {}", quantity(found.tolerance_m, "m"), quantity(found.path_length_m, "m"));
    lines.row("agreement", &format!("within {within}"));
    lines.row("inertia effect", &difference(&found.inertia_effect));
    lines.row("engine error", &difference(&found.engine_error));
    lines.row("own error", &difference(&found.own_error.all));
    lines.row("  of rapier", &difference(&found.own_error.rapier));
    lines.row("parts first", &parting(found.first_parting.by_inertia.as_ref(), "by inertia"));
    lines.row("", &parting(found.first_parting.by_engine.as_ref(), "by the engine"));
    let numbers = &found.numbers;
    let (epsilon, phi) = (or_none(numbers.epsilon, ""), or_none(numbers.phi, ""));
    lines.row("numbers", &format!("epsilon {epsilon}, Phi {phi}, zeta {}", number(numbers.zeta)));
    let predicted = &found.predicted;
    let (driven, stop) = (or_none(predicted.while_driven_m, "m"), or_none(predicted.where_tips_stop_m, "m"));
    lines.row("predicted", &format!("{driven} while driven, {stop} where tips stop"));
    let coasting = or_none(predicted.coasting_m, "m");
    lines.row("", &format!("{coasting} of coasting from the start, releases times {}", number(predicted.release_factor)));
    lines.row("", if predicted.quasi_static_is_sound { "neglecting inertia is sound" } else { "neglecting inertia is not sound" });
    for solution in &found.solutions {
        let cost = format!("steps of {}, {} not converged", quantity(solution.step_s, "s"), solution.steps.n_not_converged);
        lines.row(solution.kind.name(), &cost);
    }
}

fn or_none(value: Option<f64>, unit: &str) -> String {
    value.map_or("none".to_owned(), |value| quantity(value, unit))
}

fn difference(difference: &Difference) -> String {
    let position =
        format!("{} at most, {} at the end", quantity(difference.position_max_m, "m"), quantity(difference.position_final_m, "m"));
    let heading = format!("{} and {}", quantity(difference.heading_max_rad, "rad"), quantity(difference.heading_final_rad, "rad"));
    format!("{position}; {heading}")
}

fn parting(parting: Option<&Parting>, cause: &str) -> String {
    let Some(parting) = parting else { return format!("never {cause}") };
    let time = quantity(parting.time_s, "s");
    match &parting.after {
        Some(after) => {
            let what = match after.kind {
                OccasionKind::Grasp => "grasp",
                OccasionKind::Release => "release",
                OccasionKind::Onset => "onset of motion",
            };
            let which = after.spring.map_or(String::new(), |spring| format!(" of spring {spring}"));
            format!("{cause} at {time}, after the {what}{which} at {}", quantity(after.time_s, "s"))
        }
        None => format!("{cause} at {time}"),
    }
}

fn of_ensemble(found: &ClosedLoop, lines: &mut Lines) {
    lines.section("closed loop, paired seeds");
    lines.row("verdict", found.verdict.text());
    lines.row("seeds", &format!("{} from {}", found.n_seeds, found.first_seed));
    let part = |time: Option<f64>| time.map_or("never".to_owned(), |time| quantity(time, "s"));
    let (quasi_static, rapier) = (part(found.decisions_part.quasi_static_s), part(found.decisions_part.rapier_s));
    lines.row("decisions part", &format!("first at: quasi-static {quasi_static}, rapier {rapier}, against inertial"));
    for measure in &found.measures {
        let (name, unit) = named(measure.name);
        lines.row(&name, &format!("quasi-static {}", distribution(&measure.quasi_static, unit)));
        lines.row("", &format!("inertial     {}", distribution(&measure.inertial, unit)));
        lines.row("", &format!("rapier       {}", distribution(&measure.rapier, unit)));
        lines.row("", &format!("inertia      {}", shift(&measure.inertia_effect, unit)));
        lines.row("", &format!("engine       {}", shift(&measure.engine_error, unit)));
    }
}

/// A measure's name without its unit, and the unit.
fn named(name: &str) -> (String, &'static str) {
    let units = [("_m_per_s", "m/s"), ("_s", "s"), ("_n", "N")];
    let found = units.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((name, ""));
    (name.replace('_', " "), unit)
}

fn distribution(found: &Distribution, unit: &str) -> String {
    if found.n == 0 {
        return "none".to_owned();
    }
    format!("{} +- {} ({} runs)", quantity(found.mean, unit), quantity(found.sd, unit), found.n)
}

fn shift(found: &Distribution, unit: &str) -> String {
    let Some(interval) = found.mean_interval_95 else { return "too few pairs".to_owned() };
    let range = format!("{} to {}", quantity(interval.low, unit), quantity(interval.high, unit));
    let says = if found.is_shifted { "a shift" } else { "none that the seeds show" };
    format!("{} ({range}, 95 %): {says}", quantity(found.mean, unit))
}
