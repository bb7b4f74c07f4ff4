//! Traces -> panels: what each figure shows, in print units.

use std::f64::consts::TAU;

use crate::math::{Pose, Vec2, direction};
use crate::output::chart::difference::{self, Difference};
use crate::output::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use crate::output::chart::scene::{Labelled, MILLI, Scene};
use crate::output::chart::shown::{Quantity, Seen};
use crate::output::chart::thin::{self, Column};
use crate::output::quantity::quantity;
use crate::simulation::{Event, EventKind};

/// Events are marked when there are at most this many at different instants: more would be a grey
/// wall.
const MOST_EVENTS: usize = 40;

pub fn path(traces: &[Seen], scene: &Scene) -> Panel {
    let mut panel = Panel::new("x (mm)", "y (mm)", Scale::Plane);
    if let Some(nest) = scene.nest {
        panel.add(circle(nest.position, nest.arrival_radius), Style::NEST, Shape::Path);
    }
    for (index, one) in traces.iter().enumerate() {
        let Some([first, last]) = &one.rows.ends else { continue };
        if index == 0 {
            panel.add(outline(first, scene.load_radius), Style::START, Shape::Path);
        }
        let style = Style::of_trace(index);
        panel.add(one.rows.path(), style, Shape::Path);
        panel.add(outline(last, scene.load_radius), style.thin(), Shape::Path);
    }
    panel
}

pub fn heading(traces: &[Seen]) -> Panel {
    of_rows(traces, "heading (rad)", Scale::Linear, Shape::Graph, Quantity::Heading)
}

pub fn speed(traces: &[Seen]) -> Panel {
    let mut panel = of_rows(traces, "speed (mm/s)", Scale::FromZero, Shape::Graph, Quantity::Speed);
    panel.cut_rare_peaks(|peak| format!("peaks up to {} cut off", quantity(peak / MILLI, "m/s")));
    panel
}

pub fn net_pull(traces: &[Seen], scene: &Scene) -> Panel {
    let mut panel = of_rows(traces, "net pull (mN)", Scale::FromZero, Shape::Graph, Quantity::NetPull);
    if scene.slip_limit > 0.0 {
        panel.marks.push(Mark { at: Across::Horizontal(MILLI * scene.slip_limit), style: Style::SLIP_LIMIT });
    }
    panel
}

pub fn total_pull(traces: &[Seen]) -> Panel {
    of_rows(traces, "sum of pulls (mN)", Scale::FromZero, Shape::Graph, Quantity::TotalPull)
}

pub fn attachments(traces: &[Seen]) -> Panel {
    of_rows(traces, "attached springs", Scale::Count, Shape::Steps, Quantity::Attachments)
}

pub fn energy(one: &Seen) -> Panel {
    let mut panel = Panel::new("time (s)", "energy (mJ)", Scale::FromZero);
    panel.mark_events([one.events]);
    for (kind, energy) in [Quantity::TipWork, Quantity::Dissipated, Quantity::Elastic].into_iter().enumerate() {
        panel.add_columns(one.rows.columns(energy), Style::of_pair(kind), Shape::Graph);
    }
    panel
}

pub fn position_difference(traces: &[Labelled]) -> Panel {
    let displacement = |pose: &Pose, start: &Pose| (pose.position - start.position).norm();
    of_pairs(traces, "position apart (m)", displacement, |difference| difference.position)
}

pub fn heading_difference(traces: &[Labelled]) -> Panel {
    let turn = |pose: &Pose, start: &Pose| (pose.heading - start.heading).abs();
    of_pairs(traces, "heading apart (rad)", turn, |difference| difference.heading)
}

pub fn trace_entries(traces: &[Labelled]) -> Vec<Entry> {
    traces.iter().enumerate().map(|(index, one)| Entry::line(one.label, Style::of_trace(index))).collect()
}

pub fn pair_entries(traces: &[Labelled]) -> Vec<Entry> {
    let label = |(from, to): (usize, usize)| format!("{} − {}", traces[to].label, traces[from].label);
    pairs(traces.len()).into_iter().enumerate().map(|(index, pair)| Entry::line(label(pair), Style::of_pair(index))).collect()
}

pub fn energy_entries() -> Vec<Entry> {
    let names = ["work of the tips", "dissipated", "elastic"];
    names.into_iter().enumerate().map(|(index, name)| Entry::line(name, Style::of_pair(index))).collect()
}

pub fn scene_entries(scene: &Scene) -> Vec<Entry> {
    let start = (scene.load_radius > 0.0).then(|| Entry::line("load at start", Style::START));
    let nest = scene.nest.map(|_| Entry::line("nest", Style::NEST));
    start.into_iter().chain(nest).collect()
}

pub fn slip_limit_entry(scene: &Scene) -> Vec<Entry> {
    if scene.slip_limit > 0.0 { vec![Entry::line("slip limit", Style::SLIP_LIMIT)] } else { Vec::new() }
}

pub fn event_entries(traces: &[Labelled]) -> Vec<Entry> {
    if event_marks(traces.iter().map(|one| &one.trace.events[..])).is_empty() {
        return Vec::new();
    }
    vec![Entry::upright("grasp", Style::GRASP), Entry::upright("release", Style::RELEASE)]
}

/// Indices of the traces that are compared: (from, to), all pairs of up to three traces, else each
/// with the first.
fn pairs(n_traces: usize) -> Vec<(usize, usize)> {
    let n_from = if n_traces <= 3 { n_traces } else { 1 };
    (0..n_from).flat_map(|from| (from + 1..n_traces).map(move |to| (from, to))).collect()
}

fn of_rows(traces: &[Seen], y_label: &str, scale: Scale, shape: Shape, quantity: Quantity) -> Panel {
    let mut panel = Panel::new("time (s)", y_label, scale);
    panel.mark_events(traces.iter().map(|one| one.events));
    for (index, one) in traces.iter().enumerate() {
        panel.add_columns(one.rows.columns(quantity), Style::of_trace(index), shape);
    }
    panel
}

fn of_pairs(traces: &[Labelled], y_label: &str, from_start: impl Fn(&Pose, &Pose) -> f64, y: impl Fn(&Difference) -> f64) -> Panel {
    let poses = traces.iter().flat_map(|one| {
        let start = one.trace.rows.first().map(|row| row.motion.pose);
        one.trace.rows.iter().filter_map(move |row| Some((row.motion.pose, start?)))
    });
    let rounding = ROUNDING * poses.map(|(pose, start)| from_start(&pose, &start)).fold(0.0, f64::max);
    let mut panel = Panel::new("time (s)", y_label, Scale::Log);
    panel.mark_events(traces.iter().map(|one| &one.trace.events[..]));
    for (index, (from, to)) in pairs(traces.len()).into_iter().enumerate() {
        let differences = difference::over_time(traces[from].trace, traces[to].trace);
        let seen = |one: &Difference| if y(one) <= rounding { 0.0 } else { y(one) };
        let points = differences.iter().map(|one| [one.time, seen(one)]).collect();
        panel.add(points, Style::of_pair(index), Shape::Graph);
    }
    panel
}

/// Distances up to this, over the longest way (1), are rounding. They leave a gap, so that the
/// decades of the axis go to what can be told apart.
const ROUNDING: f64 = 1e-11;

/// One mark for each instant and kind, in the order of time; none when there are too many.
fn event_marks<'a>(of_traces: impl IntoIterator<Item = &'a [Event]>) -> Vec<Mark> {
    let mut events: Vec<_> = of_traces.into_iter().flatten().map(|event| (event.time, event.kind == EventKind::Grasp)).collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    events.dedup();
    if events.len() > MOST_EVENTS {
        return Vec::new();
    }
    let style = |grasp| if grasp { Style::GRASP } else { Style::RELEASE };
    events.into_iter().map(|(time, grasp)| Mark { at: Across::Vertical(time), style: style(grasp) }).collect()
}

fn in_mm(point: Vec2) -> [f64; 2] {
    [MILLI * point.x, MILLI * point.y]
}

fn circle(centre: Vec2, radius: f64) -> Vec<[f64; 2]> {
    (0..=72).map(|k| in_mm(centre + radius * direction(TAU * f64::from(k) / 72.0))).collect()
}

/// Outline of the load and the radius along its heading, in one line (mm).
fn outline(pose: &Pose, radius: f64) -> Vec<[f64; 2]> {
    let edge = (0..=72).map(|k| pose.position + radius * direction(pose.heading + TAU * f64::from(k) / 72.0));
    edge.chain([pose.position]).map(in_mm).collect()
}

impl Panel {
    pub fn new(x_label: &str, y_label: &str, scale: Scale) -> Self {
        let (x_label, y_label) = (x_label.to_owned(), y_label.to_owned());
        Self { x_label, y_label, scale, marks: Vec::new(), curves: Vec::new(), ceiling: None, note: None }
    }

    fn add(&mut self, points: Vec<[f64; 2]>, style: Style, shape: Shape) {
        self.curves.push(Curve { points, columns: Vec::new(), style, shape });
    }

    /// Adds a graph of which ranges and means are known.
    fn add_columns(&mut self, columns: Vec<Column>, style: Style, shape: Shape) {
        let points = thin::up_and_down(&columns);
        self.curves.push(Curve { points, columns, style, shape });
    }

    fn mark_events<'a>(&mut self, of_traces: impl IntoIterator<Item = &'a [Event]>) {
        self.marks.extend(event_marks(of_traces));
    }

    /// Cuts the y axis when less than half a percent of all points lie beyond three times the
    /// height of the rest.
    fn cut_rare_peaks(&mut self, note: impl Fn(f64) -> String) {
        let mut heights: Vec<f64> =
            self.curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]).filter(|y| y.is_finite()).collect();
        let Some(last) = heights.len().checked_sub(1) else { return };
        let peak = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (_, &mut usual, _) = heights.select_nth_unstable_by(last * 995 / 1000, f64::total_cmp);
        if usual > 0.0 && peak > 3.0 * usual {
            self.ceiling = Some(1.3 * usual);
            self.note = Some(note(peak));
        }
    }
}
