//! The files of a benchmark.

use std::path::Path;

use crate::bench::figure;
use crate::bench::page::bench_page;
use crate::bench::report::Benchmark;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::table::{Table, write_rows};

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
    if !found.equal_error.is_empty() {
        folder.write("equal-error.csv", |out| write_rows(&found.equal_error, out))?;
    }
    write_table(&mut folder, "solvers.csv", &found.solvers)?;
    write_table(&mut folder, "growth.csv", &found.growth)?;
    write_table(&mut folder, "fits.csv", &found.fits)?;
    for facts in &found.scenes {
        let figure = figure::work_precision_figure(facts, &found.measured.rows, found.effort.budget_s);
        folder.write(&format!("work-precision-{}.svg", facts.scene), |out| out.write_all(figure.as_bytes()))?;
    }
    if !found.measured.growth.is_empty() {
        folder.write("growth.svg", |out| out.write_all(figure::growth_figure(&found.measured.growth).as_bytes()))?;
    }
    folder.finish(manifest)
}

fn write_table(folder: &mut OutputFolder, name: &str, table: &Table) -> Result<(), FolderError> {
    if table.rows.is_empty() {
        return Ok(());
    }
    folder.write(name, |out| table.write_csv(out))
}
