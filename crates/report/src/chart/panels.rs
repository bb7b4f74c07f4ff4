//! Traces -> panels: what each figure shows, in units that fit its largest value.

use crate::chart::difference::{self, Difference};
use crate::chart::outline::{View, circle, edges, front, hatching};
use crate::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use crate::chart::scene::{Labelled, Scene};
use crate::chart::shown::{Quantity, Seen};
use crate::chart::thin::{self, Column};
use crate::quantity::quantity;
use cohaul::backend::BackendKind;
use cohaul::math::{Pose, Vec2};
use cohaul::model::Obstacle;
use cohaul::simulation::{Event, EventKind};

/// Events are marked when there are at most this many at different instants: more would be a grey
/// wall.
const MOST_EVENTS: usize = 40;

pub fn path(traces: &[Seen], scene: &Scene) -> Panel {
    let mut panel = Panel::new("x", "y", Scale::Plane);
    if let Some(nest) = scene.nest {
        panel.add(points(circle(&nest.position, nest.arrival_radius, 0.0)), Style::NEST, Shape::Path);
    }
    for obstacle in &scene.world.obstacles {
        add_obstacle(&mut panel, obstacle, traces, scene);
    }
    for (index, one) in traces.iter().enumerate() {
        let Some([first, last]) = &one.rows.ends else { continue };
        if index == 0 {
            panel.add(load(first, scene), Style::START, Shape::Path);
        }
        let style = Style::of_trace(index);
        panel.add(one.rows.path(), style, Shape::Path);
        panel.add(load(last, scene), style.thin(), Shape::Path);
        if !one.rows.touched.is_empty() {
            panel.add(points(one.rows.touched.iter().copied()), Style::CONTACT, Shape::Dots);
        }
    }
    panel.in_fitting_unit("m")
}

pub fn heading(traces: &[Seen]) -> Panel {
    of_rows(traces, "heading (rad)", Scale::Linear, Shape::Graph, Quantity::Heading)
}

pub fn speed(traces: &[Seen]) -> Panel {
    let mut panel = of_rows(traces, "speed", Scale::FromZero, Shape::Graph, Quantity::Speed);
    panel.cut_rare_peaks(|peak| format!("peaks up to {} cut off", quantity(peak, "m/s")));
    panel.in_fitting_unit("m/s")
}

pub fn net_pull(traces: &[Seen], scene: &Scene) -> Panel {
    let mut panel = of_rows(traces, "net pull", Scale::FromZero, Shape::Graph, Quantity::NetPull);
    if scene.slip_limit > 0.0 {
        panel.marks.push(Mark { at: Across::Horizontal(scene.slip_limit), style: Style::SLIP_LIMIT });
    }
    panel.in_fitting_unit("N")
}

pub fn total_pull(traces: &[Seen]) -> Panel {
    of_rows(traces, "sum of pulls", Scale::FromZero, Shape::Graph, Quantity::TotalPull).in_fitting_unit("N")
}

pub fn attachments(traces: &[Seen]) -> Panel {
    of_rows(traces, "attached springs", Scale::Count, Shape::Steps, Quantity::Attachments)
}

pub fn energy(one: &Seen, scene: &Scene) -> Panel {
    let mut panel = Panel::new("time (s)", "energy", Scale::FromZero);
    panel.mark_events([one.events]);
    let of_obstacles = moves(scene).then_some(Quantity::ObstacleWork);
    for (kind, energy) in [Quantity::TipWork, Quantity::Dissipated, Quantity::Elastic].into_iter().chain(of_obstacles).enumerate() {
        panel.add_columns(one.rows.columns(energy), Style::of_pair(kind), Shape::Graph);
    }
    panel.in_fitting_unit("J")
}

pub fn edge_difference(traces: &[Labelled], scene: &Scene) -> Panel {
    let from_start = |pose: &Pose, start: &Pose| pose.edge_displacement(start, scene.radius);
    let mut panel = of_pairs(traces, "edge displacement apart", from_start, |one| one.edge_displacement(scene.radius));
    panel.mark_tolerance(scene.tolerances.map(|[edge, _]| edge));
    panel.in_fitting_unit("m")
}

pub fn heading_difference(traces: &[Labelled], scene: &Scene) -> Panel {
    // Headings are rounded to parts of a radian, however little the load turns.
    let turn = |pose: &Pose, start: &Pose| (pose.heading - start.heading).abs().max(1.0);
    let mut panel = of_pairs(traces, "heading apart (rad)", turn, |difference| difference.heading);
    panel.mark_tolerance(scene.tolerances.map(|[_, heading]| heading));
    panel
}

pub fn trace_entries(traces: &[Labelled]) -> Vec<Entry> {
    traces.iter().enumerate().map(|(index, one)| Entry::line(one.label, Style::of_trace(index))).collect()
}

pub fn pair_entries(traces: &[Labelled]) -> Vec<Entry> {
    let label = |(from, to): (usize, usize)| format!("{} − {}", traces[to].label, traces[from].label);
    pairs(traces).into_iter().enumerate().map(|(index, pair)| Entry::line(label(pair), Style::of_pair(index))).collect()
}

fn moves(scene: &Scene) -> bool {
    scene.world.obstacles.iter().any(|obstacle| obstacle.path.moves())
}

pub fn energy_entries(scene: &Scene) -> Vec<Entry> {
    let names = ["work of the tips", "dissipated", "elastic"];
    names
        .into_iter()
        .chain(moves(scene).then_some("work of obstacles"))
        .enumerate()
        .map(|(index, name)| Entry::line(name, Style::of_pair(index)))
        .collect()
}

pub fn scene_entries(traces: &[Seen], scene: &Scene) -> Vec<Entry> {
    let start = (!scene.world.outline.parts.is_empty()).then(|| Entry::line("load at start", Style::START));
    let nest = scene.nest.map(|_| Entry::line("nest", Style::NEST));
    let obstacle = (!scene.world.is_empty()).then(|| Entry::line("obstacle", Style::OBSTACLE));
    let path = moves(scene).then(|| Entry::line("path of an obstacle", Style::OBSTACLE_PATH));
    let touches = traces.iter().any(|one| !one.rows.touched.is_empty());
    let contact = touches.then(|| Entry::dot("contact at the end", Style::CONTACT));
    start.into_iter().chain(nest).chain(obstacle).chain(path).chain(contact).collect()
}

pub fn slip_limit_entry(scene: &Scene) -> Vec<Entry> {
    if scene.slip_limit > 0.0 { vec![Entry::line("slip limit", Style::SLIP_LIMIT)] } else { Vec::new() }
}

pub fn tolerance_entry(scene: &Scene) -> Vec<Entry> {
    scene.tolerances.map(|_| Entry::line("tolerance", Style::TOLERANCE)).into_iter().collect()
}

pub fn event_entries(traces: &[Labelled]) -> Vec<Entry> {
    if event_marks(traces.iter().map(|one| &one.trace.events[..])).is_empty() {
        return Vec::new();
    }
    vec![Entry::upright("grasp", Style::GRASP), Entry::upright("release", Style::RELEASE)]
}

/// Indices of the traces that are compared: (from, to), all pairs of up to three traces, else each
/// with the first. Of several engines after the exact runs, each is compared with the inertial one.
fn pairs(traces: &[Labelled]) -> Vec<(usize, usize)> {
    let n = traces.len();
    let [quasi_static, inertial, _] = BackendKind::COMPARED.map(BackendKind::name);
    let are_engines = n > 3 && traces[0].label == quasi_static && traces[1].label == inertial;
    match n {
        ..=3 => (0..n).flat_map(|from| (from + 1..n).map(move |to| (from, to))).collect(),
        _ if are_engines => [(0, 1)].into_iter().chain((2..n).map(|engine| (1, engine))).collect(),
        _ => (1..n).map(|to| (0, to)).collect(),
    }
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
    for (index, (from, to)) in pairs(traces).into_iter().enumerate() {
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

fn points(points: impl IntoIterator<Item = Vec2>) -> Vec<[f64; 2]> {
    points.into_iter().map(|point| [point.x, point.y]).collect()
}

/// Ends a line, so that the next point begins another one.
const GAP: [f64; 2] = [f64::NAN; 2];

/// Outline of the load, and a line from its origin along its heading (m).
fn load(pose: &Pose, scene: &Scene) -> Vec<[f64; 2]> {
    let outline = &scene.world.outline;
    let tip = pose.to_world(&Vec2::new(front(outline), 0.0));
    let mut lines: Vec<Vec<[f64; 2]>> = edges(outline, pose).into_iter().map(points).collect();
    match (&mut lines[..], outline.centred_radius()) {
        // A circle ends in the direction of the heading.
        ([circle], Some(_)) => circle.extend(points([pose.position])),
        _ => lines.push(points([tip, pose.position])),
    }
    lines.join(&GAP)
}

/// Distance of the lines of a hatching, over the larger side of what is seen (1).
const HATCHING: f64 = 0.018;

/// Adds what is seen of an obstacle: a path of the load in it would be small beside a long wall, so
/// that it is cut an extent of the load away from all that the load touches.
fn add_obstacle(panel: &mut Panel, obstacle: &Obstacle, traces: &[Seen], scene: &Scene) {
    let ends = traces.iter().filter_map(|one| one.rows.ends.as_ref());
    let loads = ends.flatten().flat_map(|pose| edges(&scene.world.outline, pose)).flatten();
    let paths = traces.iter().flat_map(|one| one.rows.path()).map(|[x, y]| Vec2::new(x, y));
    let margin = scene.world.outline.extent();
    let Some(view) = View::around(loads.chain(paths)).map(|view| view.widened(margin)) else { return };
    let size = (view.0[1] - view.0[0]).amax();
    let [from, to] = traces.iter().fold([f64::INFINITY, 0.0_f64], |[from, to], one| [from.min(one.rows.span[0]), to.max(one.rows.span[1])]);
    let cut = |lines: Vec<[Vec2; 2]>| -> Vec<[f64; 2]> {
        lines.into_iter().filter_map(|line| view.clip(line)).flat_map(|line| points(line).into_iter().chain([GAP])).collect()
    };
    let sides = |edge: &Vec<Vec2>| edge.windows(2).map(|ends| [ends[0], ends[1]]).collect::<Vec<_>>();
    let at = |time: f64| edges(&obstacle.outline, &obstacle.path.pose_at(time));
    let mut add = |lines: Vec<[Vec2; 2]>, style| {
        let seen = cut(lines);
        if !seen.is_empty() {
            panel.add(seen, style, Shape::Path);
        }
    };
    let is_closed = |edge: &&Vec<Vec2>| edge.len() > 3 && edge.first() == edge.last();
    add(at(to).iter().filter(is_closed).flat_map(|edge| hatching(edge, HATCHING * size)).collect(), Style::HATCHING);
    if obstacle.path.moves() {
        add(at(from).iter().flat_map(sides).collect(), Style::OBSTACLE_START);
        let corners = obstacle.path.waypoints.iter().map(|(time, _)| time.clamp(from, to));
        let path: Vec<Vec2> = [from].into_iter().chain(corners).chain([to]).map(|time| obstacle.path.pose_at(time).position).collect();
        add(sides(&path), Style::OBSTACLE_PATH);
    }
    add(at(to).iter().flat_map(sides).collect(), Style::OBSTACLE);
}

impl Panel {
    pub fn new(x_label: &str, y_label: &str, scale: Scale) -> Self {
        let (x_label, y_label) = (x_label.to_owned(), y_label.to_owned());
        Self { x_label, y_label, scale, x_names: Vec::new(), marks: Vec::new(), curves: Vec::new(), ceiling: None, note: None }
    }

    pub fn add(&mut self, points: Vec<[f64; 2]>, style: Style, shape: Shape) {
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

    fn mark_tolerance(&mut self, tolerance: Option<f64>) {
        let levels = tolerance.filter(|tolerance| *tolerance > 0.0).map(Across::Horizontal);
        self.marks.extend(levels.map(|at| Mark { at, style: Style::TOLERANCE }));
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
