//! Files of a stress test.

use std::path::Path;

use super::heat_map::heat_map;
use super::page::stress_page;
use super::report::Stress;
use super::{Map, Row};
use cohaul_report::account_words;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::table::Table;

/// Writes `report.html`, `cells.csv`, a heat map a map as SVG, `summary.json` and `manifest.json`
/// to the folder `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_stress(target: &Path, found: &Stress, maps: &[Map], rows: &[Row], manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(stress_page(found, maps, rows, manifest).to_html().as_bytes()))?;
    folder.write("cells.csv", |out| cells(maps, rows).write_csv(out))?;
    for map in maps {
        let of_map: Vec<&Row> = rows.iter().filter(|row| row.map == map.name).collect();
        folder.write(&format!("{}.svg", map.name), |out| out.write_all(heat_map(map, &of_map).as_bytes()))?;
    }
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

/// Columns of `cells.csv`. Parameters of different maps have different names, which are fields too.
fn cells(maps: &[Map], rows: &[Row]) -> Table {
    let of_map = rows.iter().filter_map(|row| Some((maps.iter().find(|map| map.name == row.map)?, row)));
    Table::of(
        &of_map.collect::<Vec<(&Map, &Row)>>(),
        &[
            ("map", "", &|(map, _)| map.name.into()),
            ("x name", "", &|(map, _)| map.x.name.into()),
            ("x", "", &|(_, row)| row.x.into()),
            ("y name", "", &|(map, _)| map.y.name.into()),
            ("y", "", &|(_, row)| row.y.into()),
            ("y label", "", &|(map, row)| y_label(map, row).into()),
            ("backend", "", &|(_, row)| row.method.key.into()),
            ("outcome", "", &|(_, row)| row.outcome.name().into()),
            ("cause", "", &|(_, row)| row.cause.as_str().into()),
            ("account", "", &|(_, row)| row.account.map_or("", |judged| account_words::name(judged.health)).into()),
            ("residual", "", &|(_, row)| row.numbers.residual.into()),
            ("not converged share", "", &|(_, row)| row.numbers.not_converged_share.into()),
            ("defect", "J", &|(_, row)| row.numbers.defect_j.into()),
            ("defect share", "", &|(_, row)| row.numbers.defect_share.into()),
            ("creep radii", "", &|(_, row)| row.numbers.creep_radii.into()),
            ("drift share", "", &|(_, row)| row.numbers.drift_share.into()),
            ("error share", "", &|(_, row)| row.numbers.error_share.into()),
            ("step radians", "", &|(_, row)| row.numbers.step_radians.into()),
            ("shortest share", "", &|(_, row)| row.numbers.shortest_share.into()),
            ("swing", "rad", &|(_, row)| row.numbers.swing_rad.into()),
            ("n steps", "", &|(_, row)| row.numbers.n_steps.into()),
            ("n solves", "", &|(_, row)| row.numbers.n_solves.into()),
            ("n iterations", "", &|(_, row)| row.numbers.n_iterations.into()),
        ],
    )
}

/// Name of the row's value on the y axis; empty where the values are numbers.
fn y_label(map: &Map, row: &Row) -> String {
    let at = map.y.values.iter().position(|value| *value == row.y);
    at.and_then(|at| map.y.names.get(at)).cloned().unwrap_or_default()
}
