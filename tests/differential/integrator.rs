//! An independent solution with inertia, for scenes without restitution.
//!
//! It shares nothing with the backends. Obstacles are stiff springs with strong dashpots that push
//! points of the load out, and Coulomb's friction is a smooth function of the slip velocity:
//!
//! ```text
//! N = max(0, k depth + c d(depth)/dt),    F = -mu N v / sqrt(v^2 + e^2)
//! ```
//!
//! A Rosenbrock method of second order (Shampine and Reichelt 1997, ode23s) with error control
//! solves the equations of motion. The limit of a rigid obstacle and of Coulomb's law is
//! extrapolated from two solutions with different k, c and e.

use nalgebra::{SMatrix, SVector};

use crate::scene::{Body, Part, Point, Scene};

type State = SVector<f64, 6>;
type Matrix = SMatrix<f64, 6, 6>;

/// Depth at which a contact carries the weight of the load, over the size (1).
const DEPTH: f64 = 2e-7;
/// Slip velocity at which friction is 0.7 of Coulomb's (m/s).
const SLIP: f64 = 2e-6;
/// Damping ratio of contacts (1): a load rebounds with about 1 / (4 ratio^2) of its speed.
const DAMPING: f64 = 16.0;
/// Error of a step: positions over the size and headings, and velocities (1, m/s).
const POSITION_ERROR: f64 = 1e-9;
const VELOCITY_ERROR: f64 = 1e-6;
/// Shortest and first step (s).
const SHORTEST: f64 = 1e-13;
const FIRST: f64 = 1e-6;
/// Largest number of steps: beyond it a scene is given up.
const MOST_STEPS: usize = 400_000;

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

/// An instant (s), and one inside of the step that it belongs to.
#[derive(Clone, Copy)]
struct Instant {
    time: f64,
    inside: f64,
}

/// Values along waypoints, and their rates: straight between them and constant outside.
fn along<const N: usize, const M: usize>(path: &[[f64; N]], Instant { time, inside }: Instant) -> ([f64; M], [f64; M]) {
    let value = |at: usize| std::array::from_fn(|k| path[at][k + 1]);
    let next = path.partition_point(|waypoint| waypoint[0] <= inside);
    if next == 0 || next == path.len() {
        return (value(next.saturating_sub(1)), [0.0; M]);
    }
    let (a, b): ([f64; M], [f64; M]) = (value(next - 1), value(next));
    let span = path[next][0] - path[next - 1][0];
    let share = (time - path[next - 1][0]) / span;
    (std::array::from_fn(|k| a[k] + share * (b[k] - a[k])), std::array::from_fn(|k| (b[k] - a[k]) / span))
}

/// The equations of motion of a scene.
struct Equations<'a> {
    scene: &'a Scene,
    load: Vec<Shape>,
    obstacles: Vec<(&'a Body, Vec<Shape>)>,
    stiffness: f64,
    damping: f64,
    slip: f64,
    size: f64,
}

impl<'a> Equations<'a> {
    /// Contacts of `softness` times the depth and the rebound, and friction of `softness` times the
    /// slip: all errors are proportional to it.
    fn new(scene: &'a Scene, softness: f64) -> Self {
        let size = scene.size();
        let stiffness = scene.mass * crate::scene::GRAVITY / (softness * DEPTH * size);
        let shapes = |parts: &[Part]| parts.iter().map(Shape::of).collect();
        Self {
            scene,
            load: shapes(&scene.load),
            obstacles: scene.obstacles.iter().map(|body| (body, shapes(&body.parts))).collect(),
            stiffness,
            damping: 2.0 * DAMPING * (stiffness * scene.mass / softness).sqrt(),
            slip: softness * SLIP,
            size,
        }
    }

    /// Friction of a normal load at a slip velocity (N).
    fn friction(&self, limit: f64, velocity: Point) -> Point {
        times(-limit / (dot(velocity, velocity) + self.slip * self.slip).sqrt(), velocity)
    }

    /// Rates of pose and velocity.
    fn rates(&self, time: Instant, state: &State) -> State {
        let pose = [state[0], state[1], state[2]];
        let (linear, rate) = ([state[3], state[4]], state[5]);
        let velocity_at = |arm: Point| [linear[0] - rate * arm[1], linear[1] + rate * arm[0]];
        let (mut force, mut torque) = ([0.0; 2], 0.0);
        let mut push = |arm: Point, one: Point| {
            force = [force[0] + one[0], force[1] + one[1]];
            torque += cross(arm, one);
        };
        let turned = |offset: Point| placed([0.0, 0.0, pose[2]], offset);
        for (offset, normal_load) in &self.scene.supports {
            let arm = turned(*offset);
            push(arm, self.friction(self.scene.ground_friction * normal_load, velocity_at(arm)));
        }
        for spring in &self.scene.springs {
            let (arm, (tip, _)) = (turned(spring.root), along::<3, 2>(&spring.path, time));
            push(arm, times(spring.stiffness, sub(sub(tip, [pose[0], pose[1]]), arm)));
        }
        let load: Vec<Shape> = self.load.iter().map(|shape| shape.at(pose)).collect();
        let mut touching = Vec::new();
        for (body, shapes) in &self.obstacles {
            let (at, [u, v, turn]) = along::<4, 3>(&body.path, time);
            for obstacle in shapes.iter().map(|shape| shape.at(at)) {
                load.iter().for_each(|shape| contacts(shape, &obstacle, &mut touching));
            }
            for Contact { point, normal, depth } in touching.drain(..) {
                let (arm, from) = (sub(point, [pose[0], pose[1]]), sub(point, [at[0], at[1]]));
                let relative = sub(velocity_at(arm), [u - turn * from[1], v + turn * from[0]]);
                let pressing = (self.stiffness * depth - self.damping * dot(normal, relative)).max(0.0);
                let tangent = [-normal[1], normal[0]];
                let sliding = self.friction(body.friction * pressing, times(dot(tangent, relative), tangent));
                push(arm, [pressing * normal[0] + sliding[0], pressing * normal[1] + sliding[1]]);
            }
        }
        let (mass, inertia) = (self.scene.mass, self.scene.inertia);
        State::from([linear[0], linear[1], rate, force[0] / mass, force[1] / mass, torque / inertia])
    }

    fn jacobian(&self, time: Instant, state: &State, rates: &State) -> Matrix {
        let mut jacobian = Matrix::zeros();
        for k in 0..6 {
            // A hundredth of the depth or of the slip at which forces change.
            let change = if k < 3 { 0.01 * DEPTH * if k < 2 { self.size } else { 1.0 } } else { 0.01 * self.slip };
            let mut other = *state;
            other[k] += change;
            jacobian.set_column(k, &((self.rates(time, &other) - rates) / change));
        }
        jacobian
    }

    /// A step of length `h` (s), and its error over what is allowed (1).
    fn step(&self, time: f64, state: &State, h: f64) -> (State, f64) {
        let (d, e32) = (1.0 / (2.0 + 2f64.sqrt()), 6.0 + 2f64.sqrt());
        let at = |share: f64| Instant { time: time + share * h, inside: time + 0.5 * h };
        let first = self.rates(at(0.0), state);
        let in_time = (self.rates(at(1e-3), state) - first) / (1e-3 * h);
        let lu = (Matrix::identity() - h * d * self.jacobian(at(0.0), state, &first)).lu();
        let solve = |right: State| lu.solve(&right).unwrap_or_else(|| State::repeat(f64::NAN));
        let k1 = solve(first + h * d * in_time);
        let middle = self.rates(at(0.5), &(state + 0.5 * h * k1));
        let k2 = solve(middle - k1) + k1;
        let next = state + h * k2;
        let last = self.rates(at(1.0), &next);
        let k3 = solve(last - e32 * (k2 - middle) - 2.0 * (k1 - first) + h * d * in_time);
        let error = h / 6.0 * (k1 - 2.0 * k2 + k3);
        let (position, velocity) = (POSITION_ERROR * self.size, VELOCITY_ERROR);
        let allowed = [position, position, POSITION_ERROR, velocity, velocity, velocity / self.size];
        let share = (0..6).map(|k| (error[k] / allowed[k]).abs()).fold(0.0, |a, b| if b <= a { a } else { b });
        (next, share)
    }

    /// Poses at these instants (s); `None` where that takes too many steps.
    fn poses(&self, instants: &[f64]) -> Option<Vec<[f64; 3]>> {
        let ([x, y, heading], [u, v, rate]) = (self.scene.start, self.scene.velocity);
        let (mut state, mut time, mut h) = (State::from([x, y, heading, u, v, rate]), 0.0, FIRST);
        let (mut poses, mut n_steps) = (vec![self.scene.start], 0);
        for until in &instants[1..] {
            while time < *until {
                n_steps += 1;
                let left = until - time;
                let is_last = 1.01 * h >= left;
                let step = if is_last { left } else { h };
                let (next, error) = self.step(time, &state, step);
                let factor = if error.is_finite() { (0.8 * error.powf(-1.0 / 3.0)).clamp(0.2, 3.0) } else { 0.1 };
                let is_accepted = error <= 1.0;
                if is_accepted {
                    (state, time) = (next, if is_last { *until } else { time + step });
                }
                h = if is_accepted && is_last { h.max(step * factor) } else { step * factor };
                if h < SHORTEST || n_steps > MOST_STEPS {
                    return None;
                }
            }
            poses.push([state[0], state[1], state[2]]);
        }
        Some(poses)
    }
}

/// Poses of a scene at the ends of its control periods, extrapolated to rigid contacts and
/// Coulomb's friction, and their error over the size (1); `None` where the solution takes too many
/// steps.
///
/// Waypoints must lie at ends of control periods.
pub fn solve(scene: &Scene) -> Option<(Vec<[f64; 3]>, f64)> {
    let n = (scene.duration / scene.control_period).round() as u32;
    let instants: Vec<f64> = (0..=n).map(|k| f64::from(k) * scene.control_period).collect();
    let soft = Equations::new(scene, 2.0).poses(&instants)?;
    let stiff = Equations::new(scene, 1.0).poses(&instants)?;
    let size = [scene.size(), scene.size(), 1.0];
    let mut error: f64 = 0.0;
    let mut extrapolated = Vec::new();
    for (a, b) in stiff.iter().zip(&soft) {
        extrapolated.push(std::array::from_fn(|k| 2.0 * a[k] - b[k]));
        error = (0..3).map(|k| (a[k] - b[k]).abs() / size[k]).fold(error, f64::max);
    }
    Some((extrapolated, error))
}
