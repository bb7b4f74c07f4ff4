//! The HTML page of one run: the answer, the replay, and the numbers.

use crate::run::answer::{is_negligible, sentence};
use crate::run::contacts::contact_table;
use crate::run::summary::RunSummary;
use crate::run::text::{run_text, steps};
use cohaul::scenario::Scenario;
use cohaul::simulation::Trace;
use cohaul_report::chart::{self, Labelled, Scene};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::curves::Curves;
use cohaul_report::page::{Block, Headline, Number, Page, Replay};
use cohaul_report::quantity::of_run::quantity;
use cohaul_report::text::Detail;

pub fn run_page(summary: &RunSummary, trace: &Trace, scenario: &Scenario, manifest: &Manifest) -> Page {
    let (run, estimate) = (&summary.run, summary.inertia_estimate.as_ref());
    let label = run.options.kind.name();
    let end = trace.rows.last().map_or(0.0, |row| row.time);
    let opens_at = estimate.and_then(|estimate| estimate.largest).map_or(0.4 * end, |largest| largest.time_s);
    let (runs, scene) = ([Labelled { label, trace }], Scene::of(scenario));
    let replay = Replay::new(format!("The run on {label}"), scenario, &runs, opens_at);
    let curves = Curves::over_time(&runs, &scene, "Energy, pulls, speed, heading and attached springs over time.");
    let headline = Headline::new(is_negligible(run, estimate), sentence(run, estimate)).with(Block::Numbers(numbers(summary)));
    let contacts = contact_table(run).map(Block::Table);
    Page::new(&scenario.name, headline)
        .from(manifest)
        .section("The run", [Block::Replay(Box::new(replay))].into_iter().chain(contacts).collect())
        .section("Over time", vec![Block::Curves(Box::new(curves)), Block::figure(chart::path(&runs, &scene), "Path of the load.")])
        .section("Numbers", vec![Block::Code(run_text(summary, Detail::Full))])
        .section("Terms", vec![Block::Terms])
}

fn numbers(summary: &RunSummary) -> Vec<Number> {
    let (run, outcome) = (&summary.run, summary.run.outcome);
    let pose = &outcome.motion.pose;
    let [x, y] = [pose.position.x, pose.position.y].map(|value| quantity(value, "m"));
    let mut numbers = vec![
        Number::new("backend", run.options.kind.name(), steps(run)),
        Number::new("end", format!("({x}, {y})"), format!("heading {}", quantity(pose.heading, "rad"))),
    ];
    let solves = format!("{} solves, {} not converged", outcome.steps.n_solves, outcome.steps.n_not_converged);
    numbers.extend(run.wall_time.map(|time| Number::new("wall time", quantity(time, "s"), solves)));
    numbers
}
