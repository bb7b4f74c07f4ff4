//! Known answers without inertia.

use cohaul::backend::BackendKind::QuasiStatic;
use cohaul::backend::Status;
use cohaul::math::Vec2;

use crate::scenes::*;

/// K1: a disc slides along a frictionless wall. The wall bears what the spring presses, and friction
/// takes the rest.
#[test]
fn a_disc_slides_along_a_wall() {
    let system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.0)]);
    let path = |s: f64| Vec2::new(0.06 * s, -0.02 * s);
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, 40), 40, path);
    let pose = load.motion().pose;
    println!("{pose:?} {report:?} {:?}", load.energy());
    assert_eq!(report.status, Status::Converged);
    assert!((pose.position - Vec2::new(0.06 - BEHIND, 0.0)).norm() < 1e-15);
    assert!((load.energy().friction - 5.91243736e-4).abs() < 1e-12);
}

/// K2: a box slides on a wall that rubs.
#[test]
fn a_box_rubs_along_a_wall() {
    for mu in [0.3, 0.0] {
        let system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), mu)], Vec2::zeros());
        let path = |s: f64| Vec2::new(0.06 * s, -0.02 * s);
        for n in [40, 80, 160] {
            let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, n), n, path);
            let pose = load.motion().pose;
            println!("{mu} {n} {pose:?} x {} {report:?} {:?}", pose.position.x - (0.06 - BEHIND - mu * 0.02), load.energy());
        }
    }
}

/// K3: a tip draws a disc round a post.
#[test]
fn a_disc_goes_round_a_post() {
    let system = disc(vec![post(Vec2::zeros(), 0.005)]);
    let start = (BEHIND / 0.035f64).asin() / 2.5;
    let path = |s: f64| {
        let angle = std::f64::consts::FRAC_PI_2 - 2.5 * (start + (1.0 - start) * s);
        0.035 * Vec2::new(angle.cos(), angle.sin())
    };
    for n in [40, 80, 160] {
        let (load, report) = drive(&system, at_rest(0.0, 0.0172), &fixed(QuasiStatic, n), n, path);
        println!("{n} {:?} {report:?} {:?}", load.motion().pose, load.energy());
    }
    let (load, report) = drive(&system, at_rest(0.0, 0.0172), &exact(QuasiStatic, &system, 1e-9), 40, path);
    println!("{:?} {report:?} {:?}", load.motion().pose.position - Vec2::new(0.016379861540, 0.005247869655), load.pose_error());
}

/// K4: a notch.
#[test]
fn a_disc_jams_in_a_notch() {
    let s = 0.5f64.sqrt();
    let walls = [Vec2::new(s, s), Vec2::new(-s, s)].map(|n| wall(Vec2::zeros(), 0.2 * Vec2::new(-n.y, n.x), 0.0));
    let system = disc(walls.to_vec());
    let from = Vec2::new(0.02, 0.02 + RADIUS / s);
    let path = |share: f64| from + share * (Vec2::new(-0.02, -0.03) - from);
    let (load, report) = drive(&system, at_rest(from.x, from.y), &fixed(QuasiStatic, 50), 50, path);
    println!("{:?} {report:?} {:?} {:?}", load.motion().pose, load.energy(), load.motion().pose.position - Vec2::new(0.0, RADIUS / s));
}

/// K5: rear lifts
#[test]
fn a_box_lifts() {
    let system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), 0.0)], Vec2::new(0.0, 0.004));
    let path = |s: f64| Vec2::new(0.06 * s, 0.004 - 0.03 + 0.03 * s);
    for n in [60, 120] {
        let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, n), n, path);
        println!("{n} {:?} {report:?} {:?}", load.motion().pose, load.transitions());
    }
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &exact(QuasiStatic, &system, 1e-9), 60, path);
    println!("{:?} {report:?} {:?}", load.motion().pose, load.pose_error());
}

/// K6: rolling
#[test]
fn a_disc_rolls() {
    let system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 2.0)]);
    let path = |s: f64| Vec2::new(0.08 * s, -0.02);
    for n in [60, 120] {
        let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, n), n, path);
        println!("{n} {:?} {report:?} {:?}", load.motion().pose, load.energy());
    }
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &exact(QuasiStatic, &system, 1e-9), 60, path);
    println!("{:?} {report:?} {:?}", load.motion().pose, load.pose_error());
}

/// K13
#[test]
fn a_disc_snaps_round_a_post() {
    let system = disc(vec![post(Vec2::new(0.04, 0.01), 0.003)]);
    let path = |s: f64| Vec2::new(0.08 * s, 0.0);
    for n in [100, 400] {
        let mut load = cohaul::backend::build(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, n));
        load.attach(0, path(0.0));
        for tick in 1..=n {
            let report = load.advance(&[path(f64::from(tick) / f64::from(n))], 1.0 / f64::from(n));
            for t in load.transitions() {
                println!("{n} {} {t:?} {:?}", 80.0 * f64::from(tick) / f64::from(n), load.motion().pose);
            }
            if report.status != Status::Converged {
                println!("{tick} {report:?}");
            }
        }
        println!("{:?} {:?}", load.motion().pose, load.energy());
    }
}
