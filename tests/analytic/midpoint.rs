//! The second-order step of the reference dynamics, on the scenes on which engines are compared, at
//! their step of 1 ms.

use cohaul::backend::{Backend, BackendKind, BackendOptions, Integrator, Motion, Status, build};
use cohaul::math::Vec2;
use cohaul::model::System;
use cohaul_studies::verify::tripod::STARTS;

use crate::common::*;

fn midpoint(system: &System, start: Motion, step: f64) -> Box<dyn Backend> {
    build(system, start, &BackendOptions { integrator: Integrator::Midpoint, ..BackendOptions::new(BackendKind::Inertial, step) })
}

/// Final pose of a load that starts with a speed and is left alone for 0.1 s.
fn coasted(start: Motion, step: f64) -> (Vec2, f64) {
    let mut load = midpoint(&peers_system(Vec::new()), start, step);
    assert_eq!(load.advance(&[], 0.1).status, Status::Converged);
    let pose = load.motion().pose;
    assert_eq!(load.motion().twist.linear, Vec2::zeros());
    (pose.position, pose.heading)
}

/// Position under a tip at 5 mm/s through the centre after `duration` (s).
fn pulled(step: f64, duration: f64) -> f64 {
    let mut load = midpoint(&peers_system(vec![isotropic(Vec2::zeros(), 0.0)]), at_rest(), step);
    let n = (duration / 1e-3).round() as u32;
    drive(load.as_mut(), |t| vec![(0, Vec2::new(5e-3 * t, 0.0))], duration, n, |_, _| {});
    load.motion().pose.position.x
}

/// v t - (v / w) sin(w t) from the onset of slip.
fn pulled_exactly(duration: f64) -> f64 {
    let (speed, rate) = (5e-3, (RADIAL / MASS).sqrt());
    let time = duration - SLIP_LIMIT / (RADIAL * speed);
    speed * time - speed / rate * (rate * time).sin()
}

/// Deceleration is constant, so every full step is exact; the last one, in which the load stops
/// from less than mu g h, is off by (mu g h)^2 / (8 mu g) at most: 0.12 % here. Implicit Euler is
/// 6.75 % off.
#[test]
fn a_slide_is_exact_but_for_its_last_step() {
    for step in [1e-3, 3e-4, 1e-4] {
        let (position, _) = coasted(moving(0.2, 0.0, 0.0), step);
        let exact = 0.2f64.powi(2) / (2.0 * MU * GRAVITY);
        let bound = MU * GRAVITY * step * step / 8.0;
        // Rounding of 1e-3 m over a thousand steps.
        assert!((position.x - exact).abs() <= bound + 1e-15, "{step}: {} {bound}", position.x - exact);
    }
}

/// The same in turning, with alpha = f a / I.
#[test]
fn a_spin_is_exact_but_for_its_last_step() {
    let system = peers_system(Vec::new());
    let alpha = SLIP_LIMIT * 0.02 / system.load.inertia;
    let (_, heading) = coasted(moving(0.0, 0.0, 20.0), 1e-3);
    let exact = 20.0 * 20.0 / (2.0 * alpha);
    assert!((heading - exact).abs() <= alpha * 1e-6 / 8.0 + 1e-14, "{heading} {exact}");
}

/// 3.592949 mm is the distance in the limit of small steps of both integrators.
#[test]
fn slide_and_spin_together_come_within_a_ten_thousandth() {
    let distance = coasted(moving(0.2, 0.0, 10.0), 1e-3).0.norm();
    // The step in which it stops: 0.006 % measured, where friction at the end velocity alone is
    // 0.05 % off.
    assert!((distance / 3.592949e-3 - 1.0).abs() < 1e-4, "{distance}");
    let fine = coasted(moving(0.2, 0.0, 10.0), 5e-5).0.norm();
    // Seven digits of the known value.
    assert!((fine - 3.592949e-3).abs() < 2e-9, "{fine}");
}

/// Slips that turn while the load slides, is caught on a support and turns about it, down to rest:
/// known poses of 13 digits. Friction at the end velocity alone would make all of it first order.
#[test]
fn a_slip_that_turns_is_second_order() {
    let unit = (SUPPORT_RADIUS / (MU * GRAVITY)).sqrt();
    for start in STARTS {
        let mut system = paper_system(Vec::new());
        system.load.inertia = start.chi * MASS * SUPPORT_RADIUS * SUPPORT_RADIUS;
        let errors = [100.0, 200.0, 400.0, 800.0, 1600.0].map(|n| {
            let mut load = midpoint(&system, moving(SUPPORT_RADIUS / unit, 0.0, start.turn_rate / unit), start.stop * unit / n);
            load.advance(&[], 1.1 * start.stop * unit);
            let pose = load.motion().pose;
            let [x, y, heading] = start.end;
            (pose.position / SUPPORT_RADIUS - Vec2::new(x, y)).norm().max((pose.heading - heading).abs())
        });
        // 4 + O(h).
        assert!(errors.windows(2).all(|pair| (3.6..5.0).contains(&(pair[0] / pair[1]))), "{} {errors:?}", start.name);
    }
}

/// Thirteen seconds of ripple. With frequencies right to fourth order what is left is the onset
/// within a step: second order, 8e-8 of the path at 1 ms.
#[test]
fn the_ripple_of_a_pulled_load_keeps_its_phase_and_size() {
    let errors = [1e-3, 5e-4].map(|step| pulled(step, 20.0) - pulled_exactly(20.0));
    assert!(errors[0].abs() < 2e-7 * pulled_exactly(20.0), "{errors:?}");
    assert!((errors[0] / errors[1] - 4.0).abs() < 0.2, "{errors:?}");
    // Over the last period the ripple is v / w within a thousandth; implicit Euler at this step has
    // damped it to 8 %.
    let lag = |time: f64| (pulled(1e-3, time) - 5e-3 * (time - SLIP_LIMIT / (RADIAL * 5e-3))) / (5e-3 / (RADIAL / MASS).sqrt());
    let lags: Vec<f64> = (0..20).map(|i| lag(19.6 + 0.016 * f64::from(i))).collect();
    let ripple = lags.iter().fold(0.0f64, |most, lag| most.max(lag.abs()));
    // Twenty samples of a period miss its crest by up to 1.2 %.
    assert!(ripple < 1.001 && ripple > 0.985, "{ripple}");
}

/// QS-REF-1 with the paper's mass: pose after 1 s, extrapolated to ten digits by an independent
/// program.
#[test]
fn the_reference_scene_comes_within_a_micrometre_at_a_millisecond() {
    let error = |step: f64| {
        let mut load = midpoint(&paper_system(paper_springs(4)), at_rest(), step);
        drive(load.as_mut(), reference_tips, 1.0, 1000, |_, _| {});
        (load.motion().pose.position - Vec2::new(0.0312405053, 0.0024621252)).norm()
    };
    // Euler is 1.6e-5 m off at 0.25 ms. The nodes of the tips add 1e-7.
    assert!(error(1e-3) < 1.1e-6, "{}", error(1e-3));
    assert!(error(2.5e-4) < 2e-7, "{}", error(2.5e-4));
}

/// A load held below its limit stays where it is, bit for bit, and no step is too long.
#[test]
fn it_sticks_exactly_and_stays_bounded_at_long_steps() {
    let mut stuck = midpoint(&paper_system(vec![isotropic(Vec2::new(0.004, 0.0), 0.0)]), at_rest(), 1e-3);
    stuck.attach(0, Vec2::new(0.004, 0.8 * SLIP_LIMIT / RADIAL / 1.5));
    stuck.advance(&[Vec2::new(0.004, 0.8 * SLIP_LIMIT / RADIAL / 1.5)], 60.0);
    assert_eq!(stuck.motion(), at_rest());

    // Ten radians of the oscillation a step, no friction: only boundedness is left to ask for.
    let mut system = peers_system(vec![isotropic(Vec2::zeros(), 0.0)]);
    system.ground.friction_coefficient = 0.0;
    let mut swinging = midpoint(&system, at_rest(), 0.5);
    swinging.attach(0, Vec2::new(0.01, 0.0));
    for _ in 0..200 {
        swinging.advance(&[Vec2::new(0.01, 0.0)], 0.5);
        // The implicit midpoint rule keeps the energy of a linear oscillation: no further out than
        // it started.
        assert!((swinging.motion().pose.position.x - 0.01).abs() < 0.01 * (1.0 + 1e-9));
    }
}

/// x'' + 2 zeta w x' + w^2 x = 0 without friction, from rest at 1: second order in the step, and
/// what the dashpot takes is what is lost.
#[test]
fn dashpots_are_second_order_and_the_books_close() {
    let zeta = 0.3;
    let error = |step: f64| {
        let mut system = peers_system(vec![isotropic(Vec2::zeros(), zeta)]);
        system.ground.friction_coefficient = 0.0;
        let mut load = midpoint(&system, at_rest(), step);
        load.attach(0, Vec2::new(0.01, 0.0));
        load.advance(&[Vec2::new(0.01, 0.0)], 0.2);
        let (rate, damped) = ((RADIAL / MASS).sqrt(), (1.0f64 - zeta * zeta).sqrt());
        let phase = rate * damped * 0.2;
        let exact = 0.01 * (1.0 - (-zeta * rate * 0.2).exp() * (phase.cos() + zeta / damped * phase.sin()));
        // Loss at the stage and loss of energy agree to rounding: midpoint conserves quadratic
        // energies.
        assert!(load.energy().defect().abs() < 1e-12 * load.energy().tip_work, "{:e}", load.energy().defect());
        load.motion().pose.position.x - exact
    };
    let ratio = error(2e-3) / error(1e-3);
    assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
}

/// The paper's load without friction on one isotropic spring at `root`, whose tip is held at (0.03,
/// 0.01).
fn swinging(root: Vec2, velocity: [f64; 2], step: f64) -> Box<dyn Backend> {
    let mut system = paper_system(vec![isotropic(root, 0.0)]);
    system.ground.friction_coefficient = 0.0;
    let mut load = midpoint(&system, moving(velocity[0], velocity[1], 0.0), step);
    load.attach(0, Vec2::new(0.03, 0.01));
    load
}

/// A spring through the centre has no torque: however its force lies to the way, the load does not
/// turn, and goes round an ellipse for ever. A torque of half a step times force times speed, which
/// springs and inertia at two places of one arc would leave, turned it by 1.3 rad in the first
/// second at 1 ms and had it gain energy.
#[test]
fn a_force_across_the_way_does_not_turn_the_load() {
    let mut load = swinging(Vec2::zeros(), [0.0, 0.3], 1e-3);
    let rate = (RADIAL / MASS).sqrt();
    for _ in 0..100 {
        assert_eq!(load.advance(&[Vec2::new(0.03, 0.01)], 1.0).status, Status::Converged);
        // Rounding of a hundred thousand steps.
        assert!(load.motion().pose.heading.abs() < 1e-10, "{:e}", load.motion().pose.heading);
        // Fox and Goodwin's rule keeps an energy that is off by (omega h)^2 / 6 of the true one at
        // most.
        let energy = load.energy();
        let brought = energy.initial + energy.tip_work;
        assert!(energy.defect().abs() < (rate * 1e-3).powi(2) / 6.0 * brought, "{:e} of {brought:e}", energy.defect());
    }
}

/// An off-centre spring makes the load turn and shift at once. Known: two integrators of other
/// kinds (Dormand and Prince, Radau), which agree in 12 digits.
#[test]
fn shifts_and_turns_together_are_second_order() {
    let known = (Vec2::new(0.009647823926134, -0.001929328146567), -7.351829534382);
    let errors = [1e-3, 5e-4, 2.5e-4].map(|step| {
        let mut load = swinging(Vec2::new(0.004, 0.0), [0.0, 0.2], step);
        load.advance(&[Vec2::new(0.03, 0.01)], 0.3);
        let pose = load.motion().pose;
        ((pose.position - known.0).norm(), (pose.heading - known.1).abs())
    });
    for pair in errors.windows(2) {
        let ratios = [pair[0].0 / pair[1].0, pair[0].1 / pair[1].1];
        // 4 + O(h^2).
        assert!(ratios.iter().all(|ratio| (ratio - 4.0).abs() < 0.1), "{ratios:?} of {errors:?}");
    }
    // A fifth of a radian of the turning oscillation a step, of which the leading error is a tenth
    // of its square.
    assert!(errors[0].1 < 1e-3 * known.1.abs(), "{errors:?}");
}
