//! The same scene posed differently: its motion is the same, in the other pose.

use crate::draws::Draws;
use crate::scene::{Body, Part, Point, Scene, Spring};

/// A similarity of the plane that maps a scene to another one: mirrors it in the x axis or not,
/// then scales it, turns it and shifts it.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub is_mirrored: bool,
    /// (1)
    pub scale: f64,
    /// (rad)
    pub angle: f64,
    /// (m)
    pub shift: Point,
}

impl Pose {
    pub const SAME: Self = Self { is_mirrored: false, scale: 1.0, angle: 0.0, shift: [0.0; 2] };

    /// A turn by any angle, a scale of 0.01 to 10, and a shift of up to 3 m.
    pub fn random(draws: &mut Draws) -> Self {
        let shift = [(); 2].map(|()| draws.between(-1.0, 1.0));
        let far = draws.log_between(0.01, 3.0);
        Self {
            is_mirrored: false,
            scale: draws.log_between(0.01, 10.0),
            angle: draws.between(-3.2, 3.2),
            shift: shift.map(|one| far * one),
        }
    }

    fn sign(&self) -> f64 {
        if self.is_mirrored { -1.0 } else { 1.0 }
    }

    /// A vector in the frame of a body.
    fn local(&self, [x, y]: Point) -> Point {
        [self.scale * x, self.scale * self.sign() * y]
    }

    fn vector(&self, vector: Point) -> Point {
        let ([x, y], (sin, cos)) = (self.local(vector), self.angle.sin_cos());
        [cos * x - sin * y, sin * x + cos * y]
    }

    fn point(&self, point: Point) -> Point {
        let [x, y] = self.vector(point);
        [x + self.shift[0], y + self.shift[1]]
    }

    /// A position and a heading.
    pub fn pose(&self, [x, y, heading]: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.point([x, y]);
        [x, y, self.sign() * heading + self.angle]
    }

    fn part(&self, part: &Part) -> Part {
        match part {
            Part::Disc { centre, radius } => Part::Disc { centre: self.local(*centre), radius: self.scale * radius },
            Part::Line(points) => Part::Line(points.iter().map(|point| self.local(*point)).collect()),
            Part::Polygon(points) => {
                let mut points: Vec<Point> = points.iter().map(|point| self.local(*point)).collect();
                if self.is_mirrored {
                    points.reverse();
                }
                Part::Polygon(points)
            }
        }
    }

    fn body(&self, body: &Body) -> Body {
        let waypoint = |[time, x, y, heading]: &[f64; 4]| {
            let [x, y, heading] = self.pose([*x, *y, *heading]);
            [*time, x, y, heading]
        };
        Body { parts: body.parts.iter().map(|part| self.part(part)).collect(), path: body.path.iter().map(waypoint).collect(), ..*body }
    }

    fn spring(&self, spring: &Spring) -> Spring {
        let waypoint = |[time, x, y]: &[f64; 3]| {
            let [x, y] = self.point([*x, *y]);
            [*time, x, y]
        };
        Spring { root: self.local(spring.root), stiffness: spring.stiffness, path: spring.path.iter().map(waypoint).collect() }
    }

    /// The scene in this pose. Masses, stiffnesses and times stay, so that forces grow with the
    /// scale.
    pub fn of(&self, scene: &Scene) -> Scene {
        let [u, v, rate] = scene.velocity;
        let [u, v] = self.vector([u, v]);
        Scene {
            load: scene.load.iter().map(|part| self.part(part)).collect(),
            inertia: self.scale * self.scale * scene.inertia,
            start: self.pose(scene.start),
            velocity: [u, v, self.sign() * rate],
            supports: scene.supports.iter().map(|(offset, load)| (self.local(*offset), self.scale * load)).collect(),
            springs: scene.springs.iter().map(|spring| self.spring(spring)).collect(),
            obstacles: scene.obstacles.iter().map(|body| self.body(body)).collect(),
            ..scene.clone()
        }
    }
}

/// A point on the way from `a` to `b` (m).
fn between(a: Point, b: Point, share: f64) -> Point {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

/// The same chain of points with up to three more on each straight piece.
fn with_more_points(points: &[Point], is_closed: bool, draws: &mut Draws) -> Vec<Point> {
    let n_pieces = if is_closed { points.len() } else { points.len() - 1 };
    let mut chain = Vec::new();
    for at in 0..n_pieces {
        let (a, b) = (points[at], points[(at + 1) % points.len()]);
        chain.push(a);
        let mut shares: Vec<f64> = (0..draws.below(4)).map(|_| draws.between(0.02, 0.98)).collect();
        shares.sort_by(f64::total_cmp);
        chain.extend(shares.into_iter().map(|share| between(a, b, share)));
    }
    chain.extend((!is_closed).then(|| points[points.len() - 1]));
    chain
}

fn refined_part(part: &Part, draws: &mut Draws) -> Part {
    match part {
        Part::Disc { .. } => part.clone(),
        Part::Polygon(points) => Part::Polygon(with_more_points(points, true, draws)),
        Part::Line(points) => Part::Line(with_more_points(points, false, draws)),
    }
}

/// The same outline with corners on its straight edges.
pub fn refined(parts: &[Part], draws: &mut Draws) -> Vec<Part> {
    parts.iter().map(|part| refined_part(part, draws)).collect()
}
