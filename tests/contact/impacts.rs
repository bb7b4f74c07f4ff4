//! Impacts with closed answers: of moving obstacles that change their velocity while they touch, of
//! second corners, without loss, and just ahead of where a load would stop.

use std::f64::consts::FRAC_PI_2;

use cohaul::backend::BackendKind::Inertial;
use cohaul::backend::{Backend, BackendOptions, ImpactLaw, Integrator, Status, StepReport, TransitionKind, build};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::{Motion, Obstacle, ObstaclePath, OutlinePart, System};

use crate::scenes::*;

/// Deceleration by the ground (m/s^2).
const DECELERATION: f64 = MU * GRAVITY;

/// An impact: time (s), energy lost (J) and law.
type Hit = (f64, f64, ImpactLaw);

/// A load without springs that goes on for a time in periods (s), with its impacts.
struct Course {
    load: Box<dyn Backend>,
    hits: Vec<Hit>,
    time: f64,
}

impl Course {
    fn new(system: &System, start: Motion, options: &BackendOptions) -> Self {
        Self { load: build(system, start, options), hits: Vec::new(), time: 0.0 }
    }

    fn go_on(&mut self, n_periods: u32, period: f64) {
        for _ in 0..n_periods {
            let report: StepReport = self.load.advance(&[Vec2::zeros()], period);
            assert_eq!(report.status, Status::Converged, "{report:?}");
            self.hits.extend(self.load.transitions().iter().filter_map(|transition| match transition.kind {
                TransitionKind::Impact { energy, law, .. } => Some((self.time + transition.time, energy, law)),
                _ => None,
            }));
            self.time += period;
        }
    }

    fn motion(&self) -> Motion {
        self.load.motion()
    }

    /// Defect of the energy ledger over its largest entry (1).
    fn defect(&self) -> f64 {
        let energy = self.load.energy();
        let largest = [energy.kinetic, energy.initial, energy.friction, energy.impacts, energy.obstacle_work.abs()];
        energy.defect().abs() / largest.into_iter().fold(0.0, f64::max)
    }
}

/// A wall in the way of a load that goes along x, behind it or ahead: its face is at x = 0 at
/// first, and then where the waypoints (s, m) have it.
fn moving_face(waypoints: &[(f64, f64)], restitution: f64) -> Obstacle {
    let face = OutlinePart::Polyline { points: vec![Vec2::new(0.0, -0.1), Vec2::new(0.0, 0.1)] };
    let waypoints = waypoints.iter().map(|(time, x)| (*time, Pose::new(*x, 0.0, 0.0))).collect();
    Obstacle { path: ObstaclePath { waypoints }, restitution, ..obstacle(face, 0.0) }
}

/// Distance (m) that a load has from a pusher which hit it at a relative `speed` (m/s) some time
/// (s) ago: it leaps ahead, is slowed down by the ground, and is hit again.
fn ahead_of_pusher(mut speed: f64, restitution: f64, mut time: f64) -> f64 {
    loop {
        speed *= restitution;
        let leap = 2.0 * speed / DECELERATION;
        // Shorter leaps lead nowhere.
        if leap < 1e-9 {
            return 0.0;
        }
        if time < leap {
            return speed * time - 0.5 * DECELERATION * time * time;
        }
        time -= leap;
    }
}

fn options(system: &System) -> [(BackendOptions, f64); 3] {
    let by = |integrator| BackendOptions { integrator, ..BackendOptions::new(Inertial, 1e-3) };
    // Straight steps of the midpoint rule are exact. Those of Euler are late by a share of a step.
    [(by(Integrator::Midpoint), 1e-9), (by(Integrator::Euler), 1e-4), (exact(Inertial, system, 1e-6), 1e-6)]
}

/// A pusher that starts at once, at 0.05 s or not at all before, and quadruples its speed while it
/// pushes: each change of its velocity is an impact, after which the load leaps ahead. All that the
/// leaps have is lost by impacts.
#[test]
fn a_pusher_that_speeds_up_hits_the_load() {
    let (slow, fast, restitution) = (0.05, 0.2, 0.8);
    for starts_at in [0.0, 0.05] {
        let changes_at = starts_at + 0.1;
        let way = [(0.0, 0.0), (starts_at, 0.0), (changes_at, 0.1 * slow), (changes_at + 1.0, 0.1 * slow + fast)];
        let system = disc(vec![moving_face(&way[usize::from(starts_at == 0.0)..], restitution)]);
        for (options, error) in options(&system) {
            let mut course = Course::new(&system, at_rest(RADIUS, 0.0), &options);
            let distance = |course: &Course, pusher: f64| course.motion().pose.position.x - RADIUS - pusher;
            course.go_on((starts_at / 0.01).round() as u32 + 1, 0.01);
            let leap = ahead_of_pusher(slow, restitution, course.time - starts_at);
            assert!((distance(&course, slow * (course.time - starts_at)) - leap).abs() < error, "{starts_at} {options:?}");
            course.go_on(14, 0.01);
            let leap = ahead_of_pusher(fast - slow, restitution, course.time - changes_at);
            let pusher = 0.1 * slow + fast * (course.time - changes_at);
            let found = distance(&course, pusher);
            assert!((found - leap).abs() < error, "{starts_at} {options:?}: {found:e} {leap:e}");
            course.go_on(15, 0.01);
            let energy = course.load.energy();
            let lost = 0.5 * MASS * (slow * slow + (fast - slow) * (fast - slow));
            // Steps of Euler lose energy themselves, (mu g h)^2 m / 2 each.
            if error < 1e-4 {
                assert!((energy.impacts / lost - 1.0).abs() < 1e3 * error, "{starts_at} {options:?}: {energy:?}");
                assert!(course.defect() < 1e-3, "{starts_at} {options:?}: {energy:?}");
            }
            // The first two leaps take longer than a step, and are impacts of their own.
            assert!(course.hits.len() > 4 && course.hits.iter().all(|hit| hit.2 == ImpactLaw::Newton), "{:?}", course.hits);
        }
    }
}

/// A pusher that slows down lets the load go on by itself, and hits it again at the speed by which
/// the load was faster. A pusher that stops does not: the load goes on by v^2 / (2 mu g).
#[test]
fn a_load_leaves_a_pusher_that_slows_down() {
    let (fast, slow, changes_at) = (0.2, 0.15, 0.1);
    for (speed, meets_again) in [(slow, true), (0.0, false)] {
        let way = [(0.0, 0.0), (changes_at, fast * changes_at), (changes_at + 1.0, fast * changes_at + speed)];
        let system = disc(vec![moving_face(&way, 0.0)]);
        for (options, error) in options(&system) {
            let start = Motion { twist: Twist { linear: Vec2::new(fast, 0.0), angular: 0.0 }, ..at_rest(RADIUS, 0.0) };
            let mut course = Course::new(&system, start, &options);
            course.go_on(20, 0.01);
            let x = course.motion().pose.position.x - RADIUS - fast * changes_at;
            if meets_again {
                let ((time, loss, law), again) = (course.hits[0], 2.0 * (fast - slow) / DECELERATION);
                // Seven steps of Euler lose half of this leap.
                if error < 1e-4 {
                    assert!((time - changes_at - again).abs() < 1e-5, "{options:?}: {:?}", course.hits);
                    let lost = 0.5 * MASS * (fast - slow).powi(2);
                    assert!((loss / lost - 1.0).abs() < 1e3 * error, "{options:?}: {:?}", course.hits);
                }
                assert_eq!((law, course.hits.len()), (ImpactLaw::Newton, 1));
                assert!((x - 0.1 * slow).abs() < error.min(1e-6), "{options:?}: {x:e}");
            } else {
                // The midpoint rule stops up to mu g h^2 / 8 late.
                let (stop, late) = (fast * fast / (2.0 * DECELERATION), error.max(DECELERATION * 1e-6 / 8.0));
                assert!(course.hits.is_empty() && (x - stop).abs() < late, "{options:?}: {x:e}");
            }
            assert!(error == 1e-4 || course.defect() < 1e-3, "{options:?}: {:?}", course.load.energy());
        }
    }
}

/// A bar that touches a disc at rest at an arm of 30 mm begins to turn. The disc leaves it at 1 + e
/// times the speed of the arm, and the bar has done the work (1 + e) m u^2.
#[test]
fn a_bar_that_begins_to_turn_hits_the_load() {
    let (arm, turn_rate, restitution, starts_at) = (0.03, 2.0, 0.5, 0.0125);
    let way =
        [(0.0, Pose::new(0.0, 0.0, 0.0)), (starts_at, Pose::new(0.0, 0.0, 0.0)), (1.0, Pose::new(0.0, 0.0, turn_rate * (starts_at - 1.0)))];
    let bar = Obstacle { path: ObstaclePath { waypoints: way.to_vec() }, ..moving_face(&[(0.0, 0.0)], restitution) };
    let mut system = disc(vec![bar]);
    system.ground.friction_coefficient = 0.0;
    for (options, _) in options(&system) {
        let mut course = Course::new(&system, at_rest(RADIUS, arm), &options);
        // The bar begins to turn within the second period, and within a step.
        course.go_on(2, 0.01);
        let (speed, Motion { pose, twist }) = (arm * turn_rate, course.motion());
        let after = (1.0 + restitution) * speed;
        // Where the bar lies when it is hit has no error but rounding, which the located instant
        // has.
        assert!((twist.linear - Vec2::new(after, 0.0)).norm() < 1e-9 * after, "{options:?}: {twist:?}");
        assert!((pose.position - Vec2::new(RADIUS + after * (0.02 - starts_at), arm)).norm() < 1e-10, "{options:?}: {pose:?}");
        let energy = course.load.energy();
        assert!((energy.obstacle_work / ((1.0 + restitution) * MASS * speed * speed) - 1.0).abs() < 1e-8, "{energy:?}");
        assert!(course.defect() < 1e-9 && course.hits.len() == 1, "{energy:?} {:?}", course.hits);
    }
}

/// Losses (J) of a tilted box that falls at a `speed` (m/s) on a smooth wall, on smooth ground,
/// without any rebound: between impacts it flies and turns evenly, and corner after corner hits.
fn losses_of_a_tumbling_box(speed: f64, tilt: f64, inertia: f64, n: usize) -> Vec<f64> {
    let [a, b] = BOX;
    // Height of a lower corner above the centre, and its rate by the heading.
    let corner = |side: f64, heading: f64| {
        let (sin, cos) = heading.sin_cos();
        (side * a * sin - b * cos, side * a * cos + b * sin)
    };
    let hits = -tilt.signum();
    let (mut heading, mut height, mut fall, mut turn) = (tilt, -corner(hits, tilt).0, -speed, 0.0);
    let (mut side, mut losses) = (hits, Vec::new());
    for _ in 0..n {
        let arm = corner(side, heading).1;
        let felt = 1.0 / (1.0 / MASS + arm * arm / inertia);
        let approach = fall + arm * turn;
        losses.push(0.5 * felt * approach * approach);
        (fall, turn) = (fall - felt * approach / MASS, turn - felt * approach * arm / inertia);
        side = -side;
        // The other corner comes down from here on, and its gap falls faster and faster or evenly.
        let gap = |time: f64| height + fall * time + corner(side, heading + turn * time).0;
        let (mut free, mut hit) = (0.0, 1e-3);
        while gap(hit) > 0.0 {
            hit += 1e-4;
        }
        for _ in 0..100 {
            let middle = 0.5 * (free + hit);
            *(if gap(middle) > 0.0 { &mut free } else { &mut hit }) = middle;
        }
        (heading, height) = (heading + turn * hit, height + fall * hit);
    }
    losses
}

/// A tilted box falls on a smooth wall, lands on a corner, and turns over it until the other corner
/// lands. Each impact takes what the effective mass at its corner has, and no step loses any
/// energy: the ledger closes.
#[test]
fn a_tilted_box_loses_its_energy_corner_by_corner() {
    let (speed, tilt, above) = (0.5, 0.15, 1e-3);
    let ([a, b], inertia) = (BOX, 0.5 * MASS * RADIUS * RADIUS);
    let mut system = boxed(vec![wall(Vec2::zeros(), Vec2::new(1.0, 0.0), 0.0)], Vec2::zeros());
    system.ground.friction_coefficient = 0.0;
    let height = a * f64::sin(tilt) + b * f64::cos(tilt);
    for heading in [tilt, -tilt] {
        let expected = losses_of_a_tumbling_box(speed, heading, inertia, 3);
        let start = Motion { pose: Pose::new(0.0, height + above, heading), twist: Twist { linear: Vec2::new(0.0, -speed), angular: 0.0 } };
        let fixed = [1e-3, 1e-4].map(|step| BackendOptions::new(Inertial, step));
        let tight = [1e-6, 1e-8].map(|size| exact(Inertial, &system, size));
        for options in fixed.into_iter().chain(tight) {
            let mut course = Course::new(&system, start, &options);
            course.go_on(12, 1e-3);
            for (hit, expected) in course.hits.iter().zip(&expected) {
                assert!((hit.1 / expected - 1.0).abs() < 1e-6, "{options:?}: {:?} {expected:e}", course.hits);
            }
            assert!(course.hits.len() >= 2 && course.defect() < 1e-3, "{options:?}: {:?}", course.load.energy());
        }
    }
}

/// A disc goes to and fro between two walls, a metre apart for its centre, without any loss. Every
/// bounce is an impact.
#[test]
fn elastic_bounces_are_counted() {
    let speed = 0.77;
    let walls =
        [1.0, -1.0].map(|side| Obstacle { restitution: 1.0, ..wall(Vec2::new(side * (0.5 + RADIUS), 0.0), Vec2::new(0.0, 1.0), 0.0) });
    let mut system = disc(walls.to_vec());
    system.ground.friction_coefficient = 0.0;
    let start = Motion { twist: Twist { linear: Vec2::new(speed, 0.0), angular: 0.0 }, ..at_rest(0.0, 0.0) };
    for (options, _) in options(&system) {
        let mut course = Course::new(&system, start, &options);
        course.go_on(6000, 0.01);
        // 46.2 m: half a metre to the first bounce, and a metre to each of 45 more.
        assert_eq!(course.hits.len(), 46, "{options:?}");
        for (n, (time, loss, law)) in course.hits.iter().enumerate() {
            assert!((time - (0.5 + n as f64) / speed).abs() < 0.01 && *loss < 1e-12 && *law == ImpactLaw::Newton, "{n}: {time} {loss:e}");
        }
        let Motion { pose, twist } = course.motion();
        assert!((pose.position.x - 0.2).abs() < 1e-9 && (twist.linear.x - speed).abs() < 1e-9, "{options:?}: {pose:?} {twist:?}");
    }
}

/// A disc would stop at v^2 / (2 mu g) by itself, and a wall lies a share of that ahead. All steps
/// of a macro-step may stop short of the wall where the extrapolated answer does not. The disc hits
/// the wall, however long macro-steps are.
#[test]
fn a_disc_that_would_stop_behind_a_wall_hits_it() {
    let speed = 0.2;
    let stop = speed * speed / (2.0 * DECELERATION);
    for share in [0.5, 0.9, 0.99] {
        let system = disc(vec![wall(Vec2::new(share * stop + RADIUS, 0.0), Vec2::new(0.0, 1.0), 0.0)]);
        let start = Motion { twist: Twist { linear: Vec2::new(speed, 0.0), angular: 0.0 }, ..at_rest(0.0, 0.0) };
        let lost = 0.5 * MASS * speed * speed * (1.0 - share);
        for tolerance in [1e-4, 1e-5, 1e-6, 1e-8] {
            let mut course = Course::new(&system, start, &exact(Inertial, &system, tolerance));
            course.go_on(10, 0.01);
            let energy = course.load.energy();
            assert!((course.motion().pose.position.x - share * stop).abs() < 1e-9, "{share} {tolerance:e}: {:?}", course.motion());
            assert_eq!(course.hits.len(), 1, "{share} {tolerance:e}: {:?}", course.hits);
            // A place that is off by the tolerance is one in the speed there.
            assert!((energy.impacts - lost).abs() < LIMIT * tolerance, "{share} {tolerance:e}: {energy:?}");
            assert!(course.defect() < 1e-6, "{share} {tolerance:e}: {energy:?}");
        }
    }
}

/// A disc is thrown into a notch of rough walls at a right angle: it hits one and then both. With
/// every restitution and friction energy falls, the ledger has the loss, and each impact its law.
#[test]
fn impacts_in_a_rough_notch_gain_no_energy() {
    for friction in [0.2, 0.8, 1.5] {
        for restitution in [0.0, 0.5, 0.9, 1.0] {
            let side = |sign: f64| 0.1 * cohaul::math::direction(FRAC_PI_2 + sign * 0.25 * std::f64::consts::PI);
            let walls = OutlinePart::Polyline { points: vec![side(1.0), Vec2::zeros(), side(-1.0)] };
            let mut system = disc(vec![Obstacle { restitution, ..obstacle(walls, friction) }]);
            system.ground.friction_coefficient = 0.2;
            let start = Motion { pose: Pose::new(0.002, 1.6 * RADIUS, 0.0), twist: Twist { linear: Vec2::new(0.05, -0.4), angular: 40.0 } };
            let mut course = Course::new(&system, start, &BackendOptions::new(Inertial, 1e-4));
            let mut last = system.load.kinetic_energy(&start.twist);
            for _ in 0..200 {
                course.go_on(1, 5e-4);
                let kinetic = course.load.energy().kinetic;
                assert!(kinetic <= last * (1.0 + 1e-9), "{friction} {restitution}: {last:e} {kinetic:e}");
                last = kinetic;
            }
            assert!(!course.hits.is_empty() && course.hits.iter().all(|hit| hit.1 >= 0.0 && hit.2 != ImpactLaw::None));
            assert!(course.defect() < 1e-3, "{friction} {restitution}: {:?}", course.load.energy());
        }
    }
}
