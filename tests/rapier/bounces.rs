//! Impacts with friction: Newton's law for the normal velocity, Coulomb's law for the impulse.

use cohaul::backend::rapier::{Precision, RapierOptions};
use cohaul::backend::{Motion, Status};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::{Ground, Load, Obstacle, ObstaclePath, Outline, System, World};

use crate::obstacle_scenes::{let_go, polygon, standing, wall};
use crate::scenes::paper_body;

/// Radius of the puck (m), and its distance from the wall at the start (m).
const RADIUS: f64 = 0.3;
const AHEAD: f64 = 1.2;

/// A load of 1 kg with this moment of inertia (kg m2) that glides without friction.
fn gliding(outline: Outline, inertia: f64, obstacle: Obstacle) -> System {
    let body = paper_body();
    System {
        load: Load { mass: 1.0, inertia, radius: RADIUS },
        ground: Ground { friction_coefficient: 0.0, ..body.ground },
        world: World { outline, obstacles: vec![obstacle] },
        ..body
    }
}

/// A wall below at this height (m).
fn floor(height: f64, friction_coefficient: f64, restitution: f64) -> Obstacle {
    Obstacle { friction_coefficient, restitution, ..standing(wall([-50.0, height], [50.0, height])) }
}

fn thrown(velocity: Vec2, turn_rate: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: velocity, angular: turn_rate } }
}

/// Twist after an impact at `arm` (m) on a wall below that stands still: the normal impulse gives
/// the restitution, and the tangential one stops the slip or is limited by Coulomb's law.
fn after_impact(before: &Twist, arm: Vec2, inertia: f64, friction: f64, restitution: f64) -> Twist {
    let compliance = |of: Vec2, at: Vec2| of.dot(&at) + arm.perp(&of) * arm.perp(&at) / inertia;
    let (normal, tangent) = (Vec2::y(), Vec2::x());
    let point = before.velocity_at(&arm);
    let need = Vec2::new(-(1.0 + restitution) * point.dot(&normal), -point.dot(&tangent));
    let [nn, nt, tt] = [compliance(normal, normal), compliance(normal, tangent), compliance(tangent, tangent)];
    let determinant = nn * tt - nt * nt;
    let (mut push, mut rub) = ((tt * need.x - nt * need.y) / determinant, (nn * need.y - nt * need.x) / determinant);
    if rub.abs() > friction * push {
        let slide = rub.signum() * friction;
        push = need.x / (nn + slide * nt);
        rub = slide * push;
    }
    let impulse = push * normal + rub * tangent;
    Twist { linear: before.linear + impulse, angular: before.angular + arm.perp(&impulse) / inertia }
}

/// Difference of two twists as the largest velocity at the edge (m/s).
fn differ(a: &Twist, b: &Twist) -> f64 {
    (a.linear - b.linear).norm() + RADIUS * (a.angular - b.angular).abs()
}

/// The table of bounces: a puck that may turn and one that may not.
#[test]
fn friction_of_a_bounce_follows_the_whole_normal_impulse() {
    for (restitution, friction) in [0.0, 0.5, 0.9].into_iter().flat_map(|e| [0.1, 0.6].map(|mu| (e, mu))) {
        for inertia in [0.5 * RADIUS * RADIUS, 1e9] {
            let start = thrown(Vec2::new(10.0, -10.0), 0.0);
            let want = after_impact(&start.twist, Vec2::new(0.0, -RADIUS), inertia, friction, restitution);
            let system = gliding(Outline::disc(RADIUS), inertia, floor(-RADIUS - AHEAD, friction, restitution));
            let end = let_go(&system, start, RapierOptions::default(), 0.4, 1e-3);
            assert_eq!(end.report.status, Status::Converged);
            let error = differ(&end.load.motion().twist, &want);
            // Of 14 m/s. The sweeps over a contact that bounces end at rounding. Without
            // restitution the load first closes its gap, and the middle of the gap counts as the
            // point of contact.
            let allowed = if restitution > 0.0 { 1e-9 } else { 0.02 * 14.0 };
            assert!(error < allowed, "{restitution} {friction} {inertia}: {:?} {want:?}", end.load.motion().twist);
            // All that is lost is lost in the impact.
            let energy = end.load.energy();
            let lost = system.load.kinetic_energy(&start.twist) - system.load.kinetic_energy(&end.load.motion().twist);
            assert!((energy.impacts - lost).abs() < 1e-9 && energy.defect().abs() < 1e-9, "{lost} {energy:?}");
        }
    }
}

/// Closed forms of the table: the sticking puck keeps two thirds of its speed, and the one that may
/// not turn keeps nothing.
#[test]
fn a_puck_rolls_off_a_rough_wall() {
    let end_of = |inertia, options| {
        let system = gliding(Outline::disc(RADIUS), inertia, floor(-RADIUS - AHEAD, 0.6, 0.9));
        let twist = let_go(&system, thrown(Vec2::new(10.0, -10.0), 0.0), options, 0.4, 1e-3).load.motion().twist;
        [twist.linear.x, twist.linear.y, twist.angular]
    };
    let single = RapierOptions { precision: Precision::F32, ..RapierOptions::default() };
    for (options, rounding) in [(RapierOptions::default(), 1e-9), (single, 1e-4)] {
        let cases = [(0.5 * RADIUS * RADIUS, [20.0 / 3.0, 9.0, -200.0 / 9.0]), (1e9, [0.0, 9.0, 0.0])];
        for (inertia, want) in cases {
            let found = end_of(inertia, options);
            assert!(found.iter().zip(want).all(|(found, want)| (found - want).abs() < rounding * 22.2), "{found:?} {want:?}");
        }
    }
}

/// A corner that hits a wall couples normal and tangent. The box stands on its tip, turned by 0.5
/// rad, and slips forward or backward at the wall.
#[test]
fn a_corner_bounces_by_the_same_law() {
    let [x, y] = [0.25f64, 0.15];
    let outline = polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]]);
    let inertia = (4.0 * x * x + 4.0 * y * y) / 12.0;
    let pose = Pose::new(0.0, 0.0, 0.5);
    let corners = [Vec2::new(x, -y), Vec2::new(-x, -y)].map(|corner| pose.to_world(&corner));
    let arm = if corners[0].y < corners[1].y { corners[0] } else { corners[1] };
    for (restitution, friction) in [(0.0, 0.1), (0.5, 0.1), (0.5, 0.6), (0.9, 0.6)] {
        for speed in [-3.0, 3.0] {
            let before = Twist { linear: Vec2::new(speed, -2.0), angular: 0.0 };
            let want = after_impact(&before, arm, inertia, friction, restitution);
            let system = gliding(outline.clone(), inertia, floor(arm.y - 0.0101, friction, restitution));
            let end = let_go(&system, Motion { pose, twist: before }, RapierOptions::default(), 7e-3, 1e-3);
            let error = differ(&end.load.motion().twist, &want) / before.linear.norm();
            // The arm turns by 0.02 in a step after the impact without restitution.
            assert!(error < 0.02, "{restitution} {friction} {speed}: {:?} {want:?}", end.load.motion().twist);
        }
    }
}

/// A wall that hits a load at rest is the same impact, seen from the wall.
#[test]
fn a_moving_wall_hits_like_one_at_rest() {
    let velocity = Vec2::new(-2.0, 3.0);
    for (restitution, friction) in [(0.0, 0.1), (0.5, 0.6), (0.9, 0.1)] {
        let inertia = 0.5 * RADIUS * RADIUS;
        let path = ObstaclePath { waypoints: vec![(0.0, Pose::new(0.0, 0.0, 0.0)), (1.0, Pose::new(velocity.x, velocity.y, 0.0))] };
        let obstacle = Obstacle { path, ..floor(-RADIUS - 0.1003, friction, restitution) };
        let end =
            let_go(&gliding(Outline::disc(RADIUS), inertia, obstacle), thrown(Vec2::zeros(), 0.0), RapierOptions::default(), 0.1, 1e-3);
        let seen = Twist { linear: -velocity, angular: 0.0 };
        let mut want = after_impact(&seen, Vec2::new(0.0, -RADIUS), inertia, friction, restitution);
        want.linear += velocity;
        let error = differ(&end.load.motion().twist, &want);
        let allowed = if restitution > 0.0 { 1e-9 } else { 0.02 * velocity.norm() };
        assert!(error < allowed, "{restitution} {friction}: {:?} {want:?}", end.load.motion().twist);
        // The work of the wall is what the load has got and lost.
        assert!(end.load.energy().defect().abs() < 1e-9, "{:?}", end.load.energy());
    }
}
