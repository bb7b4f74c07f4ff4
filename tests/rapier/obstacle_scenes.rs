//! Loads among obstacles, and runs of them.

use cohaul::backend::rapier::RapierOptions;
use cohaul::backend::{Backend, Motion, StepReport};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{Obstacle, ObstaclePath, Outline, OutlinePart, System, World};

use crate::scenes::{at_rest, backend, isotropic, paper_body};

/// Radius of the paper's load (m).
pub const RADIUS: f64 = 0.0122;
/// Half sizes of the box of the known answers (m).
pub const BOX: Vec2 = Vec2::new(0.0122, 0.008);

pub fn polygon(corners: &[[f64; 2]]) -> Outline {
    Outline { parts: vec![OutlinePart::Polygon { corners: corners.iter().map(|[x, y]| Vec2::new(*x, *y)).collect() }] }
}

/// The box of the known answers.
pub fn box_outline() -> Outline {
    let (x, y) = (BOX.x, BOX.y);
    polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]])
}

/// A straight wall between two points (m).
pub fn wall(from: [f64; 2], to: [f64; 2]) -> Outline {
    Outline { parts: vec![OutlinePart::Polyline { points: vec![from.into(), to.into()] }] }
}

/// A wall without friction and restitution that stands still.
pub fn standing(outline: Outline) -> Obstacle {
    let path = ObstaclePath::fixed(Pose::new(0.0, 0.0, 0.0));
    Obstacle { name: "obstacle".to_owned(), outline, friction_coefficient: 0.0, restitution: 0.0, path }
}

/// The paper's load with one isotropic spring at `root` (m).
pub fn on_a_spring(root: Vec2, outline: Outline, obstacles: Vec<Obstacle>) -> System {
    System { springs: vec![isotropic(root)], world: World { outline, obstacles }, ..paper_body() }
}

/// The paper's load without springs.
pub fn without_springs(outline: Outline, obstacles: Vec<Obstacle>) -> System {
    System { world: World { outline, obstacles }, ..paper_body() }
}

/// The same system with a thousandth of the inertia, under the same normal loads. With numerical
/// damping, the load follows its tip as one without inertia would.
pub fn light(mut system: System) -> System {
    system.load.mass *= 1e-3;
    system.load.inertia *= 1e-3;
    system
}

/// A run with one tip along a path over s from 0 to 1.
pub struct Run {
    pub load: Box<dyn Backend>,
    /// Report of all advances.
    pub report: StepReport,
}

/// Number of advances in a run.
pub const N_TICKS: usize = 400;

/// Moves the tip along `path` (m) within `duration` (s), from a load at rest at `start`.
pub fn run(system: &System, start: Pose, options: RapierOptions, duration: f64, step: f64, path: impl Fn(f64) -> Vec2) -> Run {
    let mut load = backend(system, at_rest(start), step, options);
    load.attach(0, path(0.0));
    let mut report = StepReport::default();
    for tick in 1..=N_TICKS {
        report.add(&load.advance(&[path(tick as f64 / N_TICKS as f64)], duration / N_TICKS as f64));
    }
    Run { load, report }
}

/// Lets a load without springs move for `duration` (s).
pub fn let_go(system: &System, start: Motion, options: RapierOptions, duration: f64, step: f64) -> Run {
    let mut load = backend(system, start, step, options);
    let report = load.advance(&[], duration);
    Run { load, report }
}
