//! The page of a sweep: what its runs come to, by parameters and backend.

use crate::sweep::report::{FAILED, SweepSummary, group_rows};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page};
use cohaul_report::table::Table;

/// Groups that the page shows; the rest are in the table of groups beside it.
const MOST_SHOWN: usize = 200;

/// `figure` is the SVG of the sweep, if there is one.
pub fn sweep_page(found: &SweepSummary, figure: Option<String>, manifest: &Manifest) -> Page {
    let groups = found.groups.as_deref().unwrap_or_default();
    let mut rows = group_rows(found, &groups[..groups.len().min(MOST_SHOWN)]).into_iter();
    let (caption, head) = ("Runs that differ by their seed alone, with 95 % intervals".to_owned(), rows.next().unwrap_or_default());
    let mut blocks = vec![Block::Table(Table::new(caption, head).with_rows(rows))];
    if groups.len() > MOST_SHOWN || found.groups.is_none() {
        blocks.push(Block::Text(format!("{} groups in all: groups.csv has them.", found.n_groups)));
    }
    let figures = figure.map(|svg| Block::figure(svg, "Means with 95 % intervals, or how the runs are spread where only seeds differ. What stands at one value is drawn a little apart."));
    let failures: Vec<String> = found.failures.iter().map(|failure| format!("cell {}: {}", failure.cell, failure.cause)).collect();
    let failures = (!failures.is_empty()).then_some(Block::List(failures));
    Page::new(format!("{}: an ensemble", found.scenario), headline(found))
        .from(manifest)
        .section("Groups", figures.into_iter().chain(blocks).collect())
        .section("The first runs that failed", failures.into_iter().collect())
}

fn headline(found: &SweepSummary) -> Headline {
    let groups = found.groups.as_deref().unwrap_or_default();
    let (n_arrived, n_with_nest) = groups.iter().fold((0, 0), |(a, n), group| (a + group.n_arrived, n + group.n_with_nest));
    let arrived = if n_with_nest > 0 { format!("; {n_arrived} of {n_with_nest} brought the load home") } else { String::new() };
    let n_failed = found.n_of(FAILED);
    let sentence = match n_failed {
        0 => format!("All {} runs have an answer{arrived}.", found.n_runs),
        n => format!("{n} of {} runs failed{arrived}.", found.n_runs),
    };
    let warnings = found.warnings();
    let is_sound = n_failed == 0 && warnings.is_empty();
    let sentence = std::iter::once(sentence).chain(warnings.iter().map(|warning| format!("{warning}."))).collect::<Vec<_>>().join(" ");
    let mut numbers = vec![
        Number::new("points", found.n_points.to_string(), found.parameters.join(", ")),
        Number::new("seeds", found.n_seeds.to_string(), format!("from {}", found.first_seed)),
    ];
    numbers.extend(found.statuses.iter().map(|(status, n)| Number::new(status.clone(), n.to_string(), "runs")));
    numbers.extend(found.took().map(|took| Number::new("took", took, "")));
    Headline::new(if is_sound { Answer::None } else { Answer::Open }, sentence).with(Block::Numbers(numbers))
}
