//! A comparison for programs, for people and as files.

use std::path::Path;

use serde::Serialize;

use crate::analysis::compare::{
    ClosedLoop, Difference, Distribution, Occasion, OccasionKind, Parting, Pathwise, Remedy, Settings, Shift, Verdict,
};
use crate::backend::{BackendKind, Status};
use crate::output::chart::{self, Labelled, Scene};
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::output::page::REPORT;
use crate::output::quantity::{number, quantity};
use crate::output::trace_csv;
use crate::output::trace_csv::TraceColumns;
use crate::scenario::Scenario;
use crate::simulation::Trace;
use crate::studies::compare::page::comparison_page;
use crate::studies::run::text::Lines;

/// What `compare --json` prints: per tier what was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub scenario: String,
    pub seed: u64,
    pub settings: Settings,
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
        Self { scenario: scenario.name.clone(), seed: scenario.seed, settings: *settings, tiers: Tiers::default(), wall_s: 0.0 }
    }
}

impl Tiers {
    /// Whether no run behind them failed.
    pub fn are_computed(&self) -> bool {
        let pathwise = [&self.prescribed, &self.replayed].into_iter().flatten().map(|found| found.verdict);
        pathwise.chain(self.closed_loop.iter().map(|found| found.verdict)).all(|verdict| verdict != Verdict::NotComputed)
    }
}

/// Writes `report.html`, `summary.json`, `overview-TIER.svg`, `trace-TIER-BACKEND.csv`, `events-TIER-BACKEND.csv` and `manifest.json` to the folder `target`, all or
/// nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_comparison(target: &Path, comparison: &Comparison, scenario: &Scenario, manifest: &Manifest) -> Result<(), FolderError> {
    let (scene, n_springs) = (&Scene::of(scenario), scenario.system.springs.len());
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(comparison_page(comparison, scenario, manifest).to_html().as_bytes()))?;
    folder.write_json("summary.json", comparison)?;
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
        folder.write(&format!("trace-{tier}-{}.csv", kind.name()), |out| {
            trace_csv::write_trace(trace, TraceColumns::Full { n_springs }, out)
        })?;
        folder.write(&format!("events-{tier}-{}.csv", kind.name()), |out| trace_csv::write_events(trace, out))?;
    }
    let labelled: Vec<_> = traces.iter().map(|(kind, trace)| Labelled { label: kind.name(), trace }).collect();
    folder.write(&format!("overview-{tier}.svg"), |out| out.write_all(chart::overview(&labelled, scene).as_bytes()))
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
    let name =
        if found.tier == crate::analysis::compare::Tier::Prescribed { "prescribed tips" } else { "replayed grasps, releases and tips" };
    lines.section(name);
    lines.row("verdict", found.verdict.text());
    for (at, remedy) in found.remedies.iter().enumerate() {
        // They are meant together.
        lines.row(if at == 0 { "  remedy" } else { "    and" }, &remedied(remedy));
    }
    let [inertia, engine, own] = [found.rim.inertia_m, found.rim.engine_m, found.rim.own_m].map(|value| quantity(value, "m"));
    lines.row("on the rim", &format!("{inertia} by inertia, {engine} by the engine, {own} own error"));
    let from = &found.rim.inertia_from;
    let [start, jumps, driving] = [from.start_m, from.jumps_m, from.driving_m].map(|part| quantity(part, "m"));
    lines.row("  of inertia", &format!("after the start {start}, jumps {jumps}, driving {driving}"));
    let within = format!("{} of its way of {}", quantity(found.tolerance_m, "m"), quantity(found.path_length_m, "m"));
    lines.row("agreement", &format!("up to {within}, seen every {}", quantity(found.between_instants_s, "s")));
    lines.row("inertia effect", &difference(&found.inertia_effect));
    lines.row("engine error", &difference(&found.engine_error));
    lines.row("  of its step", &difference(&found.engine_step_error));
    lines.row("  beyond", &difference(&found.engine_model_error));
    lines.row("own error", &difference(&found.own_error.all));
    lines.row("  of beyond", &difference(&found.own_error.rapier));
    lines.row("parts first", &parting(found.first_parting.by_inertia.as_ref(), "by inertia"));
    lines.row("", &parting(found.first_parting.by_engine.as_ref(), "by the engine"));
    let numbers = &found.numbers;
    let (epsilon, phi) = (or_none(numbers.epsilon, ""), or_none(numbers.phi, ""));
    lines.row("numbers", &format!("epsilon {epsilon}, Phi {phi}, zeta {}", number(numbers.zeta)));
    let predicted = &found.predicted;
    let (driven, stop) = (or_none(predicted.while_driven_m, "m"), or_none(predicted.where_tips_stop_m, "m"));
    lines.row("predicted", &format!("{driven} while driven, {stop} where tips stop"));
    let coasting = or_none(predicted.coasting_m, "m");
    let releases = predicted.release_factor.map_or(String::new(), |factor| format!(", releases times {}", number(factor)));
    lines.row("", &format!("{coasting} of coasting from the start{releases}"));
    lines.row("", &format!("{} on the rim, estimated from the quasi-static run", or_none(predicted.estimated_m, "m")));
    lines.row("", if predicted.quasi_static_is_sound { "neglecting inertia is sound" } else { "neglecting inertia is not sound" });
    for solution in &found.solutions {
        let failed = if solution.steps.status == Status::Failed { ", FAILED" } else { "" };
        let steps = solution.step_s.map_or("under error control".to_owned(), |step| format!("steps of {}", quantity(step, "s")));
        let cost = format!("{steps}, {} solves, {} not converged{failed}", solution.steps.n_solves, solution.steps.n_not_converged);
        lines.row(solution.kind.name(), &cost);
    }
}

pub(crate) fn remedied(remedy: &Remedy) -> String {
    match remedy {
        Remedy::SmallerStep { step_s } => format!("steps of rapier of at most {}", quantity(*step_s, "s")),
        Remedy::OtherModel => "another model of friction or springs in rapier, or its recommended settings: no step helps".to_owned(),
        Remedy::SlowerTips { factor } => format!("tips at {} of their speed", number(*factor)),
        Remedy::SlowerStart { factor } => format!("a start at {} of its speed", number(*factor)),
        Remedy::Damping { damping_ratio } => format!("springs damped by zeta {}, lest the load overshoots", number(*damping_ratio)),
        Remedy::LighterLoad { factor } => format!("{} of the mass at the same friction, to follow a release in time", number(*factor)),
        Remedy::TighterTolerance { tolerance_m } => format!("--tolerance {tolerance_m:.1e}: own errors hide the answer"),
    }
}

pub(crate) fn or_none(value: Option<f64>, unit: &str) -> String {
    value.map_or("none".to_owned(), |value| quantity(value, unit))
}

fn difference(difference: &Difference) -> String {
    let position =
        format!("{} at most, {} at the end", quantity(difference.position_max_m, "m"), quantity(difference.position_final_m, "m"));
    let heading = format!("{} and {}", quantity(difference.heading_max_rad, "rad"), quantity(difference.heading_final_rad, "rad"));
    format!("{position}; {heading}")
}

pub(crate) fn parting(parting: Option<&Parting>, cause: &str) -> String {
    let Some(parting) = parting else { return format!("never {cause}") };
    let time = quantity(parting.time_s, "s");
    let after = parting.after.map(|after| format!(", after {} at {}", occasion(&after), quantity(after.time_s, "s")));
    format!("{cause} at {time}{}", after.unwrap_or_default())
}

/// With an article: `the release of spring 1`.
pub(crate) fn occasion(occasion: &Occasion) -> String {
    let what = match occasion.kind {
        OccasionKind::Start => "start with speed",
        OccasionKind::Grasp => "grasp",
        OccasionKind::Release => "release",
        OccasionKind::Onset => "onset of motion",
        OccasionKind::Stop => "stop",
        OccasionKind::Capture => "capture",
        OccasionKind::Freed => "end of rest",
        OccasionKind::Jump => "jump",
    };
    let spring = occasion.spring.map(|spring| format!(" of spring {spring}"));
    let which = spring.or(occasion.support.map(|support| format!(" of support {support}"))).unwrap_or_default();
    format!("the {what}{which}")
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
pub(crate) fn named(name: &str) -> (String, &'static str) {
    let units = [("_m_per_s", "m/s"), ("_s", "s"), ("_n", "N")];
    let found = units.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((name, ""));
    (name.replace('_', " "), unit)
}

fn distribution(found: &Distribution, unit: &str) -> String {
    if found.n == 0 {
        return "none".to_owned();
    }
    let spread = if found.n > 1 { format!(", sd {}", quantity(found.sd, unit)) } else { String::new() };
    format!("{}{spread} ({} runs)", quantity(found.mean, unit), found.n)
}

pub(crate) fn shift(found: &Shift, unit: &str) -> String {
    let Some(interval) = found.interval else { return "too few pairs".to_owned() };
    let range = format!("{} to {}", quantity(interval.low, unit), quantity(interval.high, unit));
    let says = match (found.is_shifted, found.is_equal) {
        (true, true) => "a shift that does not count",
        (true, false) => "a shift",
        (_, true) => "equal",
        _ => "too few seeds to tell",
    };
    format!("{} ({range}, {} %): {says}", quantity(found.mean, unit), number(100.0 * found.level))
}
