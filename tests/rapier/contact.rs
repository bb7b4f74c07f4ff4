//! Claims about a load among obstacles, with the known answers of point contact under Coulomb's
//! law.

use std::f64::consts::FRAC_PI_2;

use cohaul::backend::rapier::{Precision, RapierOptions};
use cohaul::backend::{BackendKind, BackendOptions, Status, Tolerance, build};
use cohaul::math::{Pose, Vec2, direction};
use cohaul::model::{Obstacle, ObstaclePath, Outline, System, World};

use crate::obstacle_scenes::*;
use crate::scenes::*;

const MM: f64 = 1e-3;
/// Stiffness of the spring (N/m).
const STIFFNESS: f64 = 0.664;

/// Tip of the pulls along a wall, which goes away from it as it goes along (m).
fn along_the_wall(s: f64) -> Vec2 {
    MM * Vec2::new(60.0 * s, -20.0 * s)
}

fn at_origin() -> Pose {
    Pose::new(0.0, 0.0, 0.0)
}

/// A disc that rests on a wall without friction.
fn disc_on_a_wall() -> System {
    on_a_spring(Vec2::zeros(), Outline::disc(RADIUS), vec![standing(wall([-1.0, -RADIUS], [1.0, -RADIUS]))])
}

/// A box that rests on a wall with friction.
fn box_on_a_wall() -> System {
    let wall = Obstacle { friction_coefficient: 0.3, ..standing(wall([-1.0, -BOX.y], [1.0, -BOX.y])) };
    on_a_spring(Vec2::zeros(), box_outline(), vec![wall])
}

/// A disc above a round post, and the tip that goes round the post.
fn disc_at_a_post() -> (System, Pose, fn(f64) -> Vec2) {
    let system = on_a_spring(Vec2::zeros(), Outline::disc(RADIUS), vec![standing(Outline::disc(5.0 * MM))]);
    (system, Pose::new(0.0, 17.2 * MM, 0.0), |s| 35.0 * MM * direction(FRAC_PI_2 - 2.5 * s))
}

/// The end of the disc round the post without inertia (m).
const ROUND_THE_POST: Vec2 = Vec2::new(16.379861540e-3, 5.247869655e-3);

/// Asserts that halving the step halves an error, within a tenth.
fn assert_halves(errors: [f64; 2]) {
    let ratio = errors[0] / errors[1];
    assert!((1.8..2.2).contains(&ratio), "{errors:?}");
}

/// K1 and K14: a load that nothing resists but the ground slides d0 = f / k behind its tip. The
/// heading errs, since the linear spring of a step does not turn with the load.
#[test]
fn a_disc_slides_along_a_wall() {
    let of = |step| run(&light(disc_on_a_wall()), at_origin(), RapierOptions::default(), 4.0, step, along_the_wall);
    let end = of(1e-3);
    assert_eq!(end.report.status, Status::Converged);
    let pose = end.load.motion().pose;
    // What is left is the square of the heading's error.
    assert!((pose.position.x - 26.906024096386e-3).abs() < 2e-7, "{pose:?}");
    assert!(pose.position.y.abs() < 1e-15, "the wall gives way: {pose:?}");
    assert_halves([pose.heading, of(0.5e-3).load.motion().pose.heading]);
    // Friction times the path.
    assert!((end.load.energy().friction / 5.91243736e-4 - 1.0).abs() < 1e-4, "{:?}", end.load.energy());
    assert_eq!(end.load.energy().side_friction, 0.0);

    let error_of = |step| {
        let motion = run(&disc_on_a_wall(), at_origin(), RapierOptions::default(), 1.0, step, along_the_wall).load.motion();
        (motion.pose.position.x - 26.065257955e-3).abs().max(motion.pose.position.y.abs())
    };
    let errors = [0.5e-3, 0.25e-3].map(error_of);
    // 37 um of a path of 26 mm.
    assert!(errors[0] < 40e-6, "{errors:?}");
    assert_halves(errors);
}

/// K2: side friction adds mu p to the resistance. With inertia the box starts at the speed zero and
/// swings about its steady slide, without turning back.
#[test]
fn a_box_slides_along_a_rough_wall() {
    let end = run(&light(box_on_a_wall()), at_origin(), RapierOptions::default(), 4.0, 1e-3, along_the_wall);
    assert_eq!(end.report.status, Status::Converged);
    let (pose, energy) = (end.load.motion().pose, end.load.energy());
    // The direction of friction comes from forces with nine digits.
    assert!((pose.position.x - 20.906024096e-3).abs() < 1e-7, "{pose:?}");
    assert!(pose.position.y.abs() < 1e-15 && pose.heading.abs() < 1e-12, "{pose:?}");
    // The loss takes the push at the end of a step of 1 ms in 2.6 s of slide.
    assert!((energy.side_friction / 6.716687422e-5 - 1.0).abs() < 1e-3, "{energy:?}");
    assert!((energy.friction / 4.59397334e-4 - 1.0).abs() < 1e-3, "{energy:?}");

    let (omega, onset) = ((STIFFNESS / MASS).sqrt(), SLIP_LIMIT / STIFFNESS / 0.054);
    let exact = 0.054 * (1.0 - onset) - 0.054 / omega * (omega * (1.0 - onset)).sin();
    let error_of = |step| {
        let end = run(&box_on_a_wall(), at_origin(), RapierOptions::default(), 1.0, step, along_the_wall);
        assert_eq!(end.report.status, Status::Converged);
        (end.load.motion().pose.position.x - exact).abs()
    };
    let errors = [0.5e-3, 0.25e-3].map(error_of);
    // 104 um of a path of 20 mm.
    assert!(errors[0] < 0.11 * MM, "{errors:?}");
    assert_halves(errors);
}

/// A disc on a wall with friction.
fn disc_on_a_rough_wall(friction_coefficient: f64) -> System {
    let wall = Obstacle { friction_coefficient, ..standing(wall([-1.0, -RADIUS], [1.0, -RADIUS])) };
    on_a_spring(Vec2::zeros(), Outline::disc(RADIUS), vec![wall])
}

fn post(x: f64, y: f64, radius: f64) -> Obstacle {
    Obstacle { path: ObstaclePath::fixed(Pose::new(x * MM, y * MM, 0.0)), ..standing(Outline::disc(radius * MM)) }
}

/// K9 and K13: posts hold a disc where the geometry says, at any step.
#[test]
fn posts_hold_a_disc() {
    let ends =
        [(vec![post(50.0, 16.0, 5.0), post(50.0, -16.0, 5.0)], 120.0, 43.688106465), (vec![post(40.0, 10.0, 3.0)], 75.0, 28.552729583)];
    for (posts, tip, end) in ends {
        let system = light(on_a_spring(Vec2::zeros(), Outline::disc(RADIUS), posts));
        let found = run(&system, at_origin(), RapierOptions::default(), 4.0, 2e-3, |s| MM * Vec2::new(tip * s, 0.0));
        assert_eq!(found.report.status, Status::Converged);
        // The engine finds normals by iteration, to 5e-9 of the size of a shape.
        let error = (found.load.motion().pose.position - MM * Vec2::new(end, 0.0)).norm();
        assert!(error < 1e-8, "{end}: {error:e}");
    }
}

/// K12: a disc slides and turns along a wall.
#[test]
fn a_disc_slides_and_turns_along_a_wall() {
    let errors = [1e-3, 0.5e-3].map(|step| {
        let tip = |s: f64| MM * Vec2::new(80.0 * s, -20.0);
        let end = run(&light(disc_on_a_rough_wall(0.2)), at_origin(), RapierOptions::default(), 4.0, step, tip);
        assert_eq!(end.report.status, Status::Converged);
        let pose = end.load.motion().pose;
        ((pose.position - Vec2::new(43.8441255e-3, 0.0)).norm(), (pose.heading + 2.0031856).abs())
    });
    // 13 um of a path of 44 mm, and 0.043 of a turn of 2 rad.
    assert!(errors[0].0 < 14e-6 && errors[0].1 < 0.044, "{errors:?}");
    assert_halves(errors.map(|error| error.0));
    assert_halves(errors.map(|error| error.1));
}

/// End of a run of a second with the inertial backend, within 10 nm.
fn with_inertia(system: &System, path: impl Fn(f64) -> Vec2) -> Pose {
    let tolerance = Tolerance::at_edge(1e-8, &system.load);
    let mut load = build(system, at_rest(at_origin()), &BackendOptions::within(BackendKind::Inertial, tolerance));
    load.attach(0, path(0.0));
    for tick in 1..=N_TICKS {
        let status = load.advance(&[path(tick as f64 / N_TICKS as f64)], 1.0 / N_TICKS as f64).status;
        assert_eq!(status, Status::Converged);
    }
    load.motion().pose
}

/// K5 and K6 with inertia: the rear of a box lifts off a wall, and a disc rolls along one. The
/// errors vanish with the step, that of a lift in first order. Rolling starts from rest, where the
/// ground's friction turns the faster the less the load moves, so that its error falls slower.
#[test]
fn errors_of_a_lift_and_of_rolling_vanish_with_the_step() {
    let lift = on_a_spring(Vec2::new(0.0, 4.0 * MM), box_outline(), vec![standing(wall([-1.0, -BOX.y], [1.0, -BOX.y]))]);
    let errors = |system: &System, path: fn(f64) -> Vec2| {
        let exact = with_inertia(system, path);
        [0.5e-3, 0.25e-3].map(|step| {
            let end = run(system, at_origin(), RapierOptions::default(), 1.0, step, path);
            assert_eq!(end.report.status, Status::Converged);
            end.load.motion().pose.edge_displacement(&exact, RADIUS)
        })
    };
    // 45 um of a path of 27 mm.
    let [coarse, fine] = errors(&lift, |s| MM * Vec2::new(60.0 * s, -26.0 + 30.0 * s));
    assert!(coarse < 48e-6 && (1.5..2.6).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    // 0.37 mm of a path of 81 mm, of which a part falls with the square of the step.
    let [coarse, fine] = errors(&disc_on_a_rough_wall(2.0), |s| MM * Vec2::new(80.0 * s, -20.0));
    assert!(coarse < 0.4e-3 && (1.45..3.2).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// K3: the disc follows its tip round a post.
#[test]
fn a_disc_slides_round_a_post() {
    let (system, start, path) = disc_at_a_post();
    let light = light(system);
    let of = |step| {
        let end = run(&light, start, RapierOptions::default(), 4.0, step, path);
        assert_eq!(end.report.status, Status::Converged);
        end.load.motion().pose.position
    };
    let ends = [1e-3, 0.5e-3].map(of);
    // 5.7 um of a path of 20 mm.
    assert!((ends[0] - ROUND_THE_POST).norm() < 6e-6, "{ends:?}");
    assert_halves(ends.map(|end| (end - ROUND_THE_POST).norm()));
    // A step goes along the tangent, which leaves the circle by the square of its length.
    let gaps = ends.map(|end| end.norm() - 17.2 * MM);
    assert!(gaps[0] > 0.0 && gaps[0] < 5e-9 && (3.6..4.4).contains(&(gaps[0] / gaps[1])), "{gaps:?}");
}

/// With the settings of the engine, contacts are frozen until the load has moved by 50 mm: the disc
/// stays behind, at any step.
#[test]
fn as_shipped_a_disc_does_not_get_round_a_post() {
    let (system, start, path) = disc_at_a_post();
    for step in [1e-3, 0.5e-3] {
        let end = run(&system, start, RapierOptions::engine_defaults(), 4.0, step, path);
        let error = (end.load.motion().pose.position - ROUND_THE_POST).norm();
        assert!(error > 10.0 * MM, "{error}");
        assert_eq!(end.report.status, Status::NotConverged);
    }
}

/// K7: the speed of a rebound is exact, its time is known to a step.
#[test]
fn a_rebound_errs_by_its_time() {
    let ahead = RADIUS + 4.0 * MM;
    let wall = Obstacle { restitution: 0.6, ..standing(wall([ahead, -1.0], [ahead, 1.0])) };
    let system = without_springs(Outline::disc(RADIUS), vec![wall]);
    for step in [1e-3, 0.4e-3, 0.1e-3, 0.05e-3] {
        let end = let_go(&system, moving(Vec2::new(0.5, 0.0), 0.0), RapierOptions::default(), 0.1, step);
        assert_eq!(end.report.status, Status::Converged);
        let error = end.load.motion().pose.position.x - (4.0 - 1.836539974) * MM;
        // Measured 91, 51, 4.5, 5.6 um.
        assert!(error.abs() < 0.374 * step, "{step} {error}");
        // The speed at the wall errs by the friction of a step.
        let loss = end.load.energy().impacts / 7.1745536e-5 - 1.0;
        assert!(loss.abs() < 2.0 * 13.7 / 0.374 * step, "{step} {loss}");
    }
}

/// K11: an impact without friction keeps the speed along the wall.
#[test]
fn an_oblique_impact_keeps_the_speed_along_the_wall() {
    let system = |restitution| {
        let wall = Obstacle { restitution, ..standing(wall([-1.0, -RADIUS], [1.0, -RADIUS])) };
        without_springs(Outline::disc(RADIUS), vec![wall])
    };
    for step in [1e-3, 0.2e-3, 0.05e-3] {
        let start = moving(Vec2::new(0.3, -0.2), 0.0);
        let end = let_go(&system(0.0), start, RapierOptions::default(), 0.1, step);
        let at = end.load.motion().pose.position;
        // A slide from a speed falls short by half a step of it.
        assert!((at.x - 3.276539974 * MM + 0.15 * step).abs() < 0.005 * step, "{step} {at}");
        // The contact is a spring, which is not quite rigid in a short step.
        assert!(at.y.abs() < 1e-13, "{step} {at}");
        assert!((end.load.energy().impacts / 3.2e-5 - 1.0).abs() < 1e-8, "{:?}", end.load.energy());
        let at = let_go(&system(0.5), start, RapierOptions::default(), 0.1, step).load.motion().pose.position;
        // In both directions half a step of the speed.
        assert!((at - MM * Vec2::new(3.45378, 1.15126)).norm() < 0.2 * step, "{step} {at}");
    }
}

/// K10: a load that springs forward and stops at a wall loses there what a jump would lose.
#[test]
fn a_plastic_impact_loses_the_defect_of_a_jump() {
    let ahead = RADIUS + 10.0 * MM;
    let system = on_a_spring(Vec2::zeros(), Outline::disc(RADIUS), vec![standing(wall([ahead, -1.0], [ahead, 1.0]))]);
    let tip = Vec2::new(2.0 * SLIP_LIMIT / STIFFNESS, 0.0);
    let error_of = |step| {
        let end = run(&system, at_origin(), RapierOptions::default(), 0.1, step, |_| tip);
        assert!((end.load.motion().pose.position.x - 10.0 * MM).abs() < 1e-15, "{:?}", end.load.motion());
        (end.load.energy().impacts / 1.86544e-4 - 1.0).abs()
    };
    let errors = [0.25e-3, 0.125e-3].map(error_of);
    assert!(errors[0] < 4e-3, "{errors:?}");
    assert_halves(errors);
}

/// A load that is pressed on a wall with twice its slip limit, and pulled along it by less, rests.
#[test]
fn a_load_pressed_on_a_wall_does_not_creep() {
    let system = on_a_spring(Vec2::zeros(), box_outline(), vec![standing(wall([-1.0, -BOX.y], [1.0, -BOX.y]))]);
    for share in [0.0, 0.6, 0.9, 0.99] {
        let tip = SLIP_LIMIT / STIFFNESS * Vec2::new(share, -2.0);
        let mut load = backend(&system, at_rest(at_origin()), 1e-3, RapierOptions::default());
        load.attach(0, tip);
        let report = load.advance(&[tip], 0.3);
        assert_eq!(report.status, Status::Converged);
        // The sum of roundings of three hundred steps. Measured 2e-19.
        let pose = load.motion().pose;
        assert!(pose.edge_displacement(&at_origin(), RADIUS) < 1e-17, "{share} {pose:?}");
    }
}

/// A disc that pushes a box head-on takes it along exactly, and does the work of friction.
#[test]
fn a_pusher_takes_a_box_along() {
    let to = |x: f64| Pose::new(-BOX.x + x * MM, 0.0, 0.0);
    // It starts a millimetre before the box, and touches it with 20 mm/s.
    let path = ObstaclePath { waypoints: vec![(0.0, to(-6.0)), (1.0, to(14.0))] };
    let system = without_springs(box_outline(), vec![Obstacle { path, ..standing(Outline::disc(5.0 * MM)) }]);
    let defect_of = |step| {
        let end = let_go(&system, at_rest(at_origin()), RapierOptions::default(), 1.0, step);
        assert_eq!(end.report.status, Status::Converged);
        let (pose, energy) = (end.load.motion().pose, end.load.energy());
        assert!((pose.position.x - 19.0 * MM).abs() < 1e-15 && pose.heading.abs() < 1e-13, "{pose:?}");
        assert!((energy.friction / (SLIP_LIMIT * 19.0 * MM) - 1.0).abs() < 1e-9, "{energy:?}");
        // An impact with the speed of the pusher loses m v^2 / 2, and the rest is error.
        assert!(energy.impacts >= 3.2e-7, "{energy:?}");
        energy.defect() + energy.impacts - 3.2e-7
    };
    // Friction is lost in the step of the impact as well.
    assert!(defect_of(0.25e-3) < 0.6 * defect_of(0.5e-3));
}

/// Nothing distinguishes the axes of the world.
#[test]
fn a_turned_scene_moves_as_the_scene_does() {
    let (angle, shift) = (0.7, Vec2::new(0.03, -0.02));
    let pose = Pose { position: shift, heading: angle };
    let mut turned = box_on_a_wall();
    turned.world.obstacles[0].path = ObstaclePath::fixed(pose);
    let options = RapierOptions::default();
    let there = run(&turned, pose, options, 1.0, 1e-3, |s| pose.to_world(&along_the_wall(s))).load.motion().pose;
    let here = run(&box_on_a_wall(), at_origin(), options, 1.0, 1e-3, along_the_wall).load.motion().pose;
    let error = (there.position - pose.to_world(&here.position)).norm() + RADIUS * (there.heading - angle - here.heading).abs();
    // The engine finds normals by iteration, to 5e-9 of the size of a shape.
    assert!(error < 1e-8, "{error}");
}

#[test]
fn in_single_precision_a_box_slides_as_well() {
    let of = |precision| {
        let options = RapierOptions { precision, ..RapierOptions::default() };
        run(&box_on_a_wall(), at_origin(), options, 1.0, 1e-3, along_the_wall).load.motion().pose
    };
    let error = of(Precision::F32).edge_displacement(&of(Precision::F64), RADIUS);
    // Positions are rounded by 1e-9 m in each of a thousand steps.
    assert!(error > 0.0 && error < 20e-6, "{error}");
}

/// The engine with its own settings keeps contacts from step to step, which are saved as well.
#[test]
fn a_run_restored_in_contact_goes_on_bit_for_bit() {
    let post = ObstaclePath { waypoints: vec![(0.1, Pose::new(0.04, 0.006, 0.0)), (1.0, Pose::new(0.02, 0.006, 0.0))] };
    let mut system = box_on_a_wall();
    system.world.obstacles.push(Obstacle { path: post, ..standing(Outline::disc(5.0 * MM)) });
    let start = at_rest(Pose::new(0.0, 6.0 * MM, 0.0));
    let tip = |tick: u32| along_the_wall(f64::from(tick) / 400.0);
    for options in [RapierOptions::default(), RapierOptions::engine_defaults()] {
        let fresh = || backend(&system, start, 1e-3, options);
        let (mut load, mut copy) = (fresh(), fresh());
        load.attach(0, tip(0));
        copy.attach(0, tip(0));
        for tick in 1..=400 {
            for load in [&mut load, &mut copy] {
                load.advance(&[tip(tick)], 2.5e-3);
            }
            assert_eq!(load.motion(), copy.motion(), "{options:?} {tick}");
            assert_eq!(load.energy(), copy.energy(), "{options:?} {tick}");
            if tick % 50 == 0 {
                copy = fresh();
                copy.restore(&load.save().unwrap()).unwrap();
            }
        }
        let energy = load.energy();
        assert!(energy.obstacle_work != 0.0, "{options:?} {energy:?}");
    }
}

/// A load at rest without springs is not skipped once an obstacle comes.
#[test]
fn a_load_at_rest_waits_for_its_pusher() {
    let to = |x: f64| Pose::new(-BOX.x + x * MM, 0.0, 0.0);
    let path = ObstaclePath { waypoints: vec![(0.5, to(-6.0)), (1.0, to(0.0))] };
    let system = without_springs(box_outline(), vec![Obstacle { path, ..standing(Outline::disc(5.0 * MM)) }]);
    let mut load = backend(&system, at_rest(at_origin()), 1e-3, RapierOptions::default());
    for _ in 0..400 {
        load.advance(&[], 5e-3);
    }
    assert!((load.motion().pose.position.x - 5.0 * MM).abs() < 1e-15, "{:?}", load.motion());
}

/// A notch in the load is free.
#[test]
fn a_post_fits_into_a_notch() {
    let u = polygon(&[
        [-0.01, -0.01],
        [0.01, -0.01],
        [0.01, 0.01],
        [0.004, 0.01],
        [0.004, -0.004],
        [-0.004, -0.004],
        [-0.004, 0.01],
        [-0.01, 0.01],
    ]);
    let start = moving(Vec2::new(0.0, 0.3), 0.0);
    let end_with = |obstacles| let_go(&without_springs(u.clone(), obstacles), start, RapierOptions::default(), 0.1, 1e-3);
    let free = end_with(vec![]).load.motion().pose;
    // It slides 3.1 mm; the post has 4 mm to the bottom of the notch, and then 1 mm.
    let post = |y: f64| vec![Obstacle { path: ObstaclePath::fixed(Pose::new(0.0, y, 0.0)), ..standing(Outline::disc(2.0 * MM)) }];
    let beside = end_with(post(2.0 * MM));
    // Contacts change the order of the sums.
    assert!(beside.load.motion().pose.edge_displacement(&free, RADIUS) < 1e-15, "{free:?} {:?}", beside.load.motion());
    let stopped = end_with(post(-MM)).load.motion().pose;
    assert!((stopped.position.y - 1.0 * MM).abs() < 1e-13, "{stopped:?}");
}

/// An outline without obstacles changes nothing.
#[test]
fn without_obstacles_an_outline_does_not_count() {
    let bare = on_a_spring(Vec2::zeros(), Outline::default(), vec![]);
    let outlined = System { world: World { outline: box_outline(), obstacles: vec![] }, ..bare.clone() };
    let of = |system: &System| {
        let end = run(system, at_origin(), RapierOptions::default(), 1.0, 1e-3, along_the_wall);
        (end.load.motion(), end.load.energy(), end.report)
    };
    assert_eq!(of(&bare), of(&outlined));
}
