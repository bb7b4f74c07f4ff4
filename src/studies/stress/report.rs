//! Stress maps for programs, for people and as files.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::output::page::REPORT;
use crate::output::quantity::quantity;
use crate::studies::methods::Method;
use crate::studies::stress::heat_map::heat_map;
use crate::studies::stress::page::stress_page;
use crate::studies::stress::{Map, Outcome, Row};

/// What `stress --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stress {
    /// No panic, no number without a value, nothing unexplained.
    pub holds: bool,
    pub n_cells: usize,
    /// Cells times backends.
    pub n_runs: usize,
    pub n_panicked: usize,
    pub n_not_finite: usize,
    pub n_unexplained: usize,
    pub quick: bool,
    pub wall_s: f64,
    /// Number of runs by backend and outcome.
    pub outcomes: Counts,
    pub maps: Vec<MapSummary>,
    /// The first of what must not be.
    pub defects: Vec<Defect>,
}

/// By backend and outcome.
pub type Counts = BTreeMap<&'static str, BTreeMap<&'static str, usize>>;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapSummary {
    pub name: &'static str,
    pub what: &'static str,
    pub x: &'static str,
    pub y: &'static str,
    pub n_cells: usize,
    pub outcomes: Counts,
}

/// A run that panicked, had a number without a value, or is unexplained.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Defect {
    pub map: String,
    pub x: f64,
    pub y: f64,
    pub backend: &'static str,
    pub outcome: &'static str,
    pub cause: String,
}

/// How many defects a summary names.
const MOST_DEFECTS: usize = 20;

/// A row of `cells.csv`; empty fields where there is no number. Parameters of unlike maps have unlike names, so those stand beside them.
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

impl Stress {
    /// Of the `rows` of `maps`, in the order of their cells.
    pub fn new(maps: &[Map], rows: &[Row], quick: bool, wall_s: f64) -> Self {
        let n_of = |outcome: Outcome| rows.iter().filter(|row| row.outcome == outcome).count();
        let of_map = |map: &Map| MapSummary {
            name: map.name,
            what: map.what,
            x: map.x.name,
            y: map.y.name,
            n_cells: map.n_cells(),
            outcomes: counts(rows.iter().filter(|row| row.map == map.name)),
        };
        let defects = rows.iter().filter(|row| row.outcome.is_defect()).take(MOST_DEFECTS).map(Defect::of);
        Self {
            holds: !rows.iter().any(|row| row.outcome.is_defect()),
            n_cells: maps.iter().map(Map::n_cells).sum(),
            n_runs: rows.len(),
            n_panicked: n_of(Outcome::Panicked),
            n_not_finite: n_of(Outcome::NotFinite),
            n_unexplained: n_of(Outcome::Unexplained),
            quick,
            wall_s,
            outcomes: counts(rows.iter()),
            maps: maps.iter().map(of_map).collect(),
            defects: defects.collect(),
        }
    }
}

impl Defect {
    fn of(row: &Row) -> Self {
        let (backend, outcome) = (row.method.key, row.outcome.name());
        Self { map: row.map.clone(), x: row.x, y: row.y, backend, outcome, cause: row.cause.clone() }
    }
}

fn counts<'a>(rows: impl Iterator<Item = &'a Row>) -> Counts {
    let mut counts = Counts::new();
    for row in rows {
        *counts.entry(row.method.key).or_default().entry(row.outcome.name()).or_default() += 1;
    }
    counts
}

/// Numbers of outcomes, a table a map and one over all, then what must not be, then whether all holds.
pub fn stress_text(found: &Stress) -> String {
    let mut text = String::new();
    for map in &found.maps {
        writeln!(text, "{} ({} cells, {} x {}): {}", map.name, map.n_cells, map.x, map.y, map.what).expect("a string takes all");
        text.push_str(&table(&map.outcomes));
    }
    if found.maps.len() > 1 {
        writeln!(text, "all maps").expect("a string takes all");
        text.push_str(&table(&found.outcomes));
    }
    for Defect { map, x, y, backend, outcome, cause } in &found.defects {
        writeln!(text, "{outcome}: {map} at {x:e}, {y:e} by {backend}: {cause}").expect("a string takes all");
    }
    let (cells, runs, wall) = (found.n_cells, found.n_runs, quantity(found.wall_s, "s"));
    let Stress { n_panicked, n_not_finite, n_unexplained, .. } = found;
    writeln!(text, "{cells} cells, {runs} runs: {n_panicked} panics, {n_not_finite} not finite, {n_unexplained} unexplained; {wall}")
        .expect("a string takes all");
    text
}

/// A line a backend, a column an outcome that occurs.
fn table(counts: &Counts) -> String {
    let occurs = |outcome: &Outcome| counts.values().any(|of_backend| of_backend.contains_key(outcome.name()));
    let columns: Vec<&str> = Outcome::ALL.iter().filter(|outcome| occurs(outcome)).map(|outcome| outcome.name()).collect();
    let mut text = format!("  {:<18}", "");
    columns.iter().for_each(|name| write!(text, "  {name:>8}").expect("a string takes all"));
    text.push('\n');
    for method in Method::all_stressed().filter(|method| counts.contains_key(method.key)) {
        write!(text, "  {:<18}", method.key).expect("a string takes all");
        for name in &columns {
            let n = counts[method.key].get(name).copied().unwrap_or(0);
            write!(text, "  {n:>width$}", width = name.len().max(8)).expect("a string takes all");
        }
        text.push('\n');
    }
    text
}

/// Names of the maps, their parameters and what they do.
pub fn stress_list(maps: &[Map]) -> String {
    let size = |map: &Map| format!("{} x {}", map.x.values.len(), map.y.values.len());
    let width = |text: fn(&Map) -> String| maps.iter().map(|map| text(map).chars().count()).max().unwrap_or(0);
    let axes = |map: &Map| format!("{}, {}", map.x.name, map.y.name);
    let (name_width, axes_width) = (width(|map| map.name.to_owned()), width(|map| format!("{}, {}", map.x.name, map.y.name)));
    maps.iter().map(|map| format!("{:<name_width$}  {:>7}  {:<axes_width$}  {}\n", map.name, size(map), axes(map), map.what)).collect()
}

/// Writes `report.html`, `cells.csv`, a heat map a map as SVG, `summary.json` and `manifest.json` to the folder `target`, all or nothing.
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

fn write_csv(maps: &[Map], rows: &[Row], out: impl std::io::Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(out);
    for row in rows {
        let Some(map) = maps.iter().find(|map| map.name == row.map) else { continue };
        writer.serialize(line(map, row))?;
    }
    Ok(writer.flush()?)
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
