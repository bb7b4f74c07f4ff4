//! Runs of one scene at one time as a picture, one view a run.

use std::f64::consts::TAU;

use super::pen::{Line, Pen, Rgba, Shape};
use crate::chart::outline::front;
use crate::chart::{Labelled, Scene, trace_color};
use crate::quantity::short_quantity;
use cohaul::backend::BackendKind;
use cohaul::math::{Pose, Vec2};
use cohaul::model::OutlinePart;
use cohaul::model::ant::Mode;
use cohaul::scenario::Scenario;
use cohaul::simulation::{AttachedTip, Row, follow_ants};

/// Size of a picture (px).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// Draws runs of one scene at any time between their ends.
pub struct Drawing<'a> {
    scenario: &'a Scenario,
    runs: &'a [Labelled<'a>],
    /// Ants of each run at each row.
    ants: Vec<Vec<Vec<PlacedAnt>>>,
    size: Size,
    /// Middle and half sides of what is seen (m); the middle moves with a load that is followed.
    middle: Vec2,
    half: Vec2,
    follows: bool,
    largest_pull: f64,
    largest_force: f64,
}

#[derive(Clone, Copy)]
struct PlacedAnt {
    position: Vec2,
    heading: f64,
    holds: bool,
}

/// A run at one time.
struct State<'a> {
    pose: Pose,
    row: &'a Row,
    tips: Vec<AttachedTip>,
    ants: Vec<PlacedAnt>,
}

const INK: Rgba = [28, 29, 31, 255];
const SOFT: Rgba = [119, 125, 133, 255];
const FAINT: Rgba = [220, 220, 216, 255];
const NEST: Rgba = [0, 158, 115, 255];
const FORCE: Rgba = [123, 63, 160, 255];
const ANT: Rgba = [138, 56, 0, 255];
/// Pulls from slack to the largest, as in a replay.
const RAMP: [[f64; 3]; 5] = [[86.0, 180.0, 233.0], [0.0, 158.0, 115.0], [230.0, 159.0, 0.0], [213.0, 94.0, 0.0], [160.0, 20.0, 70.0]];
/// Room above the drawing for the name of a run, and below for scale and time (px).
const TOP: f64 = 30.0;
const BOTTOM: f64 = 30.0;

impl<'a> Drawing<'a> {
    /// Of runs of `scenario`; with `follows` a view goes along with its load, else all is seen that
    /// the load and the tips come to.
    pub fn new(scenario: &'a Scenario, runs: &'a [Labelled<'a>], size: Size, follows: bool) -> Self {
        let ants = runs.iter().map(|run| ants_of(scenario, run)).collect();
        let rows = || runs.iter().flat_map(|run| &run.trace.rows);
        let largest = |sizes: &mut dyn Iterator<Item = f64>| sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        let largest_pull = largest(&mut rows().flat_map(|row| &row.tips).map(|tip| tip.pull.norm()));
        let largest_force = largest(&mut rows().flat_map(|row| &row.contacts).map(|contact| contact.force.norm()));
        let radius = scenario.system.load.radius;
        let (middle, half) = if follows { (Vec2::zeros(), reach(scenario)) } else { extent(scenario, runs, radius) };
        Self { scenario, runs, ants, size, middle, half, follows, largest_pull, largest_force }
    }

    pub fn size(&self) -> Size {
        self.size
    }

    /// The picture at a time (s), as rows of pixels of four bytes.
    pub fn at(&self, time: f64) -> Vec<u8> {
        let mut all = Pen::new(self.size.width, self.size.height);
        let n = self.runs.len() as u32;
        for at in 0..n {
            let (left, right) = (at * self.size.width / n, (at + 1) * self.size.width / n);
            let mut view = Pen::new((right - left).max(1), self.size.height);
            self.draw(&mut view, at as usize, time);
            all.put(&view, left, 0);
            if at > 0 {
                let x = f64::from(left);
                all.stroke(&Shape::line([Vec2::new(x, 0.0), Vec2::new(x, f64::from(self.size.height))]), Line::new(FAINT, 1.0));
            }
        }
        all.into_rgba()
    }

    fn draw(&self, pen: &mut Pen, run: usize, time: f64) {
        let state = self.state(run, time);
        let (width, height) = (f64::from(self.size.width) / self.runs.len() as f64, f64::from(self.size.height));
        let middle = if self.follows { state.pose.position } else { self.middle };
        let per = ((width - 16.0) / (2.0 * self.half.x)).min((height - TOP - BOTTOM) / (2.0 * self.half.y));
        let to = |place: Vec2| {
            Vec2::new(0.5 * width + per * (place.x - middle.x), TOP + 0.5 * (height - TOP - BOTTOM) - per * (place.y - middle.y))
        };
        let view = View { pen, per, to: &to };
        self.draw_world(view, run, &state, time);
        pen.square(Vec2::new(17.0, 16.0), 6.0, self.color(run));
        pen.text(self.runs[run].label, 30.0, 21.0, INK);
        let bar = nice_below(0.25 * width / per);
        let corner = Vec2::new(12.0, height - 10.0);
        let along = Vec2::new(per * bar, 0.0);
        let up = Vec2::new(0.0, -4.0);
        pen.stroke(&Shape::line([corner + up, corner, corner + along, corner + along + up]), Line::new(INK, 1.5));
        pen.text(&short_quantity(bar, "m"), 16.0, height - 14.0, SOFT);
        if run + 1 == self.runs.len() {
            let clock = format!("{time:.2} s");
            pen.text(&clock, width - Pen::width_of(&clock) - 10.0, height - 10.0, INK);
        }
    }

    fn draw_world(&self, mut view: View, run: usize, state: &State, time: f64) {
        let system = &self.scenario.system;
        if let Some(nest) = Scene::of(self.scenario).nest {
            let disc = Shape::disc((view.to)(nest.position), (view.per * nest.arrival_radius).max(4.0));
            view.pen.fill(&disc, [0, 158, 115, 34]);
            view.pen.stroke(&disc, Line::new(NEST, 1.5).dashed(4.0, 3.0));
        }
        for obstacle in &system.world.obstacles {
            let shape = view.outline(&obstacle.outline.parts, &obstacle.path.pose_at(time));
            if obstacle.outline.parts.iter().all(|part| !matches!(part, OutlinePart::Polyline { .. })) {
                view.pen.fill(&shape, FAINT);
            }
            view.pen.stroke(&shape, Line::new(SOFT, 1.8));
        }
        let color = self.color(run);
        let rows = &self.runs[run].trace.rows;
        let past = rows.iter().take_while(|row| row.time <= time).map(|row| row.motion.pose.position);
        let trail = thin(past.chain([state.pose.position]).map(|place| (view.to)(place)));
        view.pen.stroke(&Shape::line(trail), Line::new([color[0], color[1], color[2], 110], 1.6));
        self.draw_free(&mut view, state);
        let shape = view.outline(&system.world.outline.parts, &state.pose);
        view.pen.fill(&shape, [color[0], color[1], color[2], 36]);
        view.pen.stroke(&shape, Line::new(color, 1.8));
        let ahead = state.pose.to_world(&Vec2::new(front(&system.world.outline), 0.0));
        view.pen.stroke(&Shape::line([(view.to)(state.pose.position), (view.to)(ahead)]), Line::new(color, 1.8));
        for support in system.ground.supports.iter().filter(|support| support.normal_load > 0.0) {
            let size = (0.06 * system.load.radius * view.per).clamp(1.5, 4.0);
            view.pen.square((view.to)(state.pose.to_world(&support.offset)), size, SOFT);
        }
        self.draw_held(&mut view, state);
        for contact in &state.row.contacts {
            let at = (view.to)(contact.point);
            let size = 1.2 * system.load.radius * view.per / self.largest_force.max(f64::MIN_POSITIVE);
            view.pen.arrow(at, size * Vec2::new(contact.force.x, -contact.force.y), FORCE, 2.5);
            view.pen.fill(&Shape::disc(at, 3.5), FORCE);
        }
        state.ants.iter().for_each(|ant| view.ant(ant, (0.75 * system.load.radius * view.per).max(9.0)));
    }

    fn draw_free(&self, view: &mut View, state: &State) {
        for (number, spring) in self.scenario.system.springs.iter().enumerate() {
            if state.tips.iter().all(|tip| tip.spring != number) {
                let ends = [spring.root, spring.rest_tip()].map(|end| (view.to)(state.pose.to_world(&end)));
                view.pen.stroke(&Shape::line(ends), Line::new([119, 125, 133, 140], 1.2));
            }
        }
    }

    fn draw_held(&self, view: &mut View, state: &State) {
        let width = (0.12 * self.scenario.system.load.radius * view.per).clamp(2.0, 5.0);
        for tip in &state.tips {
            let root = self.scenario.system.springs[tip.spring].root;
            let color = ramp(tip.pull.norm() / self.largest_pull.max(f64::MIN_POSITIVE));
            let end = (view.to)(tip.position);
            view.pen.stroke(&Shape::line([(view.to)(state.pose.to_world(&root)), end]), Line::new(color, width));
            view.pen.fill(&Shape::disc(end, width), color);
            if state.ants.is_empty() {
                view.pen.stroke(&Shape::disc(end, 6.0), Line::new(INK, 1.2));
            }
        }
    }

    /// A backend has the same colour in all pictures.
    fn color(&self, run: usize) -> Rgba {
        let named = BackendKind::ALL.iter().position(|kind| kind.name() == self.runs[run].label);
        rgb(trace_color(named.unwrap_or(run)))
    }

    /// Between two rows poses and tips go straight.
    fn state(&self, run: usize, time: f64) -> State<'a> {
        let rows = &self.runs[run].trace.rows;
        let at = rows.partition_point(|row| row.time <= time).max(1) - 1;
        let (row, next) = (&rows[at], &rows[(at + 1).min(rows.len() - 1)]);
        let span = next.time - row.time;
        let share = if span > 0.0 { ((time - row.time) / span).clamp(0.0, 1.0) } else { 0.0 };
        let between = |a: Vec2, b: Vec2| a + share * (b - a);
        let pose = row.motion.pose.towards(&next.motion.pose, share);
        let moved = |tip: &AttachedTip| {
            let later = next.tips.iter().find(|other| other.spring == tip.spring);
            AttachedTip { position: later.map_or(tip.position, |later| between(tip.position, later.position)), ..*tip }
        };
        let ants = self.ants[run].get(at).map(|now| {
            let later = self.ants[run].get(at + 1).unwrap_or(now);
            let walked = |(ant, next): (&PlacedAnt, &PlacedAnt)| PlacedAnt { position: between(ant.position, next.position), ..*ant };
            now.iter().zip(later).map(walked).collect()
        });
        State { pose, row, tips: row.tips.iter().map(moved).collect(), ants: ants.unwrap_or_default() }
    }
}

/// World to px.
struct View<'p, 't> {
    pen: &'p mut Pen,
    /// Px over m.
    per: f64,
    to: &'t dyn Fn(Vec2) -> Vec2,
}

impl View<'_, '_> {
    fn outline(&self, parts: &[OutlinePart], pose: &Pose) -> Shape {
        let mut shape = Shape::default();
        let place = |point: &Vec2| (self.to)(pose.to_world(point));
        for part in parts {
            match part {
                OutlinePart::Disc { centre, radius } => shape.add_disc(place(centre), radius * self.per),
                OutlinePart::Polygon { corners } => shape.add_polygon(corners.iter().map(place)),
                OutlinePart::Polyline { points } => shape.add_line(points.iter().map(place)),
            }
        }
        shape
    }

    /// The mandibles are where the ant is; its body lies behind them.
    fn ant(&mut self, ant: &PlacedAnt, length: f64) {
        let (at, color) = ((self.to)(ant.position), if ant.holds { ANT } else { SOFT });
        let turn = |along: f64, across: f64| {
            let (sin, cos) = ant.heading.sin_cos();
            at + length * Vec2::new(cos * along - sin * across, -(sin * along + cos * across))
        };
        for (middle, along, across) in [(-0.2, 0.15, 0.12), (-0.48, 0.15, 0.09), (-0.82, 0.22, 0.16)] {
            let point = |k: i32| {
                let angle = TAU * f64::from(k) / 20.0;
                turn(middle + along * angle.cos(), across * angle.sin())
            };
            let mut body = Shape::default();
            body.add_polygon((0..20).map(point));
            if ant.holds { self.pen.fill(&body, color) } else { self.pen.stroke(&body, Line::new(color, 1.2)) }
        }
        let mut legs = Shape::default();
        for side in [-1.0, 1.0] {
            legs.add_line([turn(-0.08, side * 0.05), turn(0.0, side * 0.02)]);
            [-0.38, -0.48, -0.58]
                .iter()
                .for_each(|leg| legs.add_line([turn(*leg, side * 0.08), turn(leg + 0.9 * (leg + 0.48), side * 0.32)]));
        }
        self.pen.stroke(&legs, Line::new(color, 1.2));
    }
}

fn ants_of(scenario: &Scenario, run: &Labelled) -> Vec<Vec<PlacedAnt>> {
    let mut seen = Vec::new();
    follow_ants(scenario, run.trace, |_, ants| {
        let placed = |ant: &cohaul::model::ant::Ant| PlacedAnt {
            position: ant.position,
            heading: ant.heading,
            holds: matches!(ant.mode, Mode::Transport { .. }),
        };
        seen.push(ants.iter().map(placed).collect());
    });
    seen
}

/// Half sides of what is seen about a load that is followed: its longest spring and an ant behind.
fn reach(scenario: &Scenario) -> Vec2 {
    let longest = scenario.system.springs.iter().map(|spring| spring.rest_tip().norm()).fold(2.2 * scenario.system.load.radius, f64::max);
    1.7 * longest * Vec2::new(1.0, 1.0)
}

/// Middle and half sides of all places that the load and attached tips come to, with the nest.
fn extent(scenario: &Scenario, runs: &[Labelled], radius: f64) -> (Vec2, Vec2) {
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    let mut add = |place: Vec2, around: f64| {
        if place.x.is_finite() && place.y.is_finite() {
            low = low.inf(&place.add_scalar(-around));
            high = high.sup(&place.add_scalar(around));
        }
    };
    for row in runs.iter().flat_map(|run| &run.trace.rows) {
        add(row.motion.pose.position, 1.6 * radius);
        row.tips.iter().for_each(|tip| add(tip.position, 0.4 * radius));
    }
    if let Some(nest) = Scene::of(scenario).nest {
        add(nest.position, nest.arrival_radius + 0.3 * radius);
    }
    for obstacle in scenario.system.world.obstacles.iter().filter(|obstacle| obstacle.path.moves()) {
        obstacle.path.waypoints.iter().for_each(|(_, pose)| add(pose.position, 0.6 * radius));
    }
    (0.5 * (low + high), (0.5 * (high - low)).map(|half| half.max(radius)))
}

/// Points that are a pixel apart at least.
fn thin(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut kept: Vec<Vec2> = Vec::new();
    for point in points.filter(|point| point.x.is_finite() && point.y.is_finite()) {
        if kept.last().is_none_or(|last| (point - last).norm() >= 1.0) {
            kept.push(point);
        }
    }
    kept
}

/// The 1, 2 or 5 times a power of ten that is the largest one up to `most`.
fn nice_below(most: f64) -> f64 {
    let power = 10f64.powf(most.log10().floor());
    power
        * if most / power >= 5.0 {
            5.0
        } else if most / power >= 2.0 {
            2.0
        } else {
            1.0
        }
}

fn ramp(share: f64) -> Rgba {
    let at = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let (a, b) = (RAMP[at as usize], RAMP[(at as usize + 1).min(RAMP.len() - 1)]);
    let part = |k: usize| (a[k] + at.fract() * (b[k] - a[k])).round() as u8;
    [part(0), part(1), part(2), 255]
}

/// A colour `#rrggbb`.
fn rgb(color: &str) -> Rgba {
    let part = |at: usize| u8::from_str_radix(color.get(at..at + 2).unwrap_or("00"), 16).unwrap_or(0);
    [part(1), part(3), part(5), 255]
}
