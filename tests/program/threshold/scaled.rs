//! Similarity of scaled scenes.

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row, Simulation};

const DOORWAY: &str = include_str!("../../common/three-robots-doorway.json");
const ANTS: &str = include_str!("../../../scenarios/paper/ten-ants-ten-springs.json");
const PUSHER: &str = include_str!("../../../scenarios/contact/push-aside.json");

fn scaled(text: &str, change: impl Fn(&mut Scenario)) -> Scenario {
    let mut scenario = Scenario::parse(text, "a scene").unwrap();
    scenario.duration = scenario.duration.min(4.0);
    change(&mut scenario);
    scenario.expanded().checked("a scaled scene").unwrap()
}

/// Rows at the control ticks of a run with this many steps in a control period.
fn run(scenario: &Scenario, kind: BackendKind, n_steps: f64) -> Vec<Row> {
    let options = BackendOptions::new(kind, scenario.control_period / n_steps);
    let mut run = Simulation::new(scenario, &options, Keep::Trace);
    run.run(|_| true);
    run.into_results().0.rows
}

/// Rounding grows over some thousand steps, and some absolute guards of the solvers do not scale.
const SAME: f64 = 1e-6;

fn assert_similar(one: &[Row], other: &[Row], [length, time]: [f64; 2], radius: f64) {
    assert!(one.len() == other.len() && one.len() > 50, "{} {}", one.len(), other.len());
    let last = one.last().unwrap().motion.pose;
    assert!(last.edge_displacement(&one[0].motion.pose, radius) > 0.1 * radius, "the load hardly moves");
    for (a, b) in one.iter().zip(other) {
        assert!((a.time * time / b.time - 1.0).abs() < 1e-9 || a.time == 0.0, "{} {}", a.time, b.time);
        let [a, b] = [a.motion.pose, b.motion.pose];
        let shift = (length * a.position - b.position).norm() / (length * radius) + (a.heading - b.heading).abs();
        assert!(shift < SAME, "{a:?} {b:?}");
    }
}

/// A scene of 4 times the size at the same speeds is similar to one at half the speed: they have
/// the same Froude number. Doubles of powers of two differ by no rounding of their own.
#[test]
fn a_larger_scene_is_a_slower_one() {
    for text in [DOORWAY, ANTS, PUSHER] {
        let (larger, slower) = (scaled(text, |scene| scene.scale_size(4.0)), scaled(text, |scene| scene.scale_speed(0.5)));
        let radius = slower.system.load.radius;
        for kind in [BackendKind::QuasiStatic, BackendKind::Inertial] {
            let [larger, slower] = [&larger, &slower].map(|scene| run(scene, kind, 4.0));
            assert_similar(&slower, &larger, [4.0, 2.0], radius);
        }
    }
}

/// Undamped quasi-static loads know no time, and ants of another speed have the same luck.
#[test]
fn a_faster_scene_has_the_same_quasi_static_path_and_another_one_with_inertia() {
    for text in [ANTS, PUSHER] {
        let undamped = |factor: f64| {
            scaled(text, |scene| {
                scene.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = 0.0);
                scene.scale_speed(factor);
            })
        };
        let (given, faster) = (undamped(1.0), undamped(4.0));
        let radius = given.system.load.radius;
        let [one, other] = [&given, &faster].map(|scene| run(scene, BackendKind::QuasiStatic, 1.0));
        assert_similar(&one, &other, [1.0, 0.25], radius);
        let [one, other] = [&given, &faster].map(|scene| run(scene, BackendKind::Inertial, 4.0).last().unwrap().motion.pose);
        assert!(one.edge_displacement(&other, radius) > 1e-3 * radius, "{one:?} {other:?}");
    }
}

/// The inverse factor restores the scene to rounding, so that no quantity is scaled twice or not at
/// all one way.
#[test]
fn the_inverse_factor_restores_a_scene() {
    type Change = fn(&mut Scenario, f64);
    let changes: [Change; 3] = [Scenario::scale_speed, Scenario::scale_size, |scene, factor| scene.system.scale_inertia(factor)];
    for text in [DOORWAY, ANTS, PUSHER] {
        for change in changes {
            let (given, back) = (scaled(text, |_| {}), scaled(text, |scene| [4.0, 0.25].into_iter().for_each(|by| change(scene, by))));
            assert_eq!(back, given);
        }
    }
}

#[test]
fn the_drive_speed_is_the_fastest_of_tips_obstacles_ants_and_start() {
    let speed = |text: &str| Scenario::parse(text, "a scene").unwrap().drive_speed();
    let ants = Scenario::parse(ANTS, "ants").unwrap();
    let cohaul::scenario::Drive::Ants(drive) = &ants.drive else { panic!("ants") };
    assert_eq!(ants.drive_speed(), drive.pull_speed);
    // 50 mm in a second.
    assert!((speed(include_str!("../../../scenarios/contact/pusher.json")) - 0.05).abs() < 1e-15);
    assert!((speed(include_str!("../../../scenarios/analytic/ramp-and-hold.json")) - 0.08).abs() < 1e-15);
}
