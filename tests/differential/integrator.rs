//! An independent solution with inertia, for scenes without restitution.
//!
//! It shares nothing with the backends. Each step of length h is one of Moreau's (1988): points
//! that are in an obstacle at its start must not go on inwards, and all forces are those at its
//! end. Strong dashpots stand for the obstacles, and Coulomb's friction is a smooth function of the
//! slip velocity:
//!
//! ```text
//! M (v - v_n) = h (springs(q_n + h v) + ground(v) + sum_k N_k n_k + F_k t_k)
//! N = max(0, -c n v),    F = -mu N t v / sqrt((t v)^2 + e^2)
//! ```
//!
//! An impact lies within one step. Its law is therefore Newton's with Coulomb's friction of the
//! velocities after it, as that of the backends. Where the slip ends or turns during an impact, a
//! soft contact would come to another velocity.

use nalgebra::{Matrix3, Vector3};

use crate::scene::{Body, Part, Point, Scene};

type Vector = Vector3<f64>;
type Matrix = Matrix3<f64>;

/// Length of a step (s).
const STEP: f64 = 4e-6;
/// Impulse of a dashpot over the momentum of the load at the same speed (1): what is left of an
/// approach.
const STRENGTH: f64 = 1e5;
/// Slip velocity at which friction is 0.7 of Coulomb's (m/s), and a larger one at which a search
/// begins that is far from its end.
const SLIP: f64 = 1e-6;
const LARGEST_SLIP: f64 = 1.0;
/// Depth at which points stay in an obstacle over the size (1): those that leave by rounding would
/// touch again and again.
const KEPT: f64 = 1e-9;
/// Change of the velocity that ends the search for it (m/s).
const FOUND: f64 = 1e-9;
/// Iterations of Newton's method at one smoothing.
const MOST_ITERATIONS: usize = 100;

/// A shape in the frame of its body: a polygon, or a disc.
enum Shape {
    Polygon(Vec<Point>),
    Disc(Point, f64),
}

/// A point where the load is in an obstacle.
struct Contact {
    point: Point,
    /// From the obstacle to the load.
    normal: Point,
    depth: f64,
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn times(factor: f64, a: Point) -> Point {
    [factor * a[0], factor * a[1]]
}

fn placed([x, y, heading]: [f64; 3], [a, b]: Point) -> Point {
    let (sin, cos) = heading.sin_cos();
    [x + cos * a - sin * b, y + sin * a + cos * b]
}

impl Shape {
    fn of(part: &Part) -> Self {
        match part {
            Part::Disc { centre, radius } => Self::Disc(*centre, *radius),
            Part::Polygon(points) => Self::Polygon(points.clone()),
            Part::Line(_) => panic!("a line has no inside"),
        }
    }

    fn at(&self, pose: [f64; 3]) -> Self {
        match self {
            Self::Polygon(points) => Self::Polygon(points.iter().map(|point| placed(pose, *point)).collect()),
            Self::Disc(centre, radius) => Self::Disc(placed(pose, *centre), *radius),
        }
    }
}

fn edges(points: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    points.iter().enumerate().map(|(at, point)| (*point, points[(at + 1) % points.len()]))
}

/// Depth of a point in a polygon and the outward normal of the nearest edge; `None` outside.
fn depth_in(points: &[Point], point: Point) -> Option<(f64, Point)> {
    let (mut is_inside, mut nearest) = (false, (f64::INFINITY, [0.0; 2]));
    for (a, b) in edges(points) {
        let (along, from) = (sub(b, a), sub(point, a));
        if (a[1] > point[1]) != (b[1] > point[1]) && (cross(along, from) > 0.0) == (b[1] > a[1]) {
            is_inside = !is_inside;
        }
        let length = along[0].hypot(along[1]);
        let share = (dot(along, from) / (length * length)).clamp(0.0, 1.0);
        let off = sub(from, times(share, along));
        let distance = off[0].hypot(off[1]);
        if distance < nearest.0 {
            nearest = (distance, [along[1] / length, -along[0] / length]);
        }
    }
    is_inside.then_some(nearest)
}

/// Contacts of a disc with a polygon, with normals from the polygon to the disc: one at each edge,
/// and one at each corner between whose edges the centre lies.
fn disc_on(points: &[Point], centre: Point, radius: f64, contacts: &mut Vec<Contact>) {
    for (at, (a, b)) in edges(points).enumerate() {
        let before = points[(at + points.len() - 1) % points.len()];
        let (along, from) = (sub(b, a), sub(centre, a));
        let length = along[0].hypot(along[1]);
        let share = dot(along, from) / (length * length);
        let outward = [along[1] / length, -along[0] / length];
        let height = dot(outward, from);
        if (0.0..=1.0).contains(&share) && (0.0..radius).contains(&height) {
            contacts.push(Contact { point: sub(centre, times(height, outward)), normal: outward, depth: radius - height });
        }
        let distance = from[0].hypot(from[1]);
        if share < 0.0 && dot(sub(a, before), from) > 0.0 && distance < radius {
            contacts.push(Contact { point: a, normal: times(1.0 / distance, from), depth: radius - distance });
        }
    }
}

/// Contacts of the load with an obstacle, both in the world.
fn contacts(load: &Shape, obstacle: &Shape, all: &mut Vec<Contact>) {
    match (load, obstacle) {
        (Shape::Polygon(load), Shape::Polygon(obstacle)) => {
            let inside = |point: &Point| depth_in(obstacle, *point).map(|(depth, normal)| Contact { point: *point, normal, depth });
            all.extend(load.iter().filter_map(inside));
            let inside =
                |point: &Point| depth_in(load, *point).map(|(depth, out)| Contact { point: *point, normal: times(-1.0, out), depth });
            all.extend(obstacle.iter().filter_map(inside));
        }
        (Shape::Disc(centre, radius), Shape::Polygon(points)) => disc_on(points, *centre, *radius, all),
        (Shape::Polygon(points), Shape::Disc(centre, radius)) => {
            let first = all.len();
            disc_on(points, *centre, *radius, all);
            all[first..].iter_mut().for_each(|contact| contact.normal = times(-1.0, contact.normal));
        }
        (Shape::Disc(centre, radius), Shape::Disc(other, other_radius)) => {
            let apart = sub(*centre, *other);
            let distance = apart[0].hypot(apart[1]);
            let (depth, normal) = (radius + other_radius - distance, times(1.0 / distance, apart));
            if depth > 0.0 {
                all.push(Contact { point: sub(*centre, times(*radius, normal)), normal, depth });
            }
        }
    }
}

/// Values along waypoints at a time (s), and their rates behind it: straight between them and
/// constant outside.
fn along<const N: usize, const M: usize>(path: &[[f64; N]], time: f64) -> ([f64; M], [f64; M]) {
    let value = |at: usize| std::array::from_fn(|k| path[at][k + 1]);
    let next = path.partition_point(|waypoint| waypoint[0] <= time);
    if next == 0 || next == path.len() {
        return (value(next.saturating_sub(1)), [0.0; M]);
    }
    let (a, b): ([f64; M], [f64; M]) = (value(next - 1), value(next));
    let span = path[next][0] - path[next - 1][0];
    let share = (time - path[next - 1][0]) / span;
    (std::array::from_fn(|k| a[k] + share * (b[k] - a[k])), std::array::from_fn(|k| (b[k] - a[k]) / span))
}

/// What the force `f` at an arm does to the load.
fn wrench(arm: Point, f: Point) -> Vector {
    Vector::new(f[0], f[1], cross(arm, f))
}

/// A contact in a step: by the velocity v of the load, it approaches by `normal v - approach`.
struct Touch {
    normal: Vector,
    tangent: Vector,
    /// Velocities of the obstacle along both.
    moving: [f64; 2],
    friction: f64,
    depth: f64,
}

struct Equations<'a> {
    scene: &'a Scene,
    load: Vec<Shape>,
    obstacles: Vec<(&'a Body, Vec<Shape>)>,
    mass: Vector,
    size: f64,
    step: f64,
}

/// A term of the forces and its derivative by the velocity.
#[derive(Clone, Copy)]
struct Force(Vector, Matrix);

impl Force {
    fn add(&mut self, force: Vector, slope: Matrix) {
        (self.0, self.1) = (self.0 + force, self.1 + slope);
    }
}

impl<'a> Equations<'a> {
    fn new(scene: &'a Scene, step: f64) -> Self {
        let shapes = |parts: &[Part]| parts.iter().map(Shape::of).collect();
        Self {
            scene,
            load: shapes(&scene.load),
            obstacles: scene.obstacles.iter().map(|body| (body, shapes(&body.parts))).collect(),
            mass: Vector::new(scene.mass, scene.mass, scene.inertia),
            size: scene.size(),
            step,
        }
    }

    /// Contacts at a pose of the load and a time (s).
    fn touches(&self, time: f64, pose: [f64; 3]) -> Vec<Touch> {
        let load: Vec<Shape> = self.load.iter().map(|shape| shape.at(pose)).collect();
        let mut touches = Vec::new();
        let mut found = Vec::new();
        for (body, shapes) in &self.obstacles {
            let (at, [u, v, turn]) = along::<4, 3>(&body.path, time);
            for obstacle in shapes.iter().map(|shape| shape.at(at)) {
                load.iter().for_each(|shape| contacts(shape, &obstacle, &mut found));
            }
            touches.extend(found.drain(..).map(|Contact { point, normal, depth }| {
                let (arm, from) = (sub(point, [pose[0], pose[1]]), sub(point, [at[0], at[1]]));
                let (tangent, moving) = ([-normal[1], normal[0]], [u - turn * from[1], v + turn * from[0]]);
                let moving = [dot(normal, moving), dot(tangent, moving)];
                Touch { normal: wrench(arm, normal), tangent: wrench(arm, tangent), moving, friction: body.friction, depth }
            }));
        }
        touches
    }

    /// Forces at the end of a step with this velocity, and their derivatives by it.
    fn forces(&self, (time, pose): (f64, [f64; 3]), velocity: &Vector, touches: &[Touch], slip: f64) -> Force {
        let mut sum = Force(Vector::zeros(), Matrix::zeros());
        let smooth = |speed_squared: f64| (speed_squared + slip * slip).sqrt().recip();
        for (offset, normal_load) in &self.scene.supports {
            let arm = placed([0.0, 0.0, pose[2]], *offset);
            let limit = self.scene.ground_friction * normal_load;
            let [x, y] = [wrench(arm, [1.0, 0.0]), wrench(arm, [0.0, 1.0])];
            let (u, v) = (x.dot(velocity), y.dot(velocity));
            let inverse = smooth(u * u + v * v);
            let along = u * x + v * y;
            sum.add(
                -limit * inverse * along,
                -limit * inverse * (x * x.transpose() + y * y.transpose() - inverse * inverse * along * along.transpose()),
            );
        }
        let end = [0, 1, 2].map(|k| pose[k] + self.step * velocity[k]);
        for spring in &self.scene.springs {
            let (arm, (tip, _)) = (placed([0.0, 0.0, end[2]], spring.root), along::<3, 2>(&spring.path, time + self.step));
            let pull = times(spring.stiffness, sub(sub(tip, [end[0], end[1]]), arm));
            let [x, y] = [wrench(arm, [1.0, 0.0]), wrench(arm, [0.0, 1.0])];
            let mut slope = -spring.stiffness * (x * x.transpose() + y * y.transpose());
            slope[(2, 2)] -= dot(arm, pull);
            sum.add(wrench(arm, pull), self.step * slope);
        }
        let strength = STRENGTH * self.scene.mass / self.step;
        for Touch { normal, tangent, moving, friction, .. } in touches {
            let (approach, sliding) = (moving[0] - normal.dot(velocity), tangent.dot(velocity) - moving[1]);
            if approach > 0.0 {
                let (pressing, inverse) = (strength * approach, smooth(sliding * sliding));
                let share = friction * sliding * inverse;
                let slope = friction * pressing * slip * slip * inverse.powi(3);
                let force = pressing * (normal - share * tangent);
                sum.add(force, -strength * (normal - share * tangent) * normal.transpose() - slope * tangent * tangent.transpose());
            }
        }
        sum
    }

    /// Velocity at the end of a step, near `guess`; `None` where Newton's method does not find it.
    fn search(&self, from: (f64, [f64; 3]), before: &Vector, touches: &[Touch], guess: Vector, slip: f64) -> Option<Vector> {
        let rest = |velocity: &Vector| {
            let Force(force, slope) = self.forces(from, velocity, touches, slip);
            let inverse = self.mass.map(f64::recip);
            (
                velocity - before - self.step * inverse.component_mul(&force),
                Matrix::identity() - self.step * Matrix::from_diagonal(&inverse) * slope,
            )
        };
        let length = |change: &Vector| change.x.hypot(change.y).max(self.size * change.z.abs());
        let mut velocity = guess;
        let (mut left, mut slope) = rest(&velocity);
        for _ in 0..MOST_ITERATIONS {
            let mut change = slope.lu().solve(&left)?;
            if length(&change) <= FOUND {
                return Some(velocity - change);
            }
            // Half of the step where that leaves less than the whole one.
            let mut next = rest(&(velocity - change));
            while length(&next.0) > length(&left) && length(&change) > FOUND {
                change *= 0.5;
                next = rest(&(velocity - change));
            }
            velocity -= change;
            (left, slope) = next;
        }
        None
    }

    /// Velocity at the end of a step. Where Newton's method does not find it at once, the friction
    /// is first smoothed more.
    fn velocity(&self, from: (f64, [f64; 3]), before: &Vector, touches: &[Touch]) -> Option<Vector> {
        self.search(from, before, touches, *before, SLIP).or_else(|| {
            let (mut slip, mut velocity) = (LARGEST_SLIP, *before);
            while slip > SLIP {
                velocity = self.search(from, before, touches, velocity, slip).unwrap_or(velocity);
                slip *= 0.2;
            }
            self.search(from, before, touches, velocity, SLIP)
        })
    }

    /// Moves a pose out of obstacles, by the least squares of what is left of the depths.
    fn push_out(&self, pose: [f64; 3], touches: &[Touch]) -> [f64; 3] {
        let (mut gram, mut right) = (1e-9 * Matrix::from_diagonal(&Vector::new(1.0, 1.0, self.size * self.size)), Vector::zeros());
        for Touch { normal, depth, .. } in touches {
            gram += normal * normal.transpose();
            right += (depth - KEPT * self.size) * normal;
        }
        let shift = gram.lu().solve(&right).unwrap_or_default();
        [0, 1, 2].map(|k| pose[k] + shift[k])
    }

    /// Poses after every `every` steps; `None` where a step has no answer.
    fn poses(&self, n_instants: usize, every: usize) -> Option<Vec<[f64; 3]>> {
        let (mut pose, mut velocity) = (self.scene.start, Vector::from(self.scene.velocity));
        let mut poses = vec![pose];
        for n in 0..n_instants * every {
            let time = n as f64 * self.step;
            let touches = self.touches(time, pose);
            if touches.iter().any(|touch| touch.depth > 2.0 * KEPT * self.size) {
                pose = self.push_out(pose, &touches);
            }
            velocity = self.velocity((time, pose), &velocity, &touches)?;
            pose = [0, 1, 2].map(|k| pose[k] + self.step * velocity[k]);
            if (n + 1) % every == 0 {
                poses.push(pose);
            }
        }
        Some(poses)
    }
}

/// Poses of a scene at the ends of its control periods, and their error over the size (1); `None`
/// where there is no solution. The error is the difference of two solutions, one with steps twice
/// as long: both are of first order.
pub fn solve(scene: &Scene) -> Option<(Vec<[f64; 3]>, f64)> {
    let n = (scene.duration / scene.control_period).round() as usize;
    let every = (scene.control_period / STEP).ceil() as usize;
    let by = |every: usize| Equations::new(scene, scene.control_period / every as f64).poses(n, every);
    let (coarse, fine) = (by(every.div_ceil(2))?, by(every)?);
    let size = [scene.size(), scene.size(), 1.0];
    let apart = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]).abs() / size[k]).fold(0.0, f64::max);
    let error = fine.iter().zip(&coarse).map(apart).fold(0.0, f64::max);
    Some((fine, error))
}
