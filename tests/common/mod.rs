//! Loads, springs and drives that several tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::f64::consts::PI;
use std::ops::{Add, Mul, Sub};

use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, StepReport, build};
use cohaul::math::{Pose, Twist, Vec2, Vec3, direction};
use cohaul::model::{Ground, Load, PolarSpring, SupportPoint, System};

pub const GRAVITY: f64 = 9.81;
pub const MU: f64 = 1.4;
pub const MASS: f64 = 1.6e-3;
/// mu m g (N).
pub const SLIP_LIMIT: f64 = MU * MASS * GRAVITY;
pub const RADIAL: f64 = 0.664;
pub const TORSIONAL: f64 = 4.52e-4;
/// R_L and l_0 (m).
pub const LOAD_RADIUS: f64 = 0.0122;
pub const REST_LENGTH: f64 = 0.0263;
/// a: supports of the paper's load from its centre (m).
pub const SUPPORT_RADIUS: f64 = 2.0 * LOAD_RADIUS / 3.0;

pub const WITH_INERTIA: [BackendKind; 2] = [BackendKind::Inertial, BackendKind::Rapier];

/// Three supports at 90, 210 and 330 degrees that share `total` (N) of normal load.
pub fn tripod(radius: f64, total: f64) -> Vec<SupportPoint> {
    [PI / 2.0, 7.0 * PI / 6.0, 11.0 * PI / 6.0]
        .map(|angle| SupportPoint { offset: radius * direction(angle), normal_load: total / 3.0 })
        .to_vec()
}

/// The paper's load on `springs`, with its inertia and friction.
pub fn paper_system(springs: Vec<PolarSpring>) -> System {
    System {
        load: Load { mass: MASS, inertia: 0.5 * MASS * LOAD_RADIUS * LOAD_RADIUS, radius: LOAD_RADIUS },
        ground: Ground { friction_coefficient: MU, supports: tripod(SUPPORT_RADIUS, MASS * GRAVITY) },
        springs,
    }
}

/// n of the paper's springs, evenly spaced from bearing zero.
pub fn paper_springs(n: usize) -> Vec<PolarSpring> {
    let spring = |j: usize| {
        let bearing = 2.0 * PI * j as f64 / n as f64;
        PolarSpring {
            root: LOAD_RADIUS * direction(bearing),
            bearing,
            rest_length: REST_LENGTH,
            radial_stiffness: RADIAL,
            torsional_stiffness: TORSIONAL,
            damping_ratio: 0.0,
        }
    };
    (0..n).map(spring).collect()
}

/// An isotropic spring of the paper's radial stiffness, rooted at `root`.
pub fn isotropic(root: Vec2, damping_ratio: f64) -> PolarSpring {
    PolarSpring { root, bearing: 0.0, rest_length: 0.0, radial_stiffness: RADIAL, torsional_stiffness: 0.0, damping_ratio }
}

/// The load of the comparison with other engines: disc of radius 38.5 mm, supports at 20 mm.
pub fn peers_system(springs: Vec<PolarSpring>) -> System {
    let radius = 0.0385;
    System {
        load: Load { mass: MASS, inertia: 0.5 * MASS * radius * radius, radius },
        ground: Ground { friction_coefficient: MU, supports: tripod(0.02, MASS * GRAVITY) },
        springs,
    }
}

pub fn at_rest() -> Motion {
    moving(0.0, 0.0, 0.0)
}

pub fn moving(vx: f64, vy: f64, turn_rate: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::new(vx, vy), angular: turn_rate } }
}

pub fn backend(kind: BackendKind, system: &System, start: Motion, step: f64) -> Box<dyn Backend> {
    build(system, start, &BackendOptions::new(kind, step))
}

/// Drives the tips of springs 0, 1 ... along `path(t)` through `n` equal pieces up to `duration` (s); grasps at the first point. After each piece
/// `watch` sees the time and the backend.
pub fn drive(
    backend: &mut dyn Backend,
    path: impl Fn(f64) -> Vec<(usize, Vec2)>,
    duration: f64,
    n: u32,
    mut watch: impl FnMut(f64, &mut dyn Backend),
) -> StepReport {
    let mut report = StepReport::default();
    let n_springs = path(0.0).iter().map(|(spring, _)| spring + 1).max().unwrap_or(0);
    for (spring, tip) in path(0.0) {
        backend.grasp(spring, tip);
    }
    for i in 1..=n {
        let time = duration * f64::from(i) / f64::from(n);
        // What a free spring's entry holds must not matter.
        let mut targets = vec![Vec2::new(f64::NAN, f64::NAN); n_springs];
        for (spring, tip) in path(time) {
            targets[spring] = tip;
        }
        report.add(&backend.advance(&targets, duration / f64::from(n)));
        watch(time, backend);
    }
    report
}

/// The tips of the reference scene QS-REF-1 at s in [0, 1].
pub fn reference_tips(s: f64) -> Vec<(usize, Vec2)> {
    let reach = LOAD_RADIUS + REST_LENGTH;
    vec![
        (0, Vec2::new(reach + 0.06 * s, 0.02 * (3.0 * s).sin())),
        (1, Vec2::new(0.03 * s, reach + 0.02 * s - 0.01 * s * s)),
        (3, Vec2::new(0.045 * s + 0.01 * (4.0 * s).sin(), -reach - 0.01 * s)),
    ]
}

/// The value at step zero from values at a step, its half, its quarter ... (Romberg's table), where errors are a series in whole powers
/// of the step.
pub fn extrapolated<T>(values: &[T]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let mut column = values.to_vec();
    let mut weight = 2.0;
    while column.len() > 1 {
        column = column.windows(2).map(|pair| pair[1] + (pair[1] - pair[0]) * (1.0 / (weight - 1.0))).collect();
        weight *= 2.0;
    }
    column[0]
}

/// (x, y, heading) of a pose (m, m, rad).
pub fn entries(pose: &Pose) -> Vec3 {
    Vec3::new(pose.position.x, pose.position.y, pose.heading)
}

/// How far apart two poses are: the largest of shift and turn of a support (m).
pub fn distance(one: &Pose, other: &Pose) -> f64 {
    (one.position - other.position).norm().max(SUPPORT_RADIUS * (one.heading - other.heading).abs())
}

/// Error at a step over the error at its half: 2 for a method of first order.
pub fn error_ratio(coarse: f64, fine: f64, exact: f64) -> f64 {
    (coarse - exact) / (fine - exact)
}
