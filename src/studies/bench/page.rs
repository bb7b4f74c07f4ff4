//! The page of a benchmark: what each error costs.

use crate::output::manifest::Manifest;
use crate::output::page::{Answer, Block, Headline, Number, Page};
use crate::output::quantity::short;
use crate::output::quantity::{number, quantity};
use crate::output::table::Table;
use crate::studies::bench::figure;
use crate::studies::bench::report::Benchmark;
use crate::studies::bench::text::bench_text;
use crate::studies::bench::{EqualError, SceneFacts};
use crate::studies::methods::METHODS;

/// The error at which the headline compares methods, over the path length (1).
const COMPARED: f64 = 1e-3;

pub fn bench_page(found: &Benchmark, manifest: &Manifest) -> Page {
    let mut page = Page::new("What an error costs", headline(found)).from(manifest);
    for facts in &found.scenes {
        let figure = Block::figure(figure::work_precision_figure(facts, &found.rows, found.effort.budget_s), caption(facts));
        page = page.section(&facts.scene, vec![Block::Table(equal_error(facts, found)), figure]);
    }
    if !found.growth.is_empty() {
        let figure = Block::figure(figure::growth_figure(&found.growth), "Cost of a step, or of a tick of ants, over the size of a scene.");
        page = page.section("Growth", vec![figure]);
    }
    if !found.solvers.is_empty() {
        page = page.section("Solvers", vec![Block::Table(solvers(found))]);
    }
    page.section("All tables", vec![Block::Folded { heading: "As printed".to_owned(), blocks: vec![Block::Code(bench_text(found))] }])
}

fn headline(found: &Benchmark) -> Headline {
    let settings = format!("{} settings in {} scenes", found.rows.len(), found.scenes.len());
    let ratios = found.scenes.iter().filter_map(|facts| sooner(found, facts));
    let (least, most, n) = ratios.fold((f64::INFINITY, 0.0f64, 0), |(least, most, n), ratio| (least.min(ratio), most.max(ratio), n + 1));
    let sentence = match n {
        0 => format!("{settings} were measured."),
        1 => format!(
            "{settings}: the inertial method reaches an error of 0.1 % of the path length {} times as fast as the best rapier variant.",
            short(most)
        ),
        _ => format!(
            "{settings}: the inertial method reaches an error of 0.1 % of the path length {} to {} times as fast as the best rapier variant, in the {n} scenes where both reach it.",
            short(least),
            short(most)
        ),
    };
    let noise = &found.noise;
    let trust = if noise.is_noisy { "too busy to conclude" } else { "quiet enough" };
    let numbers = vec![
        Number::new("machine", found.host.cpu.clone().unwrap_or_else(|| "unknown processor".to_owned()), trust),
        Number::new(
            "spread",
            format!("{} of {}", noise.n_spread, noise.n_timings),
            format!("medians above {} times the least time", noise.most_spread),
        ),
        Number::new("rounds", found.effort.repeats.to_string(), "CPU times of one thread, the least counts"),
        Number::new("took", quantity(found.wall_s, "s"), ""),
    ];
    let headline = Headline::new(if noise.is_noisy { Answer::Open } else { Answer::None }, sentence).with(Block::Numbers(numbers));
    if found.warnings.is_empty() { headline } else { headline.with(Block::List(found.warnings.clone())) }
}

/// How many times as fast as the best engine the best setting with inertia is in a scene (1), at
/// the error that is compared.
fn sooner(found: &Benchmark, facts: &SceneFacts) -> Option<f64> {
    let of_scene = found.equal_error.iter().filter(|line| line.scene == facts.scene && line.error == COMPARED);
    let ratios = of_scene.filter(|line| line.method.starts_with("inertial")).filter_map(|line| line.over_rapier);
    ratios.filter(|ratio| *ratio > 0.0).map(|ratio| 1.0 / ratio).max_by(f64::total_cmp)
}

fn caption(facts: &SceneFacts) -> String {
    let inertia = facts.inertia_effect_m.map_or(String::new(), |apart| format!("; inertia effect {}", quantity(apart, "m")));
    format!(
        "Error against CPU time, one point per setting; path length {}{inertia}. Left and low is better.",
        quantity(facts.path_length_m, "m")
    )
}

/// Levels of error to the right, methods downwards.
fn equal_error(facts: &SceneFacts, found: &Benchmark) -> Table {
    let lines: Vec<&EqualError> = found.equal_error.iter().filter(|line| line.scene == facts.scene).collect();
    let mut levels: Vec<f64> = lines.iter().filter(|line| line.cpu_s.is_some()).map(|line| line.error).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    let heads = levels.iter().map(|level| format!("{level:.0e}"));
    let caption = "CPU time at which an error is reached, over the path length; in brackets over the best rapier variant";
    let mut table = Table::new(caption, ["method".to_owned()].into_iter().chain(heads));
    for method in METHODS.iter().map(|method| method.name).filter(|name| lines.iter().any(|line| line.method == *name)) {
        let cell = |level: &f64| {
            let line = lines.iter().find(|line| line.error == *level && line.method == method)?;
            let ratio = line.over_rapier.map_or(String::new(), |ratio| format!(" ({})", number(ratio)));
            line.cpu_s.map(|cpu| quantity(cpu, "s") + &ratio)
        };
        let cells = levels.iter().map(|level| cell(level).unwrap_or_else(|| "not reached".to_owned()));
        table.push([method.to_owned()].into_iter().chain(cells));
    }
    table
}

fn solvers(found: &Benchmark) -> Table {
    let head = ["problems", "solver", "number", "time each", "over exact", "residual, median", "at most"];
    found.solvers.iter().fold(Table::new("Solvers on the friction problems of four ants on four springs", head), |table, line| {
        table.row([
            line.problems.to_owned(),
            line.solver.to_owned(),
            line.n_problems.to_string(),
            line.cpu_min_s.map_or("none".to_owned(), |cpu| quantity(cpu, "s")),
            line.over_exact.map_or("none".to_owned(), number),
            number(line.residual_median),
            number(line.residual_max),
        ])
    })
}
