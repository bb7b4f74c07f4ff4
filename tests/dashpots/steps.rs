//! What the quasi-static method does with dashpots besides the motion: its ledger, its rest, its
//! jumps about damped springs, its order, the switch, its state and its contacts.

use cohaul::backend::{Backend, BackendKind, BackendOptions, Skips, TransitionKind, build};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use cohaul::simulation::Row;
use serde_json::{Value, json};

use crate::known::three_springs;
use crate::scene::*;

/// K3 with a dashpot of this ratio on each spring.
fn release(zeta: f64) -> Value {
    let reach = 1.8 * LIMIT / STIFFNESS;
    let springs = [isotropic(STIFFNESS, zeta), isotropic(STIFFNESS, zeta)];
    let paths = [path(0, &[[0.0, 0.0, 0.0], [0.4, reach, 0.0]]), released(1, &[[0.0, 0.0, 0.0], [0.4, -reach, 0.0]], 0.5)];
    scene(1.0, &springs, &paths)
}

fn fixed(step: f64) -> BackendOptions {
    BackendOptions::new(BackendKind::QuasiStatic, step)
}

/// Steps much longer than a relaxation lead to its end, and the dashpots take what is missing:
/// (F0 - f)^2 / 2 k.
#[test]
fn a_step_longer_than_a_relaxation_books_its_loss() {
    let scenario = parsed(&release(1e-3));
    let (rows, outcome) = run(&scenario, &fixed(2.5e-3));
    let end = rows.last().unwrap();
    let beyond = 0.8 * LIMIT;
    // What is left after the first steps, each a fortieth of the time before: rounding.
    assert!((end.motion.pose.position.x - beyond / STIFFNESS).abs() < 1e-12, "{:?}", end.motion.pose);
    let energy = outcome.energy;
    let known = beyond * beyond / (2.0 * STIFFNESS);
    // The tips lost c v^2 for 0.4 s before: 1e-3 of it.
    assert!((energy.damping / known - 1.0).abs() < 5e-3, "{:e} {known:e}", energy.damping);
    assert!(energy.defect().abs() < 1e-6 * known && energy.jumps == 0.0, "{:e}", energy.defect());
    assert_eq!(outcome.transitions.n_jumps, 0);
}

/// One step with still tips shows that the load rests, and the next ones are left out. Without that
/// all is the same to the bit.
#[test]
fn a_load_at_rest_is_left_alone_after_a_step() {
    let paths = [path(0, &[[0.0, 0.0, 0.0], [0.1, 0.005, 0.0]])];
    let scenario = parsed(&scene(0.5, &[isotropic(STIFFNESS, 0.5)], &paths));
    let (rows, outcome) = run(&scenario, &fixed(2.5e-3));
    assert!(rows.iter().all(|row| row.motion.pose == scenario.start.pose));
    // 40 control periods of four steps; the first one at rest is computed.
    assert_eq!(outcome.steps.skipped.still_tips, 39 * 4, "{:?}", outcome.steps);
    let (all, _) = run(&scenario, &BackendOptions { skips: Skips::NONE, ..fixed(2.5e-3) });
    assert_eq!(rows, all);
    // The pull of the dashpot ends with the motion of the tip.
    let pulls = [0.1, 0.11].map(|time| pull(rows.iter().find(|row| (row.time - time).abs() < 1e-9).unwrap(), 0).x);
    assert!((pulls[1] - 0.005 * STIFFNESS).abs() < 1e-15 && (pulls[0] - pulls[1] - 0.05 * dashpot(STIFFNESS, 0.5)).abs() < 1e-12);
}

/// A damped spring holds one point of the load for the moment. Undamped springs turn the load about
/// it at once when one of two is released, to where friction bears the rest of the torque.
#[test]
fn undamped_springs_jump_about_a_damped_one() {
    let at = |x: f64, y: f64, zeta: f64| {
        let mut spring = isotropic(STIFFNESS, zeta);
        spring["root_m"] = json!([x, y]);
        spring
    };
    let springs = [at(-RADIUS, 0.0, 1e3), at(RADIUS, 0.0, 0.0), at(RADIUS, 0.0, 0.0)];
    let stretch = 0.06;
    let scene = scene(1.0, &springs, &[path(0, &[[0.0, -RADIUS, 0.0]])]);
    let scenario = parsed(&scene);
    let held = Vec2::new(-RADIUS, 0.0);
    let arms = scenario.system.ground.supports.iter().map(|support| (support.offset - held).norm());
    let resisted: f64 = arms.zip(scenario.system.ground.slip_limits()).map(|(arm, limit)| arm * limit).sum();
    // The tip lies `stretch` across from the root, 2 R from the point that is held.
    let (across, along) = (stretch, 2.0 * RADIUS);
    let torque = |turn: f64| STIFFNESS * 2.0 * RADIUS * (across * turn.cos() - along * turn.sin());
    assert!(torque(0.0) > resisted);
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if torque(middle) > resisted { &mut low } else { &mut high }) = middle;
    }
    for options in [within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS), fixed(1e-6)] {
        let mut load = build(&scenario.system, scenario.start, &options);
        let tips = [held, Vec2::new(RADIUS, stretch), Vec2::new(RADIUS, -stretch)];
        (0..3).for_each(|spring| load.attach(spring, tips[spring]));
        load.advance(&tips, 1e-6);
        assert!(load.motion().pose.heading.abs() < 1e-12);
        load.release(2);
        load.advance(&tips, 1e-6);
        // The dashpot is a million times as stiff as the springs in the jump. As it takes its
        // force, the load turns by a further 3e-5 with less friction.
        let heading = load.motion().pose.heading;
        assert!((heading - low).abs() < 1e-4, "{heading} {low}");
        assert!((load.motion().pose.to_world(&held) - held).norm() < 1e-5 * RADIUS);
        let is_jump = |kind: &TransitionKind| matches!(kind, TransitionKind::Jump { is_uncertain: false, .. });
        assert!(load.transitions().iter().any(|it| is_jump(&it.kind)), "{:?}", load.transitions());
        let energy = load.energy();
        assert!((energy.defect() + energy.jumps).abs() < 1e-5 * energy.jumps, "{energy:?}");
    }
}

/// Steps of second order are of second order on damped springs as well: here of a load that is
/// towed aside and turns.
#[test]
fn steps_of_second_order() {
    let spring = |x: f64, y: f64, zeta: f64| {
        json!({
            "root_m": [x, y], "bearing_rad": 0.0, "rest_length_m": REST_LENGTH, "radial_stiffness_n_per_m": STIFFNESS,
            "torsional_stiffness_nm_per_rad": 4.52e-4, "damping_ratio": zeta,
        })
    };
    let springs = [spring(0.01, 0.006, 0.8), spring(0.01, -0.006, 0.3)];
    let tip = |y: f64| [RADIUS + REST_LENGTH, y];
    let straight = |j: usize, y: f64, v: [f64; 2]| {
        let [x, y] = tip(y);
        path(j, &[[0.0, x + 0.02, y], [1.0, x + 0.02 + v[0], y + v[1]]])
    };
    let scenario = parsed(&scene(1.0, &springs, &[straight(0, 0.006, [0.10, 0.04]), straight(1, -0.006, [0.09, 0.05])]));
    let exact = run(&scenario, &within(&scenario, BackendKind::QuasiStatic, 1e-9 * RADIUS)).0;
    let error = |step: f64, second_order: bool| {
        let rows = run(&scenario, &BackendOptions { second_order, ..fixed(step) }).0;
        let of = |(row, exact): (&Row, &Row)| row.motion.pose.edge_displacement(&exact.motion.pose, RADIUS);
        let pulls = |(row, exact): (&Row, &Row)| (pull(row, 0) - pull(exact, 0)).norm();
        [rows.iter().zip(&exact).map(of).fold(0.0, f64::max), pulls((&rows[90], &exact[90]))]
    };
    let [first, second] = [false, true].map(|second_order| [2.5e-3, 1.25e-3, 6.25e-4].map(|step| error(step, second_order)));
    for at in 0..2 {
        let ratios = [first, second].map(|errors| errors[1][at] / errors[2][at]);
        assert!((ratios[0] - 2.0).abs() < 0.2 && (ratios[1] - 4.0).abs() < 0.8, "{ratios:?}");
    }
}

/// The rate-independent model is that of the same scene without dashpots, to the bit.
#[test]
fn the_rate_independent_model_has_no_dashpots() {
    let scenario = parsed(&three_springs());
    let mut undamped = scenario.clone();
    undamped.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = 0.0);
    for options in [within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS), fixed(2.5e-3)] {
        let of = |scenario: &Scenario, rate_independent: bool| run(scenario, &BackendOptions { rate_independent, ..options });
        let (rows, outcome) = of(&scenario, true);
        let (expected, of_undamped) = of(&undamped, false);
        assert_eq!(rows, expected);
        assert_eq!(outcome.steps, of_undamped.steps);
        assert!(of(&scenario, false).0 != rows, "dashpots change the path");
    }
}

/// A restored run goes on to the bit, in the midst of a relaxation.
#[test]
fn a_restored_run_goes_on() {
    let scenario = parsed(&release(1.5));
    for options in [within(&scenario, BackendKind::QuasiStatic, 1e-6 * RADIUS), fixed(2.5e-3)] {
        let new = || build(&scenario.system, scenario.start, &options);
        let reach = 1.8 * LIMIT / STIFFNESS;
        let tips = [Vec2::new(reach, 0.0), Vec2::new(-reach, 0.0)];
        let (mut load, mut restored) = (new(), new());
        (0..2).for_each(|spring| load.attach(spring, tips[spring]));
        load.advance(&tips, 0.01);
        load.release(1);
        load.advance(&tips, 0.01);
        restored.restore(&load.save().unwrap()).unwrap();
        for _ in 0..5 {
            let moved = |load: &mut Box<dyn Backend>| (load.advance(&tips, 0.01), load.motion(), load.energy(), load.pull(0));
            assert_eq!(moved(&mut load), moved(&mut restored));
        }
    }
}

/// A pusher moves a load away from the resting tip of its damped spring and withdraws: the load
/// follows at the pace of its relaxation, to where friction holds it.
#[test]
fn a_load_relaxes_behind_a_pusher_that_withdraws() {
    let (zeta, reach) = (1.2, 0.08);
    let mut scene = scene(2.0, &[isotropic(STIFFNESS, zeta)], &[path(0, &[[0.0, 0.0, 0.0]])]);
    scene["load"]["outline"] = json!({ "disc": { "radius_m": RADIUS } });
    scene["load"].as_object_mut().unwrap().remove("radius_m");
    scene["obstacles"] = json!([{
        "name": "pusher", "outline": { "disc": { "radius_m": 0.01 } }, "friction_coefficient": 0.0,
        "path": { "waypoints": [
            [0.0, -RADIUS - 0.011, 0.0, 0.0], [1.0, -RADIUS - 0.01 + reach, 0.0, 0.0], [1.2, -0.2, 0.0, 0.0], [2.0, -0.2, 0.0, 0.0]
        ] },
    }]);
    let scenario = parsed(&scene);
    let time = dashpot(STIFFNESS, zeta) / STIFFNESS;
    let (rows, outcome) = run(&scenario, &within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS));
    let rest = LIMIT / STIFFNESS;
    let speed = (reach + 0.001) / 1.0;
    for row in &rows {
        let exact = match row.time {
            t if t <= 1.0 => (speed * t - 0.001).max(0.0),
            t => rest + (reach - rest) * (-(t - 1.0) / time).exp(),
        };
        let x = row.motion.pose.position.x;
        assert!((x - exact).abs() < 1e-8 * RADIUS, "{}: {x:e} by {:e}", row.time, x - exact);
    }
    let energy = outcome.energy;
    assert!(energy.defect().abs() < 1e-7 * energy.obstacle_work, "{energy:?}");
}
