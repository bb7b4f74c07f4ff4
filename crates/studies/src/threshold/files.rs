//! The files of a search for thresholds in an output folder.

use std::path::Path;

pub use super::figure::figure as thresholds_figure;
use super::figure::{LEAST, figure, figure_for_print};
use super::point::Class;
use super::report::Thresholds;
use cohaul_report::chart::print::write_for_print;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page, REPORT};
use cohaul_report::quantity::quantity;

/// Writes `report.html`, `points.csv`, `threshold.svg`, figures for print, `summary.json` and
/// `manifest.json` to the folder `target`, or nothing.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_thresholds(target: &Path, found: &Thresholds, manifest: &Manifest) -> Result<(), FolderError> {
    let svg = figure(found);
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(thresholds_page(found, svg.clone(), manifest).to_html().as_bytes()))?;
    folder.write("points.csv", |out| found.table_of_points().write_csv(out))?;
    folder.write("threshold.svg", |out| out.write_all(svg.as_bytes()))?;
    write_for_print(&mut folder, "threshold", |width| figure_for_print(found, width))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

/// The page of a search.
pub fn thresholds_page(found: &Thresholds, svg: String, manifest: &Manifest) -> Page {
    let numbers = vec![
        Number::new("points", found.points.len().to_string(), ""),
        Number::new("failed", found.n_failed.to_string(), ""),
        Number::new("took", quantity(found.wall_s, "s"), ""),
    ];
    let caption = format!(
        "Inertia effect over the tolerance of each quantity: quasi-static is valid below the dashed line. Values below {LEAST} stand at {LEAST}."
    );
    Page::new(
        format!("{}: thresholds in {}", found.scenario, found.parameter.path),
        Headline::new(answer(found), &*found.answer).with(Block::Numbers(numbers)),
    )
    .from(manifest)
    .section("Inertia effect", vec![Block::figure(svg, caption)])
    .section("Ranges", vec![Block::Text(format!("Parameter: {}.", found.meaning())), Block::Table(found.table())])
}

/// Whether quasi-static is valid for all quantities everywhere, somewhere or nowhere.
fn answer(found: &Thresholds) -> Answer {
    let has = |class: Class| found.quantities.iter().any(|of| !of.of(class).is_empty());
    match [has(Class::Valid), has(Class::NotValid), has(Class::Failed)] {
        [.., true] | [false, false, _] => Answer::Open,
        [true, false, _] => Answer::Yes,
        [false, true, _] => Answer::No,
        [true, true, _] => Answer::Partly,
    }
}
