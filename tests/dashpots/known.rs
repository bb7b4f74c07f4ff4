//! Known answers K1 to K9 (isotropic springs at the centre unless said; u is the time since the
//! event, f the slip limit, T = c / k).

use std::f64::consts::FRAC_PI_2;

use cohaul::backend::{BackendKind, BackendOptions, build};
use cohaul::math::{Vec2, direction};
use cohaul::simulation::Row;
use serde_json::json;

use crate::scene::*;

/// Error of a position (m): the tolerance of the runs.
const POSITION: f64 = 1e-8 * RADIUS;
/// Error of a pull (N). Rates are less exact than positions: their errors are those of a macro-step
/// over its length.
const PULL: f64 = 1e-6 * LIMIT;

/// Asserts where the load is at all rows, and that it goes along x.
fn assert_path(rows: &[Row], exact: impl Fn(f64) -> f64) {
    for row in rows {
        let (position, x) = (row.motion.pose.position, exact(row.time));
        assert!((position - Vec2::new(x, 0.0)).norm() < POSITION, "{}: {position:?} not {x:e}, by {:e}", row.time, position.x - x);
    }
}

/// Asserts the pull of a spring along x at all rows in (from, to], which a change of the velocity
/// of a tip begins and the next one ends: pulls at an instant are those just before.
fn assert_pulls(rows: &[Row], [from, to]: [f64; 2], spring: usize, exact: impl Fn(f64) -> f64) {
    let n = rows.iter().filter(|row| row.time > from + 1e-9 && row.time < to + 1e-9);
    let n = n.map(|row| {
        let (pull, x) = (pull(row, spring), exact(row.time));
        assert!((pull - Vec2::new(x, 0.0)).norm() < PULL, "{}: {pull:?} not {x:e}, by {:e}", row.time, pull.x - x);
    });
    assert!(n.count() > 3, "{from} to {to}");
}

/// 1 - exp(-u / T), and zero before the event.
fn relaxed(u: f64, time: f64) -> f64 {
    if u > 0.0 { -(-u / time).exp_m1() } else { 0.0 }
}

/// K1: a held load pulls with k v t + c v, slips at (f - c v) / (k v), and then lags by v T less
/// what has relaxed; the pull is f.
#[test]
fn a_start_with_a_dashpot() {
    let (speed, zeta) = (0.08, 0.5);
    let c = dashpot(STIFFNESS, zeta);
    let (time, start) = (c / STIFFNESS, (LIMIT - c * speed) / (STIFFNESS * speed));
    assert!((start - 0.364586629).abs() < 5e-10);
    let rows = quasi_static(&scene(1.0, &[isotropic(STIFFNESS, zeta)], &[path(0, &[[0.0, 0.0, 0.0], [1.0, speed, 0.0]])]));
    assert_path(&rows, |t| speed * ((t - start).max(0.0) - time * relaxed(t - start, time)));
    assert_pulls(&rows, [0.0, 0.36], 0, |t| STIFFNESS * speed * t + c * speed);
    assert_pulls(&rows, [0.37, 1.0], 0, |_| LIMIT);
}

/// K1, c v > f: the load moves at once.
#[test]
fn a_start_with_a_strong_dashpot_moves_the_load_at_once() {
    let (speed, zeta) = (0.08, 6.0);
    let c = dashpot(STIFFNESS, zeta);
    assert!(c * speed > LIMIT);
    let rows = quasi_static(&scene(1.0, &[isotropic(STIFFNESS, zeta)], &[path(0, &[[0.0, 0.0, 0.0], [1.0, speed, 0.0]])]));
    assert_path(&rows, |t| speed * t - LIMIT / STIFFNESS * relaxed(t, c / STIFFNESS));
    assert_pulls(&rows, [0.0, 1.0], 0, |_| LIMIT);
}

/// K2: the speed of a load that is towed is that of the tip at once when that changes, and it rests
/// at once when the tip stops. A tip that turns back pulls with f - c v at once and moves the load
/// when it has gone so far that the spring pushes with f.
#[test]
fn a_tow_follows_its_tip_at_once() {
    let (v1, v2, zeta) = (0.05, 0.11, 1.0);
    let c = dashpot(STIFFNESS, zeta);
    let (time, start) = (c / STIFFNESS, (LIMIT - c * v1) / (STIFFNESS * v1));
    let lag = |t: f64| v1 * ((t - start).max(0.0) - time * relaxed(t - start, time));
    let corners = [[0.0, 0.0, 0.0], [3.0, 3.0 * v1, 0.0], [3.5, 3.0 * v1 + 0.5 * v2, 0.0], [4.0, 3.0 * v1 + 0.5 * v2, 0.0]];
    let rows = quasi_static(&scene(4.0, &[isotropic(STIFFNESS, zeta)], &[path(0, &corners)]));
    // The spring gives way by the change of c v / k, with the load at the speed of the tip.
    let at_corner = lag(3.0);
    let gap = 3.0 * v1 - at_corner;
    // k s + c s' = f for the stretch s as long as the load slips, whatever the tip does.
    let stretch = |u: f64, first: f64| LIMIT / STIFFNESS + (first - LIMIT / STIFFNESS) * (-u / time).exp();
    assert_path(&rows, |t| match t {
        t if t <= 3.0 => lag(t),
        t if t <= 3.5 => 3.0 * v1 + v2 * (t - 3.0) - stretch(t - 3.0, gap),
        _ => 3.0 * v1 + 0.5 * v2 - stretch(0.5, gap),
    });
    assert_pulls(&rows, [1.0, 3.5], 0, |_| LIMIT);

    let back = 0.06;
    let turned = 4.0 + (2.0 * LIMIT - c * back) / (STIFFNESS * back);
    assert!((turned - 4.0 - 1.004956391).abs() < 5e-10);
    // After 4 s the stretch is f / k to rounding.
    let corners = [[0.0, 0.0, 0.0], [4.0, 0.2, 0.0], [5.5, 0.2 - 1.5 * back, 0.0]];
    let rows = quasi_static(&scene(5.5, &[isotropic(STIFFNESS, zeta)], &[path(0, &corners)]));
    let rest = 0.2 - LIMIT / STIFFNESS;
    let later: Vec<Row> = rows.into_iter().filter(|row| row.time >= 4.0).collect();
    assert_path(&later, |t| rest - back * ((t - turned).max(0.0) - time * relaxed(t - turned, time)));
    assert_pulls(&later, [4.0, 5.0], 0, |t| LIMIT - STIFFNESS * back * (t - 4.0) - c * back);
    assert_pulls(&later, [5.01, 5.5], 0, |_| -LIMIT);
}

/// K3: after a release from F0 the load relaxes by (F0 - f) / k, at (F0 - f) / c first; the spring
/// that holds on pulls with f at once.
#[test]
fn a_release_relaxes() {
    let (zeta, pulled) = (1.5, 1.8 * LIMIT);
    let (time, reach) = (dashpot(STIFFNESS, zeta) / STIFFNESS, pulled / STIFFNESS);
    let springs = [isotropic(STIFFNESS, zeta), isotropic(STIFFNESS, 0.7)];
    let paths = [path(0, &[[0.0, 0.0, 0.0], [0.4, reach, 0.0]]), released(1, &[[0.0, 0.0, 0.0], [0.4, -reach, 0.0]], 0.5)];
    let rows = quasi_static(&scene(1.0, &springs, &paths));
    let exact = |t: f64| (pulled - LIMIT) / STIFFNESS * relaxed(t - 0.5, time);
    assert!((exact(0.52) - 3.362131e-3).abs() < 5e-10 && (exact(0.6) - 13.049678e-3).abs() < 5e-10);
    assert_path(&rows, exact);
    assert_pulls(&rows, [0.5, 1.0], 0, |_| LIMIT);
}

/// K4: two springs pull along one line, and side by side at angles.
#[test]
fn two_springs_start_together() {
    let (stiffness, speed, c) = ([STIFFNESS, 0.3], [0.05, 0.11], [dashpot(STIFFNESS, 2.0), dashpot(0.3, 0.5)]);
    let sum = |terms: [f64; 2]| terms[0] + terms[1];
    let product = |a: [f64; 2], b: [f64; 2]| sum([a[0] * b[0], a[1] * b[1]]);
    let springs = [isotropic(STIFFNESS, 2.0), isotropic(0.3, 0.5)];
    let straight = |spring: usize, angle: f64, speed: f64| {
        let end: Vec2 = speed * direction(angle);
        path(spring, &[[0.0, 0.0, 0.0], [1.0, end.x, end.y]])
    };
    let rows = quasi_static(&scene(1.0, &springs, &[straight(0, 0.0, speed[0]), straight(1, 0.0, speed[1])]));
    let start = (LIMIT - product(c, speed)) / product(stiffness, speed);
    let time = sum(c) / sum(stiffness);
    assert!((start - 0.197062313).abs() < 5e-10 && (time - 0.157973874).abs() < 5e-10);
    let exact = |t: f64| product(stiffness, speed) / sum(stiffness) * ((t - start).max(0.0) - time * relaxed(t - start, time));
    assert_path(&rows, exact);
    // Alike at +-alpha: the load goes straight ahead, and each pull has its part across.
    let (angle, zeta, speed) = (0.6_f64, 0.5, 0.08);
    let c = dashpot(STIFFNESS, zeta);
    let ahead = speed * angle.cos();
    let springs = [isotropic(STIFFNESS, zeta), isotropic(STIFFNESS, zeta)];
    let rows = quasi_static(&scene(1.0, &springs, &[straight(0, angle, speed), straight(1, -angle, speed)]));
    let (start, time) = ((0.5 * LIMIT - c * ahead) / (STIFFNESS * ahead), c / STIFFNESS);
    assert_path(&rows, |t| ahead * ((t - start).max(0.0) - time * relaxed(t - start, time)));
    for row in rows.iter().filter(|row| row.time > 0.0) {
        let across = (STIFFNESS * speed * row.time + c * speed) * angle.sin();
        let pulls = [pull(row, 0), pull(row, 1)];
        assert!((pulls[0].y - across).abs() < PULL && (pulls[1].y + across).abs() < PULL, "{}: {pulls:?}", row.time);
    }
}

/// K5: a damped spring holds the load back while its tip moves. As the tip stops, the load starts.
#[test]
fn a_load_starts_when_a_tip_stops() {
    let (soft, speed) = (0.02, 0.05);
    let c = 0.9 * LIMIT / speed;
    let zeta = c / (2.0 * (soft * MASS).sqrt());
    assert!((zeta - 34.961056).abs() < 5e-7);
    let amplitude = (0.5 * LIMIT - soft * speed * 0.6) / (STIFFNESS + soft);
    let time = c / (STIFFNESS + soft);
    assert!((amplitude - 15.185965e-3).abs() < 5e-10 && (time - 0.578273684).abs() < 5e-10);
    let springs = [isotropic(STIFFNESS, 0.0), isotropic(soft, zeta)];
    let paths = [path(0, &[[0.0, 0.0, 0.0], [0.5, -1.5 * LIMIT / STIFFNESS, 0.0]]), path(1, &[[0.0, 0.0, 0.0], [0.6, 0.6 * speed, 0.0]])];
    let rows = quasi_static(&scene(1.6, &springs, &paths));
    assert_path(&rows, |t| -amplitude * relaxed(t - 0.6, time));
}

/// The paper's load on three polar springs, of which one is released (K6).
pub fn three_springs() -> serde_json::Value {
    let springs: [(f64, f64, f64, f64); 3] = [(10.0, 0.664, 4.52e-4, 0.3), (130.0, 0.5, 3e-4, 1.2), (235.0, 0.9, 6e-4, 0.5)];
    let of = |(bearing, radial, torsional, zeta): (f64, f64, f64, f64)| {
        let root: Vec2 = RADIUS * direction(bearing.to_radians());
        json!({
            "root_m": [root.x, root.y], "bearing_rad": bearing.to_radians(), "rest_length_m": REST_LENGTH,
            "radial_stiffness_n_per_m": radial, "torsional_stiffness_nm_per_rad": torsional, "damping_ratio": zeta,
        })
    };
    let shifts = [[0.031, 0.018], [-0.016, 0.028], [-0.022, -0.036]];
    let drawn = |(j, [x, y]): (usize, [f64; 2])| {
        let rest: Vec2 = (RADIUS + REST_LENGTH) * direction(springs[j].0.to_radians());
        let corners = [[0.0, rest.x, rest.y], [0.4, rest.x + x, rest.y + y]];
        if j == 2 { released(j, &corners, 0.5) } else { path(j, &corners) }
    };
    let paths: Vec<_> = shifts.into_iter().enumerate().map(drawn).collect();
    scene(1.0, &springs.map(of), &paths)
}

/// x, y (mm) and heading (mrad) at times (s): an independent program, to half of the last digit.
const THREE_SPRINGS: [(f64, [f64; 3]); 4] =
    [(0.5, [-0.0526, -0.0924, 13.071]), (0.51, [0.7903, 1.1569, 33.229]), (0.6, [2.4217, 3.8597, 67.081]), (1.0, [2.4896, 3.9829, 67.471])];

/// K6: three polar springs with other dashpots each.
#[test]
fn three_polar_springs_relax_along_a_bent_path() {
    let rows = quasi_static(&three_springs());
    for (time, pose) in THREE_SPRINGS {
        let row = rows.iter().find(|row| (row.time - time).abs() < 1e-9).unwrap();
        let found = row.motion.pose;
        let found = [1e3 * found.position.x, 1e3 * found.position.y, 1e3 * found.heading];
        let errors = [0, 1, 2].map(|i| (found[i] - pose[i]).abs());
        assert!(errors[0] < 5.1e-5 && errors[1] < 5.1e-5 && errors[2] < 5.1e-4, "{time}: {found:?} {pose:?}");
    }
    let energy = rows.last().unwrap().energy;
    for (found, known) in [(energy.friction, 1.08541e-4), (energy.damping, 4.18476e-4), (energy.elastic, 5.54303e-4)] {
        assert!((found - known).abs() < 5.1e-10, "{found:e} {known:e}");
    }
    // The errors of all entries in some hundred macro-steps.
    assert!(energy.defect().abs() < 1e-9 * energy.tip_work, "{:e}", energy.defect());
}

/// At fixed steps K6 is right to first order; the errors after the release are those that an
/// independent program finds with the same steps, to a few percent.
#[test]
fn fixed_steps_are_of_first_order() {
    let scenario = parsed(&three_springs());
    let exact = run(&scenario, &within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS)).0;
    let errors = [2.5e-3, 1.25e-3, 6.25e-4, 3.125e-4].map(|step| {
        let rows = run(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, step)).0;
        let error = |(row, exact): (&Row, &Row)| row.motion.pose.edge_displacement(&exact.motion.pose, RADIUS);
        rows.iter().zip(&exact).map(error).fold(0.0, f64::max)
    });
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.3, "{errors:?}");
    }
}

/// K7: a held load. The tip goes on an arc about the root: the spring pulls across with
/// (kt psi + ct w) / l0. A radial spring whose tip goes straight across pulls with
/// k (l - l0) + c v^2 t / l.
#[test]
fn a_held_load_pulls_with_its_dashpots() {
    let spring = |torsional: f64| {
        json!({
            "root_m": [RADIUS, 0.0], "bearing_rad": 0.0, "rest_length_m": REST_LENGTH, "radial_stiffness_n_per_m": STIFFNESS,
            "torsional_stiffness_nm_per_rad": torsional, "damping_ratio": 0.7,
        })
    };
    let held = |torsional: f64| {
        let mut scene = scene(1.0, &[spring(torsional)], &[path(0, &[[0.0, RADIUS + REST_LENGTH, 0.0]])]);
        scene["ground"]["friction_coefficient"] = json!(1e3);
        parsed(&scene)
    };
    let (torsional, rate) = (4.52e-4, 1.3);
    let scenario = held(torsional);
    let system = &scenario.system;
    let (_, c) = system.dashpot(&system.springs[0]);
    let mut load = build(system, scenario.start, &within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS));
    let root = Vec2::new(RADIUS, 0.0);
    let n = 1000;
    load.attach(0, root + REST_LENGTH * direction(0.0));
    for i in 1..=n {
        let swing = rate * f64::from(i) / f64::from(n);
        load.advance(&[root + REST_LENGTH * direction(swing)], 1.0 / f64::from(n));
        let across = load.pull(0).dot(&direction(swing + FRAC_PI_2));
        let exact = (torsional * swing + c * rate) / REST_LENGTH;
        // The rate at the end of a chord of 1.3 mrad is that of the arc to its square.
        assert!((across / exact - 1.0).abs() < 1e-6, "{i}: {across:e} {exact:e}");
    }
    assert_eq!(load.motion().pose, scenario.start.pose);

    let scenario = held(0.0);
    let system = &scenario.system;
    let (c, _) = system.dashpot(&system.springs[0]);
    let speed = 0.06;
    let mut load = build(system, scenario.start, &within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS));
    load.attach(0, root + Vec2::new(REST_LENGTH, 0.0));
    for i in 1..=100 {
        let time = 0.01 * f64::from(i);
        let tip = Vec2::new(REST_LENGTH, speed * time);
        load.advance(&[root + tip], 0.01);
        let length = tip.norm();
        let exact = STIFFNESS * (length - REST_LENGTH) + c * speed * speed * time / length;
        assert!((load.pull(0) - exact * tip / length).norm() < PULL, "{time}: {:?} {exact:e}", load.pull(0));
    }
}

/// K8: a load that is pushed through between two springs, where the springs lose their stiffness
/// and more, goes on at a finite speed.
#[test]
fn a_snap_through_is_a_fast_motion() {
    let x0 = -f64::sqrt(0.035 * 0.035 - 0.03 * 0.03);
    let radial = |angle: f64| {
        json!({
            "root_m": [0.0, 0.0], "bearing_rad": angle, "rest_length_m": 0.035, "radial_stiffness_n_per_m": STIFFNESS,
            "torsional_stiffness_nm_per_rad": 0.0, "damping_ratio": 1.0,
        })
    };
    let springs = [radial(FRAC_PI_2), radial(-FRAC_PI_2), isotropic(0.1, 0.5)];
    let paths = [path(0, &[[0.0, 0.0, 0.03]]), path(1, &[[0.0, 0.0, -0.03]]), path(2, &[[0.0, x0, 0.0], [0.5, x0 + 0.1, 0.0]])];
    let mut scene = scene(0.5, &springs, &paths);
    scene["ground"]["friction_coefficient"] = json!(0.2);
    for support in scene["ground"]["supports"].as_array_mut().unwrap() {
        support["normal_load_n"] = json!(MASS * GRAVITY / 3.0);
    }
    scene["load"]["position_m"] = json!([x0, 0.0]);
    let rows = quasi_static(&scene);
    let known = [(0.2, -13.542794), (0.26, -9.387229), (0.3, -3.754008), (0.32, 1.803201), (0.35, 9.773747), (0.5, 23.337049)];
    for (time, x) in known {
        let row = rows.iter().find(|row| (row.time - time).abs() < 1e-9).unwrap();
        let found = 1e3 * row.motion.pose.position.x;
        // Half of the last digit, and the tolerance of the run.
        assert!((found - x).abs() < 7e-7, "{time}: {found} {x}");
    }
}

/// K9: a box is towed against a wall: K1 until it touches, then the spring pulls with
/// k (v t - g) + c v.
#[test]
fn a_load_is_towed_against_a_wall() {
    let (mass, stiffness, zeta, speed, gap, mu) = (2.0, 80.0, 0.3, 0.1, 0.05, 0.3);
    let (limit, c) = (mu * mass * GRAVITY, 2.0 * zeta * f64::sqrt(stiffness * mass));
    let scene = json!({
        "name": "towed against a wall", "duration_s": 2.0, "control_period_s": 0.01, "seed": 1,
        "load": { "mass_kg": mass, "radius_m": 0.1 },
        "ground": { "friction_coefficient": mu, "gravity_m_per_s2": GRAVITY, "supports": { "tripod": { "radius_m": 0.06 } } },
        "springs": [isotropic(stiffness, zeta)],
        "obstacles": [{
            "name": "wall", "outline": { "polyline": { "points_m": [[0.1 + gap, -1.0], [0.1 + gap, 1.0]] } }, "friction_coefficient": 0.2
        }],
        "drive": { "kind": "tips", "paths": [path(0, &[[0.0, 0.0, 0.0], [2.0, 2.0 * speed, 0.0]])] },
    });
    let (time, start) = (c / stiffness, (limit - c * speed) / (stiffness * speed));
    let towed = |t: f64| speed * ((t - start).max(0.0) - time * relaxed(t - start, time));
    let touch = 1.235570;
    assert!((towed(touch) - gap).abs() < 1e-7 && (towed(1.0) - 26.64034e-3).abs() < 5e-9);
    let scenario = parsed(&scene);
    let rows = run(&scenario, &within(&scenario, BackendKind::QuasiStatic, 1e-9)).0;
    for row in &rows {
        let x = row.motion.pose.position.x;
        assert!((x - towed(row.time).min(gap)).abs() < 1e-9, "{}: {x:e} by {:e}", row.time, x - towed(row.time).min(gap));
        let exact = match row.time {
            t if t < 1e-9 => continue,
            t if t < start => stiffness * speed * t + c * speed,
            t if t < touch => limit,
            t => stiffness * (speed * t - gap) + c * speed,
        };
        assert!((pull(row, 0).x - exact).abs() < 1e-6 * limit, "{}: {} {exact}", row.time, pull(row, 0).x);
    }
}
