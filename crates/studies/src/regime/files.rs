//! The regime map as text and as files.

use std::path::Path;

use crate::regime::figure::{disagreement, scene_map};
use crate::regime::page::regime_page;
use crate::regime::readme::readme;
use crate::regime::report::{Regime, table};
use crate::regime::tables;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::quantity::quantity;
use cohaul_report::table::wrapped;
use cohaul_report::text::WIDTH;

/// Text of the tables: panels, measurement over theory, and the rule of thumb.
pub fn regime_text(found: &Regime) -> String {
    let rule = "rule of thumb: quasi-static is valid for epsilon <= 0.05, Phi >= 2 pi, zeta >= 0.5";
    format!(
        "paths agree up to {} % of the path length\n{}measured / theory\n{}{}\n{}{} cells in {}\n",
        100.0 * found.relative_tolerance,
        tables::panels(found).text_by(2),
        tables::laws(found).text_in_groups(2),
        wrapped(rule, 2, WIDTH - 2),
        tables::rule(found).text(),
        found.n_cells,
        quantity(found.wall_s, "s")
    )
}

/// Writes `regime.csv`, a map a scene and the disagreements as SVG, `README.md`, `report.html`,
/// `summary.json` and `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_regime(target: &Path, found: &Regime, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("regime.csv", |out| table(&found.cells).write_csv(out))?;
    let maps = found.grids.iter().map(|grid| (grid.scene.name().to_owned(), scene_map(grid, &found.cells)));
    let disagreement = ("disagreement".to_owned(), disagreement(&found.grids, &found.cells));
    let figures: Vec<(String, String)> = maps.chain([disagreement]).collect();
    for (name, svg) in &figures {
        folder.write(&format!("{name}.svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    folder.write(REPORT, |out| out.write_all(regime_page(found, &figures, manifest).to_html().as_bytes()))?;
    folder.write("README.md", |out| out.write_all(readme(found, target).as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}
