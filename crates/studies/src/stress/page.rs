//! The page of a stress test: where numbers break.

use crate::stress::heat_map::heat_map;
use crate::stress::report::{Counts, Stress};
use crate::stress::{Map, Row};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page};
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;

pub fn stress_page(found: &Stress, maps: &[Map], rows: &[Row], manifest: &Manifest) -> Page {
    let mut page = Page::new("Where numbers break", headline(found)).from(manifest);
    if !found.defects.is_empty() {
        let head = ["map", "at", "backend", "outcome", "cause"];
        let table = found.defects.iter().fold(Table::new("The first of what must not be", head), |table, defect| {
            let at = format!("{:e}, {:e}", defect.x, defect.y);
            table.row([defect.map.clone(), at, defect.backend.to_owned(), defect.outcome.to_owned(), defect.cause.clone()])
        });
        page = page.section("Defects", vec![Block::Table(table)]);
    }
    page = page.section("All maps", vec![Block::Table(outcomes("Runs by backend and outcome", &found.outcomes))]);
    for (map, summary) in maps.iter().zip(&found.maps) {
        let of_map: Vec<&Row> = rows.iter().filter(|row| row.map == map.name).collect();
        let figure = Block::figure(heat_map(map, &of_map), format!("{}: {}, {} over {}.", map.name, map.what, map.y.name, map.x.name));
        let counts = Block::Folded {
            heading: "Counts".to_owned(),
            blocks: vec![Block::Table(outcomes("Runs by backend and outcome", &summary.outcomes))],
        };
        page = page.section(format!("{}: {}", map.name, map.what), vec![figure, counts]);
    }
    page
}

fn headline(found: &Stress) -> Headline {
    let all = format!("{} runs in {} cells of {} maps", found.n_runs, found.n_cells, found.maps.len());
    let (answer, sentence) = if found.holds {
        (Answer::Yes, format!("Every one of {all} was finished, or says what went wrong and why."))
    } else {
        let n = found.n_panicked + found.n_not_finite + found.n_unexplained;
        (Answer::No, format!("{n} of {all} panicked, had a number without a value, or broke without a cause."))
    };
    let count = |name: &str, n: usize| Number::new(name, n.to_string(), "");
    let numbers = vec![
        count("panicked", found.n_panicked),
        count("not finite", found.n_not_finite),
        count("unexplained", found.n_unexplained),
        Number::new("took", quantity(found.wall_s, "s"), if found.quick { "four values an axis" } else { "" }),
    ];
    Headline::new(answer, sentence).with(Block::Numbers(numbers))
}

fn outcomes(caption: &str, counts: &Counts) -> Table {
    let mut names: Vec<&str> = counts.values().flat_map(|of| of.keys().copied()).collect();
    names.sort_unstable();
    names.dedup();
    let head = ["backend"].into_iter().chain(names.iter().copied()).map(str::to_owned);
    let row = |(backend, of): (&&str, &std::collections::BTreeMap<&str, usize>)| {
        let cells = names.iter().map(|name| of.get(name).copied().unwrap_or(0).to_string());
        [(*backend).to_owned()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    Table::new(caption, head).with_rows(counts.iter().map(row))
}
