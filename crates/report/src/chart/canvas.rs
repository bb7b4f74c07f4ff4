//! Panels -> SVG: the only file that knows the plotting library, kuva.
//!
//! kuva draws axes, ticks and curves of one panel. Ranges and ticks are computed here (its log axis
//! ends at 1e-10 and its automatic ranges need not fit equal scales); panels are put side by side
//! here, and the legend stands below them where it covers nothing.

use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, LineStyle, ScatterPlot};
use kuva::render::color::Color;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};

use crate::chart::axis::{Axis, power_label};
use crate::chart::panel::{Across, Curve, Entry, Mark, Panel, Sample, Scale, Shape, Style};
use crate::chart::thin;
use crate::quantity::quantity;

/// A panel and its place on the sheet (px).
#[derive(Clone, Copy, Debug)]
pub struct Cell<'a> {
    pub panel: &'a Panel,
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

/// Panels on their way to SVG.
pub struct Sheet {
    scene: Scene,
    /// The letters of the panels to come.
    letters: Option<RangeInclusive<char>>,
}

const FONTS: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// Space for labels around the axes of a panel (px).
const LEFT: f64 = 72.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 44.0;
const TEXT: u32 = 12;

impl Sheet {
    pub fn new(width: f64, height: f64) -> Self {
        Self { scene: empty(width, height), letters: None }
    }

    /// With a, b, c ... beside the panels, in the order they are added.
    pub fn lettered(width: f64, height: f64) -> Self {
        Self { letters: Some('a'..='z'), ..Self::new(width, height) }
    }

    pub fn add(&mut self, cell: &Cell) {
        draw_cell(&mut self.scene, cell);
        if let Some(letter) = self.letters.as_mut().and_then(Iterator::next) {
            add_text(&mut self.scene, cell.left + 6.0, cell.top + 16.0, letter.to_string(), TextAnchor::Start, true);
        }
    }

    /// The SVG with the groups of the `legend` below the panels, each from a new line.
    pub fn into_svg(self, legend: &[Vec<Entry>]) -> String {
        svg(&self.into_scene(legend))
    }

    pub(super) fn into_scene(mut self, legend: &[Vec<Entry>]) -> Scene {
        self.scene.height = add_legend(&mut self.scene, legend);
        self.scene
    }
}

/// A drawing of this size (px) without anything in it.
pub(super) fn empty(width: f64, height: f64) -> Scene {
    let mut scene = Scene::new(width, height);
    scene.font_family = Some(FONTS.to_owned());
    scene.text_color = Some("black".to_owned());
    scene
}

pub(super) fn svg(scene: &Scene) -> String {
    let svg = SvgBackend::new().render_scene(scene);
    // Which kuva leaves out: without it a drawing shown smaller is cut and not shrunk.
    svg.replacen("<svg ", &format!("<svg viewBox=\"0 0 {} {}\" ", scene.width, scene.height), 1)
}

/// Axes between these ends on an area of this size (px), with room around it: left, right, above
/// and below (px).
pub(super) fn axes_between(x: (f64, f64), y: (f64, f64), [width, height]: [f64; 2], [left, right, top, bottom]: [f64; 4]) -> Layout {
    Layout::new(x, y)
        .with_width(width)
        .with_height(height)
        .with_force_margins(left, right)
        .with_force_margins_y(top, bottom)
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
        .with_show_grid(false)
}

/// Height (px) at which a panel in the plane of that `width` fits its content, within reason.
pub fn natural_height(panel: &Panel, width: f64) -> f64 {
    let along = |axis: usize| Axis::around(panel.curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis]), 1.0).span();
    ((width - LEFT - RIGHT) * along(1) / along(0)).clamp(160.0, 560.0) + TOP + BOTTOM
}

fn draw_cell(scene: &mut Scene, cell: &Cell) {
    let (x, y) = axes(cell);
    let dense = is_dense(cell, &y);
    let (plots, layout) = (plots(cell, (x, y), dense), layout(cell, (x, y)));
    let mut drawn = render_multiple(plots, layout);
    name_clips_by_content(&mut drawn);
    // Panels of one size share their clip region.
    drawn.defs.retain(|definition| !scene.defs.contains(definition));
    scene.defs.append(&mut drawn.defs);
    scene.add(Primitive::GroupStart { transform: Some(format!("translate({},{})", cell.left, cell.top)), title: None, extra_attrs: None });
    scene.elements.append(&mut drawn.elements);
    scene.add(Primitive::GroupEnd);
    if let Some(note) = note(cell, &x, dense) {
        add_text(scene, cell.left + cell.width - RIGHT, cell.top + TOP - 8.0, note, TextAnchor::End, false);
    }
}

/// The panel's own note, and how a dense panel is to be read.
fn note(cell: &Cell, x: &Axis, dense: bool) -> Option<String> {
    let (width, _) = area(cell);
    let reading = dense.then(|| format!("mean and range over {} each", quantity(x.span() * DENSE_COLUMN / width, "s")));
    let notes: Vec<String> = reading.into_iter().chain(cell.panel.note.clone()).collect();
    (!notes.is_empty()).then(|| notes.join("; "))
}

/// kuva numbers its clip regions through the life of the program. Named after their size instead,
/// they make equal figures equal, and two figures on one page can share a name only where they
/// share the region.
fn name_clips_by_content(scene: &mut Scene) {
    for element in &mut scene.elements {
        if let Primitive::ClipStart { x, y, width, height, id } = element {
            let name = format!("clip-{x:.0}-{y:.0}-{width:.0}-{height:.0}");
            for definition in &mut scene.defs {
                *definition = definition.replace(&format!("id=\"{id}\""), &format!("id=\"{name}\""));
            }
            *id = name;
        }
    }
}

fn layout(cell: &Cell, (x, y): (Axis, Axis)) -> Layout {
    let panel = cell.panel;
    let y_ticks = if matches!(panel.scale, Scale::Log | Scale::LogLog) { ticks(power_label) } else { ticks(move |value| y.label(value)) };
    let names = panel.x_names.clone();
    let x_ticks = match panel.scale {
        _ if !names.is_empty() => ticks(move |value| name_at(&names, value).to_owned()),
        Scale::LogLog => ticks(power_label),
        _ => ticks(move |value| x.label(value)),
    };
    let mut layout = axes_between((x.low, x.high), (y.low, y.high), [cell.width, cell.height], [LEFT, RIGHT, TOP, BOTTOM])
        .with_x_tick_step(x.step)
        .with_y_tick_step(y.step)
        .with_x_tick_format(x_ticks)
        .with_y_tick_format(y_ticks)
        .with_x_label(plain(&panel.x_label))
        .with_y_label(plain(&panel.y_label))
        .with_label_size(13)
        .with_tick_size(11)
        .with_box_axes();
    layout.show_legend = false;
    layout
}

/// Name at a tick; nothing between two of them.
fn name_at(names: &[String], value: f64) -> &str {
    let at = value.round();
    let is_tick = (value - at).abs() < 1e-6 && at >= 1.0;
    names.get(if is_tick { at as usize - 1 } else { names.len() }).map_or("", String::as_str)
}

fn ticks(format: impl Fn(f64) -> String + Send + Sync + 'static) -> TickFormat {
    TickFormat::Custom(Arc::new(format))
}

fn area(cell: &Cell) -> (f64, f64) {
    (cell.width - LEFT - RIGHT, cell.height - TOP - BOTTOM)
}

fn axes(cell: &Cell) -> (Axis, Axis) {
    let panel = cell.panel;
    let (width, height) = area(cell);
    let along = |axis: usize| panel.curves.iter().flat_map(|curve| &curve.points).map(move |point| point[axis]);
    let levels = panel.marks.iter().filter_map(|mark| mark.at.level());
    let ceiling = panel.ceiling.unwrap_or(f64::INFINITY);
    let ys = along(1).chain(levels).map(|y| y.min(ceiling));
    let log_ys = ys.clone().map(f64::log10);
    // A tick every 55 px or more to the right, every 26 px upwards.
    let (n_right, n_up) = (width / 55.0, height / 26.0);
    let (x, y) = match panel.scale {
        Scale::Linear => (Axis::tight(along(0), n_right), Axis::around(ys, n_up)),
        Scale::FromZero => (Axis::tight(along(0), n_right), Axis::from_zero(ys, n_up)),
        Scale::Count => (Axis::tight(along(0), n_right), Axis::from_zero(ys, n_up).whole()),
        Scale::Log => (Axis::tight(along(0), n_right), Axis::decades(log_ys, n_up)),
        Scale::LogLog => (Axis::decades(along(0).map(f64::log10), n_right), Axis::decades(log_ys, n_up)),
        Scale::Plane => Axis::equal(Axis::around(along(0), n_right), Axis::around(ys, n_up), width, height),
    };
    (if panel.x_names.is_empty() { x } else { Axis::of_names(panel.x_names.len()) }, y)
}

/// Marks first, so that they lie under the curves.
fn plots(cell: &Cell, (x, y): (Axis, Axis), dense: bool) -> Vec<Plot> {
    let marks = cell.panel.marks.iter().map(|mark| mark_plot(mark, &x, &y));
    let curves = cell.panel.curves.iter().flat_map(|curve| curve_plots(curve, cell, &x, dense));
    let plots: Vec<Plot> = marks.chain(curves).collect();
    // Without any plot kuva draws no axes.
    if plots.is_empty() { vec![LinePlot::new().into()] } else { plots }
}

fn mark_plot(mark: &Mark, x: &Axis, y: &Axis) -> Plot {
    let ends = match mark.at {
        Across::Vertical(at) => [(at, y.low), (at, y.high)],
        Across::Horizontal(at) => [(x.low, at), (x.high, at)],
    };
    line(&mark.style).with_data(ends).into()
}

/// A curve without its gaps: one line for each run of finite points, thinned to what the panel can
/// show.
fn curve_plots(curve: &Curve, cell: &Cell, x: &Axis, dense: bool) -> Vec<Plot> {
    let (width, _) = area(cell);
    let points: Cow<[[f64; 2]]> = match cell.panel.scale {
        Scale::Log => curve.points.iter().map(|point| [point[0], point[1].log10()]).collect(),
        Scale::LogLog => curve.points.iter().map(|point| point.map(f64::log10)).collect(),
        _ => Cow::Borrowed(&curve.points),
    };
    let runs = finite_runs(&points);
    if dense && curve.shape != Shape::Unseen {
        let n_columns = (width / DENSE_COLUMN) as usize;
        let columns = match &curve.columns[..] {
            [] => thin::columns(&points, [x.low, x.high], n_columns),
            columns => vec![thin::merged(columns, n_columns)],
        };
        return columns.iter().map(|run| band(&curve.style, run)).collect();
    }
    if matches!(curve.shape, Shape::Marked | Shape::Crosses | Shape::Dots | Shape::Area | Shape::Unseen) {
        return marked(curve, runs);
    }
    let thinned = |run: &[[f64; 2]]| match curve.shape {
        // Columns of two pixels: lines are about that wide.
        Shape::Graph | Shape::Steps => thin::by_column(run, (width / 2.0) as usize),
        // A third of a pixel.
        _ => thin::by_distance(run, x.span() / width / 3.0),
    };
    let plot = |run: &[[f64; 2]]| {
        let mut plot = line(&curve.style).with_data(thinned(run).into_iter().map(|[x, y]| (x, y)));
        plot.step = curve.shape == Shape::Steps;
        plot.into()
    };
    runs.map(plot).collect()
}

/// Few points, each with its mark.
fn marked<'a>(curve: &Curve, runs: impl Iterator<Item = &'a [[f64; 2]]>) -> Vec<Plot> {
    let data = |run: &[[f64; 2]]| run.iter().map(|[x, y]| (*x, *y)).collect::<Vec<_>>();
    let marks = |run: &[[f64; 2]], shape, size| -> Plot {
        ScatterPlot::new().with_data(data(run)).with_color(curve.style.color).with_size(size).with_marker(shape).into()
    };
    let plots = |run: &[[f64; 2]]| match curve.shape {
        Shape::Marked => vec![line(&curve.style).with_data(data(run)).into(), marks(run, MarkerShape::Circle, 2.6)],
        Shape::Crosses => vec![marks(run, MarkerShape::Cross, 5.0)],
        Shape::Dots => vec![marks(run, MarkerShape::Circle, 2.2)],
        Shape::Area => vec![area_between(&curve.style, run)],
        _ => Vec::new(),
    };
    runs.flat_map(plots).collect()
}

/// The area between pairs of points, under a line of no width.
fn area_between(style: &Style, pairs: &[[f64; 2]]) -> Plot {
    let middle = pairs.chunks_exact(2).map(|pair| (pair[0][0], 0.5 * (pair[0][1] + pair[1][1])));
    let ends = |end: usize| pairs.chunks_exact(2).map(|pair| pair[end][1]).collect::<Vec<f64>>();
    with_band(line(&Style { width: 0.0, ..*style }).with_data(middle), [ends(0), ends(1)], 0.2)
}

fn finite_runs(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    // One question instead of two: what overflows when added is as little to be drawn.
    points.split(|point| !(point[0] + point[1]).is_finite()).filter(|run| !run.is_empty())
}

/// Width of the columns of which a dense graph shows range and mean (px).
const DENSE_COLUMN: f64 = 6.0;
/// A graph that crosses the panel oftener than this in every column is dense: as a line it would be
/// a wall of ink.
const CROSSINGS_PER_COLUMN: f64 = 0.7;

/// Whether some graph of the panel is dense; all of them are then shown as ranges with means.
fn is_dense(cell: &Cell, y: &Axis) -> bool {
    let (width, _) = area(cell);
    let most = CROSSINGS_PER_COLUMN * width / DENSE_COLUMN;
    let is_dense = |curve: &Curve| {
        let n: f64 = finite_runs(&curve.points).map(|run| thin::n_crossings(run, y.low, y.high)).sum();
        matches!(curve.shape, Shape::Graph | Shape::Steps | Shape::Marked) && n > most
    };
    !matches!(cell.panel.scale, Scale::Log | Scale::LogLog) && cell.panel.curves.iter().any(is_dense)
}

fn band(style: &Style, columns: &[thin::Column]) -> Plot {
    let ends = |of: fn(&thin::Column) -> f64| columns.iter().map(of).collect::<Vec<f64>>();
    let means = line(style).with_data(columns.iter().map(|column| (column.x, column.mean)));
    // Light enough for three of them over each other.
    with_band(means, [ends(|column| column.low), ends(|column| column.high)], 0.13)
}

fn with_band(plot: LinePlot, [low, high]: [Vec<f64>; 2], opacity: f64) -> Plot {
    let mut plot = plot.with_band(low, high);
    if let Some(band) = &mut plot.band {
        band.opacity = opacity;
    }
    plot.into()
}

fn line(style: &Style) -> LinePlot {
    let dashes = if style.dash.is_empty() { LineStyle::Solid } else { LineStyle::Custom(style.dash.to_owned()) };
    LinePlot::new().with_color(style.color).with_stroke_width(style.width).with_line_style(dashes)
}

/// Length of a sample, gap after it, and between two entries (px).
const SAMPLE: f64 = 30.0;
const GAP: f64 = 7.0;
const BETWEEN: f64 = 24.0;
const LINE_HEIGHT: f64 = 19.0;
/// Mean advance of a letter over the size of the text, on the wide side.
const LETTER_WIDTH: f64 = 0.62;

/// Adds the legend below everything and returns the height of the whole (px).
fn add_legend(scene: &mut Scene, legend: &[Vec<Entry>]) -> f64 {
    let mut y = scene.height;
    for group in legend.iter().filter(|group| !group.is_empty()) {
        let mut x = LEFT;
        y += LINE_HEIGHT;
        for entry in group {
            let length = SAMPLE + GAP + LETTER_WIDTH * f64::from(TEXT) * entry.label.chars().count() as f64;
            if x > LEFT && x + length > scene.width - RIGHT {
                (x, y) = (LEFT, y + LINE_HEIGHT);
            }
            add_sample(scene, entry, x, y - 4.0);
            add_text(scene, x + SAMPLE + GAP, y, entry.label.clone(), TextAnchor::Start, false);
            x += length + BETWEEN;
        }
    }
    y + 10.0
}

fn add_sample(scene: &mut Scene, entry: &Entry, x: f64, y: f64) {
    let middle = x + 0.5 * SAMPLE;
    let (x1, y1, x2, y2) = match entry.sample {
        Sample::Line => (x, y, x + SAMPLE, y),
        Sample::Upright => (middle, y - 8.0, middle, y + 8.0),
        Sample::Dot => {
            let fill = Color::from(entry.style.color);
            return scene.add(Primitive::Circle { cx: middle, cy: y, r: 2.6, fill, fill_opacity: None, stroke: None, stroke_width: None });
        }
    };
    let dash = (!entry.style.dash.is_empty()).then(|| entry.style.dash.to_owned());
    let stroke = Color::from(entry.style.color);
    scene.add(Primitive::Line { x1, y1, x2, y2, stroke, stroke_width: entry.style.width, stroke_dasharray: dash });
}

fn add_text(scene: &mut Scene, x: f64, y: f64, text: String, anchor: TextAnchor, bold: bool) {
    let size = if bold { TEXT + 2 } else { TEXT };
    scene.add(Primitive::Text { x, y, content: plain(&text), size, anchor, rotate: None, bold, color: None });
}

/// kuva reads `$` as the start of a formula.
pub(super) fn plain(text: &str) -> String {
    text.replace('$', "\\$")
}
