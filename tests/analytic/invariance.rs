//! What must not matter: place and heading of the scene, its mirror image, the units, the names of
//! springs and supports, and, without inertia, time.

use cohaul::backend::{BackendKind, Motion};
use cohaul::math::{Pose, Twist, Vec2, rotation};
use cohaul::model::{PolarSpring, System};

use crate::common::*;

type Tips = dyn Fn(f64) -> Vec<(usize, Vec2)>;

/// Poses of the load at the 300 steps of a second.
fn path(kind: BackendKind, system: &System, start: Pose, tips: &Tips) -> Vec<Pose> {
    let start = Motion { pose: start, twist: Twist::ZERO };
    let mut run = backend(kind, system, start, 1.0);
    let mut poses = Vec::new();
    drive(run.as_mut(), tips, 1.0, 300, |_, run| poses.push(run.motion().pose));
    poses
}

fn home() -> Pose {
    Pose::new(0.0, 0.0, 0.0)
}

/// Supports that no symmetry of the tips hides, and springs with dashpots.
fn system() -> System {
    let springs = paper_springs(4).into_iter().map(|spring| PolarSpring { damping_ratio: 0.2, ..spring });
    let mut system = paper_system(springs.collect());
    system.ground.supports[0].offset *= 1.2;
    system.ground.supports[1].normal_load *= 0.8;
    system
}

/// The system's path and that of `other`, taken back by `undo`, are one up to `tolerance` (m) at
/// every step, and not for being the same run.
fn check_same(name: &str, kind: BackendKind, other: &[Pose], undo: impl Fn(&Pose) -> Pose, tolerance: f64) {
    let reference = path(kind, &system(), home(), &reference_tips);
    let largest = reference.iter().zip(other).map(|(one, two)| distance(one, &undo(two))).fold(0.0, f64::max);
    assert_eq!(reference.len(), other.len());
    assert!(largest < tolerance, "{name} {kind:?}: {largest:e}");
    assert!(largest > 0.0, "{name} {kind:?}: bit for bit the same");
    assert!(reference.last().unwrap().position.norm() > 0.02);
}

/// Rounding of positions of 0.1 m, which the load's springs turn into forces and steps near a
/// change of regime magnify. The engine linearises in world axes and stops its sweeps at a
/// residual.
fn tolerance(kind: BackendKind) -> f64 {
    if kind.is_exact() { 1e-14 } else { 1e-11 }
}

#[test]
fn place_and_heading_do_not_matter() {
    let moved = Pose::new(0.3, -0.2, 1.1);
    let tips = move |s: f64| reference_tips(s).into_iter().map(|(spring, tip)| (spring, moved.to_world(&tip))).collect();
    for kind in BackendKind::ALL {
        let other = path(kind, &system(), moved, &tips);
        let undo = |pose: &Pose| Pose {
            position: rotation(moved.heading).tr_mul(&(pose.position - moved.position)),
            heading: pose.heading - moved.heading,
        };
        check_same("moved", kind, &other, undo, tolerance(kind));
    }
}

fn mirrored(point: Vec2) -> Vec2 {
    Vec2::new(point.x, -point.y)
}

#[test]
fn the_mirror_image_takes_the_mirrored_path() {
    let mut image = system();
    for spring in &mut image.springs {
        (spring.root, spring.bearing) = (mirrored(spring.root), -spring.bearing);
    }
    image.ground.supports.iter_mut().for_each(|support| support.offset = mirrored(support.offset));
    // Left is right from another place, so that signs alone do not make the bits equal.
    let away = Vec2::new(0.07, 0.013);
    let tips = move |s: f64| reference_tips(s).into_iter().map(|(spring, tip)| (spring, mirrored(tip) + away)).collect();
    for kind in BackendKind::ALL {
        let other = path(kind, &image, Pose { position: away, heading: 0.0 }, &tips);
        let undo = |pose: &Pose| Pose { position: mirrored(pose.position - away), heading: -pose.heading };
        check_same("mirror", kind, &other, undo, tolerance(kind));
    }
}

/// Stiffness, friction and mass times one number: the same path. Lengths times another, with the
/// torsion to match: the path times it.
#[test]
fn units_do_not_matter() {
    for (force, length) in [(3.7, 1.0), (1e3, 1e3), (1e-3, 0.37), (1.0, 25.4)] {
        let mut scaled = system();
        scaled.load.mass *= force / length;
        scaled.load.inertia *= force * length;
        scaled.load.radius *= length;
        for support in &mut scaled.ground.supports {
            support.offset *= length;
            support.normal_load *= force;
        }
        for spring in &mut scaled.springs {
            spring.root *= length;
            spring.rest_length *= length;
            spring.radial_stiffness *= force / length;
            spring.torsional_stiffness *= force * length;
        }
        let tips = move |s: f64| reference_tips(s).into_iter().map(|(spring, tip)| (spring, length * tip)).collect();
        for kind in BackendKind::ALL {
            let other = path(kind, &scaled, home(), &tips);
            let undo = |pose: &Pose| Pose { position: pose.position / length, heading: pose.heading };
            check_same("units", kind, &other, undo, tolerance(kind));
        }
    }
}

#[test]
fn names_of_springs_and_supports_do_not_matter() {
    let order = [2, 0, 3, 1];
    let mut renamed = system();
    renamed.springs = order.map(|spring| system().springs[spring]).to_vec();
    renamed.ground.supports.rotate_left(1);
    let name_of = move |spring: usize| order.iter().position(|old| *old == spring).unwrap();
    let tips = move |s: f64| reference_tips(s).into_iter().map(|(spring, tip)| (name_of(spring), tip)).collect();
    for kind in BackendKind::ALL {
        check_same("names", kind, &path(kind, &renamed, home(), &tips), |pose| *pose, tolerance(kind));
    }
}

/// Poses at the nodes s_i of the reference scene without dashpots, passed at the times that `clock`
/// says.
fn at_nodes(nodes: &[f64], clock: impl Fn(f64) -> f64) -> Vec<Pose> {
    let mut undamped = system();
    undamped.springs.iter_mut().for_each(|spring| spring.damping_ratio = 0.0);
    let mut run = backend(BackendKind::QuasiStatic, &undamped, at_rest(), f64::INFINITY);
    for (spring, tip) in reference_tips(0.0) {
        run.attach(spring, tip);
    }
    let poses = nodes.windows(2).map(|pair| {
        let mut targets = vec![Vec2::new(f64::NAN, f64::NAN); 4];
        reference_tips(pair[1]).into_iter().for_each(|(spring, tip)| targets[spring] = tip);
        run.advance(&targets, clock(pair[1]) - clock(pair[0]));
        run.motion().pose
    });
    poses.collect()
}

/// Rate independence: the same nodes at other times give the same bits.
#[test]
fn without_inertia_only_the_nodes_matter_not_their_times() {
    let nodes: Vec<f64> = (0..=300).map(|i| f64::from(i) / 300.0).collect();
    let even = at_nodes(&nodes, |s| s);
    for (name, other) in [("slow", at_nodes(&nodes, |s| 1e4 * s)), ("warped", at_nodes(&nodes, |s| s * s + 1e-3 * s))] {
        assert_eq!(even, other, "{name}");
    }
}

/// Other nodes on the same paths give another path, which differs by the first order of the method
/// and no more.
#[test]
fn without_inertia_a_warped_clock_converges_to_the_same_path() {
    let end = |n: u32, warp: fn(f64) -> f64| {
        let nodes: Vec<f64> = (0..=n).map(|i| warp(f64::from(i) / f64::from(n))).collect();
        *at_nodes(&nodes, |s| s).last().unwrap()
    };
    let gaps = [500, 1000, 2000].map(|n| distance(&end(n, |t| t), &end(n, |t| 0.3 * t + 0.7 * t * t)));
    for pair in gaps.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.1, "{gaps:?}");
    }
    assert!(gaps[2] > 0.0);
}
