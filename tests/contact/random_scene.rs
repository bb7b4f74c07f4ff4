//! Random loads, springs and obstacles.

use std::f64::consts::{PI, TAU};

use cohaul::backend::{BackendKind, BackendOptions, Integrator, Tolerance};
use cohaul::math::{Pose, RandomStreams, Stream, Twist, Vec2, direction};
use cohaul::model::geometry::overlap_depth;
use cohaul::model::{Ground, Load, Motion, Obstacle, ObstaclePath, Outline, OutlinePart, PolarSpring, SupportPoint, System, World};

/// Draws of one scene.
struct Draws {
    streams: RandomStreams,
    n: u64,
}

impl Draws {
    fn unit(&mut self) -> f64 {
        self.n += 1;
        self.streams.uniform(Stream::Scene, 0, self.n)
    }

    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    fn below(&mut self, n: usize) -> usize {
        ((n as f64) * self.unit()) as usize % n
    }

    fn is(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    fn point(&mut self, radius: f64) -> Vec2 {
        radius * self.unit().sqrt() * direction(TAU * self.unit())
    }
}

/// A scene in units of the load: lengths of its size, forces of its slip limit.
pub struct Scene {
    pub system: System,
    pub start: Motion,
    /// Whether each spring is attached at the start.
    pub attached: Vec<bool>,
    /// Waypoints of each tip, relative to its rest.
    pub waypoints: Vec<Vec<Vec2>>,
    /// Number of advances and their duration (s).
    pub n_advances: usize,
    pub duration: f64,
    /// Size of the load (m) and its slip limit (N), roughly.
    pub scale: f64,
    pub force: f64,
    /// Number of long walls, the first obstacles: the load must stay on its side of each.
    pub n_long: usize,
}

fn polygon(corners: impl IntoIterator<Item = Vec2>) -> OutlinePart {
    OutlinePart::Polygon { corners: corners.into_iter().collect() }
}

fn block([a, b]: [f64; 2], about: Vec2) -> OutlinePart {
    polygon([[-a, -b], [a, -b], [a, b], [-a, b]].map(|corner| about + Vec2::from(corner)))
}

/// An L whose centre of area lies near the origin.
fn angle(size: f64) -> OutlinePart {
    let corners = [[-0.6, -0.6], [0.9, -0.6], [0.9, -0.1], [-0.1, -0.1], [-0.1, 0.9], [-0.6, 0.9]];
    polygon(corners.map(|corner| size * Vec2::from(corner)))
}

/// A star with concave corners.
fn star(draws: &mut Draws, size: f64) -> OutlinePart {
    let n = 3 + draws.below(4);
    polygon((0..2 * n).map(|k| if k % 2 == 0 { size } else { 0.45 * size } * direction(PI * k as f64 / n as f64)))
}

fn load_outline(draws: &mut Draws) -> Outline {
    let parts = match draws.below(4) {
        0 => vec![OutlinePart::Disc { centre: Vec2::zeros(), radius: 1.0 }],
        1 => vec![block([draws.between(0.4, 0.9), draws.between(0.3, 0.6)], Vec2::zeros())],
        2 => vec![angle(1.0)],
        _ => vec![block([0.7, 0.2], Vec2::zeros()), OutlinePart::Disc { centre: Vec2::new(0.7, 0.0), radius: draws.between(0.21, 0.4) }],
    };
    Outline { parts }
}

fn obstacle_part(draws: &mut Draws) -> OutlinePart {
    let size = draws.between(0.1, 1.0);
    match draws.below(5) {
        0 => OutlinePart::Disc { centre: Vec2::zeros(), radius: size },
        1 => block([size, draws.between(0.1, 1.0)], Vec2::zeros()),
        2 => star(draws, size),
        3 => angle(size),
        _ => {
            let mut points = vec![Vec2::zeros()];
            for _ in 0..1 + draws.below(3) {
                let next = points[points.len() - 1] + draws.between(0.3, 2.0) * direction(draws.between(-1.0, 1.0));
                points.push(next);
            }
            OutlinePart::Polyline { points }
        }
    }
}

fn obstacle(draws: &mut Draws, is_long: bool) -> Obstacle {
    let outline = if is_long {
        Outline { parts: vec![OutlinePart::Polyline { points: vec![Vec2::new(-40.0, 0.0), Vec2::new(40.0, 0.0)] }] }
    } else {
        Outline { parts: vec![obstacle_part(draws)] }
    };
    let position = draws.between(0.8, 5.0) * direction(TAU * draws.unit());
    let pose = Pose { position, heading: TAU * draws.unit() };
    let mut waypoints = vec![(0.0, pose)];
    if !is_long && draws.is(0.25) {
        for _ in 0..3 {
            let (time, last) = waypoints[waypoints.len() - 1];
            // Toward the load, or anywhere.
            let aim = if draws.is(0.5) { -0.5 * last.position } else { draws.point(2.0) };
            let heading = last.heading + if draws.is(0.5) { draws.between(-1.0, 1.0) } else { 0.0 };
            waypoints.push((time + draws.between(0.1, 0.6), Pose { position: last.position + aim, heading }));
        }
    }
    Obstacle {
        name: "obstacle".into(),
        outline,
        friction_coefficient: if draws.is(0.3) { 0.0 } else { draws.between(0.0, 2.0) },
        restitution: if draws.is(0.4) { 0.0 } else { draws.between(0.0, 0.9) },
        path: ObstaclePath { waypoints },
    }
}

fn spring(draws: &mut Draws) -> PolarSpring {
    let root = draws.point(0.5);
    let stiffness = 0.37 * 10f64.powf(draws.between(-0.5, 1.0));
    if draws.is(0.5) {
        return PolarSpring { root, radial_stiffness: stiffness, ..PolarSpring::default() };
    }
    let (bearing, rest_length) = (TAU * draws.unit(), draws.between(1.0, 2.5));
    let torsional_stiffness = stiffness * draws.between(0.5, 5.0);
    PolarSpring { root, bearing, rest_length, radial_stiffness: stiffness, torsional_stiffness, ..PolarSpring::default() }
}

fn scaled_part(part: &OutlinePart, scale: f64) -> OutlinePart {
    match part {
        OutlinePart::Disc { centre, radius } => OutlinePart::Disc { centre: scale * centre, radius: scale * radius },
        OutlinePart::Polygon { corners } => OutlinePart::Polygon { corners: corners.iter().map(|corner| scale * corner).collect() },
        OutlinePart::Polyline { points } => OutlinePart::Polyline { points: points.iter().map(|point| scale * point).collect() },
    }
}

fn scaled_outline(outline: &Outline, scale: f64) -> Outline {
    Outline { parts: outline.parts.iter().map(|part| scaled_part(part, scale)).collect() }
}

fn scaled_pose(pose: &Pose, scale: f64) -> Pose {
    Pose { position: scale * pose.position, heading: pose.heading }
}

impl Scene {
    /// The scene of this seed.
    pub fn new(seed: u64) -> Self {
        let mut draws = Draws { streams: RandomStreams::new(seed), n: 0 };
        let draws = &mut draws;
        let outline = load_outline(draws);
        let start = Pose::new(0.0, 0.0, TAU * draws.unit());
        let n_obstacles = 1 + draws.below(20);
        let n_long = if draws.is(0.4) { 1 + draws.below(3) } else { 0 };
        let mut obstacles: Vec<Obstacle> = Vec::new();
        while obstacles.len() < n_obstacles.max(n_long) {
            let is_long = obstacles.len() < n_long;
            let one = obstacle(draws, is_long);
            let near = Outline { parts: vec![OutlinePart::Disc { centre: Vec2::zeros(), radius: 1.001 * outline.extent() }] };
            let is_close = overlap_depth(&near, &start, &one.outline, &one.path.pose_at(0.0)).is_some();
            if overlap_depth(&outline, &start, &one.outline, &one.path.pose_at(0.0)).is_none() && !(is_close && draws.is(0.5)) {
                obstacles.push(one);
            }
        }
        let scale = 10f64.powf(if draws.is(0.5) { -2.0 } else { draws.between(-6.0, 3.0) });
        let force = 10f64.powf(if draws.is(0.5) { -2.0 } else { draws.between(-6.0, 4.0) });
        let n_supports = 3 + draws.below(4);
        let supports = (0..n_supports)
            .map(|k| SupportPoint {
                offset: scale * 0.4 * direction(TAU * k as f64 / n_supports as f64),
                normal_load: force / n_supports as f64,
                friction_coefficient: None,
            })
            .collect();
        let springs: Vec<PolarSpring> = (0..1 + draws.below(4)).map(|_| spring(draws)).collect();
        let attached = springs.iter().map(|_| draws.is(0.85)).collect();
        let waypoints =
            springs.iter().map(|_| (0..4).map(|k| if k == 0 { draws.point(0.2) } else { draws.point(8.0) }).collect()).collect();
        // A slip limit of one in units of the force: a load that slides half its size in 0.1 s.
        let mass = force / (scale * 40.0);
        let unit = force / scale;
        let springs = springs
            .into_iter()
            .map(|spring| PolarSpring {
                root: scale * spring.root,
                rest_length: scale * spring.rest_length,
                radial_stiffness: unit * spring.radial_stiffness,
                torsional_stiffness: unit * scale * scale * spring.torsional_stiffness,
                ..spring
            })
            .collect();
        for obstacle in &mut obstacles {
            obstacle.outline = scaled_outline(&obstacle.outline, scale);
            obstacle.path.waypoints.iter_mut().for_each(|(_, pose)| *pose = scaled_pose(pose, scale));
        }
        let outline = scaled_outline(&outline, scale);
        let radius = outline.extent();
        let system = System {
            load: Load { mass, inertia: 0.5 * mass * radius * radius, radius },
            ground: Ground { friction_coefficient: draws.between(0.3, 1.5), supports },
            springs,
            world: World { outline, obstacles },
        };
        let start = Motion { pose: scaled_pose(&start, scale), twist: Twist::ZERO };
        Self { system, start, attached, waypoints, n_advances: 30, duration: 1.0 / 30.0, scale, force, n_long }
    }

    /// Place of a tip (m) at a share of the run.
    pub fn tip(&self, spring: usize, share: f64) -> Vec2 {
        let points = &self.waypoints[spring];
        let at = share * (points.len() - 1) as f64;
        let k = (at as usize).min(points.len() - 2);
        let offset = points[k] + (at - k as f64) * (points[k + 1] - points[k]);
        self.start.pose.to_world(&self.system.springs[spring].rest_tip()) + self.scale * offset
    }

    /// Steps of first order, of second order, or under error control.
    pub fn options(&self, kind: BackendKind, way: usize) -> BackendOptions {
        match way {
            0 => BackendOptions { integrator: Integrator::Euler, second_order: false, ..BackendOptions::new(kind, self.duration / 4.0) },
            1 => BackendOptions { integrator: Integrator::Midpoint, second_order: true, ..BackendOptions::new(kind, self.duration / 4.0) },
            _ => BackendOptions::within(kind, Tolerance::at_edge(1e-4 * self.scale, &self.system.load)),
        }
    }

    /// Places of all tips (m) at a share of the run.
    pub fn targets(&self, share: f64) -> Vec<Vec2> {
        (0..self.system.springs.len()).map(|spring| self.tip(spring, share)).collect()
    }
}
