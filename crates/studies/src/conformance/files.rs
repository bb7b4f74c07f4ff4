//! The page and the files of a conformance table.

use std::path::Path;

use super::grade::MEANING;
use super::report::{Conformance, conformance_markdown};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page, REPORT};

/// The page: the answer, a line a number, and what each test asks.
pub fn conformance_page(found: &Conformance, manifest: &Manifest) -> Page {
    let counts = &found.counts;
    let mark = match () {
        () if counts.failed > 0 => Answer::No,
        () if counts.beyond > 0 || counts.refused > 0 => Answer::Partly,
        () => Answer::Yes,
    };
    let number = |name: &str, n: usize| Number::new(name, n.to_string(), "");
    let numbers = vec![
        number("exact", counts.exact),
        number("to 1 %", counts.to_1_percent),
        number("to 10 %", counts.to_10_percent),
        number("beyond", counts.beyond),
        number("refused", counts.refused),
        number("failed", counts.failed),
    ];
    Page::new(format!("Conformance of {}", found.engine.text()), Headline::new(mark, &*found.answer).with(Block::Numbers(numbers)))
        .from(manifest)
        .section("Known answers", vec![Block::Table(found.table()), Block::text(MEANING)])
        .section("Questions", vec![Block::Table(found.questions())])
        .section("For a README", vec![Block::Code(found.line.clone())])
}

/// Writes `report.html`, `conformance.md`, `summary.json` and `manifest.json` to the folder
/// `target`, or nothing.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_conformance(target: &Path, found: &Conformance, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(conformance_page(found, manifest).to_html().as_bytes()))?;
    folder.write("conformance.md", |out| out.write_all(conformance_markdown(found).as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}
