//! A comparison as text: the answer, the evidence, and all details on request.

use crate::compare::answer::{self, name_and_unit, rounded_up, tolerance, verdict_text, words_of};
use crate::compare::comparison::Comparison;
use crate::compare::words::{WORDS, wrapped};
use crate::compare::{doubt, side_by_side};
use cohaul::analysis::compare::{ClosedLoop, DampingEffect, Difference, Distribution, Divergence, EngineAnswer, InertiaAnswer};
use cohaul::analysis::compare::{LONGEST_TRIAL, Measure, PairedDifference, Pathwise, Predicted, QuantityVerdict, RunMeasure};
use cohaul::analysis::compare::{Solution, SuggestedChange, Tier, Tried};
use cohaul::backend::{PoseError, Tolerance};
use cohaul::scenario::Scenario;
use cohaul_report::account_words::{self, name};
use cohaul_report::quantity::of_run::{quantity, short_quantity};
use cohaul_report::quantity::short;
use cohaul_report::text::{Detail, Lines};
use cohaul_report::transition_words::{ATTRIBUTION, by_trigger};

/// Most lines of brief text below the answer.
const MOST_LINES: usize = 18;

/// The answer, then the evidence, in lines of at most 80 columns.
pub fn text(comparison: &Comparison, detail: Detail) -> String {
    let mut lines = Lines::default();
    lines.answer(&comparison.answer);
    if detail == Detail::Full {
        lines.row("scenario", &format!("{} (seed {})", comparison.scenario, comparison.seed));
        lines.row("wall time", &quantity(comparison.wall_s, "s"));
    }
    let of_ensemble = comparison.tiers.closed_loop.as_ref().map_or(0, |found| measures(found).lines().count());
    for found in comparison.tiers.pathwise() {
        let engines = comparison.side_by_side(found);
        let refused_by = &comparison.refused_by;
        let beside = if side_by_side::is_shown(&engines, refused_by) { side_by_side::text(&engines, refused_by) } else { String::new() };
        let verdicts = verdicts(found) + &beside;
        lines.text += &verdicts;
        match detail {
            Detail::Brief => {
                let n_left = MOST_LINES.saturating_sub(verdicts.lines().count() + of_ensemble);
                lines.text += &brief_evidence(found, n_left);
            }
            Detail::Full => {
                evidence(found, detail).into_iter().chain(details(found)).for_each(|(label, value)| lines.row(&label, &value));
            }
        }
    }
    comparison.beside.iter().flat_map(|beside| beside.lines()).for_each(|(label, value)| lines.row(&label, &value));
    match (&comparison.tiers.closed_loop, detail) {
        (Some(found), Detail::Brief) => lines.text += &measures(found),
        (Some(found), Detail::Full) => closed_loop(found, &mut lines),
        _ => {}
    }
    lines.text
}

/// Warnings about runs of paths that are not ok.
pub fn account_warnings(comparison: &Comparison) -> Vec<String> {
    let of_run = |(name, solution): (&str, &Solution)| {
        account_words::warnings(&solution.account).map(|what| format!("{name}: {what}")).collect::<Vec<_>>()
    };
    let others = comparison.other_engines.iter().filter_map(|found| found.named_runs().nth(2));
    comparison.tiers.pathwise().flat_map(|found| found.named_runs()).chain(others).flat_map(of_run).collect()
}

/// Warning about reference runs that do not reach the tolerance asked for; `None` if all do.
pub fn tolerance_warning(comparison: &Comparison, scenario: &Scenario) -> Option<String> {
    let asked = Tolerance::at_edge(comparison.settings.reference_tolerance_m?, &scenario.system.load);
    let errors = comparison.tiers.pathwise().map(|found| &found.reference_error.all);
    let errors = errors.map(|error| PoseError { position: error.position_max_m, heading: error.heading_max_rad });
    let largest = errors.reduce(|a, b| a.max(&b)).filter(|error| !asked.allows(error))?;
    // What is far below rounding may be asked for.
    let short_quantity = cohaul_report::quantity::short_quantity;
    let pair = |position, heading| format!("{} and {}", short_quantity(position, "m"), short_quantity(heading, "rad"));
    let (error, tolerance) = (pair(largest.position, largest.heading), pair(asked.position_m, asked.heading_rad));
    Some(format!("the reference error, {error}, exceeds the tolerance, {tolerance}"))
}

/// The table of the differences in each quantity, and the verdicts. A number that decides one of
/// both answers alone has a line of its own.
fn verdicts(found: &Pathwise) -> String {
    let row = |[name, inertia, engine, reference, tolerance, verdict]: [&str; 6]| {
        format!("{}\n", format!("{name:<20} {inertia:<9} {engine:<9} {reference:<9} {tolerance:<9} {verdict}").trim_end())
    };
    let mut text = row([tier_name(found.tier), "inertia", "engine", "reference", "tolerance", "verdict"]);
    for (name, of) in found.verdicts.shown() {
        for (measure, words) in deciding(of) {
            let name = measure.map_or(name, |measure| if measure.name == "energy dissipated" { "energy" } else { measure.name });
            let own = [of.inertia_effect, of.engine_error, of.reference_error, of.tolerance];
            let numbers = measure.map_or(own, |it| [it.inertia_effect, it.engine_error, it.reference_error, it.tolerance]);
            let [inertia, engine, reference, tolerance] = numbers.map(|value| short_quantity(value, of.unit));
            let mut words = wrapped(&words, WORDS).into_iter();
            text += &row([&format!("  {name}"), &inertia, &engine, &reference, &tolerance, &words.next().unwrap_or_default()]);
            words.for_each(|rest| text += &row(["", "", "", "", "", &rest]));
        }
    }
    text
}

/// The numbers that decide the answers on a quantity, each with what it decides in words. There is
/// none for path and heading.
fn deciding(of: &QuantityVerdict) -> Vec<(Option<&RunMeasure>, String)> {
    let (first, of_engine) = (of.deciding(), of.worst_of_engine());
    let is_other = first.zip(of_engine).is_some_and(|(a, b)| !std::ptr::eq(a, b));
    if is_other && of.inertia != InertiaAnswer::Negligible && of.engine != EngineAnswer::Within {
        return vec![(first, words_of(of, [true, false])), (of_engine, words_of(of, [false, true]))];
    }
    vec![(first, verdict_text(of))]
}

/// As many lines of the evidence as there is room for, the most useful first. What belongs together
/// is printed as a whole or not at all.
fn brief_evidence(found: &Pathwise, most_lines: usize) -> String {
    let rows = evidence(found, Detail::Brief);
    let mut text = String::new();
    for whole in rows.chunk_by(|_, (label, _)| label.starts_with("  ")) {
        let mut lines = Lines::default();
        whole.iter().for_each(|(label, value)| lines.row(label, value));
        if text.lines().count() + lines.text.lines().count() <= most_lines {
            text += &lines.text;
        }
    }
    text
}

pub fn tier_name(tier: Tier) -> &'static str {
    match tier {
        Tier::Prescribed => "Prescribed tips",
        Tier::Replayed => "Replayed tips",
        Tier::ClosedLoop => "Closed loop",
        Tier::Controlled => "Own controller",
    }
}

/// What the verdict on the path rests on, and what would change it.
fn evidence(found: &Pathwise, detail: Detail) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    for (at, change) in found.suggested_changes.iter().enumerate() {
        let (what, why) = suggested(change, &found.engine.name);
        let text = if detail == Detail::Full { format!("{what}: {why}") } else { what };
        rows.push((if at == 0 { "suggested change" } else { "  and" }, text));
    }
    rows.extend(tried(found).map(|text| ("  together", text)));
    let metres = |value: f64| short_quantity(value, "m");
    rows.extend(by_trigger(&found.edge_displacement.by_trigger).map(|parts| ("by trigger", parts)));
    rows.extend(found.first_divergence.inertia_effect.map(|first| ("first divergence", divergence(&first))));
    let [step, model] = [&found.time_step_error, &found.model_error].map(|error| metres(error.edge_displacement_max_m));
    let order = found.time_step_order.map(|order| format!(" (order {order:.2})"));
    let uncertainty = metres(found.reference_error.engine.edge_displacement_max_m);
    rows.push(("engine error", format!("time step {step}{}, model {model} ± {uncertainty}", order.unwrap_or_default())));
    rows.push(("tolerance", tolerance(found)));
    rows.extend(found.damping_effect.as_ref().map(|effect| ("damping effect", damping(effect))));
    rows.extend(estimate(&found.predicted).map(|text| ("estimate", text)));
    rows.into_iter().map(|(label, value)| (label.to_owned(), value)).collect()
}

/// What the dashpots change in the quasi-static model.
pub fn damping(effect: &DampingEffect) -> String {
    let path = short_quantity(effect.path.edge_displacement_max_m, "m");
    let pulls = answer::instead(effect.peak_net_pull_n, effect.peak_net_pull_without_n, "N");
    format!("path {path}, net pull {pulls} at most; relaxes in {}", short_quantity(effect.relaxation_s, "s"))
}

/// What trials of the changes against inertia found; `None` where there is no such change.
pub fn tried(found: &Pathwise) -> Option<String> {
    let has_change = found.suggested_changes.iter().any(SuggestedChange::is_of_scene);
    let metres = |value: f64| short_quantity(value, "m");
    let outcome = |tried: &Tried| {
        let left = format!("inertia effect {}, tolerance {}", metres(tried.inertia_effect_m), metres(tried.tolerance_m));
        match tried.is_enough {
            true => format!("checked: {left}"),
            false => format!("not enough: {left}; `--threshold speed` finds what is"),
        }
    };
    has_change.then(|| found.tried.as_ref().map_or_else(|| why_not_tried(found), outcome))
}

/// Why the changes were not tried.
fn why_not_tried(found: &Pathwise) -> String {
    let slower = |change: &SuggestedChange| match change {
        SuggestedChange::SlowerTips { factor } | SuggestedChange::SlowerObstacles { factor } => Some(factor.recip()),
        _ => None,
    };
    match found.suggested_changes.iter().find_map(slower) {
        Some(times) if times > LONGEST_TRIAL => format!("not checked: a trial would take {} times as long", short(times)),
        Some(_) if found.tier != Tier::Prescribed => "not checked: recorded motions have their own speed".to_owned(),
        _ => "not checked".to_owned(),
    }
}

/// Everything else that a comparison of paths found.
pub fn details(found: &Pathwise) -> Vec<(String, String)> {
    let predicted = &found.predicted;
    let mut rows = Vec::new();
    let mut row = |label: &str, value: String| rows.push((label.to_owned(), value));
    found.doubts.iter().for_each(|of| row("doubt", doubt::in_words(of)));
    for (name, of) in found.verdicts.shown() {
        let effects = [("inertia effect", of.first_divergence.inertia_effect), ("engine error", of.first_divergence.engine_error)];
        for (effect, first) in effects {
            row(
                name,
                format!(
                    "{effect}: {}",
                    first.map_or("within the tolerance".to_owned(), |first| format!("first divergence at {}", divergence(&first)))
                ),
            );
        }
        for measure in &of.measures {
            row("", measured(measure, &found.engine.name, of.unit));
        }
    }
    row("sampled every", quantity(found.sampled_every_s, "s"));
    row("attribution", ATTRIBUTION.to_owned());
    row("inertia effect", difference(&found.inertia_effect));
    row("engine error", difference(&found.engine_error));
    row("time-step error", difference(&found.time_step_error));
    row("model error", difference(&found.model_error));
    row("  its error", difference(&found.reference_error.engine));
    row("reference error", difference(&found.reference_error.all));
    if let Some(zeta) = found.numbers.zeta {
        let (epsilon, phi) = (or_none(found.numbers.epsilon, ""), or_none(found.numbers.phi, "rad"));
        row("numbers", format!("epsilon {epsilon}, Phi {phi}, zeta {}", short(zeta)));
    }
    let predictions = [
        (predicted.while_driven_m, "m", "while the tips drive the load"),
        (predicted.where_tips_stop_m, "m", "where the tips stop"),
        (predicted.coasting_m, "m", "of coasting from the start"),
        (predicted.release_factor, "", "times the displacement after a release"),
    ];
    for (value, unit, what) in predictions {
        value.into_iter().for_each(|value| row("predicted", format!("{} {what}", short_quantity(value, unit))));
    }
    for (run, solution) in found.named_runs() {
        let steps = solution.step_s.map_or("error control".to_owned(), |step| format!("steps of {}", quantity(step, "s")));
        let counts = format!(
            "{} solves, {} not converged, {}",
            solution.steps.n_solves,
            solution.steps.n_not_converged,
            name(solution.account.health)
        );
        row(run, format!("{steps}, {counts}"));
    }
    rows
}

/// What an estimate is, and how good it is. Source: `results/2026-11-21-inertia-estimate`.
const ESTIMATED: &str = "from the quasi-static run alone; 98 % of random scenes are within a factor of 2";

/// The same where a load with inertia runs beside the quasi-static one. Source:
/// `tests/differential/estimate.rs`.
const ESTIMATED_AMONG_OBSTACLES: &str = "from a load with inertia at long steps beside the quasi-static one; of 567 random scenes all \
                                         are within a factor of 2";

/// What the estimate is, and how good it is.
pub fn estimated(predicted: &Predicted) -> &'static str {
    if predicted.estimated_among_obstacles { ESTIMATED_AMONG_OBSTACLES } else { ESTIMATED }
}

/// The inertia effect that the quasi-static run lets expect; `None` without an estimate.
fn estimate(predicted: &Predicted) -> Option<String> {
    let (effect, what) = (short_quantity(predicted.estimated_m?, "m"), estimated(predicted));
    Some(match predicted.estimated_is_negligible {
        None => format!("{effect}, too near to the tolerance to decide, {what}"),
        Some(_) => format!("{effect} {what}"),
    })
}

/// A change, and what it does.
pub fn suggested(change: &SuggestedChange, engine: &str) -> (String, &'static str) {
    match change {
        SuggestedChange::SmallerStep { step_s } => {
            (format!("use {engine} with --step-s {step_s:.2e}"), "the time-step error falls with the step")
        }
        SuggestedChange::MoreHalvings { halvings } => {
            (format!("compare with --halvings {halvings}"), "time step and model cannot be told apart at this step")
        }
        SuggestedChange::OtherModel => {
            (format!("use another friction or spring model in {engine}"), "the model error does not depend on the step")
        }
        SuggestedChange::SlowerTips { factor } => {
            (format!("move the tips at {} % of their speed", short(100.0 * factor)), "the lag of the load grows with the speed")
        }
        SuggestedChange::SlowerObstacles { factor } => {
            (format!("move the obstacles at {} % of their speed", short(100.0 * factor)), "the load coasts by the square of the speed")
        }
        SuggestedChange::SlowerStart { factor } => {
            (format!("start at {} % of the speed", short(100.0 * factor)), "the load coasts by the square of the start speed")
        }
        SuggestedChange::SpringDamping { damping_ratio } => {
            (format!("add spring damping: damping_ratio >= {}", short(*damping_ratio)), "the load then relaxes after a release")
        }
        SuggestedChange::TighterTolerance { tolerance_m } => {
            (format!("use --tolerance {tolerance_m:.1e}"), "the reference error then becomes small enough")
        }
    }
}

pub fn or_none(value: Option<f64>, unit: &str) -> String {
    value.map_or("none".to_owned(), |value| short_quantity(value, unit))
}

/// One number on all backends, and its differences.
pub fn measured(measure: &RunMeasure, engine: &str, unit: &str) -> String {
    let [a, b, c] = [measure.quasi_static, measure.inertial, measure.engine].map(|value| quantity(value, unit));
    let [error, tolerance] = [measure.reference_error, measure.tolerance].map(|value| short_quantity(value, unit));
    format!("{}: quasi-static {a}, inertial {b}, {engine} {c} (reference error {error}, tolerance {tolerance})", measure.label())
}

fn difference(found: &Difference) -> String {
    let metres = |value| quantity(value, "m");
    let (position, position_end) = (metres(found.position_max_m), metres(found.position_final_m));
    let (heading, heading_end) = (quantity(found.heading_max_rad, "rad"), quantity(found.heading_final_rad, "rad"));
    format!("{position} and {heading} max., {position_end} and {heading_end} at the end")
}

pub fn divergence(first: &Divergence) -> String {
    let trigger = first.trigger.map(|trigger| format!(", after the {} at {}", trigger.name(), short_quantity(trigger.time_s, "s")));
    format!("{}{}", short_quantity(first.time_s, "s"), trigger.unwrap_or_default())
}

/// The means of all measures, and whether they differ.
fn measures(found: &ClosedLoop) -> String {
    let row = |cells: [&str; 6]| {
        let [name, a, b, c, inertia, engine] = cells;
        format!("{}\n", format!("{name:<22}{a:>12}{b:>10}{c:>10} {inertia:<12} {engine}").trim_end())
    };
    let title = format!("{}, {} seeds", tier_name(found.tier), found.n_seeds);
    let mut text = row([&title, "quasi-static", "inertial", &found.engine.name, "inertia", "engine"]);
    for measure in &found.measures {
        let (name, unit) = name_and_unit(measure.name);
        let mean = |of: &Distribution| if of.n > 0 { short_quantity(of.mean, unit) } else { "none".to_owned() };
        let [a, b, c] = [&measure.quasi_static, &measure.inertial, &measure.engine].map(mean);
        let [inertia, engine] = [&measure.inertia_effect, &measure.engine_error].map(|of| says(of, found));
        text += &row([&format!("  {name}"), &a, &b, &c, inertia, engine]);
    }
    if let Some(n) = found.n_seeds_needed {
        text += &format!("  too few seeds     about {} would decide all measures\n", rounded_up(n));
    }
    text
}

fn closed_loop(found: &ClosedLoop, lines: &mut Lines) {
    let seeds = format!("{} paired seeds from {}", found.n_seeds, found.first_seed);
    lines.section(&format!("{}, {seeds} (verdict: {})", tier_name(found.tier), found.verdict.text()));
    let time = |time: Option<f64>| time.map_or("never".to_owned(), |time| quantity(time, "s"));
    let first = &found.first_different_decision;
    let (quasi_static, engine, run) = (time(first.quasi_static_s), time(first.engine_s), &found.engine.name);
    lines.row("decisions", &format!("differ from inertial at {quasi_static} (quasi-static), {engine} ({run})"));
    for seed in &found.doubts {
        lines.row("doubt", &format!("with seed {}, {}", seed.seed, doubt::in_words(&seed.doubt)));
    }
    for Measure { name, quasi_static, inertial, engine, inertia_effect, engine_error, .. } in &found.measures {
        let (name, unit) = name_and_unit(name);
        lines.row(&name, &format!("quasi-static {}", distribution(quasi_static, unit)));
        lines.row("", &format!("inertial {}", distribution(inertial, unit)));
        lines.row("", &format!("{run} {}", distribution(engine, unit)));
        lines.row("", &format!("inertia effect {}", paired(inertia_effect, unit, found)));
        lines.row("", &format!("engine error {}", paired(engine_error, unit, found)));
    }
}

fn distribution(found: &Distribution, unit: &str) -> String {
    if found.n == 0 {
        return "none".to_owned();
    }
    let spread = if found.n > 1 { format!(", sd {}", quantity(found.sd, unit)) } else { String::new() };
    format!("{}{spread} ({} runs)", quantity(found.mean, unit), found.n)
}

/// A difference of means with its interval, and what it says in a comparison `among` seeds.
pub fn paired(found: &PairedDifference, unit: &str, among: &ClosedLoop) -> String {
    let Some(interval) = found.interval else { return "too few pairs".to_owned() };
    let range = format!("{} to {}", quantity(interval.low, unit), quantity(interval.high, unit));
    format!("{} ({} % interval {range}): {}", quantity(found.mean, unit), short(100.0 * found.level), says(found, among))
}

fn says(found: &PairedDifference, among: &ClosedLoop) -> &'static str {
    match (found.excludes_zero, found.is_equal) {
        _ if !among.doubts.is_empty() => "inconclusive",
        (_, true) => "equal",
        (true, false) => "differs",
        _ => "inconclusive",
    }
}
