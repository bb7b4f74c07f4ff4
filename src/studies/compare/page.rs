//! The page of a comparison: whether quasi-static was justified, by how much not, the replay, then all that this rests on.

use crate::analysis::compare::{Difference, Pathwise, Tier};
use crate::backend::{BackendKind, Status};
use crate::output::chart::{self, Labelled, Scene};
use crate::output::manifest::Manifest;
use crate::output::page::bars::{self, Bar};
use crate::output::page::replay::{Replay, Shown};
use crate::output::page::terms::TERMS;
use crate::output::page::{Answer, Block, Headline, Number, Page, Table};
use crate::output::quantity::{number, quantity};
use crate::scenario::Scenario;
use crate::studies::compare::ensemble_page;
use crate::studies::compare::report::Comparison;
use crate::studies::compare::report::{or_none, parting, remedied};
use crate::studies::compare::sentence::{engine_sentence, of_ensemble, of_paths, sentence_of_ensemble, sentence_of_paths, short};

pub fn comparison_page(comparison: &Comparison, scenario: &Scenario, manifest: &Manifest) -> Page {
    let mut page = Page::new(format!("{}: is quasi-static justified?", comparison.scenario), headline(comparison)).from(manifest);
    for found in comparison.pathwise() {
        page = of_paths_sections(page, found, scenario);
    }
    if let Some(found) = &comparison.tiers.closed_loop {
        page = page.section("Ants that decide for themselves", ensemble_page::blocks(found, scenario));
    }
    page.section("What the words mean", vec![Block::Terms(TERMS.to_vec())])
}

/// The answer of the paths where there are any, for only they tell cause from chance.
fn headline(comparison: &Comparison) -> Headline {
    let closed_loop = comparison.tiers.closed_loop.as_ref();
    let Some(found) = comparison.pathwise().next() else {
        return match closed_loop {
            Some(found) => Headline::new(of_ensemble(found), sentence_of_ensemble(found)),
            None => Headline::new(Answer::Open, "Nothing was compared."),
        };
    };
    let mut says = vec![engine_sentence(found)];
    says.extend(closed_loop.map(sentence_of_ensemble));
    says.retain(|sentence| !sentence.is_empty());
    let left = vec![attribution(found), Block::List(says)];
    let mut right = vec![Block::Numbers(numbers(found))];
    if !found.remedies.is_empty() {
        right.push(Block::text(if found.remedies.len() > 1 {
            "What would bring the paths together, all of it at once:"
        } else {
            "What would bring the paths together:"
        }));
        right.push(Block::List(found.remedies.iter().map(remedied).collect()));
    }
    Headline::new(of_paths(found), sentence_of_paths(found)).with(Block::Columns(vec![left, right]))
}

/// What moves the paths apart, beside what counts as agreement.
fn attribution(found: &Pathwise) -> Block {
    let bar = |name: &str, value: f64| Bar { name: name.to_owned(), value, text: quantity(value, "m") };
    let (rim, from) = (&found.rim, &found.rim.inertia_from);
    let mut bars = vec![bar("inertia effect", rim.inertia_m), bar("engine error", rim.engine_m), bar("own error", rim.own_m)];
    let mut parts = vec![bar("… from the start", from.start_m), bar("… from jumps", from.jumps_m), bar("… from driving", from.driving_m)];
    parts.retain(|part| part.value > 0.0);
    if parts.len() > 1 {
        bars.splice(1..1, parts);
    }
    let tolerated = format!("agreement: {}", quantity(found.tolerance_m, "m"));
    Block::Chart {
        svg: bars::bars(&bars, found.tolerance_m, &tolerated),
        caption: "Largest displacement of the load's rim (m): by inertia and what that comes from, by the engine, and how far these may themselves be wrong."
            .to_owned(),
    }
}

fn numbers(found: &Pathwise) -> Vec<Number> {
    let (numbers, predicted) = (&found.numbers, &found.predicted);
    let driven =
        predicted.while_driven_m.map(|driven| format!("inertia against friction; predicts {} while driven", quantity(driven, "m")));
    let releases =
        predicted.release_factor.map(|factor| format!("time for a swing; after a release {} times the way without inertia", short(factor)));
    let sound = if predicted.quasi_static_is_sound { "sound to neglect inertia" } else { "not sound to neglect inertia" };
    let plain = |value: Option<f64>| value.map_or("none".to_owned(), number);
    vec![
        Number::new("epsilon", plain(numbers.epsilon), driven.unwrap_or_default()),
        Number::new("Phi", plain(numbers.phi), releases.unwrap_or_default()),
        Number::new("zeta", number(numbers.zeta), "damping of the springs over critical"),
        Number::new("theory", sound, ""),
        Number::new("estimate", or_none(predicted.estimated_m, "m"), "on the rim, from the quasi-static run alone"),
    ]
}

fn of_paths_sections(page: Page, found: &Pathwise, scenario: &Scenario) -> Page {
    let shown: Vec<Shown> = found.solutions.iter().map(|solution| Shown { label: solution.kind.name(), trace: &solution.trace }).collect();
    let (heading, name) = match found.tier {
        Tier::Prescribed => ("Side by side, at the same tips", "Three backends under the same prescribed tips"),
        _ => ("Side by side, at the same tips", "Three backends under the grasps, releases and tip motions of one recorded run"),
    };
    let opens_at = found.first_parting.by_inertia.or(found.first_parting.by_engine).map(|parting| parting.time_s);
    let end = found.solutions[0].trace.rows.last().map_or(0.0, |row| row.time);
    let replay = Replay::new(name, scenario, &shown, opens_at.unwrap_or(0.4 * end));
    let labelled: Vec<Labelled> = shown.iter().map(|run| Labelled { label: run.label, trace: run.trace }).collect();
    let overview = chart::overview(&labelled, &Scene::of(scenario));
    let caption = "Path, distances between the paths, heading, speed, net pull and held springs of the three backends over time.";
    page.section(heading, vec![Block::Replay(Box::new(replay))])
        .section("How far the paths lie apart", apart(found))
        .section("Over time", vec![Block::figure(overview, caption)])
}

fn apart(found: &Pathwise) -> Vec<Block> {
    let row = |table: Table, name: &str, difference: &Difference| {
        let Difference { position_max_m, position_final_m, heading_max_rad, heading_final_rad, rim_max_m } = *difference;
        let [position, last] = [position_max_m, position_final_m].map(|value| quantity(value, "m"));
        let [heading, last_heading] = [heading_max_rad, heading_final_rad].map(|value| quantity(value, "rad"));
        table.row([name.to_owned(), position, last, heading, last_heading, quantity(rim_max_m, "m")])
    };
    let head = ["", "position, at most", "at the end", "heading, at most", "at the end", "on the rim, at most"];
    let mut table = Table::new("Differences between paths and their errors", head);
    for (name, difference) in [
        ("inertia effect", &found.inertia_effect),
        ("engine error", &found.engine_error),
        ("of its step", &found.engine_step_error),
        ("beyond any step", &found.engine_model_error),
        ("own error", &found.own_error.all),
        ("own error of beyond", &found.own_error.rapier),
    ] {
        table = row(table, name, difference);
    }
    let partings = [(&found.first_parting.by_inertia, "by inertia"), (&found.first_parting.by_engine, "by the engine")];
    let parted = partings.map(|(it, cause)| format!("Paths part {}.", parting(it.as_ref(), cause)));
    vec![Block::Table(table), Block::List(parted.into()), Block::Table(predicted(found)), Block::Table(steps(found))]
}

fn predicted(found: &Pathwise) -> Table {
    let predicted = &found.predicted;
    let factor = predicted.release_factor.map_or("no release".to_owned(), number);
    Table::new("What theory expects of inertia", ["", "expected", "law"])
        .row(["while tips go on".to_owned(), or_none(predicted.while_driven_m, "m"), "epsilon f / k".to_owned()])
        .row(["where tips stop".to_owned(), or_none(predicted.where_tips_stop_m, "m"), "at most twice that".to_owned()])
        .row(["coasting from the start".to_owned(), or_none(predicted.coasting_m, "m"), "kinetic energy over slip limit".to_owned()])
        .row(["way after a release, over that without inertia".to_owned(), factor, "first swing of a damped oscillator".to_owned()])
        .row(["on the rim".to_owned(), or_none(predicted.estimated_m, "m"), "estimated along the quasi-static run".to_owned()])
}

fn steps(found: &Pathwise) -> Table {
    let mut table = Table::new("What the paths took", ["backend", "steps", "solves", "not converged", "status"]);
    for solution in &found.solutions {
        let status = match solution.steps.status {
            Status::Converged => "converged",
            Status::NotConverged => "some did not converge",
            Status::Failed => "failed",
        };
        let step = solution.step_s.map_or("under error control".to_owned(), |step| quantity(step, "s"));
        let counts = [solution.steps.n_solves, solution.steps.n_not_converged].map(|n| n.to_string());
        let [n_solves, n_not_converged] = counts;
        table = table.row([solution.kind.name().to_owned(), step, n_solves, n_not_converged, status.to_owned()]);
    }
    table
}

impl Comparison {
    /// Of prescribed tips and of replayed ones, as far as they were asked for.
    fn pathwise(&self) -> impl Iterator<Item = &Pathwise> {
        [&self.tiers.prescribed, &self.tiers.replayed].into_iter().flatten()
    }
}

/// Names of the backends, in their order.
pub fn backend_names() -> [&'static str; 3] {
    BackendKind::ALL.map(BackendKind::name)
}
