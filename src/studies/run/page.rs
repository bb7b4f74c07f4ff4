//! The page of one run: what happened, the replay, and what inertia would have done where the run has none.

use crate::analysis::estimate::InertiaEstimate;
use crate::backend::Status;
use crate::output::chart::{self, Labelled, Scene};
use crate::output::manifest::Manifest;
use crate::output::page::replay::{Replay, Shown};
use crate::output::page::terms::TERMS;
use crate::output::page::{Answer, Block, Headline, Number, Page, Table};
use crate::output::quantity::quantity;
use crate::scenario::Scenario;
use crate::simulation::Trace;
use crate::simulation::run_facts::Run;
use crate::studies::compare::sentence::short;
use crate::studies::run::summary::RunSummary;
use crate::studies::run::text::{LOST, cause, run_text};

pub fn run_page(summary: &RunSummary, trace: &Trace, scenario: &Scenario, manifest: &Manifest) -> Page {
    let label = summary.run.options.kind.name();
    let end = trace.rows.last().map_or(0.0, |row| row.time);
    let opens_at = summary.inertia_estimate.and_then(|estimate| estimate.largest).map_or(0.4 * end, |largest| largest.time_s);
    let replay = Replay::new(format!("The run on {label}"), scenario, &[Shown { label, trace }], opens_at);
    let overview = chart::overview(&[Labelled { label, trace }], &Scene::of(scenario));
    Page::new(&scenario.name, headline(summary))
        .from(manifest)
        .section("The run", vec![Block::Replay(Box::new(replay))])
        .section("Over time", vec![Block::figure(overview, "Path, pulls, energy, heading, speed, net pull and held springs over time.")])
        .section(
            "Numbers",
            vec![
                Block::Table(energy(summary)),
                Block::Folded { heading: "All of them".to_owned(), blocks: vec![Block::Code(run_text(summary))] },
            ],
        )
        .section("What the words mean", vec![Block::Terms(TERMS.to_vec())])
}

fn headline(summary: &RunSummary) -> Headline {
    let (answer, inertia) = match &summary.inertia_estimate {
        Some(estimate) => (if estimate.is_negligible { Answer::Yes } else { Answer::No }, inertia_sentence(estimate)),
        None => (Answer::None, String::new()),
    };
    let answer = if summary.run.outcome.steps.status == Status::Failed { Answer::Open } else { answer };
    Headline::new(answer, format!("{} {inertia}", what_happened(summary)).trim_end()).with(Block::Numbers(numbers(summary)))
}

fn what_happened(summary: &RunSummary) -> String {
    let time = quantity(summary.run.outcome.time, "s");
    if summary.run.outcome.steps.status == Status::Failed {
        return format!("A step failed: what is shown up to {time} is not to be trusted.");
    }
    match summary.run.outcome.arrived {
        Some(true) => format!("The load reached the nest after {time}."),
        Some(false) => format!("The load did not reach the nest within {time}."),
        None => format!("The tips drove the load for {time}."),
    }
}

fn inertia_sentence(estimate: &InertiaEstimate) -> String {
    let (largest, share) = (quantity(estimate.displacement_max_m, "m"), short(100.0 * estimate.share));
    let way = quantity(estimate.path_length_m, "m");
    let after = estimate.largest.map_or(String::new(), |largest| format!(", most of all after {}", cause(&largest)));
    let justified =
        if estimate.is_negligible { "Leaving inertia out looks justified" } else { "Leaving inertia out does NOT look justified" };
    if estimate.is_lost {
        return format!("{justified}: {LOST}.");
    }
    format!("{justified}: by estimate it would move the load's rim by up to {largest}, {share} % of its way of {way}{after}.")
}

fn numbers(summary: &RunSummary) -> Vec<Number> {
    let Run { options, outcome, .. } = &summary.run;
    let pose = &outcome.motion.pose;
    let [x, y] = [pose.position.x, pose.position.y].map(|value| quantity(value, "m"));
    let step = Some(options.step_s).filter(|step| step.is_finite());
    let steps = step.map_or("under error control".to_owned(), |step| format!("steps of {}", quantity(step, "s")));
    let mut numbers = vec![
        Number::new("backend", options.kind.name(), steps),
        Number::new("end", format!("({x}, {y})"), format!("heading {}", quantity(pose.heading, "rad"))),
    ];
    let pull = &outcome.pulls;
    if pull.n() > 0 {
        let [mean, sd, max] = [pull.mean(), pull.sd(), pull.max()].map(|value| quantity(value, "N"));
        numbers.push(Number::new("pull", mean, format!("± {sd}, at most {max}, at {} grasps (0) and decisions", pull.n())));
    }
    if let Some((asked, error)) = options.tolerance.zip(outcome.error) {
        let note = format!("asked for {}", quantity(asked.position_m, "m"));
        numbers.push(Number::new("error of the position", quantity(error.position, "m"), note));
    }
    if let Some(largest) = outcome.transitions.largest_jump {
        numbers.push(Number::new("jumps", outcome.transitions.n_jumps.to_string(), format!("the largest by {}", quantity(largest, "m"))));
    }
    let solves = format!("{} solves, {} not converged", summary.run.outcome.steps.n_solves, summary.run.outcome.steps.n_not_converged);
    numbers.extend(summary.run.wall_time.map(|time| Number::new("computed in", quantity(time, "s"), solves)));
    numbers
}

fn energy(summary: &RunSummary) -> Table {
    let energy = &summary.run.outcome.energy;
    let lines = [
        ("done by the tips", energy.tip_work),
        ("dissipated", energy.dissipated()),
        ("by friction", energy.friction),
        ("by damping", energy.damping),
        ("released with tips", energy.released),
        ("elastic", energy.elastic),
        ("kinetic", energy.kinetic),
        ("at the start", energy.initial),
        ("defect", energy.defect()),
    ];
    lines.into_iter().fold(Table::new("Where the energy went", ["", "energy"]), |table, (name, value)| {
        table.row([name.to_owned(), quantity(value, "J")])
    })
}
