//! Known answers with inertia. Under a tolerance they hold to 1e-8 of the load's size; at fixed
//! steps with the order of the method.

use std::f64::consts::{FRAC_PI_2, PI};

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{Backend, BackendOptions, Integrator, Status, StepReport, Transition, TransitionKind, build};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{Motion, Obstacle, ObstaclePath, Outline, OutlinePart, System};
use cohaul::scenario::{Drive, Scenario};

use crate::scenes::*;

/// 1e-8 of the load's size (m).
const EXACT: f64 = 1e-8 * RADIUS;

fn moving(vx: f64, vy: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::new(vx, vy), angular: 0.0 } }
}

fn elastic(obstacle: Obstacle, restitution: f64) -> Obstacle {
    Obstacle { restitution, ..obstacle }
}

/// A free load after so many milliseconds, all of whose steps converge.
fn coasted(system: &System, start: Motion, options: &BackendOptions, n: u32) -> Box<dyn Backend> {
    let mut load = build(system, start, options);
    for _ in 0..n {
        assert_eq!(load.advance(&[Vec2::zeros()], 1e-3).status, Status::Converged);
    }
    load
}

fn by(integrator: Integrator, step: f64) -> BackendOptions {
    BackendOptions { integrator, ..BackendOptions::new(Inertial, step) }
}

/// K7: a disc slides at a wall 4 mm ahead and rebounds. The impact law loses what it should.
#[test]
fn a_disc_rebounds_from_a_wall() {
    let system = disc(vec![elastic(wall(Vec2::new(0.004 + RADIUS, 0.0), Vec2::new(0.0, 1.0), 0.0), 0.6)]);
    let (end, lost) = (0.004 - 1.836539974e-3, 7.1745536e-5);
    let errors = |integrator| {
        [1e-3, 1e-4].map(|h| {
            let load = coasted(&system, moving(0.5, 0.0), &by(integrator, h), 30);
            ((load.motion().pose.position.x - end).abs(), (load.energy().impacts - lost).abs())
        })
    };
    let [(coarse, _), (fine, _)] = errors(Integrator::Euler);
    assert!((coarse / fine - 10.0).abs() < 1.0, "first order: {coarse:e} {fine:e}");
    let [(coarse, lost_coarse), (fine, lost_fine)] = errors(Integrator::Midpoint);
    assert!(coarse < 2e-6 && 50.0 * fine < coarse, "at least second order: {coarse:e} {fine:e}");
    assert!(lost_coarse < 1e-12 && lost_fine < 1e-12, "as many digits as are known");
    let load = coasted(&system, moving(0.5, 0.0), &exact(Inertial, &system, 1e-9), 30);
    assert!((load.motion().pose.position.x - end).abs() < EXACT);
    assert!((load.energy().impacts - lost).abs() < 1e-12);
}

/// The end of a line enters a box by one edge and would leave it by the next one within a step: the
/// box then lies across the line, and no feature that it touches says so. Short steps see the end
/// inside of the box. Both lead to the same impact.
#[test]
fn a_box_does_not_pass_over_the_end_of_a_line() {
    let end = Vec2::from(BOX) + Vec2::new(-1.2e-3, 0.4e-3);
    let line = OutlinePart::Polyline { points: vec![end, end + Vec2::new(-0.05, 0.05)] };
    let system = boxed(vec![obstacle(line, 0.0)], Vec2::zeros());
    let losses = [1e-3, 1e-4].map(|step| {
        let load = coasted(&system, moving(-2.1, 2.1), &by(Integrator::Midpoint, step), 1);
        load.energy().impacts
    });
    assert!(losses[1] > 1e-4, "{losses:?}");
    // Ahead of the impact the box is slowed down evenly, which each step follows to rounding.
    assert!((losses[0] / losses[1] - 1.0).abs() < 1e-9, "{losses:?}");
}

fn pulled_at_a_wall(restitution: f64) -> (System, Vec2) {
    (disc(vec![elastic(wall(Vec2::new(0.010 + RADIUS, 0.0), Vec2::new(0.0, 1.0), 0.0), restitution)]), Vec2::new(2.0 * BEHIND, 0.0))
}

/// K10: a spring draws a disc into a wall, where a plastic impact ends its motion.
#[test]
fn a_disc_is_drawn_into_a_wall() {
    let (system, tip) = pulled_at_a_wall(0.0);
    let losses = [1e-3, 5e-4, 2.5e-4].map(|h| {
        let mut load = build(&system, moving(0.0, 0.0), &BackendOptions::new(Inertial, h));
        load.attach(0, tip);
        for _ in 0..100 {
            assert_eq!(load.advance(&[tip], 1e-3).status, Status::Converged);
        }
        assert!((load.motion().pose.position - Vec2::new(0.010, 0.0)).norm() < EXACT);
        assert_eq!(load.motion().twist, Twist::ZERO);
        load.energy().impacts
    });
    let ratio = (losses[0] - losses[1]) / (losses[1] - losses[2]);
    assert!((ratio - 4.0).abs() < 0.1, "second order: {losses:?}");
    let extrapolated = losses[2] + (losses[2] - losses[1]) / 3.0;
    assert!((extrapolated - 1.86544e-4).abs() < 6e-10, "as many digits as are known: {extrapolated:e}");
}

/// K10: time and speed of that impact, and the end of a jump: what it loses is the defect of the
/// jump without inertia.
#[test]
fn an_impact_loses_the_defect_of_a_jump() {
    let (system, tip) = pulled_at_a_wall(0.0);
    let mut load = build(&system, moving(0.0, 0.0), &exact(Inertial, &system, 1e-9));
    load.attach(0, tip);
    let (time, speed) = (0.039193517225, 0.482887150378);
    // A picosecond before the wall.
    load.advance(&[tip], time - 1e-12);
    let Motion { pose, twist } = load.motion();
    assert!((pose.position.x - 0.010).abs() < EXACT && (twist.linear.x - speed).abs() < 1e-9, "{pose:?} {twist:?}");
    let mut load = build(&system, moving(0.0, 0.0), &exact(QuasiStatic, &system, 1e-9));
    load.attach(0, tip);
    assert_eq!(load.advance(&[tip], 0.1).status, Status::Converged);
    assert!((load.motion().pose.position.x - 0.010).abs() < EXACT);
    let lost = -load.energy().defect();
    assert!((lost - 1.86544e-4).abs() < 6e-10, "as many digits as are known: {lost:e}");
}

/// K10: the length of the first rebound does not depend on the mass.
#[test]
fn a_rebound_from_a_jump_has_a_length_of_its_own() {
    for (restitution, length) in [(0.3, 0.282751557e-3), (0.6, 1.125700520e-3), (0.9, 2.513415447e-3)] {
        for heavier in [1.0, 100.0] {
            let (mut system, tip) = pulled_at_a_wall(restitution);
            system.load.mass *= heavier;
            system.load.inertia *= heavier;
            let mut load = build(&system, moving(0.0, 0.0), &exact(Inertial, &system, 1e-9));
            load.attach(0, tip);
            let tick = 1e-4 * f64::sqrt(heavier);
            let (mut highest, mut had_impact) = (0.0f64, false);
            for _ in 0..2000 {
                load.advance(&[tip], tick);
                let Motion { pose, twist } = load.motion();
                had_impact |= !load.transitions().is_empty() && load.energy().impacts > 0.0;
                if had_impact && twist.linear.x > 0.0 {
                    break;
                }
                if had_impact {
                    // What is left of the rebound at the force of this instant, within a tick.
                    let force = STIFFNESS * (tip.x - pose.position.x) + LIMIT;
                    highest = 0.010 - pose.position.x + 0.5 * system.load.mass * twist.linear.x.powi(2) / force;
                }
            }
            // The force changes by the rebound over the length of the spring, so that the last tick
            // has an error of that share of its own length, some 1e-9 m.
            assert!((highest - length).abs() < 2e-9, "{restitution} {heavier}: {highest:e}");
        }
    }
}

/// K11: a disc hits a wall at an angle.
#[test]
fn a_disc_hits_a_wall_at_an_angle() {
    // v^2 / (2 mu g) along the wall, and along (3, 1) after a rebound with half the speed.
    let slide = |speed: Vec2| speed * (speed.norm() / (2.0 * MU * GRAVITY));
    for (restitution, end) in [(0.0, slide(Vec2::new(0.3, 0.0))), (0.5, slide(Vec2::new(0.3, 0.1)))] {
        let system = disc(vec![elastic(wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.0), restitution)]);
        let away = |options: &BackendOptions| (coasted(&system, moving(0.3, -0.2), options, 60).motion().pose.position - end).norm();
        assert!(away(&exact(Inertial, &system, 1e-9)) < EXACT);
        let errors = [1e-3, 2.5e-4].map(|h| away(&BackendOptions::new(Inertial, h)));
        assert!(errors[0] < 3e-6 && 3.5 * errors[1] < errors[0], "at least first order: {errors:?}");
    }
}

/// A pusher behind a disc drives it against a wall. It is squeezed out along the wall at V cot a,
/// where a is the angle between wall and the line of the centres. Momentum gives the impulse of the
/// pusher, m V cos a / sin^2 a, and with it its work, m V^2 cot^2 a, and the loss, m V^2 / (2 sin^2
/// a). Energy that a moving obstacle adds while a fixed one is hit is its work.
#[test]
fn a_pusher_works_on_a_disc_that_hits_a_wall() {
    let (speed, angle, radius) = (0.1, PI / 3.0, 0.005);
    let towards = Vec2::new(angle.cos(), angle.sin());
    let way = Pose::new(speed, 0.0, 0.0);
    let pusher = Obstacle {
        path: ObstaclePath { waypoints: vec![(0.0, Pose::new(0.0, 0.0, 0.0)), (1.0, way)] },
        ..post(-(RADIUS + radius) * towards, radius)
    };
    let ahead = wall(Vec2::new(RADIUS + 1e-3, 0.0), Vec2::new(0.0, 1.0), 0.0);
    for obstacles in [vec![ahead.clone(), pusher.clone()], vec![pusher, ahead]] {
        let mut system = disc(obstacles);
        system.ground.friction_coefficient = 0.0;
        for options in [by(Integrator::Euler, 2e-3), by(Integrator::Midpoint, 2e-3), exact(Inertial, &system, 1e-9)] {
            let mut load = build(&system, moving(speed, 0.0), &options);
            // The impact is at 10 ms. What the pusher does in the nanosecond after it is a share of
            // 1e-9 V / R of its work.
            assert_eq!(load.advance(&[Vec2::zeros()], 0.01 + 1e-9).status, Status::Converged);
            let (twist, energy, unit) = (load.motion().twist, load.energy(), MASS * speed * speed);
            let cotangent = 1.0 / angle.tan();
            assert!((twist.linear - Vec2::new(0.0, speed * cotangent)).norm() < 1e-7 * speed, "{twist:?}");
            assert!((energy.obstacle_work - unit * cotangent * cotangent).abs() < 1e-7 * unit, "{energy:?}");
            assert!((energy.impacts - 0.5 * unit / angle.sin().powi(2)).abs() < 1e-7 * unit, "{energy:?}");
            assert!(energy.defect().abs() < 1e-7 * unit, "{energy:?}");
        }
    }
}

/// K14: K1 with inertia.
#[test]
fn a_disc_with_inertia_slides_along_a_wall() {
    let system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.0)]);
    let path = |s: f64| Vec2::new(0.06 * s, -0.02 * s);
    let error = |options: &BackendOptions, n| {
        let (load, report) = drive(&system, at_rest(0.0, 0.0), options, n, path);
        assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0));
        let Motion { pose, twist } = load.motion();
        ((pose.position - Vec2::new(0.026065257955, 0.0)).norm(), (twist.linear.x - 0.117503405139).abs())
    };
    let of = |integrator| [200, 400, 800].map(|n| error(&BackendOptions { integrator, ..fixed(Inertial, n) }, n).0);
    let [coarse, middle, fine] = of(Integrator::Euler);
    assert!(coarse > 1.5 * middle && middle > 1.5 * fine, "first order: {coarse:e} {middle:e} {fine:e}");
    let [coarse, middle, fine] = of(Integrator::Midpoint);
    assert!(coarse > 3.5 * middle && middle > 3.5 * fine, "second order: {coarse:e} {middle:e} {fine:e}");
    let (position, speed) = error(&exact(Inertial, &system, 1e-9), 40);
    assert!(position < EXACT && speed < 1e-9, "{position:e} {speed:e}");
}

/// Distance of two poses at the edge of the load, or more (m).
fn distance(a: &Pose, b: &Pose) -> f64 {
    (a.position - b.position).norm() + RADIUS * (a.heading - b.heading).abs()
}

/// K3 with inertia and a rough post, which turns the disc: steps of second order lead to the path
/// of a tolerance. Where nothing changes, each of them takes one solution. On a dashpot they take
/// more: its tip bends its path, so that it pulls otherwise at once.
#[test]
fn a_disc_with_inertia_goes_round_a_rough_post() {
    let mut system = disc(vec![Obstacle { friction_coefficient: 0.1, ..post(Vec2::zeros(), 0.005) }]);
    let start = (BEHIND / 0.035f64).asin() / 2.5;
    let path = |s: f64| 0.035 * direction(FRAC_PI_2 - 2.5 * (start + (1.0 - start) * s));
    let from = at_rest(0.0, 0.0172);
    for (damping_ratio, most_work) in [(0.0, 1e-6), (0.7, 1e-5)] {
        system.springs[0].damping_ratio = damping_ratio;
        let (exact, _) = drive(&system, from, &exact(Inertial, &system, 1e-9), 400, path);
        assert!(exact.motion().pose.heading.abs() > 0.1, "it turns");
        let [coarse, middle, fine] = [400, 800, 1600].map(|n| {
            let (load, report) = drive(&system, from, &fixed(Inertial, n), 400, path);
            assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0));
            // What side friction holds at rest at first takes more.
            assert!(damping_ratio > 0.0 || report.n_solves < 3 * report.n_steps, "{report:?}");
            // The work of the tip is within second order of a step of a four hundredth.
            let energy = load.energy();
            assert!(energy.defect().abs() < most_work * energy.tip_work, "{energy:?}");
            distance(&load.motion().pose, &exact.motion().pose)
        });
        // Steps that went on over a bend of a damped tip would be wrong by 1e-5 m.
        let is_exact = if damping_ratio > 0.0 { coarse < 1e-6 && fine < 1e-7 } else { coarse > 3.5 * middle && middle > 3.5 * fine };
        assert!(is_exact, "second order: {coarse:e} {middle:e} {fine:e}");
    }
}

/// As above, along a rough wall on a dashpot whose tip goes straight on, but for one bend at most:
/// each step takes one solution.
#[test]
fn a_dashpot_draws_a_disc_along_a_rough_wall() {
    let mut system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.3)]);
    system.springs[0].damping_ratio = 0.7;
    for bend in [0.0, 0.03] {
        let path = |s: f64| Vec2::new(0.06 * s - bend * (s - 0.5).max(0.0), -0.02 * s);
        let (exact, _) = drive(&system, at_rest(0.0, 0.0), &exact(Inertial, &system, 1e-9), 200, path);
        let Motion { pose, .. } = exact.motion();
        assert!(pose.position.x > 0.005 && pose.heading.abs() > 0.01, "it rolls and slides: {pose:?}");
        let [coarse, middle, fine] = [200, 400, 800].map(|n| {
            let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(Inertial, n), 200, path);
            assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0));
            assert!(report.n_solves < 2 * report.n_steps, "{report:?}");
            // Losses are of first order where the disc starts.
            let (damping, exact) = (load.energy().damping, exact.energy().damping);
            assert!((damping - exact).abs() < 1e-3 * exact, "{damping:e} {exact:e}");
            distance(&load.motion().pose, &pose)
        });
        assert!(coarse > 3.5 * middle && middle > 3.5 * fine, "second order: {coarse:e} {middle:e} {fine:e}");
    }
}

/// A disc is pulled against a post, stands there, and is then pulled on along it until it parts.
/// Macro-steps are short where it starts again. There the velocity of a chord must not be taken for
/// the load's: it would part from the post and hit it dozens of times, and macro-steps would remain
/// short.
#[test]
fn a_disc_starts_again_along_a_post() {
    let tip = |s: f64| Vec2::new(0.06 * (2.5 * s).min(1.0), 0.18 * (s - 0.5).max(0.0));
    for (damping_ratio, friction) in [(0.3, 0.0), (0.0, 0.3), (0.3, 0.3)] {
        let post = Obstacle { friction_coefficient: friction, ..post(Vec2::new(0.0222, -0.004), 0.005) };
        let mut system = disc(vec![post]);
        system.springs[0].damping_ratio = damping_ratio;
        let ends = [1e-6, 1e-8].map(|tolerance| {
            let (load, report) = drive(&system, at_rest(0.0, 0.0), &exact(Inertial, &system, tolerance), 200, tip);
            assert_eq!(report.n_not_converged, 0);
            // It takes 65,000 at most, and 400,000 and more where macro-steps remain short.
            assert!(report.n_solves < 150_000, "{damping_ratio} {friction} {tolerance:e}: {report:?}");
            load.motion().pose
        });
        // The tolerances are of the whole run.
        assert!(distance(&ends[0], &ends[1]) < 1e-6 + 1e-8, "{damping_ratio} {friction}: {ends:?}");
    }
}

/// Contact forces have their digits in steps of a nanosecond, at 0.5 m from the origin, where the
/// last digit of a position would ask for 0.1 N: at a wall, round a post, on a post under a face,
/// and before a pusher.
#[test]
fn contact_forces_have_their_digits_in_short_steps() {
    let (speed, at) = (0.1, Vec2::new(0.5, 0.0));
    let start = Motion { pose: Pose { position: at, heading: 0.0 }, twist: Twist { linear: Vec2::new(speed, 0.0), angular: 0.0 } };
    let arm = RADIUS + 0.005;
    let below = |depth: f64| post(at - Vec2::new(0.0, depth + 0.005), 0.005);
    let path = ObstaclePath { waypoints: vec![(0.0, Pose::new(0.0, 0.0, 0.0)), (1.0, Pose::new(speed, 0.0, 0.0))] };
    let pusher = Obstacle { path, ..post(at - Vec2::new(arm, 0.0), 0.005) };
    let (pulled, pull) = (Some(at - Vec2::new(0.0, 0.02)), 0.02 * STIFFNESS);
    let centripetal = MASS * speed * speed / arm;
    // Forces, and what they may be wrong by: the load has moved by less than 1e-6 m from where they
    // are these. On a curve, steps of second order begin anew with the force of a chord.
    let scenes = [
        (disc(vec![wall(at - Vec2::new(0.0, RADIUS), Vec2::new(1.0, 0.0), 0.0)]), pulled, pull, 1e-6 * pull),
        (disc(vec![below(RADIUS)]), pulled, pull - centripetal, 0.6 * centripetal),
        (boxed(vec![below(0.008)], Vec2::zeros()), pulled, pull, 1e-6 * pull),
        (disc(vec![pusher]), None, LIMIT, 1e-6 * LIMIT),
    ];
    for (case, (system, tip, force, error)) in scenes.into_iter().enumerate() {
        let mut load = build(&system, start, &by(Integrator::Euler, 1e-6));
        if let Some(tip) = tip {
            load.attach(0, tip);
        }
        let target = [tip.unwrap_or_default()];
        // Shorter steps than this one would not yet see that the load touches. It is straight, so
        // that on a curve the load is free for the first of the short ones.
        load.advance(&target, 1e-6);
        for n in 1..=400 {
            let status = load.advance(&target, 1e-9).status;
            let found: Vec<f64> = load.side_contacts().iter().map(|contact| contact.force.norm()).collect();
            let is_exact = found.len() == 1 && (found[0] - force).abs() < error;
            assert!(status == Status::Converged && (n < 100 || is_exact), "case {case}, step {n}: {found:?} for {force}");
        }
    }
}

/// A disc that spins while it slides along a wall: friction turns with the load.
#[test]
fn a_spinning_disc_slides_along_a_wall() {
    let system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.1)]);
    let start = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::new(0.5, 0.0), angular: 30.0 } };
    let end = |options: &BackendOptions| {
        let mut load = build(&system, start, options);
        let tip = |time: f64| Vec2::new(0.5 * time, -0.03);
        load.attach(0, tip(0.0));
        let mut report = StepReport::default();
        for tick in 1..=10 {
            report.add(&load.advance(&[tip(1e-3 * f64::from(tick))], 1e-3));
        }
        assert_eq!(report.status, Status::Converged);
        load.motion().pose
    };
    let exact = end(&exact(Inertial, &system, 1e-9));
    assert!(exact.heading > 0.05, "{exact:?}");
    let [coarse, middle, fine] = [1e-3, 5e-4, 2.5e-4].map(|step| distance(&end(&by(Integrator::Midpoint, step)), &exact));
    assert!(coarse > 3.5 * middle && middle > 3.5 * fine, "second order: {coarse:e} {middle:e} {fine:e}");
}

/// A disc with rough sides is drawn into a notch at a right angle. Where it arrives, each impact on
/// one side opens the contact with the other one, hardly faster than rounding, and the next one
/// follows at once. A step does not follow them for ever.
#[test]
fn a_step_with_endless_impacts_takes_bounded_work() {
    let depth = RADIUS / f64::sin(0.5 * 1.57);
    let side = |sign: f64| 2.0 * (depth + RADIUS) * direction(FRAC_PI_2 + sign * 0.5 * 1.57);
    let walls = OutlinePart::Polyline { points: vec![side(1.0), Vec2::zeros(), side(-1.0)] };
    let system = disc(vec![obstacle(walls, 1.5)]);
    let start = Vec2::new(0.0, depth + 0.2 * RADIUS);
    let mut load = build(&system, at_rest(start.x, start.y), &BackendOptions::new(Inertial, 2e-3));
    load.attach(0, start);
    let mut most = 0;
    for k in 1..=40 {
        let tip = start + f64::min(f64::from(k) / 30.0, 1.0) * 3.0 * BEHIND * direction(0.3 - FRAC_PI_2);
        let report = load.advance(&[tip], 2e-3);
        assert_eq!(report.status, Status::Converged);
        most = report.n_iterations.max(most);
    }
    assert!(most < 30_000, "{most} iterations");
    let gap = load.motion().pose.position - Vec2::new(0.0, depth);
    assert!(gap.norm() < 1e-6 * RADIUS, "it ends in the notch: {gap}");
}

/// Two smooth fingers push a box, fall behind it, and turn. Where one of them hits it, the box
/// parts from the other one at (I - m b^2) / (I + m b^2) of that speed, with the arm b of the
/// fingers, and friction brings it back. It rocks ever faster, until that takes less than a step.
/// From then on it touches both, and moves as they do.
#[test]
fn a_box_rocks_between_two_fingers_and_comes_to_rest() {
    let (arm, radius, turn_rate) = (0.0075, 0.002, 0.5);
    let finger = |side: f64| OutlinePart::Disc { centre: Vec2::new(-BOX[0] - radius, side * arm), radius };
    let way = [(0.0, Pose::new(-1e-4, 0.0, 0.0)), (0.1, Pose::new(0.006, 0.0, 0.0)), (0.3, Pose::new(0.016, 0.0, 0.2 * turn_rate))];
    let fingers = Obstacle {
        outline: Outline { parts: vec![finger(1.0), finger(-1.0)] },
        path: ObstaclePath { waypoints: way.to_vec() },
        ..obstacle(finger(1.0), 0.0)
    };
    for step in [1e-3, 2.5e-4] {
        let mut system = boxed(vec![fingers.clone()], Vec2::zeros());
        system.ground.friction_coefficient = 0.1;
        let mut load = build(&system, at_rest(0.0, 0.0), &by(Integrator::Midpoint, step));
        let mut impacts = Vec::new();
        for tick in 0..300 {
            assert_eq!(load.advance(&[Vec2::zeros()], 1e-3).status, Status::Converged);
            let since = 1e-3 * f64::from(tick);
            let is_impact = |transition: &&Transition| matches!(transition.kind, TransitionKind::Impact { .. });
            impacts.extend(load.transitions().iter().filter(is_impact).map(|impact| since + impact.time));
        }
        // One where both meet the box, and others after they fell behind, none within a step: at
        // most five, as each speed is 0.14 of the last one, and so is nearly each time apart.
        assert!(impacts[0] < 0.01 && impacts[1] > 0.1 && (2..8).contains(&impacts.len()), "{impacts:?}");
        assert!(impacts.windows(2).all(|two| two[1] - two[0] > step), "{impacts:?}");
        // Both contacts keep the box on the fingers to rounding.
        let Motion { pose, twist } = load.motion();
        assert!((twist.angular - turn_rate).abs() < 1e-9 * turn_rate, "{twist:?}");
        assert!((pose.heading - 0.2 * turn_rate).abs() < 1e-9, "{pose:?}");
    }
}

/// A box on a soft spring slides along a rough wall and past two posts, and parts from each. Where
/// a contact parts, steps so short that rounding of the gap is a force do not agree at any length,
/// and the control took them for converged. Both tolerances lead to the same end, up to what errors
/// of the looser one add up to.
#[test]
fn a_box_past_two_posts_ends_where_the_tolerance_says() {
    let text = include_str!("../common/box-past-posts.json");
    let Scenario { system, start, drive: Drive::Tips(paths), .. } = Scenario::parse(text, "box past posts").unwrap() else {
        panic!("tips are prescribed")
    };
    let [from, to] = [0, 1].map(|at| paths[0].waypoints[at].position);
    let radius = system.load.radius;
    let ends = [1e-5, 1e-6].map(|size| {
        let mut load = build(&system, start, &exact(Inertial, &system, size * radius));
        load.attach(0, from);
        let mut report = StepReport::default();
        for tick in 1..=200 {
            report.add(&load.advance(&[from + f64::from(tick) / 200.0 * (to - from)], 0.01));
        }
        assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0), "{report:?}");
        load.motion().pose
    });
    assert!(ends[0].edge_displacement(&ends[1], radius) < 3e-5 * radius, "{ends:?}");
}

/// A spring presses a box on a rough wall and swings it to and fro: each swing is half a period
/// long, about a centre that friction shifts by mu d, with d the depth of the tip behind the wall's
/// balance. Where a swing ends, slip and friction reverse at once. All steps of a macro-step may
/// end before that, and the extrapolated answer behind it.
#[test]
fn a_box_swings_along_a_rough_wall() {
    let (friction, depth, first) = (0.2, 0.02, 0.03);
    let mut system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), friction)], Vec2::zeros());
    system.ground.friction_coefficient = 0.0;
    let (shift, rate) = (friction * depth, (STIFFNESS / MASS).sqrt());
    let place = |time: f64| {
        let swing = (rate * time / PI).floor();
        let sign = if swing % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let phase = rate * time - PI * swing;
        sign * (shift + (first - (2.0 * swing + 1.0) * shift) * phase.cos())
    };
    let tip = Vec2::new(0.0, -depth);
    // Where a swing ends, slips up to 1e-11 of the load's size do not point friction yet: they take
    // 2e-6 s, at an acceleration of mu k d / m more than there should be.
    for (tolerance, error) in [(1e-5, 1e-5), (1e-6, 1e-6), (1e-7, 1e-6)] {
        let mut load = build(&system, at_rest(first, 0.0), &exact(Inertial, &system, tolerance));
        load.attach(0, tip);
        for tick in 1..=40 {
            assert_eq!(load.advance(&[tip], 0.01).status, Status::Converged);
            let (time, Motion { pose, .. }) = (0.01 * f64::from(tick), load.motion());
            assert!((pose.position - Vec2::new(place(time), 0.0)).norm() < error, "{tolerance:e} {time}: {pose:?} {}", place(time));
        }
    }
}

/// A load in the shape of an L is drawn against a rough wall, lands flush on it, and turns over it.
/// On the way its corner slides to and fro. The end is that of an independent solver, with
/// regularised friction and stiff contact, extrapolated in both; it is known to 2e-8 m.
#[test]
fn an_ell_lands_flush_and_turns_over_a_wall() {
    let text = include_str!("../common/ell-lands-flush.json");
    let Scenario { system, start, drive: Drive::Tips(paths), duration, .. } = Scenario::parse(text, "ell").unwrap() else {
        panic!("tips are prescribed")
    };
    let ends: Vec<[Vec2; 2]> = paths.iter().map(|path| [0, 1].map(|at| path.waypoints[at].position)).collect();
    let at = |share: f64| ends.iter().map(|[from, to]| from + share * (to - from)).collect::<Vec<_>>();
    let mut load = build(&system, start, &exact(Inertial, &system, 1e-8));
    for (path, tip) in paths.iter().zip(at(0.0)) {
        load.attach(path.spring, tip);
    }
    for tick in 1..=500 {
        let report = load.advance(&at(f64::from(tick) / 500.0), duration / 500.0);
        assert_eq!(report.status, Status::Converged, "{report:?}");
    }
    let pose = load.motion().pose;
    assert!((pose.position - Vec2::new(0.0269591709, 0.0477562661)).norm() < 2e-8, "{pose:?}");
    // The heading is known to seven digits.
    assert!((pose.heading + 3.3782493).abs() < 1e-7, "{pose:?}");
}
