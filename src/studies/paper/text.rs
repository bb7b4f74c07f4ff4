//! The paper's results made again, for people.

use std::fmt::Write;

use crate::math::Interval;
use crate::model::paper::SIMULATED_SAMPLES;
use crate::output::quantity::{number, quantity};
use crate::studies::paper::report::Paper;
use crate::studies::paper::{Claim, Estimate};

/// Tables of the results: quantities beside printed ones, claims, speed by group size, transitions,
/// backends, conclusions that change, and replayed runs.
pub fn paper_text(found: &Paper) -> String {
    let mut text = String::new();
    header(found, &mut text);
    section("not reproduced", missed(found), &mut text);
    section("beside the paper", table(found), &mut text);
    section("claims", found.claims.iter().map(claim).collect(), &mut text);
    section("samples by number of pulling ants, mixture of the trials", samples(found), &mut text);
    section("measured on ants, not graded", experiment(found), &mut text);
    section("inertial force by smoothing time (paper: 1e-4 mN, friction 22 mN)", forces(found), &mut text);
    section("load speed by number of pulling ants, ten springs", speeds(found), &mut text);
    section("one change of mean in a run", transitions(found), &mut text);
    section("other sets, paired differences", others(found), &mut text);
    section("conclusions that change", changed(found), &mut text);
    section("replayed: largest edge displacements", replayed(found), &mut text);
    text
}

fn header(found: &Paper, text: &mut String) {
    writeln!(text, "{}\n\npreset {}, seeds from {}", found.answer, found.preset, found.first_seed).expect("a string takes all");
    let lines = found
        .sets
        .iter()
        .map(|set| vec![set.name.clone(), format!("{} seeds", set.n_seeds), format!("{} of {} runs arrived", set.n_arrived, set.n_runs)]);
    section("sets of runs", lines.collect(), text);
}

/// Lines of cells, aligned; nothing of no lines.
fn section(title: &str, lines: Vec<Vec<String>>, text: &mut String) {
    if lines.is_empty() {
        return;
    }
    writeln!(text, "{title}").expect("a string takes all");
    let n_columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| lines.iter().filter_map(|line| line.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..n_columns).map(width).collect();
    for line in &lines {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        writeln!(text, "  {}", cells.join("  ").trim_end()).expect("a string takes all");
    }
}

fn with_interval(estimate: &Option<Estimate>, unit: &str) -> String {
    estimate.map_or_else(|| "-".to_owned(), |estimate| format!("{}{}", quantity(estimate.value, unit), between(estimate.interval_95, unit)))
}

fn between(interval: Option<Interval>, unit: &str) -> String {
    interval.map_or_else(String::new, |Interval { low, high }| format!(" ({} to {})", quantity(low, unit), quantity(high, unit)))
}

fn table(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::TableRow| {
        let printed = row.printed.map_or_else(|| "not printed".to_owned(), |printed| quantity(printed, row.unit));
        vec![row.quantity.clone(), printed, with_interval(&row.ours, row.unit), row.grade.map_or("", |grade| grade.name()).to_owned()]
    };
    found.table.iter().map(row).collect()
}

fn missed(found: &Paper) -> Vec<Vec<String>> {
    let row = |missed: &crate::studies::paper::Missed| {
        let certain = if missed.is_certain { "" } else { "(these seeds do not tell)" };
        vec![missed.what.clone(), format!("paper {}", missed.paper), format!("here {}", missed.here), certain.to_owned()]
    };
    found.not_reproduced.iter().map(row).collect()
}

fn samples(found: &Paper) -> Vec<Vec<String>> {
    let Some(mixture) = &found.mixture else { return Vec::new() };
    let n_printed: u64 = SIMULATED_SAMPLES.iter().sum();
    let row = |size: usize| {
        let n = (mixture.shares[size - 1] * n_printed as f64).round();
        vec![size.to_string(), format!("paper n = {}", SIMULATED_SAMPLES[size - 1]), format!("mixture n = {n}")]
    };
    (1..=10).map(row).collect()
}

fn experiment(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::Experiment| {
        vec![row.quantity.clone(), format!("measured {}", quantity(row.measured, row.unit)), with_interval(&row.here, row.unit)]
    };
    found.experiment.iter().map(row).collect()
}

fn forces(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::ForceRow| {
        let largest = format!("largest {}", quantity(row.largest_n, "N"));
        vec![row.trial.name(), quantity(row.smoothing_s, "s"), format!("mean {}", with_interval(&row.mean_n, "N")), largest]
    };
    found.inertial_force.iter().map(row).collect()
}

fn claim(claim: &Claim) -> Vec<String> {
    let verdict = match claim.holds {
        Some(true) => "holds",
        Some(false) => "does not hold",
        None => "unknown",
    };
    let side = if claim.below { "below" } else { "above" };
    vec![
        claim.claim.to_owned(),
        verdict.to_owned(),
        with_interval(&claim.found, ""),
        format!("{side} {}: {}", number(claim.limit), claim.statistic),
    ]
}

fn speeds(found: &Paper) -> Vec<Vec<String>> {
    let row = |speeds: &crate::studies::paper::Speeds| {
        let printed = format!("paper n = {}", speeds.printed_instants);
        let n = format!("n = {}", speeds.n_instants);
        let headway = format!("as ants, towards the nest {}", with_interval(&speeds.headway_m_per_s, "m/s"));
        vec![speeds.n_transporting.to_string(), speeds.trial.name(), with_interval(&speeds.load_speed_m_per_s, "m/s"), headway, n, printed]
    };
    found.load_speed.iter().map(row).collect()
}

fn transitions(found: &Paper) -> Vec<Vec<String>> {
    let row = |row: &crate::studies::paper::report::TransitionRow| {
        let counts = format!("in {} of {} runs, {} rising", row.n_significant, row.n_runs, row.n_rising);
        let at = row.median_time_s.map_or_else(String::new, |time| format!("median at {}", quantity(time, "s")));
        let ratio = row.median_ratio.map_or_else(String::new, |ratio| format!("after over before {}", number(ratio)));
        vec![row.trial.name(), row.series.to_owned(), counts, at, ratio]
    };
    found.transitions.iter().map(row).collect()
}

/// What shifts on other sets of the same preset.
fn others(found: &Paper) -> Vec<Vec<String>> {
    let mut lines = Vec::new();
    for (at, set) in found.sets.iter().enumerate().skip(1).filter(|(_, set)| set.preset == found.preset) {
        for row in &found.table {
            let Some(other) = row.on_others.get(at - 1).filter(|other| other.is_shifted) else { continue };
            lines.push(vec![
                set.name.clone(),
                row.quantity.clone(),
                with_interval(&other.value, row.unit),
                with_interval(&other.minus_first, row.unit),
            ]);
        }
    }
    lines
}

fn changed(found: &Paper) -> Vec<Vec<String>> {
    let row = |conclusion: &crate::studies::paper::Conclusion| {
        let value = |at: &str| {
            let standing = conclusion.on.iter().find(|standing| standing.set == at);
            format!("{at}: {}", standing.and_then(|standing| standing.value).map_or_else(|| "none".to_owned(), number))
        };
        let first = conclusion.on.first().map_or_else(String::new, |standing| value(&standing.set));
        let others: Vec<String> = conclusion.changed_on.iter().map(|set| value(set)).collect();
        vec![conclusion.conclusion.clone(), first, others.join(", ")]
    };
    let changed: Vec<_> = found.conclusions.iter().filter(|conclusion| !conclusion.changed_on.is_empty()).map(row).collect();
    if changed.is_empty() && found.conclusions.first().is_some_and(|conclusion| conclusion.on.len() > 1) {
        return vec![vec!["none".to_owned()]];
    }
    changed
}

fn replayed(found: &Paper) -> Vec<Vec<String>> {
    let row = |replayed: &crate::studies::paper::Replayed| {
        let parts = [
            ("inertia effect", replayed.inertia_effect_m),
            ("engine error", replayed.engine_error_m),
            ("reference error", replayed.reference_error_m),
        ];
        let mut line = vec![replayed.trial.name(), replayed.verdict.clone()];
        line.extend(parts.map(|(name, value)| format!("{name} {}", quantity(value, "m"))));
        line.push(format!("path length {} in {}", quantity(replayed.path_length_m, "m"), quantity(replayed.duration_s, "s")));
        line
    };
    found.replayed.iter().map(row).collect()
}
