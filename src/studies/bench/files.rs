//! The files of a benchmark.

use std::path::Path;

use serde::Serialize;

use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::output::page::REPORT;
use crate::output::table::write_rows;
use crate::studies::bench::figure;
use crate::studies::bench::page::bench_page;
use crate::studies::bench::report::Benchmark;

/// Writes `report.html`, the tables, figures, `bench.json` and `manifest.json` to the folder
/// `target`, all or nothing; tables and figures only of what was measured.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_benchmark(target: &Path, found: &Benchmark, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(bench_page(found, manifest).to_html().as_bytes()))?;
    folder.write_json("bench.json", found)?;
    write_table(&mut folder, "bench.csv", &found.rows)?;
    write_table(&mut folder, "equal-error.csv", &found.equal_error)?;
    write_table(&mut folder, "solvers.csv", &found.solvers)?;
    write_table(&mut folder, "growth.csv", &found.growth)?;
    write_table(&mut folder, "fits.csv", &found.fits)?;
    for facts in &found.scenes {
        let figure = figure::work_precision_figure(facts, &found.rows, found.effort.budget_s);
        folder.write(&format!("work-precision-{}.svg", facts.scene), |out| out.write_all(figure.as_bytes()))?;
    }
    if !found.growth.is_empty() {
        folder.write("growth.svg", |out| out.write_all(figure::growth_figure(&found.growth).as_bytes()))?;
    }
    folder.finish(manifest)
}

fn write_table<T: Serialize>(folder: &mut OutputFolder, name: &str, lines: &[T]) -> Result<(), FolderError> {
    if lines.is_empty() {
        return Ok(());
    }
    folder.write(name, |out| write_rows(lines, out))
}
