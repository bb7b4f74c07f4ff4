//! Ways to pose a random scene differently.

use std::f64::consts::TAU;

use crate::draws::Draws;
use crate::posed::{Pose, refined};
use crate::random_scene::{Drive, LoadKind, ObstacleKind, Random};
use crate::scene::{Body, Part, Point, Scene};

/// A way to pose a scene differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// The obstacle is cut into flush obstacles.
    Pieces,
    /// The obstacle is one obstacle of flush parts.
    Compound,
    /// Flush pieces, of which some are lower by less than what counts as a step.
    Steps,
    /// Walls that end out of reach end farther.
    Longer,
    /// The ends of blocks are rounded with a radius of a ten millionth of the size.
    Rounded,
    /// Corners on straight edges of load and obstacle.
    Refined,
    /// Supports, parts and obstacles in another order, and outlines from another corner.
    Reordered,
    Turned,
    Mirrored,
    Scaled,
}
use Variant::{Compound, Longer, Mirrored, Pieces, Refined, Reordered, Rounded, Scaled, Steps, Turned};

/// Step down that is none, over lengths of a decimetre (m).
const NO_STEP: f64 = 1e-12;
/// Radius of a rounded corner (m).
const ROUNDED: f64 = 1e-8;

impl Variant {
    pub const ALL: [Self; 10] = [Pieces, Compound, Steps, Longer, Rounded, Refined, Reordered, Turned, Mirrored, Scaled];

    /// Whether a scene can be posed so.
    pub fn applies(self, to: &Random) -> bool {
        match self {
            Pieces | Steps => to.obstacle != ObstacleKind::Post,
            Compound => matches!(to.obstacle, ObstacleKind::Block | ObstacleKind::Pusher),
            Longer => to.is_long && to.obstacle != ObstacleKind::Bend,
            Rounded => matches!(to.obstacle, ObstacleKind::Block | ObstacleKind::Pusher),
            Refined => to.load != LoadKind::Disc || to.obstacle != ObstacleKind::Post,
            Reordered | Turned | Mirrored | Scaled => true,
        }
    }

    /// Largest distance over the size that has a reason apart from steps and rounding (1): a
    /// rounded end is off by its radius, which a load that turns about it multiplies.
    pub fn allowed(self) -> f64 {
        if self == Rounded { 1e-5 } else { 0.0 }
    }

    /// Whether the steps may be divided at other instants: at a joint of pieces, at a corner on an
    /// edge, or about the edge of a round end.
    pub fn may_cut_steps(self) -> bool {
        matches!(self, Pieces | Compound | Steps | Rounded | Refined)
    }

    /// The other scene, and how its poses follow from those of this one.
    pub fn of(self, random: &Random, draws: &mut Draws) -> (Scene, Pose) {
        let mut scene = random.scene.clone();
        let mut pose = Pose::SAME;
        match self {
            Pieces => scene.obstacles = in_pieces(&scene.obstacles, 0.0, draws),
            Steps => scene.obstacles = in_pieces(&scene.obstacles, NO_STEP, draws),
            Compound => each_part(&mut scene, pieces_of, draws),
            Longer => each_part(&mut scene, |part, _| vec![longer(part)], draws),
            Rounded => each_part(&mut scene, |part, _| rounded(part), draws),
            Refined => {
                each_part(&mut scene, |part, draws| refined(std::slice::from_ref(part), draws), draws);
                scene.load = refined(&scene.load, draws);
            }
            Reordered => reorder(&mut scene, draws),
            Turned => pose = Pose { angle: draws.between(-3.0, 3.0), shift: [draws.between(-1.0, 1.0), draws.between(-1.0, 1.0)], ..pose },
            Mirrored => pose.is_mirrored = true,
            Scaled => pose.scale = draws.log_between(0.01, 100.0),
        }
        (pose.of(&scene), pose)
    }
}

fn each_part(scene: &mut Scene, mut change: impl FnMut(&Part, &mut Draws) -> Vec<Part>, draws: &mut Draws) {
    for body in &mut scene.obstacles {
        body.parts = body.parts.iter().flat_map(|part| change(part, draws)).collect();
    }
}

/// Places of cuts of the interval from 0 to 1, with both ends.
fn cuts(draws: &mut Draws) -> Vec<f64> {
    let mut cuts: Vec<f64> = (0..1 + draws.below(29)).map(|_| draws.unit()).collect();
    cuts.extend([0.0, 1.0]);
    cuts.sort_by(f64::total_cmp);
    cuts
}

fn along(a: Point, b: Point, share: f64) -> Point {
    [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]))
}

/// Flush pieces of a part: of each straight piece of a line, or of a rectangle across its first
/// side.
fn pieces_of(part: &Part, draws: &mut Draws) -> Vec<Part> {
    match part {
        Part::Disc { .. } => vec![part.clone()],
        Part::Line(points) => points
            .windows(2)
            .flat_map(|ends| {
                let points: Vec<Point> = cuts(draws).into_iter().map(|share| along(ends[0], ends[1], share)).collect();
                points.windows(2).map(|piece| Part::Line(piece.to_vec())).collect::<Vec<_>>()
            })
            .collect(),
        Part::Polygon(points) => {
            let [a, b, c, d] = points[..] else { panic!("obstacles are rectangles") };
            let cuts = cuts(draws);
            let piece = |s: f64, t: f64| Part::Polygon(vec![along(a, b, s), along(a, b, t), along(d, c, t), along(d, c, s)]);
            cuts.windows(2).map(|ends| piece(ends[0], ends[1])).collect()
        }
    }
}

fn in_pieces(bodies: &[Body], step: f64, draws: &mut Draws) -> Vec<Body> {
    let mut pieces = Vec::new();
    for body in bodies {
        for part in body.parts.iter().flat_map(|part| pieces_of(part, draws)).collect::<Vec<_>>() {
            let lower = step * f64::from(u8::from(draws.is(0.5)));
            let path = body.path.iter().map(|[time, x, y, heading]| [*time, *x, y - lower, *heading]).collect();
            pieces.push(Body { parts: vec![part], path, ..*body });
        }
    }
    pieces
}

fn longer(part: &Part) -> Part {
    let far = |points: &[Point]| points.iter().map(|[x, y]| [7.0 * x, *y]).collect();
    match part {
        Part::Disc { .. } => part.clone(),
        Part::Line(points) => Part::Line(far(points)),
        Part::Polygon(points) => Part::Polygon(far(points)),
    }
}

/// A rectangle whose upper corners are rounded, below which its ends are set in by the radius.
fn rounded(part: &Part) -> Vec<Part> {
    let Part::Polygon(points) = part else { return vec![part.clone()] };
    let [a, b, c, d] = points[..] else { panic!("obstacles are rectangles") };
    let r = ROUNDED;
    let straight = vec![[a[0] + r, a[1]], [b[0] - r, b[1]], [c[0] - r, c[1]], [d[0] + r, d[1]]];
    let end = |centre: Point| Part::Disc { centre, radius: r };
    vec![Part::Polygon(straight), end([c[0] - r, c[1] - r]), end([d[0] + r, d[1] - r])]
}

fn reorder(scene: &mut Scene, draws: &mut Draws) {
    draws.shuffle(&mut scene.supports);
    draws.shuffle(&mut scene.obstacles);
    let bodies = scene.obstacles.iter_mut().map(|body| &mut body.parts);
    for parts in bodies.chain([&mut scene.load]) {
        draws.shuffle(parts);
        for part in parts {
            match part {
                Part::Disc { .. } => {}
                Part::Line(points) => points.reverse(),
                Part::Polygon(points) => {
                    let first = draws.below(points.len());
                    points.rotate_left(first);
                }
            }
        }
    }
}

/// The scene with each disc as a regular polygon of `n` corners; `None` where there is no disc.
pub fn with_polygons(random: &Random, n: usize) -> Option<Scene> {
    let mut scene = random.scene.clone();
    let has_disc = random.load == LoadKind::Disc || random.obstacle == ObstacleKind::Post;
    let corner = |[x, y]: Point, radius: f64, k: usize| {
        let (sin, cos) = (TAU * k as f64 / n as f64).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    let polygon = |part: &Part| match part {
        Part::Disc { centre, radius } => Part::Polygon((0..n).map(|k| corner(*centre, *radius, k)).collect()),
        other => other.clone(),
    };
    scene.load = scene.load.iter().map(polygon).collect();
    scene.obstacles.iter_mut().for_each(|body| body.parts = body.parts.iter().map(polygon).collect());
    (has_disc && random.drive != Drive::Thrown).then_some(scene)
}
