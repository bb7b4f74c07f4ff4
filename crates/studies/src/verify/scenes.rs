//! Loads, springs and tips that cases share.

use std::f64::consts::PI;

use crate::subject::Runs;
use cohaul::backend::{Backend, BackendOptions, Motion, StepReport, Tolerance, n_steps_in};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{Ground, Load, PolarSpring, SupportPoint, System, World, paper};

/// (m/s^2)
pub const GRAVITY: f64 = 9.81;
/// Coefficient of friction, mu (1).
pub const MU: f64 = paper::FRICTION_COEFFICIENT;
/// Mass of the paper's load (kg).
pub const MASS: f64 = paper::LOAD_MASS_KG;
/// mu m g (N).
pub const SLIP_LIMIT: f64 = MU * MASS * GRAVITY;
/// Radial stiffness of the paper's springs (N/m).
pub const RADIAL: f64 = paper::RADIAL_STIFFNESS_N_PER_M;
/// Torsional stiffness of the paper's springs (N m/rad).
pub const TORSIONAL: f64 = paper::TORSIONAL_STIFFNESS_NM_PER_RAD;
/// Radius of the paper's load (m).
pub const LOAD_RADIUS: f64 = paper::LOAD_RADIUS_M;
/// Rest length of the paper's springs (m).
pub const REST_LENGTH: f64 = paper::REST_LENGTH_M;
/// Supports of the paper's load from its centre (m).
pub const SUPPORT_RADIUS: f64 = 2.0 * LOAD_RADIUS / 3.0;
/// mu m g over the radial stiffness (m): the stretch at which a load on one spring slips.
pub const SLIP_STRETCH: f64 = SLIP_LIMIT / RADIAL;

/// omega_n of the paper's load on one radial spring (rad/s).
pub fn natural_rate() -> f64 {
    (RADIAL / MASS).sqrt()
}

/// Three supports at 90, 210 and 330 degrees, `radius` (m) from the centre, that share `total` (N)
/// of normal load.
pub fn tripod(radius: f64, total: f64) -> Vec<SupportPoint> {
    [PI / 2.0, 7.0 * PI / 6.0, 11.0 * PI / 6.0]
        .map(|angle| SupportPoint { offset: radius * direction(angle), normal_load: total / 3.0, friction_coefficient: None })
        .to_vec()
}

/// The paper's load on `springs`, with its inertia and friction.
pub fn paper_system(springs: Vec<PolarSpring>) -> System {
    disc_on_tripod(LOAD_RADIUS, SUPPORT_RADIUS, springs)
}

/// `n` of the paper's springs, evenly spaced from bearing zero.
pub fn paper_springs(n: usize) -> Vec<PolarSpring> {
    let spring = |j: usize| {
        let bearing = 2.0 * PI * j as f64 / n as f64;
        PolarSpring {
            root: LOAD_RADIUS * direction(bearing),
            bearing,
            rest_length: REST_LENGTH,
            radial_stiffness: RADIAL,
            torsional_stiffness: TORSIONAL,
            ..PolarSpring::default()
        }
    };
    (0..n).map(spring).collect()
}

/// A spring of the paper's radial stiffness in every direction, rooted at `root` (m).
pub fn isotropic(root: Vec2, damping_ratio: f64) -> PolarSpring {
    PolarSpring { root, radial_stiffness: RADIAL, damping_ratio, ..PolarSpring::default() }
}

/// The load on which engines are compared: a disc of radius 38.5 mm on supports at 20 mm.
pub fn peers_system(springs: Vec<PolarSpring>) -> System {
    disc_on_tripod(0.0385, 0.02, springs)
}

fn disc_on_tripod(radius: f64, arm: f64, springs: Vec<PolarSpring>) -> System {
    System {
        load: Load { mass: MASS, inertia: 0.5 * MASS * radius * radius, radius },
        ground: Ground { friction_coefficient: MU, supports: tripod(arm, MASS * GRAVITY) },
        springs,
        world: World::default(),
    }
}

pub fn at_rest() -> Motion {
    moving(0.0, 0.0, 0.0)
}

/// At the origin with this velocity (m/s) and turn rate (rad/s).
pub fn moving(vx: f64, vy: f64, turn_rate: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::new(vx, vy), angular: turn_rate } }
}

/// Drives the tips of springs 0, 1 ... along `path(t)` through `n` equal pieces up to `duration`
/// (s); grasps at the first point. After each piece `watch` sees the time and the backend.
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
        backend.attach(spring, tip);
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

/// Equal pieces of `duration` (s) between whose nodes the tips of the reference scene go straight:
/// at most a step of `options` long, and where they have none, so short that chords leave the paths
/// by a hundredth of the tolerance.
pub fn n_pieces(duration: f64, options: &BackendOptions) -> u64 {
    // A chord of duration h leaves a path of this acceleration by up to an eighth of it times h^2.
    const ACCELERATION: f64 = 0.18;
    let chord = |tolerance: Tolerance| (0.08 * tolerance.position_m / ACCELERATION).sqrt();
    let longest = options.tolerance.filter(|_| options.step_s.is_infinite()).map_or(options.step_s, chord);
    n_steps_in(duration, longest)
}

/// Poses at all nodes of a run along curved tip paths.
pub fn path(system: &System, start: Motion, runs: &Runs, tips: &Tips, duration: f64) -> (Vec<Pose>, StepReport) {
    let mut poses = Vec::new();
    let mut run = runs.start(system, start);
    let n = n_pieces(duration, runs) as u32;
    let report = drive(run.as_mut(), tips, duration, n, |_, run| poses.push(run.motion().pose));
    (poses, report)
}

/// Attached springs and their tips (m, world) at a time (s).
pub type Tips = dyn Fn(f64) -> Vec<(usize, Vec2)>;

/// The tips of the reference scene at s in [0, 1].
pub fn reference_tips(s: f64) -> Vec<(usize, Vec2)> {
    let reach = LOAD_RADIUS + REST_LENGTH;
    vec![
        (0, Vec2::new(reach + 0.06 * s, 0.02 * (3.0 * s).sin())),
        (1, Vec2::new(0.03 * s, reach + 0.02 * s - 0.01 * s * s)),
        (3, Vec2::new(0.045 * s + 0.01 * (4.0 * s).sin(), -reach - 0.01 * s)),
    ]
}

/// How far apart two poses of the paper's load are: the largest of shift and turn of a support (m).
pub fn distance(one: &Pose, other: &Pose) -> f64 {
    (one.position - other.position).norm().max(SUPPORT_RADIUS * (one.heading - other.heading).abs())
}
