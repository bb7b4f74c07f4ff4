//! The files of a map of comparisons in an output folder.

use std::path::Path;

pub use super::figure::figure as map_figure;
use super::figure::{LEAST, figure, figure_for_print};
use super::report::{Map, NUMBERS, rule};
use cohaul_report::chart::print::write_for_print;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page, REPORT};
use cohaul_report::quantity::quantity;

/// Writes `report.html`, `map.csv`, `map.svg`, figures for print, `summary.json` and
/// `manifest.json` to the folder `target`, or nothing.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_map(target: &Path, map: &Map, manifest: &Manifest) -> Result<(), FolderError> {
    let svg = figure(map);
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(map_page(map, svg.clone(), manifest).to_html().as_bytes()))?;
    folder.write("map.csv", |out| map.table().write_csv(out))?;
    folder.write("map.svg", |out| out.write_all(svg.as_bytes()))?;
    write_for_print(&mut folder, "map", |width| figure_for_print(map, width))?;
    folder.write_json("summary.json", map)?;
    folder.finish(manifest)
}

/// The page of a map.
pub fn map_page(map: &Map, svg: String, manifest: &Manifest) -> Page {
    let (n, n_valid) = (map.cells.len(), map.n_valid());
    let answer = match n_valid {
        _ if map.n_failed > 0 => Answer::Open,
        0 => Answer::No,
        _ if n_valid == n => Answer::Yes,
        _ => Answer::Partly,
    };
    let count = |name: &str, n: usize| Number::new(name, n.to_string(), "");
    let numbers = vec![
        count("points", n),
        count("compared in full", map.n_compared),
        count("by the estimate alone", map.n_by_estimate),
        count("failed", map.n_failed),
        Number::new("took", quantity(map.wall_s, "s"), ""),
    ];
    let caption = match map.axes.len() {
        1 => format!(
            "Inertia effect and engine error over the tolerance of each quantity: above the dashed line they count as a difference. Values \
             below {LEAST} stand at {LEAST}."
        ),
        _ => "Inertia effect over the tolerance of each quantity. Up to the line at 1 quasi-static is valid.".to_owned(),
    };
    let paths: Vec<&str> = map.axes.iter().map(|axis| axis.path.as_str()).collect();
    Page::new(
        format!("{}: comparison over {}", map.scenario, paths.join(" and ")),
        Headline::new(answer, &*map.answer).with(Block::Numbers(numbers)),
    )
    .from(manifest)
    .section("Map", vec![Block::figure(svg, caption), Block::Text(format!("Decided by: {}.", rule(&map.question)))])
    .section("Points", vec![Block::Text(format!("The table has {NUMBERS}.")), Block::Table(map.shares())])
}
