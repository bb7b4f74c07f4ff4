//! A run summary as a text table for people.

use std::fmt::Write;

use crate::analysis::estimate::{Cause, InertiaEstimate, Largest};
use crate::backend::{PoseError, SkipCounts, Status, StepReport, Tolerance};
use crate::math::{Summary, Vec2};
use crate::output::quantity::{number, quantity};
use crate::simulation::run_facts::Run;
use crate::studies::run::summary::RunSummary;

/// The summary over aligned lines, with a line end.
pub fn run_text(summary: &RunSummary) -> String {
    let mut lines = Lines::default();
    lines.section("run");
    let Run { scenario, options, outcome, .. } = &summary.run;
    lines.row("scenario", &scenario.name);
    let step = Some(options.step_s).filter(|step| step.is_finite());
    let steps = step.map_or("steps under error control".to_owned(), |step| format!("steps of {}", quantity(step, "s")));
    lines.row("backend", &format!("{}, {steps}", options.kind.name()));
    lines.row("seed", &scenario.seed.to_string());
    end(summary, &mut lines);
    if let Some((asked, found)) = options.tolerance.zip(outcome.error) {
        of_accuracy(&asked, &found, outcome.steps.status, &mut lines);
    }
    if let Some(arrived) = outcome.arrived {
        of_ants(arrived.then_some(outcome.time), &outcome.pulls, &mut lines);
    }
    if let Some(estimate) = &summary.inertia_estimate {
        inertia(estimate, &mut lines);
    }
    of_jumps(summary, &mut lines);
    energy(summary, &mut lines);
    cost(summary, &mut lines);
    lines.text
}

fn end(summary: &RunSummary, lines: &mut Lines) {
    let (outcome, motion) = (summary.run.outcome, &summary.run.outcome.motion);
    let pair = |of: Vec2, unit| format!("({}, {})", quantity(of.x, unit), quantity(of.y, unit));
    lines.section("end");
    lines.row("time", &quantity(outcome.time, "s"));
    lines.row("position", &pair(motion.pose.position, "m"));
    lines.row("heading", &quantity(motion.pose.heading, "rad"));
    lines.row("velocity", &pair(motion.twist.linear, "m/s"));
    lines.row("turn rate", &quantity(motion.twist.angular, "rad/s"));
}

fn of_accuracy(asked: &Tolerance, found: &PoseError, status: Status, lines: &mut Lines) {
    let pair = |position, heading| format!("{} and {}", quantity(position, "m"), quantity(heading, "rad"));
    lines.section("error of the pose at any instant");
    lines.row("asked for", &pair(asked.position_m, asked.heading_rad));
    let verdict = match (asked.allows(found), status) {
        (true, Status::Converged) => "",
        (false, _) => ": more than was asked for",
        _ => ", but some strides did not converge: it may be more",
    };
    lines.row("estimated", &format!("{}{verdict}", pair(found.position, found.heading)));
}

fn of_ants(time_to_nest: Option<f64>, pull: &Summary, lines: &mut Lines) {
    lines.section("ants");
    match time_to_nest {
        Some(time) => lines.row("nest", &format!("reached after {}", quantity(time, "s"))),
        None => lines.row("nest", "not reached"),
    }
    if pull.n() == 0 {
        lines.row("pull", "no decisions");
        return;
    }
    let (mean, sd, max) = (quantity(pull.mean(), "N"), quantity(pull.sd(), "N"), quantity(pull.max(), "N"));
    lines.row("pull", &format!("{mean} mean, {sd} standard deviation, {max} largest of {} at grasps (0) and decisions", pull.n()));
}

fn inertia(estimate: &InertiaEstimate, lines: &mut Lines) {
    lines.section("inertia, estimated");
    let (largest, end) = (quantity(estimate.displacement_max_m, "m"), quantity(estimate.displacement_final_m, "m"));
    lines.row("on the rim", &format!("{largest} at most, {end} at the end"));
    let share = format!("{} % of the way of {}", number(100.0 * estimate.share), quantity(estimate.path_length_m, "m"));
    let verdict = match estimate {
        InertiaEstimate { is_lost: true, .. } => "not negligible, and more than this can follow",
        InertiaEstimate { is_negligible: true, .. } => "negligible",
        _ => "not negligible",
    };
    lines.row("share", &format!("{share}: {verdict}"));
    if let Some(largest) = &estimate.largest {
        lines.row("largest", &format!("at {}, after {}", quantity(largest.time_s, "s"), cause(largest)));
    }
    let parts = [estimate.from_start_m, estimate.from_jumps_m, estimate.from_driving_m].map(|part| quantity(part, "m"));
    lines.row("after", &format!("the start {}, jumps {}, driving {}", parts[0], parts[1], parts[2]));
}

pub(crate) fn cause(largest: &Largest) -> String {
    let spring = largest.spring.map_or(String::new(), |spring| format!(" of spring {spring}"));
    let what = match largest.cause {
        Cause::Start => return "the start with speed".to_owned(),
        Cause::Grasp => "the grasp",
        Cause::Release => "the release",
        Cause::Driving => "a change of speed",
    };
    format!("{what}{spring} at {}", quantity(largest.since_s, "s"))
}

/// What to tell of a run whose steps did not all find their balance; `None` of one whose did.
pub fn convergence_warning(summary: &RunSummary) -> Option<String> {
    let steps = &summary.run.outcome.steps;
    let worst = finite_residual(steps).map_or(String::new(), |residual| format!(", {} of the forces at most", number(residual)));
    let what = match steps.status {
        Status::Converged => return None,
        Status::NotConverged => format!("{} steps did not converge", steps.n_not_converged),
        Status::Failed => "some step had no finite answer, and the load stayed where it was".to_owned(),
    };
    Some(format!("{what}: what comes after is only as good as their residual{worst}"))
}

/// What to tell who runs without inertia where it matters.
pub fn inertia_warning(estimate: &InertiaEstimate) -> String {
    let (largest, share) = (quantity(estimate.displacement_max_m, "m"), number(100.0 * estimate.share));
    let after = estimate.largest.map_or(String::new(), |largest| format!(", most of all after {}", cause(&largest)));
    let what = if estimate.is_lost {
        LOST.to_owned()
    } else {
        format!("it would move the load's rim by about {largest}, {share} % of its way{after}")
    };
    format!("inertia is not negligible here: {what}; `cohaul compare` measures it, `--backend inertial` has it")
}

/// What inertia would do to a load that is lost.
pub(crate) const LOST: &str = "with it the load turns away from where it would be without by more than the estimate can follow";

/// Without any there is nothing to say.
fn of_jumps(summary: &RunSummary, lines: &mut Lines) {
    let transitions = &summary.run.outcome.transitions;
    if let Some(largest) = transitions.largest_jump {
        lines.section("motion");
        lines.row("jumps", &format!("{}, the largest by {}", transitions.n_jumps, quantity(largest, "m")));
    }
}

fn energy(summary: &RunSummary, lines: &mut Lines) {
    let energy = &summary.run.outcome.energy;
    lines.section("energy");
    lines.row("tip work", &quantity(energy.tip_work, "J"));
    lines.row("dissipated", &quantity(energy.dissipated(), "J"));
    lines.row("  friction", &quantity(energy.friction, "J"));
    lines.row("  damping", &quantity(energy.damping, "J"));
    lines.row("  released", &quantity(energy.released, "J"));
    lines.row("elastic", &quantity(energy.elastic, "J"));
    lines.row("kinetic", &quantity(energy.kinetic, "J"));
    lines.row("initial", &quantity(energy.initial, "J"));
    lines.row("defect", &quantity(energy.defect(), "J"));
    let parts = energy.defect_parts();
    lines.row("  jumps", &quantity(parts.jumps, "J"));
    lines.row("  step damping", &quantity(parts.numerical_damping, "J"));
    lines.row("  quadrature", &quantity(parts.quadrature, "J"));
}

fn cost(summary: &RunSummary, lines: &mut Lines) {
    let steps = &summary.run.outcome.steps;
    let status = match steps.status {
        Status::Converged => "all converged",
        Status::NotConverged => "some did not converge",
        Status::Failed => "some failed",
    };
    lines.section("steps");
    lines.row("status", status);
    lines.row("residual", &finite_residual(steps).map_or("none".to_owned(), number));
    lines.row("steps", &format!("{}, {} known without solving", steps.n_steps, steps.n_skipped));
    lines.row("skipped", &skipped_steps(steps));
    if summary.run.outcome.arrived.is_some() {
        lines.row("sensing", &format!("{} ants at ticks too far from the load to sense a tip", steps.skipped.distant_ants));
    }
    lines.row("not converged", &steps.n_not_converged.to_string());
    lines.row("solves", &format!("{} in {} iterations", steps.n_solves, steps.n_iterations));
    if let Some(wall_time) = summary.run.wall_time {
        lines.row("wall time", &quantity(wall_time, "s"));
    }
}

fn finite_residual(steps: &StepReport) -> Option<f64> {
    Some(steps.residual).filter(|residual| residual.is_finite())
}

/// Share of the steps that were not computed, and why. A backend need not say why of all.
fn skipped_steps(steps: &StepReport) -> String {
    let percent = |n: u64| format!("{} %", number(100.0 * n as f64 / steps.n_steps.max(1) as f64));
    let SkipCounts { free_load, still_tips, stick_bound, .. } = steps.skipped;
    let reasons = [(free_load, "no spring held"), (still_tips, "no tip moved"), (stick_bound, "tips too near to make the load slip")];
    let reasons: Vec<String> = reasons.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{} {why}", percent(*n))).collect();
    let why = if reasons.is_empty() { String::new() } else { format!(": {}", reasons.join(", ")) };
    format!("{} of the steps{why}", percent(steps.n_skipped))
}

/// Two columns, in sections.
#[derive(Default)]
pub(crate) struct Lines {
    pub text: String,
}

impl Lines {
    const LABEL_WIDTH: usize = 14;

    pub fn section(&mut self, name: &str) {
        self.text.push_str(name);
        self.text.push('\n');
    }

    pub fn row(&mut self, label: &str, value: &str) {
        writeln!(self.text, "  {label:<width$}  {value}", width = Self::LABEL_WIDTH).expect("a string takes all");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::BackendKind;
    use crate::output::synthetic;
    use crate::scenario::Scenario;

    fn text(arrived: Option<bool>) -> String {
        let outcome = synthetic::outcome(arrived);
        let scenario = Scenario::parse(include_str!("../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        let options = synthetic::options(BackendKind::QuasiStatic);
        let run = Run { scenario: &scenario, options: &options, outcome: &outcome, path_length: None, wall_time: Some(0.25) };
        run_text(&RunSummary { run, inertia_estimate: None })
    }

    #[test]
    fn values_stand_in_one_column_with_their_units() {
        let text = text(Some(true));
        assert!(text.contains("\n  position        (252.5 mm, -3.100 mm)\n"), "{text}");
        assert!(text.contains("\n  nest            reached after 76.10 s\n"), "{text}");
        assert!(
            text.contains(
                "\n  skipped         75.00 % of the steps: 50.00 % no spring held, 20.00 % tips too near to make the load slip\n"
            ),
            "{text}"
        );
        assert!(text.contains("\n  sensing         1234 ants at ticks too far from the load to sense a tip\n"), "{text}");
        assert!(text.contains("\n  jumps           1, the largest by 4.000 mm\n"), "{text}");
        let column = 2 + Lines::LABEL_WIDTH + 2;
        for line in text.lines().filter(|line| line.starts_with(' ')) {
            assert!(line.chars().nth(column).is_some_and(|c| c != ' ') && line.chars().nth(column - 1) == Some(' '), "{line:?}");
        }
    }

    #[test]
    fn ants_are_named_only_where_there_are_any() {
        assert!(text(Some(false)).contains("not reached"));
        assert!(!text(None).contains("ants\n  nest"));
    }
}
