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
use crate::studies::compare::sentence::short;
use crate::studies::run::summary::RunSummary;
use crate::studies::run::text::{LOST, cause, run_text};

pub fn run_page(summary: &RunSummary, trace: &Trace, scenario: &Scenario, manifest: &Manifest) -> Page {
    let label = summary.backend.name();
    let end = trace.rows.last().map_or(0.0, |row| row.time);
    let opens_at = summary.inertia_estimate.and_then(|estimate| estimate.largest).map_or(0.4 * end, |largest| largest.time_s);
    let replay = Replay::new(format!("The run on {label}"), scenario, &[Shown { label, trace }], opens_at);
    let overview = chart::overview(&[Labelled { label, trace }], &Scene::of(scenario));
    Page::new(&summary.scenario, headline(summary))
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
    let answer = if summary.steps.status == Status::Failed { Answer::Open } else { answer };
    Headline::new(answer, format!("{} {inertia}", what_happened(summary)).trim_end()).with(Block::Numbers(numbers(summary)))
}

fn what_happened(summary: &RunSummary) -> String {
    let time = quantity(summary.end.time_s, "s");
    if summary.steps.status == Status::Failed {
        return format!("A step failed: what is shown up to {time} is not to be trusted.");
    }
    match summary.ants.as_ref().map(|ants| ants.time_to_nest_s) {
        Some(Some(home)) => format!("The load reached the nest after {}.", quantity(home, "s")),
        Some(None) => format!("The load did not reach the nest within {time}."),
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
    let end = &summary.end;
    let [x, y] = end.position_m.map(|value| quantity(value, "m"));
    let steps = summary.step_s.map_or("under error control".to_owned(), |step| format!("steps of {}", quantity(step, "s")));
    let mut numbers = vec![
        Number::new("backend", summary.backend.name(), steps),
        Number::new("end", format!("({x}, {y})"), format!("heading {}", quantity(end.heading_rad, "rad"))),
    ];
    if let Some(pull) = summary.ants.as_ref().map(|ants| &ants.pull_force_n).filter(|pull| pull.n > 0) {
        let note = format!("± {}, at most {}, at {} grasps (0) and decisions", quantity(pull.sd, "N"), quantity(pull.max, "N"), pull.n);
        numbers.push(Number::new("pull", quantity(pull.mean, "N"), note));
    }
    if let Some(accuracy) = &summary.accuracy {
        let note = format!("asked for {}", quantity(accuracy.asked_m, "m"));
        numbers.push(Number::new("error of the position", quantity(accuracy.estimated_m, "m"), note));
    }
    if let Some((n, largest)) = summary.transitions.as_ref().and_then(|it| it.largest_jump_m.map(|largest| (it.n_jumps, largest))) {
        numbers.push(Number::new("jumps", n.to_string(), format!("the largest by {}", quantity(largest, "m"))));
    }
    let solves = format!("{} solves, {} not converged", summary.steps.n_solves, summary.steps.n_not_converged);
    numbers.push(Number::new("computed in", quantity(summary.wall_s, "s"), solves));
    numbers
}

fn energy(summary: &RunSummary) -> Table {
    let energy = &summary.energy;
    let lines = [
        ("done by the tips", energy.tip_work_j),
        ("dissipated", energy.dissipated_j),
        ("by friction", energy.friction_j),
        ("by damping", energy.damping_j),
        ("released with tips", energy.released_j),
        ("elastic", energy.elastic_j),
        ("kinetic", energy.kinetic_j),
        ("at the start", energy.initial_j),
        ("defect", energy.defect_j),
    ];
    lines.into_iter().fold(Table::new("Where the energy went", ["", "energy"]), |table, (name, value)| {
        table.row([name.to_owned(), quantity(value, "J")])
    })
}
