//! SVG figures over one or several traces: the load's path, its heading, speed and pulls over time,
//! and how far traces differ.
//!
//! Every function returns a whole SVG document without scripts and embedded fonts. The same
//! traces give the same bytes. The unit of each axis fits its largest value, such as mm or kN.
//! Curves differ in colour (Okabe and Ito's set, made for colour-blind readers) and in dashes.
//! Curves of many points are thinned to what can be seen, with their extremes kept: see [`thin`].
//! Where points are too dense for a line, a panel shows means and ranges and says so.
//!
//! ```text
//! scene.rs       a trace with its name, and its surroundings
//! shown.rs       rows -> what is shown of them
//! outline.rs     outlines of loads and obstacles as lines
//! panels.rs      traces -> panels: what is shown
//! difference.rs  distance of two traces over time
//! panel.rs       a panel as data: labels, curves, marks
//! unit.rs        units that fit the largest value of a panel
//! axis.rs        ranges, ticks and their labels
//! thin.rs        fewer points, same picture
//! canvas.rs      panels -> SVG
//! cells.rs       maps of cells -> SVG
//! cell_axis.rs   axis of a map of cells: ticks and their labels
//! level.rs       lines of equal value over a map of cells
//! print.rs       drawings of one or two columns -> SVG and PDF
//! ```

pub mod axis;
pub mod bars;
pub mod canvas;
mod cell_axis;
pub mod cells;
pub mod difference;
mod level;
pub mod outline;
pub mod panel;
pub mod panels;
pub mod print;
mod scene;
pub mod shown;
pub mod thin;
mod unit;

use canvas::{Cell, Sheet};
use panel::{Entry, Panel, Scale, Style};
use print::Drawing;
pub use scene::{Labelled, MILLI, Nest, Scene};
use shown::Seen;
pub use shown::SeenRows;

use std::borrow::Cow;

/// Colour of trace `index`, in drawings beside the figures.
pub fn trace_color(index: usize) -> &'static str {
    Style::of_trace(index).color
}

/// Path of the load's origin in the plane, equal scales, with the load's outline at the start
/// (grey) and at each end, and the obstacles that are near. The line from the origin of an outline
/// points along the heading.
pub fn path(traces: &[Labelled], scene: &Scene) -> String {
    let seen = Seen::all(traces);
    let panel = panels::path(&seen, scene);
    let legend = vec![panels::trace_entries(traces), panels::scene_entries(&seen, scene)];
    alone(&panel, legend, canvas::natural_height(&panel, WIDTH))
}

/// Edge displacement of the load between traces over time (log axis): all pairs of up to three
/// traces, else each against the first. Where two traces agree within rounding there is a gap. A
/// line marks the tolerance of the scene.
pub fn edge_difference(traces: &[Labelled], scene: &Scene) -> String {
    let marks = [panels::tolerance_entry(scene), panels::event_entries(traces)].concat();
    alone(&panels::edge_difference(traces, scene), vec![panels::pair_entries(traces), marks], TIME_HEIGHT)
}

/// All figures on one sheet: with differences for two or more traces, with the energy for one.
pub fn overview(traces: &[Labelled], scene: &Scene) -> String {
    overview_of(traces, &Seen::all(traces), scene)
}

/// Overview sheet of one run whose `rows` are no longer in its trace.
pub fn overview_of_rows(run: &Labelled, rows: &SeenRows, scene: &Scene) -> String {
    overview_of(&[*run], &[Seen { rows: Cow::Borrowed(rows), events: &run.trace.events }], scene)
}

fn overview_of(traces: &[Labelled], seen: &[Seen], scene: &Scene) -> String {
    let mut sheet = Sheet::lettered(2.0 * COLUMN_WIDTH, 4.0 * ROW_HEIGHT);
    // Drawn one by one: the points of one panel are gone before the next one's.
    let mut add = |panel: &Panel, column: f64, row: f64| add_in_rows(&mut sheet, panel, column, row);
    add(&panels::path(seen, scene), 0.0, 0.0);
    if let [one] = seen {
        add(&panels::total_pull(seen), 0.0, 2.0);
        add(&panels::energy(one, scene), 0.0, 3.0);
    } else {
        add(&panels::edge_difference(traces, scene), 0.0, 2.0);
        add(&panels::heading_difference(traces, scene), 0.0, 3.0);
    }
    add(&panels::heading(seen), 1.0, 0.0);
    add(&panels::speed(seen), 1.0, 1.0);
    add(&panels::net_pull(seen, scene), 1.0, 2.0);
    add(&panels::attachments(seen), 1.0, 3.0);
    let curves = if traces.len() > 1 { panels::pair_entries(traces) } else { panels::energy_entries(scene) };
    let marks = [
        panels::scene_entries(seen, scene),
        panels::slip_limit_entry(scene),
        panels::tolerance_entry(scene),
        panels::event_entries(traces),
    ];
    sheet.into_svg(&[panels::trace_entries(traces), curves, marks.concat()])
}

/// Adds a panel at a column and a row. A path is as high as two of the others.
fn add_in_rows(sheet: &mut Sheet, panel: &Panel, column: f64, row: f64) {
    let n_rows = if panel.scale == Scale::Plane { 2.0 } else { 1.0 };
    sheet.add(&Cell { panel, left: column * COLUMN_WIDTH, top: row * ROW_HEIGHT, width: COLUMN_WIDTH, height: n_rows * ROW_HEIGHT });
}

/// Path, heading and speed of the load in an expected and a found trace, and their differences.
pub fn expected_and_found(traces: &[Labelled; 2], scene: &Scene) -> String {
    let seen = Seen::all(traces);
    let mut sheet = Sheet::lettered(2.0 * COLUMN_WIDTH, 3.0 * ROW_HEIGHT);
    add_in_rows(&mut sheet, &panels::path(&seen, scene), 0.0, 0.0);
    add_in_rows(&mut sheet, &panels::heading(&seen), 1.0, 0.0);
    add_in_rows(&mut sheet, &panels::speed(&seen), 1.0, 1.0);
    add_in_rows(&mut sheet, &panels::edge_difference(traces, scene), 0.0, 2.0);
    add_in_rows(&mut sheet, &panels::heading_difference(traces, scene), 1.0, 2.0);
    let marks = [panels::scene_entries(&seen, scene), panels::event_entries(traces)].concat();
    sheet.into_svg(&[panels::trace_entries(traces), panels::pair_entries(traces), marks])
}

/// Panels in rows of `n_columns`, each `width` by `height` (px), with the groups of their legend
/// below.
pub fn grid(panels: &[Panel], legend: &[Vec<Entry>], n_columns: usize, width: f64, height: f64) -> String {
    drawing(panels, legend, n_columns, [width, height]).svg()
}

/// Panels in rows of `n_columns`, each of a size (px), to be written on a screen or on paper. One
/// panel alone has no letter.
pub fn drawing(panels: &[Panel], legend: &[Vec<Entry>], n_columns: usize, [width, height]: [f64; 2]) -> Drawing {
    let size = [n_columns as f64 * width, panels.len().div_ceil(n_columns) as f64 * height];
    let mut sheet = if panels.len() > 1 { Sheet::lettered(size[0], size[1]) } else { Sheet::new(size[0], size[1]) };
    for (i, panel) in panels.iter().enumerate() {
        let (left, top) = ((i % n_columns) as f64 * width, (i / n_columns) as f64 * height);
        sheet.add(&Cell { panel, left, top, width, height });
    }
    Drawing(sheet.into_scene(legend))
}

pub const WORK_HEIGHT: f64 = 420.0;
pub const COLUMN_WIDTH: f64 = 480.0;
pub const ROW_HEIGHT: f64 = 220.0;
pub const PANEL_HEIGHT: f64 = 280.0;
/// Size of a figure of one panel.
pub const WIDTH: f64 = 680.0;
pub const TIME_HEIGHT: f64 = 360.0;

/// Panels over time of traces, each with the names of its curves and lines: with differences for
/// two or more traces, with the energy for one.
pub fn over_time_panels(traces: &[Labelled], scene: &Scene) -> Vec<(Panel, Vec<Entry>)> {
    let seen = Seen::all(traces);
    let of_traces = || panels::trace_entries(traces);
    let mut all = Vec::new();
    if let [one] = &seen[..] {
        all.push((panels::energy(one, scene), panels::energy_entries(scene)));
        all.push((panels::total_pull(&seen), of_traces()));
    } else {
        let of_pairs = [panels::pair_entries(traces), panels::tolerance_entry(scene)].concat();
        all.push((panels::edge_difference(traces, scene), of_pairs.clone()));
        all.push((panels::heading_difference(traces, scene), of_pairs));
    }
    all.push((panels::net_pull(&seen, scene), [of_traces(), panels::slip_limit_entry(scene)].concat()));
    all.push((panels::speed(&seen), of_traces()));
    all.push((panels::heading(&seen), of_traces()));
    all.push((panels::attachments(&seen), of_traces()));
    all
}

pub fn alone(panel: &Panel, legend: Vec<Vec<Entry>>, height: f64) -> String {
    let mut sheet = Sheet::new(WIDTH, height);
    sheet.add(&Cell { panel, left: 0.0, top: 0.0, width: WIDTH, height });
    sheet.into_svg(&legend)
}

#[cfg(test)]
mod tests;
