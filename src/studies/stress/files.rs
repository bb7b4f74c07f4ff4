//! Files of a stress test.

use std::path::Path;

use serde::Serialize;

use super::heat_map::heat_map;
use super::page::stress_page;
use super::report::Stress;
use super::{Map, Row};
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::lines::TableError;
use crate::output::manifest::Manifest;
use crate::output::page::REPORT;
use crate::output::table::write_rows;

/// A row of `cells.csv`; empty fields where there is no number. Parameters of unlike maps have
/// unlike names, so those stand beside them.
#[derive(Serialize)]
struct Line<'a> {
    map: &'a str,
    x_name: &'a str,
    x: f64,
    y_name: &'a str,
    y: f64,
    y_label: &'a str,
    backend: &'static str,
    outcome: &'static str,
    cause: &'a str,
    residual: Option<f64>,
    not_converged_share: Option<f64>,
    defect_j: Option<f64>,
    defect_share: Option<f64>,
    creep_radii: Option<f64>,
    drift_share: Option<f64>,
    error_share: Option<f64>,
    step_radians: Option<f64>,
    shortest_share: Option<f64>,
    swing_rad: Option<f64>,
    n_steps: u64,
    n_solves: u64,
    n_iterations: u64,
}

/// Writes `report.html`, `cells.csv`, a heat map a map as SVG, `summary.json` and `manifest.json`
/// to the folder `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_stress(target: &Path, found: &Stress, maps: &[Map], rows: &[Row], manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(stress_page(found, maps, rows, manifest).to_html().as_bytes()))?;
    folder.write("cells.csv", |out| write_csv(maps, rows, out))?;
    for map in maps {
        let of_map: Vec<&Row> = rows.iter().filter(|row| row.map == map.name).collect();
        folder.write(&format!("{}.svg", map.name), |out| out.write_all(heat_map(map, &of_map).as_bytes()))?;
    }
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

fn write_csv(maps: &[Map], rows: &[Row], out: impl std::io::Write) -> Result<(), TableError> {
    let of = |row: &Row| maps.iter().find(|map| map.name == row.map);
    write_rows(rows.iter().filter_map(|row| Some(line(of(row)?, row))), out)
}

fn line<'a>(map: &'a Map, row: &'a Row) -> Line<'a> {
    let at = map.y.values.iter().position(|value| *value == row.y);
    let numbers = &row.numbers;
    Line {
        map: map.name,
        x_name: map.x.name,
        x: row.x,
        y_name: map.y.name,
        y: row.y,
        y_label: at.and_then(|at| map.y.names.get(at)).copied().unwrap_or_default(),
        backend: row.method.key,
        outcome: row.outcome.name(),
        cause: &row.cause,
        residual: numbers.residual,
        not_converged_share: numbers.not_converged_share,
        defect_j: numbers.defect_j,
        defect_share: numbers.defect_share,
        creep_radii: numbers.creep_radii,
        drift_share: numbers.drift_share,
        error_share: numbers.error_share,
        step_radians: numbers.step_radians,
        shortest_share: numbers.shortest_share,
        swing_rad: numbers.swing_rad,
        n_steps: numbers.n_steps,
        n_solves: numbers.n_solves,
        n_iterations: numbers.n_iterations,
    }
}
