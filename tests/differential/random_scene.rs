//! Random loads that springs pull, obstacles push, or that are thrown, at one or two obstacles.

use std::f64::consts::TAU;

use crate::draws::Draws;
use crate::known::block;
use crate::scene::{Body, GRAVITY, Part, Point, Scene, Spring, fixed, rectangle};

/// Shapes of loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKind {
    Box,
    Triangle,
    /// A load that is not convex.
    Ell,
    /// A box of two flush halves.
    Halves,
    Disc,
}

impl LoadKind {
    pub const ALL: [Self; 5] = [Self::Box, Self::Triangle, Self::Ell, Self::Halves, Self::Disc];

    /// Outline about its centroid (m).
    fn outline(self, draws: &mut Draws) -> Vec<Part> {
        let (a, b) = (draws.between(0.12, 0.22), draws.between(0.07, 0.14));
        match self {
            Self::Box => vec![rectangle([0.0; 2], [a, b])],
            Self::Halves => [-0.25 * a, 0.25 * a].map(|x| rectangle([x, 0.0], [0.5 * a, b])).to_vec(),
            Self::Disc => vec![Part::Disc { centre: [0.0; 2], radius: 0.5 * a }],
            Self::Triangle => {
                let top = draws.between(-0.2, 0.2) * a;
                vec![Part::Polygon(about_centroid(&[[-0.5 * a, 0.0], [0.5 * a, 0.0], [top, 1.2 * b]]))]
            }
            Self::Ell => {
                let (c, d) = (0.35 * a, 0.35 * b);
                let corners = [[0.0, 0.0], [a, 0.0], [a, d], [c, d], [c, b], [0.0, b]];
                vec![Part::Polygon(about_centroid(&corners))]
            }
        }
    }
}

fn about_centroid(corners: &[Point]) -> Vec<Point> {
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for (at, a) in corners.iter().enumerate() {
        let b = corners[(at + 1) % corners.len()];
        let cross = a[0] * b[1] - a[1] * b[0];
        area += 0.5 * cross;
        moment = [0, 1].map(|axis| moment[axis] + (a[axis] + b[axis]) * cross / 6.0);
    }
    corners.iter().map(|corner| [0, 1].map(|axis| corner[axis] - moment[axis] / area)).collect()
}

/// Kinds of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObstacleKind {
    Line,
    Block,
    /// A disc.
    Post,
    /// A line that bends up or down.
    Bend,
    /// A block that moves.
    Pusher,
}

impl ObstacleKind {
    pub const ALL: [Self; 5] = [Self::Line, Self::Block, Self::Post, Self::Bend, Self::Pusher];
}

/// What moves the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// A spring presses it on the obstacle and pulls it along.
    Pulled,
    /// Only the obstacle moves it.
    Pushed,
    /// It flies onto the obstacle without any spring.
    Thrown,
}

/// A random scene and what it is made of.
#[derive(Clone, Debug)]
pub struct Random {
    pub scene: Scene,
    pub load: LoadKind,
    pub obstacle: ObstacleKind,
    pub drive: Drive,
    /// Whether the ends of the first obstacle are out of reach.
    pub is_long: bool,
}

/// Reach of the load (m): it never comes so far.
const REACH: f64 = 1.5;

/// The lower edge of a load in its starting pose (m).
fn lowest(load: &[Part], heading: f64) -> f64 {
    let (sin, cos) = heading.sin_cos();
    let height = |[x, y]: &Point| sin * x + cos * y;
    let of_part = |part: &Part| match part {
        Part::Disc { centre, radius } => height(centre) - radius,
        Part::Polygon(points) | Part::Line(points) => points.iter().map(height).fold(f64::INFINITY, f64::min),
    };
    load.iter().map(of_part).fold(f64::INFINITY, f64::min)
}

/// The obstacle below a load whose lower edge is at `low` (m), and whether it is long.
fn obstacle(kind: ObstacleKind, low: f64, draws: &mut Draws) -> (Body, bool) {
    let top = low - draws.between(0.005, 0.02);
    let is_long = draws.is(0.4);
    let (from, to) = if is_long { (-REACH, REACH) } else { (-draws.between(0.05, 0.4), draws.between(0.05, 0.4)) };
    let friction = if draws.is(0.4) { 0.0 } else { draws.between(0.05, 0.6) };
    match kind {
        ObstacleKind::Line => (fixed(vec![Part::Line(vec![[from, top], [to, top]])], friction), is_long),
        ObstacleKind::Block => (block(from, to, top, friction), is_long),
        ObstacleKind::Post => {
            let radius = draws.between(0.01, 0.06);
            let centre = [draws.between(-0.08, 0.15), top - radius];
            (fixed(vec![Part::Disc { centre, radius }], friction), false)
        }
        ObstacleKind::Bend => {
            let at = draws.between(0.03, 0.25);
            let angle = if draws.is(0.5) { draws.between(-1.2, -0.1) } else { draws.between(0.1, 1.2) };
            // A bend upward stays clear of the load at the start.
            let at = if angle > 0.0 { at + 0.2 } else { at };
            (fixed(vec![Part::Line(vec![[-REACH, top], [at, top], [at + angle.cos(), top + angle.sin()]])], friction), false)
        }
        ObstacleKind::Pusher => {
            let goal = [draws.between(-0.2, 0.2), draws.between(0.03, 0.15), draws.between(-0.3, 0.3)];
            let plate = rectangle([0.5 * (from + to), top - 0.01], [to - from, 0.02]);
            let path = vec![[0.0; 4], [1.0, goal[0], goal[1], goal[2] * f64::from(u8::from(draws.is(0.5)))]];
            (Body { path, ..fixed(vec![plate], friction) }, is_long)
        }
    }
}

/// A spring whose tip presses the load down, then pulls it to one side, and perhaps back.
fn spring(size: f64, start: [f64; 3], draws: &mut Draws) -> Spring {
    let root = if draws.is(0.5) { [0.0; 2] } else { [draws.between(-0.5, 0.5) * size, draws.between(-0.3, 0.3) * size] };
    let (sin, cos) = start[2].sin_cos();
    let at = [cos * root[0] - sin * root[1], sin * root[0] + cos * root[1]];
    let depth = draws.between(-0.09, -0.04);
    let far = draws.between(-0.45, 0.45);
    let mut path = vec![[0.0, at[0], at[1]], [0.3, at[0], at[1] + depth], [0.7, at[0] + far, at[1] + depth]];
    if draws.is(0.3) {
        path.push([1.0, at[0] - 0.5 * far, at[1] + depth]);
    }
    Spring { root, stiffness: draws.log_between(60.0, 400.0), path }
}

impl Random {
    /// The scene of this seed; nothing is thrown unless `has_inertia`.
    pub fn new(seed: u64, has_inertia: bool) -> Self {
        let mut draws = Draws::new(seed);
        let draws = &mut draws;
        let (load, obstacle_kind) = (LoadKind::ALL[draws.below(5)], ObstacleKind::ALL[draws.below(5)]);
        let outline = load.outline(draws);
        let size = outline.iter().map(Part::extent).fold(0.0, f64::max);
        // Half of the loads lie flat on the obstacle.
        let heading = if draws.is(0.5) { 0.0 } else { TAU * draws.unit() };
        let start = [0.0, 0.0, heading];
        let (below, is_long) = obstacle(obstacle_kind, lowest(&outline, heading), draws);
        let drive = match obstacle_kind {
            ObstacleKind::Pusher => Drive::Pushed,
            _ if has_inertia && draws.is(0.4) => Drive::Thrown,
            _ => Drive::Pulled,
        };
        let one = spring(size, start, draws);
        let fall = [draws.between(-1.0, 1.0), draws.between(-1.5, -0.3), draws.between(-4.0, 4.0)];
        let (mass, n_supports) = (draws.between(0.3, 2.0), 3 + draws.below(5));
        let support = |k: usize| {
            let (sin, cos) = (0.3 + TAU * k as f64 / n_supports as f64).sin_cos();
            ([0.4 * size * cos, 0.4 * size * sin], mass * GRAVITY / n_supports as f64)
        };
        let mut obstacles = vec![below];
        if has_inertia && draws.is(0.3) {
            obstacles[0].restitution = draws.between(0.1, 0.8);
        }
        let scene = Scene {
            name: format!("pair {seed}"),
            duration: 1.0,
            control_period: 0.01,
            inertia: draws.between(0.25, 0.5) * mass * size * size,
            mass,
            start,
            velocity: if drive == Drive::Thrown { fall } else { [0.0; 3] },
            ground_friction: draws.between(0.1, 0.5),
            supports: (0..n_supports).map(support).collect(),
            springs: if drive == Drive::Pulled { vec![one] } else { Vec::new() },
            obstacles,
            load: outline,
        };
        Self { scene, load, obstacle: obstacle_kind, drive, is_long }
    }
}
