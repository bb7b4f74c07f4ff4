//! The page of a benchmark: what each error costs.

use crate::bench::SceneFacts;
use crate::bench::figure;
use crate::bench::report::Benchmark;
use crate::bench::text::{bench_text, equal_error_table, solver_table};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page};
use cohaul_report::quantity::{number, quantity, short};
use cohaul_report::table::Table;

/// The error at which the headline compares methods, over the path length (1).
const COMPARED: f64 = 1e-3;

pub fn bench_page(found: &Benchmark, manifest: &Manifest) -> Page {
    let mut page = Page::new("What an error costs", headline(found)).from(manifest);
    for facts in &found.scenes {
        let figure = Block::figure(figure::work_precision_figure(facts, &found.measured.rows, found.effort.budget_s), caption(facts));
        page = page.section(&facts.scene, vec![Block::Table(equal_error(facts, found)), figure]);
    }
    if !found.measured.growth.is_empty() {
        let figure =
            Block::figure(figure::growth_figure(&found.measured.growth), "Cost of a step, or of a tick of ants, over the size of a scene.");
        page = page.section("Growth", vec![figure]);
    }
    if !found.measured.solvers.is_empty() {
        page = page.section("Solvers", vec![Block::Table(solvers(found))]);
    }
    page.section("All tables", vec![Block::Folded { heading: "As printed".to_owned(), blocks: vec![Block::Code(bench_text(found))] }])
}

fn headline(found: &Benchmark) -> Headline {
    let settings = format!("{} settings in {} scenes", found.measured.rows.len(), found.scenes.len());
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

fn equal_error(facts: &SceneFacts, found: &Benchmark) -> Table {
    let caption = "CPU time at which an error is reached, over the path length; in brackets over the best rapier variant";
    equal_error_table(facts, found, "method", "not reached", number).titled(caption)
}

fn solvers(found: &Benchmark) -> Table {
    let caption = "Solvers on the friction problems of four ants on four springs";
    solver_table(found, ["residual, median", "at most"], "none", number).titled(caption)
}
