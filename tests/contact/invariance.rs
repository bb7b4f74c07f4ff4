//! What must not matter: where the scene lies, its mirror image, its units, the order of obstacles,
//! and how their outlines are divided.

use cohaul::backend::BackendKind::{self, Inertial, QuasiStatic};
use cohaul::backend::{BackendOptions, Integrator, Status, TransitionKind};
use cohaul::math::{Pose, Vec2, direction, rotation};
use cohaul::model::{Motion, Obstacle, OutlinePart, PolarSpring, System};

use crate::scenes::*;

const STEPS: u32 = 60;
/// Rounding over the load's size (1): each of the steps leaves some of 1e-15, and a load that turns
/// while it slides makes them some hundred times larger.
const ROUNDING: f64 = 1e-11;

/// A box that a tip draws along a wall with friction and round its end, past a post.
struct Scene {
    system: System,
    start: Pose,
    tip: fn(f64) -> Vec2,
}

fn tip(s: f64) -> Vec2 {
    Vec2::new(0.001 + 0.11 * s, 0.004 - 0.012 * s)
}

fn scene() -> Scene {
    let ground = OutlinePart::Polyline { points: vec![Vec2::new(-0.05, -BOX[1]), Vec2::new(0.03, -BOX[1])] };
    let obstacles = vec![obstacle(ground, 0.3), post(Vec2::new(0.05, -0.018), 0.004)];
    Scene { system: boxed(obstacles, Vec2::new(0.0, 0.004)), start: Pose::new(0.0, 0.0, 0.0), tip }
}

fn integrators(kind: BackendKind) -> &'static [Integrator] {
    if kind == Inertial { &[Integrator::Euler, Integrator::Midpoint] } else { &[Integrator::Euler] }
}

/// Poses at the ends of all advances, as far as these places of the tip lead, up to the first jump:
/// at the end of a balance, rounding decides to which other one the load goes.
fn poses(system: &System, start: Pose, kind: BackendKind, integrator: Integrator, tip: impl Fn(f64) -> Vec2) -> Vec<Pose> {
    let options = BackendOptions { integrator, ..fixed(kind, STEPS) };
    let start = Motion { pose: start, ..at_rest(0.0, 0.0) };
    let mut load = cohaul::backend::build(system, start, &options);
    load.attach(0, tip(0.0));
    let mut has_jumped = false;
    let pose_after = |tick: u32| {
        if has_jumped {
            return None;
        }
        let report = load.advance(&[tip(f64::from(tick) / f64::from(STEPS))], 1.0 / f64::from(STEPS));
        assert_eq!(report.status, Status::Converged, "{kind:?} {tick}");
        has_jumped = load.transitions().iter().any(|transition| matches!(transition.kind, TransitionKind::Jump { .. }));
        Some(load.motion().pose)
    };
    (1..=STEPS).map_while(pose_after).collect()
}

/// Asserts that a changed scene leads to the poses of the scene itself, changed by `expected`, up
/// to rounding over the size (m).
fn assert_same(changed: &System, start: Pose, size: f64, tip_of: impl Fn(Vec2) -> Vec2 + Copy, expected: impl Fn(&Pose) -> Pose) {
    assert_same_on(&[QuasiStatic, Inertial], changed, (start, size), tip_of, expected);
}

fn assert_same_on(
    kinds: &[BackendKind],
    changed: &System,
    (start, size): (Pose, f64),
    tip_of: impl Fn(Vec2) -> Vec2 + Copy,
    expected: impl Fn(&Pose) -> Pose,
) {
    let scene = scene();
    for kind in kinds.iter().copied() {
        for integrator in integrators(kind) {
            let plain = poses(&scene.system, scene.start, kind, *integrator, scene.tip);
            let other = poses(changed, start, kind, *integrator, |s| tip_of((scene.tip)(s)));
            let moved = plain.last().unwrap().position - plain[0].position;
            assert!(moved.norm() > RADIUS && plain.last().unwrap().heading.abs() > 0.1, "{moved}: a scene in which nothing happens");
            assert_eq!(plain.len(), other.len());
            for (tick, (plain, other)) in plain.iter().zip(&other).enumerate() {
                let away = expected(plain);
                let error = (away.position - other.position).norm() / size + (away.heading - other.heading).abs();
                assert!(error < ROUNDING, "{kind:?} {integrator:?} {tick}: {error:e}");
            }
        }
    }
}

fn with_obstacles(change: impl Fn(Vec<Obstacle>) -> Vec<Obstacle>) -> System {
    let mut system = scene().system;
    system.world.obstacles = change(system.world.obstacles);
    system
}

#[test]
fn a_turned_scene_leads_to_turned_poses() {
    let (angle, shift) = (1.1, Vec2::new(0.02, -0.05));
    let turned = |pose: &Pose| Pose { position: shift + rotation(angle) * pose.position, heading: pose.heading + angle };
    let system = with_obstacles(|mut obstacles| {
        obstacles.iter_mut().for_each(|obstacle| obstacle.path.waypoints[0].1 = turned(&obstacle.path.waypoints[0].1));
        obstacles
    });
    assert_same(&system, turned(&Pose::new(0.0, 0.0, 0.0)), RADIUS, |tip| shift + rotation(angle) * tip, turned);
}

fn mapped(part: &OutlinePart, map: impl Fn(&Vec2) -> Vec2 + Copy, scale: f64, reverse: bool) -> OutlinePart {
    let all = |points: &[Vec2]| -> Vec<Vec2> {
        let points = points.iter().map(&map);
        if reverse { points.rev().collect() } else { points.collect() }
    };
    match part {
        OutlinePart::Disc { centre, radius } => OutlinePart::Disc { centre: map(centre), radius: scale * radius },
        OutlinePart::Polygon { corners } => OutlinePart::Polygon { corners: all(corners) },
        OutlinePart::Polyline { points } => OutlinePart::Polyline { points: all(points) },
    }
}

/// The scene with all points mapped.
fn mapped_scene(map: impl Fn(&Vec2) -> Vec2 + Copy, scale: f64, reverse: bool) -> System {
    let mut system = scene().system;
    let outlines = system.world.obstacles.iter_mut().map(|obstacle| &mut obstacle.outline).chain([&mut system.world.outline]);
    for outline in outlines {
        outline.parts.iter_mut().for_each(|part| *part = mapped(part, map, scale, reverse));
    }
    system.ground.supports.iter_mut().for_each(|support| support.offset = map(&support.offset));
    system.springs.iter_mut().for_each(|spring| *spring = PolarSpring { root: map(&spring.root), ..*spring });
    system
}

#[test]
fn the_mirror_image_of_a_scene_leads_to_that_of_its_poses() {
    let mirrored = |point: &Vec2| Vec2::new(point.x, -point.y);
    let system = mapped_scene(mirrored, 1.0, true);
    let image = |pose: &Pose| Pose { position: mirrored(&pose.position), heading: -pose.heading };
    assert_same(&system, Pose::new(0.0, 0.0, 0.0), RADIUS, |tip| mirrored(&tip), image);
}

/// Lengths from micrometres to a kilometre, with forces between; times stay.
#[test]
fn the_units_of_a_scene_do_not_matter() {
    for (length, force) in [(1e-4, 1e-3), (1e2, 1e4), (1e5, 1.0)] {
        let map = |point: &Vec2| length * point;
        let mut system = mapped_scene(map, length, false);
        let stiffness = force / length;
        system.load.mass *= stiffness;
        system.load.inertia *= stiffness * length * length;
        system.load.radius *= length;
        system.ground.supports.iter_mut().for_each(|support| support.normal_load *= force);
        system.springs.iter_mut().for_each(|spring| spring.radial_stiffness *= stiffness);
        let scaled = |pose: &Pose| Pose { position: length * pose.position, heading: pose.heading };
        assert_same(&system, Pose::new(0.0, 0.0, 0.0), length * RADIUS, |tip| length * tip, scaled);
    }
}

#[test]
fn the_order_of_obstacles_does_not_matter() {
    let reversed = with_obstacles(|obstacles| obstacles.into_iter().rev().collect());
    assert_same(&reversed, Pose::new(0.0, 0.0, 0.0), RADIUS, |tip| tip, |pose| *pose);
}

/// A wall as one line, and as a line with a point in it.
#[test]
fn a_wall_may_be_divided() {
    let points = [-0.05, 0.004, 0.03].map(|x| Vec2::new(x, -BOX[1]));
    let line = |points: &[Vec2]| obstacle(OutlinePart::Polyline { points: points.to_vec() }, 0.3);
    let with_point = with_obstacles(|obstacles| vec![line(&points), obstacles[1].clone()]);
    assert_same(&with_point, Pose::new(0.0, 0.0, 0.0), RADIUS, |tip| tip, |pose| *pose);
}

/// A polygon with further points on its edges is the same one. With inertia a touch divides a step,
/// and one by another part of an edge divides it elsewhere, so that only the answer for short steps
/// is the same.
#[test]
fn an_outline_may_be_refined() {
    let mut system = scene().system;
    let [a, b] = BOX;
    let corners = [[-a, -b], [0.3 * a, -b], [a, -b], [a, 0.1 * b], [a, b], [-0.5 * a, b], [-a, b]];
    system.world.outline.parts = vec![OutlinePart::Polygon { corners: corners.map(Vec2::from).to_vec() }];
    assert_same_on(&[QuasiStatic], &system, (Pose::new(0.0, 0.0, 0.0), RADIUS), |tip| tip, |pose| *pose);
}

/// Obstacles out of reach change nothing, to the last bit.
#[test]
fn far_obstacles_do_not_matter() {
    let far = (0..40).map(|k| post(0.5 * direction(f64::from(k)), 0.004));
    let system = with_obstacles(|obstacles| obstacles.into_iter().chain(far.clone()).collect());
    assert_same(&system, Pose::new(0.0, 0.0, 0.0), RADIUS, |tip| tip, |pose| *pose);
}
