//! Bodies, springs and runs that the claims share.

use cohaul::backend::rapier::{FrictionModel, RapierOptions};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, build};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{Ground, Load, PolarSpring, SupportPoint, System, World};

pub const GRAVITY: f64 = 9.81;
pub const MU: f64 = 1.4;
pub const MASS: f64 = 0.0016;
/// mu m g (N).
pub const SLIP_LIMIT: f64 = MU * MASS * GRAVITY;

/// The body on which engines are compared: a disc of 38.5 mm on three supports at 20 mm.
pub fn peers_body() -> System {
    tripod(0.0385, 0.02)
}

/// The paper's load: a hub of 12.2 mm on three supports at two thirds of it.
pub fn paper_body() -> System {
    tripod(0.0122, 2.0 * 0.0122 / 3.0)
}

fn tripod(radius: f64, support_radius: f64) -> System {
    let supports = [90.0f64, 210.0, 330.0].map(|angle| SupportPoint {
        offset: support_radius * direction(angle.to_radians()),
        normal_load: MASS * GRAVITY / 3.0,
        friction_coefficient: None,
    });
    System {
        load: Load { mass: MASS, inertia: 0.5 * MASS * radius * radius, radius },
        ground: Ground { friction_coefficient: MU, supports: supports.to_vec() },
        springs: Vec::new(),
        world: World::default(),
    }
}

/// The isotropic spring of the test scenes.
pub fn isotropic(root: Vec2) -> PolarSpring {
    PolarSpring { root, radial_stiffness: 0.664, ..PolarSpring::default() }
}

/// The paper's spring at this bearing of its hub.
pub fn polar(bearing: f64) -> PolarSpring {
    PolarSpring {
        root: 0.0122 * direction(bearing),
        bearing,
        rest_length: 0.0263,
        radial_stiffness: 0.664,
        torsional_stiffness: 4.52e-4,
        ..PolarSpring::default()
    }
}

pub fn at_rest(pose: Pose) -> Motion {
    Motion { pose, twist: Twist::ZERO }
}

pub fn moving(velocity: Vec2, turn_rate: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: velocity, angular: turn_rate } }
}

pub fn backend(system: &System, start: Motion, step_s: f64, rapier: RapierOptions) -> Box<dyn Backend> {
    build(system, start, &BackendOptions { rapier, ..BackendOptions::new(BackendKind::Rapier, step_s) })
}

pub fn with_friction(friction: FrictionModel) -> RapierOptions {
    RapierOptions { friction, ..RapierOptions::default() }
}

/// The paper's load with three of its springs.
pub fn busy_system(damping_ratio: f64) -> System {
    let springs = [0.0, 2.0, 4.5].map(|bearing| PolarSpring { damping_ratio, ..polar(bearing) });
    System { springs: springs.to_vec(), ..paper_body() }
}

/// Tips of [`busy_system`] that wander about and out to the right.
pub fn busy_tips(time: f64) -> Vec<Vec2> {
    let system = busy_system(0.0);
    let paths = system.springs.iter().zip([5.0, 7.0, 9.0]);
    paths.map(|(spring, rate)| spring.rest_tip() + Vec2::new(0.05 * time, 0.0) + 0.01 * direction(rate * time)).collect()
}
