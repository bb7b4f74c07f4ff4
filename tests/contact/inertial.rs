//! Known answers with inertia.

use cohaul::backend::BackendKind::Inertial;
use cohaul::backend::{BackendOptions, Integrator, Status, build};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::Motion;

use crate::scenes::*;

fn moving(vx: f64, vy: f64) -> Motion {
    Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::new(vx, vy), angular: 0.0 } }
}

/// K7: a disc slides at a wall 4 mm ahead and rebounds.
#[test]
fn a_disc_rebounds_from_a_wall() {
    let mut ahead = wall(Vec2::new(0.004 + RADIUS, 0.0), Vec2::new(0.0, 1.0), 0.0);
    ahead.restitution = 0.6;
    let system = disc(vec![ahead]);
    for h in [1e-3, 1e-4] {
        for integrator in [Integrator::Euler, Integrator::Midpoint] {
            let options = BackendOptions { integrator, ..BackendOptions::new(Inertial, h) };
            let mut load = build(&system, moving(0.5, 0.0), &options);
            for tick in 0..30 {
                let report = load.advance(&[Vec2::zeros()], 1e-3);
                assert_eq!(report.status, Status::Converged);
                for t in load.transitions() {
                    println!("{tick} {t:?}");
                }
            }
            let energy = load.energy();
            println!(
                "{h} {integrator:?} x {} loss {} defect {}",
                load.motion().pose.position.x - (0.004 - 1.836539974e-3),
                energy.impacts - 7.1745536e-5,
                energy.defect()
            );
        }
    }
    let mut load = build(&system, moving(0.5, 0.0), &exact(Inertial, &system, 1e-9));
    for _ in 0..30 {
        let report = load.advance(&[Vec2::zeros()], 1e-3);
        if report.status != Status::Converged || report.n_rejected > 0 {
            println!("{report:?}");
        }
    }
    println!("x {:e} loss {:e}", load.motion().pose.position.x - (0.004 - 1.836539974e-3), load.energy().impacts - 7.1745536e-5);
}

/// K10: a spring draws a disc into a wall, plastically.
#[test]
fn a_disc_is_drawn_into_a_wall() {
    for e in [0.0, 0.3, 0.9] {
        let mut ahead = wall(Vec2::new(0.010 + RADIUS, 0.0), Vec2::new(0.0, 1.0), 0.0);
        ahead.restitution = e;
        let system = disc(vec![ahead]);
        let tip = Vec2::new(2.0 * BEHIND, 0.0);
        for h in [1e-3, 5e-4, 2.5e-4] {
            let mut load = build(&system, moving(0.0, 0.0), &BackendOptions::new(Inertial, h));
            load.attach(0, tip);
            let (mut seen, mut n_bad) = (0, 0);
            for _ in 0..300 {
                let report = load.advance(&[tip], 1e-3);
                n_bad += report.n_not_converged;
                for t in load.transitions() {
                    seen += 1;
                    if seen < 5 {
                        println!("{t:?} {}", load.motion().pose.position.x);
                    }
                }
            }
            println!("{e} {h} {:?} loss {} bad {n_bad}", load.motion(), load.energy().impacts - 1.86544e-4);
        }
    }
}

/// K11: oblique, frictionless.
#[test]
fn a_disc_hits_a_wall_at_an_angle() {
    for (e, end) in [(0.0, Vec2::new(3.276539974e-3, 0.0)), (0.5, Vec2::new(3.45378e-3, 1.15126e-3))] {
        let mut below = wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.0);
        below.restitution = e;
        let system = disc(vec![below]);
        for h in [1e-3, 5e-4, 2.5e-4] {
            let mut load = build(&system, moving(0.3, -0.2), &BackendOptions::new(Inertial, h));
            for _ in 0..60 {
                load.advance(&[Vec2::zeros()], 1e-3);
            }
            println!("{e} {h} {:?} {:?}", load.motion().pose.position - end, load.motion().pose.heading);
        }
    }
}

/// K14: K1 with inertia.
#[test]
fn a_disc_with_inertia_slides_along_a_wall() {
    let system = disc(vec![wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), 0.0)]);
    let path = |s: f64| Vec2::new(0.06 * s, -0.02 * s);
    for n in [100, 200, 400] {
        for integrator in [Integrator::Euler, Integrator::Midpoint] {
            let options = BackendOptions { integrator, ..fixed(Inertial, n) };
            let (load, report) = drive(&system, at_rest(0.0, 0.0), &options, n, path);
            println!(
                "{n} {integrator:?} {:e} {:e} {report:?}",
                load.motion().pose.position.x - 0.026065257955,
                load.motion().twist.linear.x - 0.117503405139
            );
        }
    }
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &exact(Inertial, &system, 1e-9), 40, path);
    println!("{:e} {:e} {report:?}", load.motion().pose.position.x - 0.026065257955, load.motion().twist.linear.x - 0.117503405139);
}
