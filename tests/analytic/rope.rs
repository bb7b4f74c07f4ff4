//! A rope, which pulls only: towing without inertia, a snatch with it, and a rope that tautens.

use std::f64::consts::PI;

use cohaul::backend::{BackendKind, BackendOptions, Motion, Status, Tolerance, build};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::{PolarSpring, SpringLaw, System};
use cohaul::scenario::Scenario;
use serde_json::json;

use crate::common::*;

/// Length without force (m).
const LENGTH: f64 = 0.05;

fn rope(root: Vec2) -> PolarSpring {
    PolarSpring { rest_length: LENGTH, law: SpringLaw::Rope, ..isotropic(root, 0.0) }
}

/// A load on one rope at its centre, on a ground with the paper's friction or without any.
fn system(has_friction: bool) -> System {
    let mut system = paper_system(vec![rope(Vec2::zeros())]);
    if !has_friction {
        system.ground.friction_coefficient = 0.0;
    }
    system
}

/// The load after its tip went from `from` to `to` (m) along an axis in n steps.
fn pulled(kind: BackendKind, system: &System, axis: Vec2, [from, to]: [f64; 2], duration: f64, n: u32) -> Motion {
    let mut run = backend(kind, system, at_rest(), duration / f64::from(n));
    run.attach(0, from * axis);
    run.advance(&[to * axis], duration);
    run.motion()
}

/// The load stands until the rope is longer than at rest by f / k, and then keeps that distance,
/// in any direction and at any step.
#[test]
fn without_inertia_a_rope_tows_once_it_is_taut() {
    let (system, lag) = (system(true), LENGTH + SLIP_LIMIT / RADIAL);
    for n in [1, 2, 7, 300] {
        for axis in [0.0, 0.7, 2.0, -1.3].map(direction) {
            for to in [0.8 * LENGTH, 0.999_999 * lag] {
                let stands = pulled(BackendKind::QuasiStatic, &system, axis, [0.2 * LENGTH, to], 1.0, n);
                assert_eq!(stands.pose, Pose::new(0.0, 0.0, 0.0), "{n} {to}");
            }
            let follows = pulled(BackendKind::QuasiStatic, &system, axis, [0.2 * LENGTH, 3.0 * LENGTH], 1.0, n);
            // Newton steps end at 1e-12 of the slip limit, over the stiffness.
            let error = (follows.pose.position - (3.0 * LENGTH - lag) * axis).norm();
            assert!(error < 1e-11 * LENGTH, "{n}: {error:e}");
        }
    }
}

/// A rope that is grasped when it pulls with fifty times the slip limit pulls the load, off its
/// centre, to where friction holds it. On its way there the rope is slack at some trials.
#[test]
fn without_inertia_a_rope_grasped_taut_comes_to_rest() {
    for (stiffness, place) in [(3000.0, [0.118, 0.248]), (3000.0, [0.12, -0.25]), (1500.0, [0.3, 0.3]), (6000.0, [-0.2, 0.2])] {
        let file = json!({
            "name": "grasped taut", "duration_s": 0.02, "control_period_s": 0.01,
            "load": { "mass_kg": 2.0, "outline": { "rectangle": { "size_m": [0.3, 0.2] } } },
            "ground": { "friction_coefficient": 0.05, "supports": { "uniform": { "n": 16 } } },
            "springs": [{
                "root_m": [-0.122_524_563_778_477_92, -0.027_788_505_203_278_566], "bearing_rad": 0.0, "rest_length_m": 0.05,
                "radial_stiffness_n_per_m": stiffness, "torsional_stiffness_nm_per_rad": 0.0, "law": "rope"
            }],
            "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0.0, place[0], place[1]]] }] }
        });
        let scenario = Scenario::parse(&file.to_string(), "grasped").unwrap();
        let mut run = build(&scenario.system, scenario.start, &BackendOptions::new(BackendKind::QuasiStatic, 1e-3));
        run.attach(0, Vec2::from(place));
        let report = run.advance(&[Vec2::from(place)], 0.01);
        let pull = run.pull(0).norm() / scenario.system.total_slip_limit();
        assert!(report.status == Status::Converged && pull > 0.0 && pull <= 1.0 + 1e-9, "{place:?}: {pull} {report:?}");
    }
}

/// Without friction, a taut rope that leaves at v brings the load to 2 v in half a period, and is
/// slack from then on: x = v t - (v / w) sin w t, and then x = v pi / w + 2 v (t - pi / w).
#[test]
fn with_inertia_a_snatch_leaves_the_load_at_twice_the_speed() {
    let system = system(false);
    let (rate, speed) = ((RADIAL / MASS).sqrt(), 0.01);
    for kind in WITH_INERTIA {
        let after = |time: f64, n: u32| pulled(kind, &system, direction(0.4), [LENGTH, LENGTH + speed * time], time, n);
        let along = |motion: Motion| [motion.pose.position, motion.twist.linear].map(|v| v.dot(&direction(0.4)));
        let errors = [200, 400, 800].map(|n| {
            let [x, v] = along(after(2.0 / rate, n));
            let taut = (x - speed / rate * (2.0 - 2f64.sin())).abs() * rate + (v - speed * (1.0 - 2f64.cos())).abs();
            let [x, v] = along(after(5.0 / rate, n));
            let slack = (x - speed / rate * (PI + 2.0 * (5.0 - PI))).abs() * rate + (v - 2.0 * speed).abs();
            [taut / speed, slack / speed]
        });
        // Of first order: w h is 1/160 in the finest steps, and the errors are some of it.
        for at in [0, 1] {
            assert!(errors[2][at] < 0.6 * errors[1][at] && errors[2][at] < 0.04, "{kind:?}: {errors:?}");
        }
    }
}

/// A load that flies away from a tip at rest is turned back by the rope: with the speed that it
/// had, and half a period after it has become taut.
#[test]
fn a_rope_that_tautens_throws_the_load_back() {
    let system = system(false);
    let (rate, speed) = ((RADIAL / MASS).sqrt(), 0.02);
    let start = Motion { twist: Twist { linear: Vec2::new(-speed, 0.0), angular: 0.0 }, ..at_rest() };
    let slack = 0.4 * LENGTH / speed;
    let duration = slack + PI / rate + 0.2 * LENGTH / speed;
    for kind in WITH_INERTIA {
        let errors = [1000, 4000].map(|n| {
            let mut run = backend(kind, &system, start, duration / f64::from(n));
            run.attach(0, Vec2::new(0.6 * LENGTH, 0.0));
            run.advance(&[Vec2::new(0.6 * LENGTH, 0.0)], duration);
            let motion = run.motion();
            ((motion.pose.position.x + 0.2 * LENGTH) / LENGTH).abs() + (motion.twist.linear.x / speed - 1.0).abs()
        });
        // Of first order: a quarter at a quarter of the step.
        assert!(errors[1] < 0.35 * errors[0] && errors[1] < 0.02, "{kind:?}: {errors:?}");
    }
}

/// Under error control the snatch keeps to its tolerance across the instant at which the rope
/// becomes slack, where its stiffness jumps.
#[test]
fn error_control_keeps_its_tolerance_across_slack() {
    let system = system(false);
    let (rate, speed) = ((RADIAL / MASS).sqrt(), 0.01);
    for tolerance in [1e-4, 1e-6] {
        let options = BackendOptions::within(BackendKind::Inertial, Tolerance::at_edge(tolerance, &system.load));
        let mut run = build(&system, at_rest(), &options);
        run.attach(0, Vec2::new(LENGTH, 0.0));
        let time = 5.0 / rate;
        let report = run.advance(&[Vec2::new(LENGTH + speed * time, 0.0)], time);
        let error = (run.motion().pose.position.x - speed / rate * (PI + 2.0 * (5.0 - PI))).abs();
        assert!(report.status == Status::Converged && error < tolerance, "{tolerance}: {error:e} {report:?}");
    }
}
