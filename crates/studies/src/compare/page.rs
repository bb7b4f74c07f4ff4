//! The HTML page of a comparison: the answer, the replay, and the evidence.

use crate::compare::answer::{name_and_unit, sentence_of_ensemble, tolerance, verdict_text};
use crate::compare::comparison::Comparison;
use crate::compare::side_by_side;
use crate::compare::text::{details, divergence, estimated, paired, suggested, tier_name, tried};
use cohaul::analysis::compare::{ClosedLoop, Distribution, Measure, Pathwise, Tier};
use cohaul::scenario::Scenario;
use cohaul_report::chart::bars::{self, Bar, Spread, SpreadLine};
use cohaul_report::chart::{self, Labelled, Scene, trace_color};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::curves::Curves;
use cohaul_report::page::{Block, Headline, Number, Page, Replay};
use cohaul_report::quantity::of_run::{quantity, short_quantity};
use cohaul_report::quantity::short;
use cohaul_report::table::Table;

pub fn comparison_page(comparison: &Comparison, scenario: &Scenario, manifest: &Manifest) -> Page {
    let mut headline = Headline::new(comparison.is_valid(), comparison.answer.clone());
    if let Some(found) = comparison.tiers.pathwise().next() {
        let mut right = vec![Block::Numbers(numbers(found))];
        if !found.suggested_changes.is_empty() {
            let changes = found
                .suggested_changes
                .iter()
                .map(|it| suggested(it, &found.engine.name))
                .map(|(what, why)| format!("{what}: {why}"))
                .collect();
            right.extend([
                Block::text("All of these changes together are to make the differences smaller than the tolerance:"),
                Block::List(changes),
            ]);
            right.extend(tried(found).map(|text| Block::Text(format!("Changes against inertia: {text}."))));
        }
        headline = headline.with(Block::Columns(vec![vec![largest(found)], right]));
    }
    let mut page = Page::new(format!("{}: is quasi-static valid?", comparison.scenario), headline).from(manifest);
    for found in comparison.tiers.pathwise() {
        page = pathwise(page, found, comparison, scenario);
    }
    if let (Some(beside), Some(found)) = (&comparison.beside, comparison.tiers.pathwise().next()) {
        page = page.section("Beside a recorded path", beside.section(found, &scene_of(found, scenario)));
    }
    if let Some(found) = &comparison.tiers.closed_loop {
        page = page.section(tier_name(found.tier), closed_loop(found, scenario));
    }
    page.section("Terms", vec![Block::Terms])
}

/// Largest edge displacements beside the tolerance.
fn largest(found: &Pathwise) -> Block {
    let bar = |name: &str, value: f64| Bar { name: name.to_owned(), value, text: quantity(value, "m") };
    let largest = &found.edge_displacement;
    let mut bars = vec![
        bar("inertia effect", largest.inertia_effect_m),
        bar("engine error", largest.engine_error_m),
        bar("reference error", largest.reference_error_m),
    ];
    let mut parts: Vec<Bar> = largest.by_trigger.named().map(|(name, part)| bar(&format!("… {name}"), part)).collect();
    parts.retain(|part| part.value > 0.0);
    if parts.len() > 1 {
        bars.splice(1..1, parts);
    }
    Block::Chart {
        svg: bars::bars(&bars, found.tolerance_m, &format!("tolerance: {}", short_quantity(found.tolerance_m, "m"))),
        caption: format!(
            "Largest edge displacements between the paths (m). The tolerance is {}. The inertia effect belongs to the last \
             disturbance that was as large as the oscillation that it met.",
            tolerance(found)
        ),
    }
}

fn numbers(found: &Pathwise) -> Vec<Number> {
    let (numbers, predicted) = (&found.numbers, &found.predicted);
    let driven = predicted.while_driven_m.map(|driven| format!("predicts {} while the tips drive the load", short_quantity(driven, "m")));
    let release = predicted.release_factor.map(|factor| format!("predicts a release factor of {}", short(factor)));
    let damping = found.damping_effect.as_ref().map(|effect| {
        let path = short_quantity(effect.path.edge_displacement_max_m, "m");
        Number::new("damping effect", path, "path of the quasi-static model less that without its dashpots")
    });
    let some = |name, value: Option<f64>, unit: &str, what: String| value.map(|value| Number::new(name, short_quantity(value, unit), what));
    let numbers = [
        some("epsilon", numbers.epsilon, "", driven.unwrap_or_default()),
        some("Phi", numbers.phi, "rad", release.unwrap_or_default()),
        some("zeta", numbers.zeta, "", "damping ratio of the springs".to_owned()),
        some("estimate", predicted.estimated_m, "m", estimated(predicted).to_owned()),
    ];
    numbers.into_iter().flatten().chain(damping).collect()
}

fn pathwise(page: Page, found: &Pathwise, comparison: &Comparison, scenario: &Scenario) -> Page {
    let runs = comparison.runs(found);
    let first = found.first_divergence.inertia_effect.or(found.first_divergence.engine_error).map(|divergence| divergence.time_s);
    let end = found.solutions[0].trace.rows.last().map_or(0.0, |row| row.time);
    let what = if found.tier == Tier::Controlled { "one on each backend" } else { "the same tip motions on all backends" };
    let name = format!("{}: {what}", tier_name(found.tier));
    let replay = Replay::new(name.clone(), scenario, &runs, first.unwrap_or(0.4 * end));
    let details = details(found).into_iter();
    let table = details.fold(Table::new("All numbers of the comparison", ["", "value"]), |table, (label, value)| table.row([label, value]));
    // The replay is in sight on the first screen.
    let mut page = page.section(name, vec![Block::Replay(Box::new(replay))]);
    let engines = comparison.side_by_side(found);
    if side_by_side::is_shown(&engines, &comparison.refused_by) {
        let beside = side_by_side::section(&engines, &comparison.refused_by);
        page = page.section(format!("{}: engines side by side", tier_name(found.tier)), beside);
    }
    page.section("Over time", over_time(&runs, &scene_of(found, scenario)))
        .section(format!("{}: each quantity", tier_name(found.tier)), quantities(found))
        .section("Differences between the paths", vec![Block::Table(table)])
}

/// The verdict on each quantity, and the numbers on which it rests.
fn quantities(found: &Pathwise) -> Vec<Block> {
    let columns = ["quantity", "inertia effect", "engine error", "reference error", "tolerance", "verdict", "first divergence"];
    let mut verdicts = Table::new("Verdict on each quantity", columns);
    let measured =
        ["number", "quasi-static", "inertial", &*found.engine.name, "inertia effect", "engine error", "reference error", "tolerance"];
    let mut measures = Table::new("Peak and mean pulls and speeds, and the energy dissipated", measured);
    for (name, of) in found.verdicts.shown() {
        let cell = |value: f64| short_quantity(value, of.unit);
        let [inertia, engine, reference, tolerance] = [of.inertia_effect, of.engine_error, of.reference_error, of.tolerance].map(cell);
        let first = of.first_divergence.inertia_effect.or(of.first_divergence.engine_error);
        let first = first.map_or("none".to_owned(), |first| divergence(&first));
        verdicts.push([name.to_owned(), inertia, engine, reference, tolerance, verdict_text(of), first]);
        for measure in &of.measures {
            let values = [measure.quasi_static, measure.inertial, measure.engine].map(|value| quantity(value, of.unit));
            let differences = [measure.inertia_effect, measure.engine_error, measure.reference_error, measure.tolerance].map(cell);
            measures.push([measure.label()].into_iter().chain(values).chain(differences));
        }
    }
    vec![
        Block::Table(verdicts),
        Block::Folded { heading: "Pulls, speeds and energy in numbers".to_owned(), blocks: vec![Block::Table(measures)] },
    ]
}

/// Surroundings of a scene, with the tolerances that its paths were compared by.
pub fn scene_of(found: &Pathwise, scenario: &Scenario) -> Scene {
    Scene::of(scenario).steered_as(&found.solutions[0].trace).within(found.tolerance_m, found.verdicts.heading.tolerance)
}

fn over_time(runs: &[Labelled], scene: &Scene) -> Vec<Block> {
    let caption = "Differences between the runs, net pull, speed, heading and attached springs over time.";
    let curves = Curves::over_time(runs, scene, caption);
    vec![Block::Curves(Box::new(curves)), Block::figure(chart::path(runs, scene), "Paths of the load.")]
}

fn closed_loop(found: &ClosedLoop, scenario: &Scenario) -> Vec<Block> {
    let runs = Labelled::compared(found.engine.after_exact(), &found.traces);
    let time = |time: Option<f64>| time.map_or("never".to_owned(), |time| format!("at {}", quantity(time, "s")));
    let first = &found.first_different_decision;
    let (quasi_static, engine, name) = (time(first.quasi_static_s), time(first.engine_s), &found.engine.name);
    let decisions = format!("A decision first differs from the inertial run {quasi_static} (quasi-static) and {engine} ({name}).");
    let chart = Block::Chart {
        svg: bars::spreads(&found.measures.iter().map(|measure| spread(measure, found.engine.after_exact())).collect::<Vec<_>>()),
        caption: "Each dot is a seed, each vertical line a mean, and each bar its 95 % confidence interval, which stand beside it as numbers. Axes may not begin at zero."
            .to_owned(),
    };
    let ends = found.traces.iter().filter_map(|trace| trace.rows.last()).map(|row| row.time);
    // After the first different decision.
    let opens_at = 0.4 * ends.fold(f64::INFINITY, f64::min).min(1e300);
    let title = format!("One run on each backend, seed {}: ants decide on each backend for themselves", found.first_seed);
    let replay = Replay::new(title, scenario, &runs, opens_at);
    let table =
        Table::new("Paired differences of means over seeds, with confidence intervals", ["measure", "inertia effect", "engine error"]);
    let table = found.measures.iter().fold(table, |table, measure| {
        let (name, unit) = name_and_unit(measure.name);
        table.row([name, paired(&measure.inertia_effect, unit, found), paired(&measure.engine_error, unit, found)])
    });
    vec![
        Block::text(sentence_of_ensemble(found)),
        Block::text(decisions),
        chart,
        Block::Table(table),
        Block::Replay(Box::new(replay)),
        Block::Folded { heading: "These runs over time".to_owned(), blocks: over_time(&runs, &Scene::of(scenario)) },
    ]
}

/// The mean and half of its interval, as drawn.
fn with_half_interval(found: &Distribution, unit: &str) -> String {
    let half = found.mean_interval_95.map(|interval| format!(" ± {}", quantity(0.5 * (interval.high - interval.low), unit)));
    format!("{}{}", quantity(found.mean, unit), half.unwrap_or_default())
}

fn spread(measure: &Measure, names: [&str; 3]) -> Spread {
    let (name, unit) = name_and_unit(measure.name);
    let of = [&measure.quasi_static, &measure.inertial, &measure.engine];
    let line = |(at, found): (usize, &Distribution)| SpreadLine {
        name: names[at].to_owned(),
        color: trace_color(at),
        values: measure.values.iter().filter_map(|values| values[at]).collect(),
        mean: if found.n > 0 { found.mean } else { f64::NAN },
        interval: found.mean_interval_95.map(|interval| [interval.low, interval.high]),
        text: if found.n > 0 { with_half_interval(found, unit) } else { "none".to_owned() },
    };
    Spread { name, unit, lines: of.into_iter().enumerate().map(line).collect() }
}
