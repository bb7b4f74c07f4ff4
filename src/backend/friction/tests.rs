//! Claims about the parts of the exact methods that no other file can see.

use super::FrictionSolver;
use super::cones::Cones;
use super::problem::ContactMode;
use super::rest::Pressed;
use crate::math::{Mat3, RandomStreams, Stream, Vec2, Vec3, direction};
use crate::model::{Ground, SupportPoint};

/// Wrenches up to 95 % of those that slip, by the exact solver. The forces balance them to rounding
/// and leave most of the room that is possible: half of a bound that is itself within a tenth or so
/// ends the search.
#[test]
fn forces_with_margin_balance_a_wrench_and_leave_most_of_the_room_there_is() {
    let mut n_crowded = 0;
    for case in 0..200 {
        let streams = RandomStreams::new(case);
        let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
        let support = |k: u64| SupportPoint {
            offset: 0.01 * Vec2::new(draw(2 * k), draw(2 * k + 1)),
            normal_load: 0.005 * 3f64.powf(draw(60 + k)),
            friction_coefficient: None,
        };
        let ground = Ground { friction_coefficient: 1.4, supports: (0..3 + case % 4).map(support).collect() };
        let cones = Cones::new(&ground, 0.0122);
        let course = Vec3::new(draw(100), draw(101), draw(102));
        let slips = |size: f64| {
            let mut solver = FrictionSolver::new(&ground, 0.0122);
            let drive = Vec3::new(size * course.x, size * course.y, 0.01 * size * course.z);
            solver.solve(&Mat3::from_diagonal(&Vec3::new(3.0, 3.0, 4e-4)), &drive).mode != ContactMode::Stick
        };
        let (mut rests, mut moves) = (0.0, 10.0);
        for _ in 0..50 {
            let middle = 0.5 * (rests + moves);
            *(if slips(middle) { &mut moves } else { &mut rests }) = middle;
        }
        for share in [0.3, 0.6, 0.9, 0.95] {
            let size = share * rests;
            let w = cones.scaled_gradient(&Vec3::new(size * course.x, size * course.y, 0.01 * size * course.z));
            let mut forces = Vec::new();
            assert!(cones.forces_with_margin(&w, &mut forces));
            // Scaled: sums of numbers up to one.
            assert!((cones.wrench(&forces) - w).amax() < 1e-14, "{case} {share}");
            let used = |forces: &[Vec2]| forces.iter().zip(&cones.limits).map(|(force, limit)| force.norm() / limit).fold(0.0, f64::max);
            let room = (1.0 - used(&forces)) / (1.0 - share);
            assert!(room > 0.5 && room < 1.0 + 1e-6, "{case} {share}: {room}");
            let least: Vec<Vec2> = (0..cones.len()).map(|k| cones.least_force(k, &(cones.balance.unwrap() * w))).collect();
            n_crowded += u32::from(used(&least) > 1.0);
        }
    }
    // The least forces alone would not have done.
    assert!(n_crowded > 100, "{n_crowded}");
}

/// Wrenches from just beyond the slip limit to far beyond. The objective at the twist is at most
/// that along the direction that proves the slip, and the touching parabolas leave, in the median,
/// at most a tenth of the distance to the least value.
#[test]
fn a_slip_is_near_where_parabolas_touch_its_losses() {
    let mut left = Vec::new();
    for case in 0..600 {
        let streams = RandomStreams::new(case);
        let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
        let support = |k: u64| SupportPoint {
            offset: 0.01 * Vec2::new(draw(2 * k), draw(2 * k + 1)),
            normal_load: 0.005,
            friction_coefficient: None,
        };
        let ground = Ground { friction_coefficient: 1.4, supports: (0..3 + case % 3).map(support).collect() };
        let (cones, mut solver) = (Cones::new(&ground, 0.0122), FrictionSolver::new(&ground, 0.0122));
        let hessian = Mat3::from_diagonal(&Vec3::new(3.0, 3.0, 4e-4));
        let size = 0.03 * 10f64.powf(1.0 + draw(103));
        let drive = size * Vec3::new(draw(100), draw(101), 0.01 * draw(102));
        let (h, w) = cones.scaled(&hessian, &drive);
        let Pressed::Slips(n) = cones.pressed_forces(&w, &mut vec![Vec2::zeros(); cones.len()]) else { continue };
        let found = solver.solve(&hessian, &drive);
        let Some(near) = cones.slip_along(&n, &h, &w).filter(|_| found.mode == ContactMode::Slip) else { continue };
        let objective = |twist: &Vec3| 0.5 * twist.dot(&(h * twist)) - w.dot(twist) + cones.loss(twist);
        let along = (n.dot(&w) - cones.loss(&n)) / n.dot(&(h * n)) * n;
        let [least, there, before] = [cones.scaled_twist(&found.increment), near, along].map(|twist| objective(&twist));
        // Roundings of the terms of the objective at the twist without friction, w^2 / h.
        let rounding = 1e-14 * w.norm_squared() / h.m11.min(h.m33);
        assert!(least <= there + rounding && there <= before + rounding, "{case}: {least} {there} {before}");
        left.push((there - least) / (before - least));
    }
    left.sort_by(f64::total_cmp);
    assert!(left.len() > 200 && left[left.len() / 2] < 0.1, "{} {}", left.len(), left[left.len() / 2]);
}

fn tripod() -> Ground {
    let supports =
        [0.3, 2.1, 4.0].map(|angle| SupportPoint { offset: 0.008 * direction(angle), normal_load: 0.005, friction_coefficient: None });
    Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
}

/// The problem is convex, so both starts lead to the one minimum, up to a hundred roundings of the
/// forces.
#[test]
fn a_slip_from_nearby_is_the_one_from_anywhere() {
    let ground = tripod();
    let hessian = Mat3::new(1600.0, 2.0, 0.3, 2.0, 1600.0, -0.2, 0.3, -0.2, 0.12);
    let mut n_found = 0;
    for i in 0..50 {
        let at = f64::from(i);
        let drive = (0.03 * direction(at)).push(1e-4 * (3.0 * at).sin());
        let [mut near, mut far] = [(); 2].map(|()| FrictionSolver::new(&ground, 0.01));
        let want = far.solve(&hessian, &drive);
        let start = want.increment.component_mul(&Vec3::new(1.05, 0.95, 1.1));
        let Some(found) = near.slide(&hessian, &drive, &start) else { continue };
        n_found += 1;
        assert_eq!(want.mode, ContactMode::Slip);
        assert!((found.increment - want.increment).norm() < 1e-13 * want.increment.norm() + 1e-20, "{i}");
        assert!(near.forces().iter().zip(far.forces()).all(|(a, b)| (a - b).norm() < 1e-14));
        assert_eq!(near.warm_start().pin, far.warm_start().pin);
    }
    assert!(n_found > 30, "{n_found}");
}

/// A start far off, none at all, and a load that stays at rest: all leave the solver as it was.
#[test]
fn gliding_without_a_slip_nearby_changes_nothing() {
    let mut solver = FrictionSolver::new(&tripod(), 0.01);
    let (hessian, before) = (Mat3::from_diagonal(&Vec3::new(1600.0, 1600.0, 0.12)), solver.warm_start().clone());
    let weak = Vec3::new(0.01, 0.0, 0.0);
    for near in [Vec3::zeros(), Vec3::new(1e-5, 0.0, 1e-3), Vec3::new(f64::NAN, 0.0, 0.0)] {
        assert_eq!(solver.slide(&hessian, &weak, &near), None);
    }
    // A turn about the first support.
    let pivot: Vec2 = tripod().supports[0].offset;
    assert_eq!(solver.slide(&hessian, &Vec3::new(0.03, 0.0, 0.0), &Vec3::new(pivot.y, -pivot.x, 1.0)), None);
    assert_eq!(*solver.warm_start(), before);
}
