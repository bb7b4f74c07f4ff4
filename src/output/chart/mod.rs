//! SVG figures over one or several traces: the load's path, its heading, speed and pulls over time,
//! and how far traces lie apart.
//!
//! Every function returns a whole SVG document without scripts and without fonts of its own; the
//! same traces give the same bytes. Axes are in mm, mN and rad. Curves differ in colour (Okabe and
//! Ito's set, made for colour-blind readers) and in dashes. Curves of many points are thinned to
//! what can be seen, extremes kept: see [`thin`]. Where a line would be a wall of ink, a panel
//! shows means and ranges and says so.
//!
//! ```text
//! shown.rs       rows -> what is shown of them, in print units
//! panels.rs      traces -> panels: what is shown
//! difference.rs  distance of two traces over time
//! panel.rs       a panel as data: labels, curves, marks
//! axis.rs        ranges, ticks and their labels
//! thin.rs        fewer points, same picture
//! canvas.rs      panels -> SVG; the only file that knows the plotting library
//! ```

pub mod axis;
pub mod bars;
pub mod canvas;
pub mod cells;
pub mod difference;
pub mod panel;
pub mod panels;
pub mod shown;
pub mod thin;

use canvas::{Cell, Sheet};
use panel::{Entry, Panel, Style};
use shown::Seen;
pub use shown::SeenRows;

use std::borrow::Cow;

use crate::math::Vec2;
use crate::scenario::{Drive, Scenario};
use crate::simulation::Trace;

/// Colour of trace `index`, in drawings beside the figures.
pub(crate) fn trace_color(index: usize) -> &'static str {
    Style::of_trace(index).color
}

/// A trace and the name it has in legends.
#[derive(Clone, Copy, Debug)]
pub struct Labelled<'a> {
    pub label: &'a str,
    pub trace: &'a Trace,
}

/// What stands around a trace. Nothing is drawn of what is zero or `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scene {
    /// Radius of the load's outline (m).
    pub load_radius: f64,
    /// Sum of the slip limits: the net pull that moves the load (N).
    pub slip_limit: f64,
    pub nest: Option<Nest>,
}

/// Where ants take the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nest {
    /// (m, world)
    pub position: Vec2,
    /// (m)
    pub arrival_radius: f64,
}

impl Scene {
    pub fn of(scenario: &Scenario) -> Self {
        let nest = match &scenario.drive {
            Drive::Ants(ants) => Some(Nest { position: ants.nest_position, arrival_radius: ants.arrival_radius }),
            Drive::Tips(_) => None,
        };
        Self { load_radius: scenario.system.load.radius, slip_limit: scenario.system.total_slip_limit(), nest }
    }
}

/// Path of the load's origin in the plane, equal scales, with the load's outline at the start
/// (grey) and at each end. The radius in an outline points along the heading.
pub fn path(traces: &[Labelled], scene: &Scene) -> String {
    let panel = panels::path(&Seen::all(traces), scene);
    let legend = vec![panels::trace_entries(traces), panels::scene_entries(scene)];
    alone(&panel, legend, canvas::natural_height(&panel, WIDTH))
}

/// Heading over time, whole turns counted (rad).
pub fn heading(traces: &[Labelled]) -> String {
    over_time(&panels::heading(&Seen::all(traces)), traces)
}

/// Speed of the load's origin over time (mm/s). Where a few peaks exceed all else by far, the axis
/// cuts them and a note says how high they are.
pub fn speed(traces: &[Labelled]) -> String {
    over_time(&panels::speed(&Seen::all(traces)), traces)
}

/// Size of the sum of all pulls over time (mN) under the force that moves the load.
pub fn net_pull(traces: &[Labelled], scene: &Scene) -> String {
    let marks = [panels::slip_limit_entry(scene), panels::event_entries(traces)].concat();
    alone(&panels::net_pull(&Seen::all(traces), scene), vec![panels::trace_entries(traces), marks], TIME_HEIGHT)
}

/// Sum of the sizes of all pulls over time (mN): what the holders spend, working against each other
/// included.
pub fn total_pull(traces: &[Labelled]) -> String {
    over_time(&panels::total_pull(&Seen::all(traces)), traces)
}

/// Number of held springs over time.
pub fn holders(traces: &[Labelled]) -> String {
    over_time(&panels::holders(&Seen::all(traces)), traces)
}

/// Energy over time (mJ) of one trace: done by the tips, dissipated, elastic.
pub fn energy(trace: &Labelled) -> String {
    alone(&panels::energy(&Seen::of(trace)), vec![panels::energy_entries(), panels::event_entries(&[*trace])], TIME_HEIGHT)
}

/// Distance of the load's positions between traces over time (m, log axis): all pairs of up to
/// three traces, else each against the first. Where two traces agree within rounding there is a
/// gap.
pub fn position_difference(traces: &[Labelled]) -> String {
    between(&panels::position_difference(traces), traces)
}

/// Difference of heading between traces over time (rad, log axis); pairs and gaps as in
/// [`position_difference`].
pub fn heading_difference(traces: &[Labelled]) -> String {
    between(&panels::heading_difference(traces), traces)
}

/// All of it on one sheet: differences with two traces and more, the energy with one.
pub fn overview(traces: &[Labelled], scene: &Scene) -> String {
    overview_of(traces, &Seen::all(traces), scene)
}

/// The same of one run whose `rows` are no longer in its trace.
pub fn overview_of_rows(run: &Labelled, rows: &SeenRows, scene: &Scene) -> String {
    overview_of(&[*run], &[Seen { rows: Cow::Borrowed(rows), events: &run.trace.events }], scene)
}

fn overview_of(traces: &[Labelled], seen: &[Seen], scene: &Scene) -> String {
    let mut sheet = Sheet::lettered(2.0 * COLUMN_WIDTH, 4.0 * ROW_HEIGHT);
    // Drawn one by one: the points of one panel are gone before the next one's.
    let mut add = |panel: &Panel, left: f64, row: f64, n_rows: f64| {
        sheet.add(&Cell { panel, left, top: row * ROW_HEIGHT, width: COLUMN_WIDTH, height: n_rows * ROW_HEIGHT });
    };
    // The path is as high as two of the others.
    add(&panels::path(seen, scene), 0.0, 0.0, 2.0);
    if let [one] = seen {
        add(&panels::total_pull(seen), 0.0, 2.0, 1.0);
        add(&panels::energy(one), 0.0, 3.0, 1.0);
    } else {
        add(&panels::position_difference(traces), 0.0, 2.0, 1.0);
        add(&panels::heading_difference(traces), 0.0, 3.0, 1.0);
    }
    add(&panels::heading(seen), COLUMN_WIDTH, 0.0, 1.0);
    add(&panels::speed(seen), COLUMN_WIDTH, 1.0, 1.0);
    add(&panels::net_pull(seen, scene), COLUMN_WIDTH, 2.0, 1.0);
    add(&panels::holders(seen), COLUMN_WIDTH, 3.0, 1.0);
    let curves = if traces.len() > 1 { panels::pair_entries(traces) } else { panels::energy_entries() };
    let marks = [panels::scene_entries(scene), panels::slip_limit_entry(scene), panels::event_entries(traces)].concat();
    sheet.into_svg(&[panels::trace_entries(traces), curves, marks])
}

/// The load's path, heading and speed as `expected` and as `found`, and how far they lie apart.
pub fn expected_and_found(traces: &[Labelled; 2], scene: &Scene) -> String {
    let seen = Seen::all(traces);
    let path = panels::path(&seen, scene);
    let others = [panels::heading(&seen), panels::speed(&seen), panels::position_difference(traces), panels::heading_difference(traces)];
    let mut sheet = Sheet::lettered(2.0 * COLUMN_WIDTH, 3.0 * ROW_HEIGHT);
    sheet.add(&Cell { panel: &path, left: 0.0, top: 0.0, width: COLUMN_WIDTH, height: 2.0 * ROW_HEIGHT });
    let places = [(1.0, 0.0), (1.0, 1.0), (0.0, 2.0), (1.0, 2.0)];
    for (panel, (column, row)) in others.iter().zip(places) {
        let (left, top) = (column * COLUMN_WIDTH, row * ROW_HEIGHT);
        sheet.add(&Cell { panel, left, top, width: COLUMN_WIDTH, height: ROW_HEIGHT });
    }
    let marks = [panels::scene_entries(scene), panels::event_entries(traces)].concat();
    sheet.into_svg(&[panels::trace_entries(traces), panels::pair_entries(traces), marks])
}

/// Panels in rows of `n_columns`, each `width` by `height` (px), with the groups of their legend
/// below.
pub fn grid(panels: &[Panel], legend: &[Vec<Entry>], n_columns: usize, width: f64, height: f64) -> String {
    let mut sheet = Sheet::lettered(n_columns as f64 * width, panels.len().div_ceil(n_columns) as f64 * height);
    for (i, panel) in panels.iter().enumerate() {
        let (left, top) = ((i % n_columns) as f64 * width, (i / n_columns) as f64 * height);
        sheet.add(&Cell { panel, left, top, width, height });
    }
    sheet.into_svg(legend)
}

pub const WORK_HEIGHT: f64 = 420.0;
pub const COLUMN_WIDTH: f64 = 480.0;
pub const ROW_HEIGHT: f64 = 220.0;
pub const PANEL_HEIGHT: f64 = 280.0;
/// Print units over those of a trace: mm, mN, mJ.
pub const MILLI: f64 = 1e3;
/// Size of a figure of one panel.
pub const WIDTH: f64 = 680.0;
pub const TIME_HEIGHT: f64 = 360.0;

fn over_time(panel: &Panel, traces: &[Labelled]) -> String {
    alone(panel, vec![panels::trace_entries(traces), panels::event_entries(traces)], TIME_HEIGHT)
}

fn between(panel: &Panel, traces: &[Labelled]) -> String {
    alone(panel, vec![panels::pair_entries(traces), panels::event_entries(traces)], TIME_HEIGHT)
}

pub fn alone(panel: &Panel, legend: Vec<Vec<Entry>>, height: f64) -> String {
    let mut sheet = Sheet::new(WIDTH, height);
    sheet.add(&Cell { panel, left: 0.0, top: 0.0, width: WIDTH, height });
    sheet.into_svg(&legend)
}

#[cfg(test)]
mod tests;
