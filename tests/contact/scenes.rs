//! Scenes with obstacles: the paper's load on an isotropic spring at its centre.

use std::f64::consts::{PI, TAU};

use cohaul::backend::{Backend, BackendKind, BackendOptions, StepReport, Tolerance, build};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{Ground, Load, Motion, Obstacle, ObstaclePath, Outline, OutlinePart, PolarSpring, SupportPoint, System, World};

/// Mass (kg), radius (m), stiffness (N/m), friction of the ground (1) and gravity (m/s^2).
pub const MASS: f64 = 1.6e-3;
pub const RADIUS: f64 = 0.0122;
pub const STIFFNESS: f64 = 0.664;
pub const MU: f64 = 1.4;
pub const GRAVITY: f64 = 9.81;
/// Slip limit f (N).
pub const LIMIT: f64 = MU * MASS * GRAVITY;
/// f / k (m).
pub const BEHIND: f64 = LIMIT / STIFFNESS;
/// Half sizes of the box (m).
pub const BOX: [f64; 2] = [0.0122, 0.008];

/// An isotropic spring whose root is `root` (m, load axes).
pub fn spring(root: Vec2) -> PolarSpring {
    PolarSpring { root, radial_stiffness: STIFFNESS, ..PolarSpring::default() }
}

fn system(outline: Outline, obstacles: Vec<Obstacle>, springs: Vec<PolarSpring>) -> System {
    let supports = [0.0, 1.0, 2.0].map(|third| SupportPoint {
        offset: 2.0 * RADIUS / 3.0 * direction(0.5 * PI + third * TAU / 3.0),
        normal_load: MASS * GRAVITY / 3.0,
        friction_coefficient: None,
    });
    System {
        load: Load { mass: MASS, inertia: 0.5 * MASS * RADIUS * RADIUS, radius: outline.extent() },
        ground: Ground { friction_coefficient: MU, supports: supports.to_vec() },
        springs,
        world: World { outline, obstacles },
    }
}

pub fn disc(obstacles: Vec<Obstacle>) -> System {
    system(Outline::disc(RADIUS), obstacles, vec![spring(Vec2::zeros())])
}

pub fn boxed(obstacles: Vec<Obstacle>, root: Vec2) -> System {
    let [a, b] = BOX;
    let corners = [[-a, -b], [a, -b], [a, b], [-a, b]].map(Vec2::from).to_vec();
    system(Outline { parts: vec![OutlinePart::Polygon { corners }] }, obstacles, vec![spring(root)])
}

/// A fixed obstacle.
pub fn obstacle(part: OutlinePart, friction_coefficient: f64) -> Obstacle {
    Obstacle {
        name: "obstacle".into(),
        outline: Outline { parts: vec![part] },
        friction_coefficient,
        restitution: 0.0,
        path: ObstaclePath::fixed(Pose::new(0.0, 0.0, 0.0)),
    }
}

/// A long wall through `at` (m) along `along`.
pub fn wall(at: Vec2, along: Vec2, friction_coefficient: f64) -> Obstacle {
    obstacle(OutlinePart::Polyline { points: vec![at - along, at + along] }, friction_coefficient)
}

/// A round post.
pub fn post(centre: Vec2, radius: f64) -> Obstacle {
    obstacle(OutlinePart::Disc { centre, radius }, 0.0)
}

pub fn at_rest(x: f64, y: f64) -> Motion {
    Motion { pose: Pose::new(x, y, 0.0), twist: Twist::ZERO }
}

/// A run of one tip along `path` over a second, in `n` advances.
pub fn drive(
    system: &System,
    start: Motion,
    options: &BackendOptions,
    n: u32,
    path: impl Fn(f64) -> Vec2,
) -> (Box<dyn Backend>, StepReport) {
    let mut load = build(system, start, options);
    load.attach(0, path(0.0));
    let mut report = StepReport::default();
    for tick in 1..=n {
        let share = f64::from(tick) / f64::from(n);
        report.add(&load.advance(&[path(share)], 1.0 / f64::from(n)));
    }
    (load, report)
}

pub fn fixed(kind: BackendKind, n: u32) -> BackendOptions {
    BackendOptions::new(kind, 1.0 / f64::from(n))
}

pub fn exact(kind: BackendKind, system: &System, tolerance: f64) -> BackendOptions {
    BackendOptions::within(kind, Tolerance::at_edge(tolerance, &system.load))
}
