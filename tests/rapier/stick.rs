//! Stick is stick: no creep below the limit of the exact law, a slide above it.

use cohaul::backend::rapier::{FrictionModel, Precision, RapierOptions, SpringModel};
use cohaul::backend::{Motion, Status};
use cohaul::math::{Pose, Vec2, direction, perpendicular};
use cohaul::model::{PolarSpring, System};

use crate::scenes::{SLIP_LIMIT, at_rest, backend, isotropic, paper_body, polar, with_friction};

/// Distance of the supports from the centre of the paper's load (m).
const A: f64 = 2.0 * 0.0122 / 3.0;

/// Where the load is after `duration` (s) under a spring at `arm` (m) along the first support,
/// drawn across it by `share` of the exact slip force.
fn pulled_aside(arm: f64, share: f64, duration: f64, options: RapierOptions) -> (Motion, Motion, f64) {
    let start = at_rest(Pose::new(0.03, -0.02, 0.7));
    let toward_support = Vec2::y();
    let system = System { springs: vec![isotropic(arm * toward_support)], ..paper_body() };
    // Onset of slip under an off-centre force: F* / f = a (b + a) / (b^2 + a b + a^2) with a
    // support on the line from the centre to the pull.
    let slip_force = SLIP_LIMIT * A * (arm + A) / (arm * arm + A * arm + A * A);
    let stretch = share * slip_force / 0.664;
    let across = perpendicular(&direction(start.pose.heading + std::f64::consts::FRAC_PI_2));
    let tip = start.pose.to_world(&system.springs[0].root) + stretch * across;
    let mut run = backend(&system, start, 1e-3, options);
    run.attach(0, tip);
    let report = run.advance(&[tip], duration);
    assert_eq!(report.status, Status::Converged);
    let largest = run.friction_forces().iter().map(|force| force.norm()).fold(0.0, f64::max);
    (start, run.motion(), largest)
}

fn distance(from: &Motion, to: &Motion) -> f64 {
    (to.pose.position - from.pose.position).norm().max(A * (to.pose.heading - from.pose.heading).abs())
}

#[test]
fn a_load_below_its_limit_does_not_creep_in_a_minute() {
    let fold = RapierOptions { springs: SpringModel::Aggregate, ..RapierOptions::default() };
    for options in [RapierOptions::default(), fold, with_friction(FrictionModel::Polygon)] {
        for arm in [0.0, 0.0122] {
            let (start, end, _) = pulled_aside(arm, 0.9, 60.0, options);
            // Asked for: 1 nm. Rounding of positions of 3 cm is 3e-18 m a step and does not add up.
            assert!(distance(&start, &end) < 1e-15, "{options:?} {arm}: {}", distance(&start, &end));
        }
    }
}

/// Ten damped springs, in one joint or in ten: the engine's sweeps over them do not end in 24, but
/// each ends with the hold.
#[test]
fn many_damped_springs_do_not_make_it_creep() {
    for springs in [SpringModel::Joint, SpringModel::Aggregate] {
        let ring = (0..10).map(|i| PolarSpring { damping_ratio: 0.3, ..polar(0.2 * std::f64::consts::PI * f64::from(i)) });
        let system = System { springs: ring.collect(), ..paper_body() };
        let start = at_rest(Pose::new(0.03, -0.02, 0.7));
        let tips: Vec<Vec2> = system.springs.iter().map(|s| start.pose.to_world(&s.rest_tip()) + Vec2::new(0.0015, 0.001)).collect();
        let mut run = backend(&system, start, 1e-3, RapierOptions { springs, ..RapierOptions::default() });
        tips.iter().enumerate().for_each(|(spring, tip)| run.attach(spring, *tip));
        run.advance(&tips, 10.0);
        // Ten springs of 0.66 N/m to all sides, 1.8 mm off: a good half of the limit.
        let pull: Vec2 = (0..10).map(|spring| run.pull(spring)).sum();
        assert!(pull.norm() > 0.4 * SLIP_LIMIT && pull.norm() < 0.7 * SLIP_LIMIT, "{}", pull.norm() / SLIP_LIMIT);
        assert!(distance(&start, &run.motion()) < 1e-15, "{springs:?}: {}", distance(&start, &run.motion()));
    }
}

#[test]
fn in_single_precision_it_does_not_creep_either() {
    for friction in [FrictionModel::Aligned, FrictionModel::Polygon] {
        let options = RapierOptions { precision: Precision::F32, ..with_friction(friction) };
        let (start, end, _) = pulled_aside(0.0122, 0.9, 60.0, options);
        // The start itself is rounded to f32: 3 cm to 1 nm, 0.7 rad to 3e-8.
        assert!(distance(&start, &end) < 2e-9, "{friction:?}: {}", distance(&start, &end));
    }
}

#[test]
fn a_hair_below_the_limit_it_sticks_and_a_hair_above_it_slides() {
    for arm in [0.0, 0.0122] {
        let (start, end, largest) = pulled_aside(arm, 1.0 - 1e-6, 1.0, RapierOptions::default());
        assert!(distance(&start, &end) < 1e-15, "{arm}: {}", distance(&start, &end));
        // Every support near its limit, none above it.
        assert!(largest <= SLIP_LIMIT / 3.0 * (1.0 + 1e-12) && largest > 0.999 * SLIP_LIMIT / 3.0);
        let (start, end, _) = pulled_aside(arm, 1.0 + 1e-3, 1.0, RapierOptions::default());
        // Released at F0 it moves by (F0 - f) / k to twice that: 33 mm times a thousandth at the
        // centre.
        assert!(distance(&start, &end) > 5e-6 && distance(&start, &end) < 1e-4, "{arm}: {}", distance(&start, &end));
    }
}

/// The box and the polygon hold as well; what they get wrong is where the limit is.
#[test]
fn fixed_axes_hold_too_but_at_another_limit() {
    for friction in [FrictionModel::Polygon, FrictionModel::Box] {
        let (start, end, _) = pulled_aside(0.0, 0.95, 5.0, with_friction(friction));
        // Fixed axes share a pull so that the last sweep leaves 1e-15 of it; near the limit more.
        assert!(distance(&start, &end) < 1e-12, "{friction:?}: {}", distance(&start, &end));
    }
    // Across a heading of 0.7 the box resists with |cos| + |sin| = 1.41 of the limit.
    let (start, end, _) = pulled_aside(0.0, 1.3, 1.0, with_friction(FrictionModel::Box));
    assert!(distance(&start, &end) < 1e-9);
    let (start, end, _) = pulled_aside(0.0, 1.3, 1.0, with_friction(FrictionModel::Polygon));
    assert!(distance(&start, &end) > 5e-3);
}
