//! Quasi-static steps of second order: the same paths, sooner.

use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, Skips, Status, Tolerance, build};
use cohaul::math::{Pose, Twist, Vec2, Vec3, rotation};
use cohaul::model::System;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};
use cohaul_studies::subject::Runs;
use cohaul_studies::verify::reference::QUASI_STATIC;

use crate::common::*;

fn second_order(system: &System, start: Motion) -> Box<dyn Backend> {
    build(system, start, &BackendOptions { second_order: true, ..BackendOptions::new(BackendKind::QuasiStatic, f64::INFINITY) })
}

/// Error of the reference scene's end in n steps of one second, over the extent of its way (1):
/// 0.05 m and half a radian.
fn end_error(n: u32, mut run: Box<dyn Backend>) -> f64 {
    let report = drive(run.as_mut(), reference_tips, 1.0, n, |_, _| ());
    assert_eq!(report.status, Status::Converged, "{n}");
    (entries(&run.motion().pose) - Vec3::from(QUASI_STATIC[1])).component_div(&Vec3::new(0.05, 0.05, 0.5)).amax()
}

/// The reference scene rests, turns about a support and slips: changes of regime within steps cost
/// both methods an error of second order that jumps from step to step, by up to itself. Over three
/// halvings Euler's falls by 8, that of second order by 64.
#[test]
fn errors_fall_with_the_square_of_the_step() {
    let system = paper_system(paper_springs(4));
    let error = |n| end_error(n, second_order(&system, at_rest()));
    for n in [100, 200, 400] {
        let gain = error(n) / error(8 * n);
        assert!((32.0..128.0).contains(&gain), "{n}: {gain}");
    }
    let euler = end_error(800, backend(BackendKind::QuasiStatic, &system, at_rest(), 1.0));
    assert!(error(800) < 0.02 * euler, "{} {euler}", error(800));
}

/// A slip whose tips go on by steps of two lengths in turn is of second order too: the past counts
/// by its time.
#[test]
fn steps_of_two_lengths_keep_the_order() {
    let system = paper_system(paper_springs(4));
    let end = |n: u32| {
        let mut run = second_order(&system, at_rest());
        for (spring, tip) in reference_tips(0.0) {
            run.attach(spring, tip);
        }
        let mut n_steps = 0;
        for i in 0..n {
            // Of a pair the second is 1.8 times as long.
            for (from, to) in [(0.0, 1.0 / 2.8), (1.0 / 2.8, 1.0)] {
                let at = |share: f64| (f64::from(i) + share) / f64::from(n);
                let mut targets = vec![Vec2::zeros(); 4];
                reference_tips(at(to)).into_iter().for_each(|(spring, tip)| targets[spring] = tip);
                n_steps += run.advance(&targets, at(to) - at(from)).n_steps;
            }
        }
        assert!(n_steps >= u64::from(2 * n));
        (entries(&run.motion().pose) - Vec3::from(QUASI_STATIC[1])).component_div(&Vec3::new(0.05, 0.05, 0.5)).amax()
    };
    let gain = end(100) / end(800);
    assert!((32.0..128.0).contains(&gain), "{gain}");
}

/// Before 1.596 s the springs of this scene are not convex, as some are pushed together: friction
/// along the slip makes up for it, and the path is of second order all the same. What a plain step
/// is off by there, 60 nm at 0.6 ms, is far above the exact run's tolerance.
#[test]
fn springs_that_are_not_convex_are_followed_too() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/four-tips-held.json");
    let scenario = Scenario { duration: 1.595, ..Scenario::read(file.as_ref()).unwrap() };
    let end = |options: &BackendOptions| {
        let mut run = Simulation::new(&scenario, options, Keep::Outcome);
        run.run(|_| true);
        run.motion().pose
    };
    let exact = end(&BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-10, &scenario.system.load)));
    let error = |second_order| {
        let options = BackendOptions { second_order, ..BackendOptions::new(BackendKind::QuasiStatic, 6.25e-4) };
        distance(&end(&options), &exact)
    };
    let (plain, second) = (error(false), error(true));
    assert!(plain > 1e-8 && second < 0.1 * plain, "{second} {plain}");
}

/// The energy that the steps lose or gain falls at least as fast as the error, where Euler's is of
/// first order.
#[test]
fn books_close_to_second_order() {
    let defect = |n| {
        let mut run = second_order(&paper_system(paper_springs(4)), at_rest());
        drive(run.as_mut(), reference_tips, 1.0, n, |_, _| ());
        run.energy().defect().abs() / run.energy().tip_work
    };
    let (coarse, fine) = (defect(100), defect(800));
    assert!(coarse < 1e-3 && fine < coarse / 32.0, "{coarse} {fine}");
}

/// A load is dragged one way, rests while its tip does, and is dragged another way: what it did
/// before says nothing of how it goes on.
#[test]
fn a_pause_does_not_cost_the_order() {
    let system = paper_system(vec![paper_springs(1)[0]]);
    let tip = |t: f64| {
        let (along, across) = (t.min(2.0), (t - 2.5).max(0.0));
        vec![(0, Vec2::new(LOAD_RADIUS + REST_LENGTH + 0.05 * along, 0.005 * along + 0.05 * across))]
    };
    let end = |options: &BackendOptions, n: u32| {
        let mut run = build(&system, at_rest(), options);
        drive(run.as_mut(), tip, 4.5, n, |_, _| ());
        run.motion().pose
    };
    let exact = end(&BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-10, &system.load)), 450);
    let of_second_order = BackendOptions { second_order: true, ..BackendOptions::new(BackendKind::QuasiStatic, f64::INFINITY) };
    let [coarse, fine] = [900, 3600].map(|n| distance(&end(&of_second_order, n), &exact));
    // Sixteen, but for onsets within steps.
    assert!(coarse / fine > 12.0, "{coarse} {fine}");
    // Whether the rest is gone through or left out makes no difference but rounding.
    let gone_through = end(&BackendOptions { skips: Skips { still_tips: false, ..Skips::ALL }, ..of_second_order }, 900);
    assert!(distance(&gone_through, &end(&of_second_order, 900)) < 1e-13);
}

/// Far from the world's origin places have fewer digits, which no tolerance may ask for: steps take
/// no more solutions, and are still of second order.
#[test]
fn far_from_the_origin_only_digits_are_lost() {
    let system = paper_system(paper_springs(4));
    let run = |away: Vec2, second_order| {
        let start = Motion { pose: Pose { position: away, heading: 0.0 }, twist: Twist::ZERO };
        let tips = move |t: f64| reference_tips(t).into_iter().map(|(spring, tip)| (spring, tip + away)).collect::<Vec<_>>();
        let options = BackendOptions { second_order, ..BackendOptions::new(BackendKind::QuasiStatic, 1.0 / 800.0) };
        let (poses, report) = path(&system, start, &Runs::of(options), &tips, 1.0);
        (poses.last().unwrap().position - away, report.n_solves)
    };
    for second_order in [false, true] {
        let (here, n_here) = run(Vec2::zeros(), second_order);
        for away in [Vec2::new(10.0, -7.0), Vec2::new(100.0, -70.0)] {
            let (there, n_there) = run(away, second_order);
            // Eight hundred steps, each off by a few roundings of the place.
            let rounding = 800.0 * 10.0 * f64::EPSILON * away.norm();
            assert!((there - here).norm() < rounding, "{second_order} {away}: {:e}", (there - here).norm());
            assert!(n_there as f64 <= 1.1 * n_here as f64, "{second_order} {away}: {n_there} for {n_here}");
        }
    }
}

/// Neither where the scene stands nor how fast it happens matters: the former to rounding of places
/// of 0.3 m, the latter, by powers of two, to the last bit.
#[test]
fn place_and_pace_do_not_matter() {
    let system = paper_system(paper_springs(4));
    let path = |start: Pose, duration: f64| {
        let mut run = second_order(&system, Motion { pose: start, twist: Twist::ZERO });
        let mut poses = Vec::new();
        let tips = |t: f64| reference_tips(t / duration).into_iter().map(|(spring, tip)| (spring, start.to_world(&tip))).collect();
        drive(run.as_mut(), tips, duration, 128, |_, run| poses.push(run.motion().pose));
        poses
    };
    let home = Pose::new(0.0, 0.0, 0.0);
    let (reference, slow, moved) = (path(home, 1.0), path(home, 1024.0), Pose::new(0.3, -0.2, 1.1));
    assert_eq!(reference, slow);
    for (here, there) in reference.iter().zip(path(moved, 1.0)) {
        let position = rotation(moved.heading).tr_mul(&(there.position - moved.position));
        let back = Pose { position, heading: there.heading - moved.heading };
        assert!(distance(here, &back) < 1e-14, "{here:?} {back:?}");
    }
}
