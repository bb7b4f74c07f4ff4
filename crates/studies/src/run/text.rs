//! A run as text: the answer, the evidence, and all details on request.

use crate::run::answer::{sentence, tolerance};
use crate::run::contacts::add_contacts;
use crate::run::summary::RunSummary;
use cohaul::analysis::estimate::InertiaEstimate;
use cohaul::backend::Status;
use cohaul::math::Vec2;
use cohaul::simulation::run_facts::{FACTS, Run, Value, unit_of};
use cohaul_report::account_words;
use cohaul_report::quantity::of_run::{quantity, short_quantity};
use cohaul_report::quantity::short;
use cohaul_report::text::{Detail, Lines};
use cohaul_report::transition_words::{ATTRIBUTION, by_trigger};

/// The answer, then the evidence, in lines of at most 80 columns.
pub fn run_text(summary: &RunSummary, detail: Detail) -> String {
    let (run, estimate) = (&summary.run, summary.inertia_estimate.as_ref());
    let mut lines = Lines::default();
    lines.answer(&sentence(run, estimate));
    lines.row("scenario", &format!("{} (seed {})", run.scenario.name, run.scenario.seed));
    lines.row("backend", &format!("{}, {}", run.options.kind.name(), steps(run)));
    end(run, &mut lines);
    if let Some(estimate) = estimate {
        inertia(estimate, detail, &mut lines);
    }
    if let Some(largest) = run.outcome.transitions.largest_jump {
        let n_jumps = run.outcome.transitions.n_jumps;
        let uncertain = match run.outcome.transitions.n_uncertain_jumps {
            0 => String::new(),
            n => format!("; the ends of {n} depend on the dissipation"),
        };
        let share = estimate.map_or(String::new(), |estimate| format!(", {} % of the path length", short(100.0 * estimate.jump_share)));
        lines.row("jumps", &format!("{n_jumps}, the largest {}{share}{uncertain}", short_quantity(largest, "m")));
    }
    add_contacts(run, detail, &mut lines);
    match detail {
        Detail::Brief => brief(run, &mut lines),
        Detail::Full => full(run, &mut lines),
    }
    lines.text
}

/// How the run was cut into steps.
pub fn steps(run: &Run) -> String {
    let step = run.options.step_s;
    if step.is_finite() { format!("steps of {}", short_quantity(step, "s")) } else { "error control".to_owned() }
}

fn end(run: &Run, lines: &mut Lines) {
    let (outcome, motion) = (run.outcome, &run.outcome.motion);
    let pair = |of: Vec2, unit| format!("({}, {})", quantity(of.x, unit), quantity(of.y, unit));
    let pose = format!("{}, heading {}", pair(motion.pose.position, "m"), quantity(motion.pose.heading, "rad"));
    lines.row("position", &pose);
    let twist = format!("{}, turn rate {}", pair(motion.twist.linear, "m/s"), quantity(motion.twist.angular, "rad/s"));
    lines.row("velocity", &twist);
    if let Some((asked, error)) = run.options.tolerance.zip(outcome.error) {
        // What is far below rounding may be asked for.
        let short_quantity = cohaul_report::quantity::short_quantity;
        let pair = |position, heading| format!("{} and {}", short_quantity(position, "m"), short_quantity(heading, "rad"));
        let found = pair(error.position, error.heading);
        lines.row("error bound", &format!("{found}, tolerance {}", pair(asked.position_m, asked.heading_rad)));
        if !asked.allows(&error) {
            lines.row("", "the error bound exceeds the tolerance");
        } else if outcome.steps.status != Status::Converged {
            lines.row("", "some macro-steps did not converge: it may be larger");
        }
    }
    let pull = &outcome.pulls;
    if outcome.arrived.is_some() && pull.n() > 0 {
        let [mean, sd, max] = [pull.mean(), pull.sd(), pull.max()].map(|value| short_quantity(value, "N"));
        lines.row("pull at decisions", &format!("{mean} mean, {sd} sd, {max} max. ({} samples)", pull.n()));
    }
}

fn inertia(estimate: &InertiaEstimate, detail: Detail, lines: &mut Lines) {
    let [largest, end] = [estimate.edge_displacement_max_m, estimate.edge_displacement_final_m].map(|value| short_quantity(value, "m"));
    lines.row("inertia effect", &format!("{largest} max., {end} at the end (estimated)"));
    lines.row("tolerance", &tolerance(estimate));
    if let Some(largest) = &estimate.largest {
        let trigger = &largest.trigger;
        lines.row("by trigger", &format!("{} (estimated)", by_trigger(&estimate.by_trigger).unwrap_or_default()));
        let [time, since] = [largest.time_s, trigger.time_s].map(|time| short_quantity(time, "s"));
        lines.row("largest effect", &format!("at {time}, after the {} at {since}", trigger.name()));
    }
    if detail == Detail::Full {
        lines.row("attribution", ATTRIBUTION);
    }
}

fn brief(run: &Run, lines: &mut Lines) {
    let (energy, steps) = (&run.outcome.energy, &run.outcome.steps);
    let [work, dissipated, defect] = [energy.tip_work, energy.dissipated(), energy.defect()].map(|value| short_quantity(value, "J"));
    lines.row("energy", &format!("tip work {work}, dissipated {dissipated}, defect {defect}"));
    let skipped = format!("{} %", short(100.0 * steps.n_skipped as f64 / steps.n_steps.max(1) as f64));
    lines.row("steps", &format!("{}, {skipped} skipped, {} not converged", steps.n_steps, steps.n_not_converged));
    lines.row("account", account_words::name(run.outcome.account.health));
    if let Some(wall_time) = run.wall_time {
        lines.row("wall time", &short_quantity(wall_time, "s"));
    }
}

/// Every number of the run, by the names of its JSON.
fn full(run: &Run, lines: &mut Lines) {
    let mut section = "";
    for fact in FACTS.iter().filter(|fact| !fact.name.starts_with("final.")) {
        let value = match fact.value(run) {
            Value::Absent => continue,
            Value::Undefined => "none".to_owned(),
            Value::Number(value) => quantity(value, unit_of(fact.name)),
            Value::Count(n) => n.to_string(),
            Value::Flag(flag) => flag.to_string(),
        };
        let (group, name) = fact.name.split_once('.').unwrap_or(("run", fact.name));
        if group != section {
            lines.section(group);
            section = group;
        }
        lines.row(name, &value);
    }
}

/// Warning about neglected inertia that is not known to be negligible.
pub fn inertia_warning(estimate: &InertiaEstimate) -> Option<String> {
    let effect = short_quantity(estimate.edge_displacement_max_m, "m");
    let may_be = match estimate.is_negligible {
        Some(true) => return None,
        Some(false) => "is not",
        None => "may not be",
    };
    let what = format!("inertia {may_be} negligible here: estimated inertia effect {effect}, tolerance {}", tolerance(estimate));
    Some(format!("{what}; `cohaul compare` measures it"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::BackendKind;
    use cohaul::scenario::Scenario;
    use cohaul_report::synthetic;

    fn text(arrived: Option<bool>, detail: Detail) -> String {
        let outcome = synthetic::outcome(arrived);
        let scenario = Scenario::parse(include_str!("../../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        let options = synthetic::options(BackendKind::QuasiStatic);
        let run = Run { scenario: &scenario, options: &options, outcome: &outcome, path_length: None, wall_time: Some(0.25) };
        run_text(&RunSummary { run, inertia_estimate: None }, detail)
    }

    #[test]
    fn values_stand_in_one_column_with_their_units() {
        let text = text(Some(true), Detail::Full);
        assert!(text.starts_with("The load reached the nest after 76.1 s at (253 mm, -3.1 mm); "), "{text}");
        assert!(text.contains("\n  position          (252.5 mm, -3.100 mm), heading "), "{text}");
        assert!(text.contains("\nenergy\n  elastic_j         ") && text.contains("\n  skipped.distant_ants  1234\n"), "{text}");
        assert!(text.contains("\n  jumps             1, the largest 4 mm\n"), "{text}");
    }

    #[test]
    fn brief_text_is_short_and_narrow() {
        for arrived in [Some(true), Some(false), None] {
            let text = text(arrived, Detail::Brief);
            assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
            let evidence = text.split_once("\n\n").unwrap().1;
            assert!(evidence.lines().count() <= 15, "{text}");
        }
    }
}
