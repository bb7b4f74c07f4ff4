//! One spring through the centre whose tip leaves at a constant speed: rest, onset, slip, hold.

use std::f64::consts::TAU;

use cohaul::backend::{BackendKind, Motion, Status};
use cohaul::math::Vec2;
use cohaul::model::System;
use cohaul_studies::verify::pull::PULLS;

use crate::common::*;

/// f / k (m): stretch at which the load slips.
const SLIP_STRETCH: f64 = SLIP_LIMIT / RADIAL;

fn system(damping_ratio: f64) -> System {
    paper_system(vec![isotropic(Vec2::zeros(), damping_ratio)])
}

/// omega_n of the load on one spring (rad/s).
fn rate() -> f64 {
    (RADIAL / MASS).sqrt()
}

/// The load after its tip went at `speed` (m/s) for n steps of `step` (s).
fn pulled(kind: BackendKind, damping_ratio: f64, speed: f64, step: f64, n: u32) -> Motion {
    let mut run = backend(kind, &system(damping_ratio), at_rest(), step);
    let duration = f64::from(n) * step;
    run.attach(0, Vec2::zeros());
    let report = run.advance(&[Vec2::new(speed * duration, 0.0)], duration);
    assert_eq!((report.status, report.n_steps), (Status::Converged, u64::from(n)));
    run.motion()
}

/// Stick until t* = f / (k v), then x = v t - f / k: the play operator, exact at its nodes however
/// coarse.
#[test]
fn without_inertia_the_load_lags_by_the_slip_stretch_at_any_step() {
    for (speed, onset, _) in PULLS {
        // Printed with nine digits.
        assert!((SLIP_STRETCH / speed - onset).abs() < 1e-9 * onset.max(5.0));
        for n in [1, 2, 3, 7, 40, 1000] {
            let onset = SLIP_STRETCH / speed;
            let below = pulled(BackendKind::QuasiStatic, 0.0, speed, 0.999_999_999 * onset / f64::from(n), n);
            assert_eq!(below.pose.position, Vec2::zeros());
            let duration = 2.5 * onset;
            let after = pulled(BackendKind::QuasiStatic, 0.0, speed, duration / f64::from(n), n);
            // Rounding of positions of 0.1 m in some Newton steps a step.
            assert!((after.pose.position.x - (speed * duration - SLIP_STRETCH)).abs() < 1e-15 * f64::from(n + 20), "{n}");
        }
    }
}

/// x = v tau - (v / omega) sin omega tau after the onset: the load touches rest every period but
/// does not stay.
#[test]
fn with_inertia_it_swings_about_that() {
    for kind in WITH_INERTIA {
        for (speed, _, amplitude) in PULLS {
            // v / omega, printed with eleven digits.
            assert!((speed / rate() - amplitude).abs() < 1e-10 * amplitude);
            for phase in [2.0, 5.0, 9.0] {
                let n_slipping = [200, 400, 800];
                let tau = phase / rate();
                let exact = speed * tau - amplitude * phase.sin();
                let values = n_slipping.map(|n| {
                    let step = tau / f64::from(n);
                    slipping_from_onset(kind, 0.0, speed, step, n).pose.position.x
                });
                let ratio = error_ratio(values[1], values[2], exact);
                assert!(ratio > 1.9 && ratio < 2.1, "{kind:?} {speed} {phase}: {ratio}");
                // (omega h)^3 is 1e-6 at phase 5. Beyond 2 pi the load has touched rest, where the
                // step's own damping acts unevenly.
                let tolerance = if phase < TAU { 1e-5 } else { 1e-3 };
                assert!((extrapolated(&values) - exact).abs() < tolerance * amplitude, "{kind:?} {speed} {phase}");
            }
        }
    }
}

/// n steps of `step` (s) from the instant at which the load is about to slip.
fn slipping_from_onset(kind: BackendKind, damping_ratio: f64, speed: f64, step: f64, n: u32) -> Motion {
    // A dashpot helps the spring by c v from the start.
    let dashpot = 2.0 * damping_ratio * (RADIAL * MASS).sqrt() * speed;
    let stretch = (SLIP_LIMIT - dashpot) / RADIAL;
    let tip = |time: f64| Vec2::new(stretch + speed * time, 0.0);
    let mut run = backend(kind, &system(damping_ratio), at_rest(), step);
    run.attach(0, tip(0.0));
    let duration = step * f64::from(n);
    assert_eq!(run.advance(&[tip(duration)], duration).status, Status::Converged);
    run.motion()
}

/// With the tip held after 0.5 s at 80 mm/s: where the load is then, how fast, and where it stops.
#[test]
fn ramp_and_hold() {
    let (speed, ramp) = (0.08, 0.5);
    for kind in WITH_INERTIA {
        let runs = [1e-3, 5e-4, 2.5e-4, 1.25e-4].map(|step| {
            let mut run = backend(kind, &system(0.0), at_rest(), step);
            run.attach(0, Vec2::zeros());
            let end = [Vec2::new(speed * ramp, 0.0)];
            run.advance(&end, ramp);
            let at_hold = run.motion();
            // It stops 0.111 s later.
            run.advance(&end, 0.11);
            assert!(run.motion().twist.linear.x > 0.0);
            run.advance(&end, 0.09);
            // At rest; in the engine up to a residue that shrinks with each step.
            assert!(run.motion().twist.linear.norm() < 1e-12);
            [at_hold.pose.position.x, at_hold.twist.linear.x, run.motion().pose.position.x]
        });
        for (i, exact) in [3.04801451521e-3, 0.0949345659362, 1.2955923139613e-2].into_iter().enumerate() {
            let values = runs.map(|run| run[i]);
            let ratio = error_ratio(values[2], values[3], exact);
            assert!(ratio > 1.9 && ratio < 2.1, "{kind:?} {i}: {ratio}");
            // Onset and hold lie within steps: some (omega h)^2 = 2.6e-5 at 0.25 ms.
            assert!((extrapolated(&values[2..]) - exact).abs() < 2e-5 * exact, "{kind:?} {i}");
        }
        // Implicit Euler in an independent program: 0.19 mm short at 1 ms.
        // Printed with two digits.
        assert!((runs[0][2] - 1.2955923139613e-2 + 1.9e-4).abs() < 5e-6, "{}", runs[0][2]);
    }
    let held = pulled(BackendKind::QuasiStatic, 0.0, speed, ramp, 1).pose.position.x;
    // Printed with twelve digits.
    assert!((held - 6.90602409639e-3).abs() < 1e-14);
}

/// A dashpot beside the spring slips at k s + c v = f; from there on the stretch less f / k is a
/// damped oscillation from -c v / k at rate v.
#[test]
fn a_damped_spring_slips_earlier_and_swings_less() {
    let (speed, damping_ratio) = (0.08, 0.3);
    let dashpot = 2.0 * damping_ratio * (RADIAL * MASS).sqrt();
    let onset = (SLIP_LIMIT - dashpot * speed) / (RADIAL * speed);
    let damped_rate = rate() * (1.0f64 - damping_ratio * damping_ratio).sqrt();
    let offset = -dashpot * speed / RADIAL;
    for kind in WITH_INERTIA {
        let n = 2000;
        let step = onset / f64::from(n);
        // The dashpot acts from the first step on; one step before the onset nothing has moved.
        // Nor in the engine, but for rounding.
        assert!(pulled(kind, damping_ratio, speed, step, n - 1).pose.position.norm() < 1e-18);
        assert!(pulled(kind, damping_ratio, speed, step, n + 20).pose.position.x > 1e-9);
        for phase in [2.0f64, 6.0] {
            let tau = phase / rate();
            let decay = (-damping_ratio * rate() * tau).exp();
            let quarter = (speed + damping_ratio * rate() * offset) / damped_rate;
            let over = decay * (offset * (damped_rate * tau).cos() + quarter * (damped_rate * tau).sin());
            let exact = speed * tau - dashpot * speed / RADIAL - over;
            let values = [400, 800, 1600].map(|n| slipping_from_onset(kind, damping_ratio, speed, tau / f64::from(n), n).pose.position.x);
            let ratio = error_ratio(values[1], values[2], exact);
            assert!(ratio > 1.9 && ratio < 2.1, "{kind:?} {phase}: {ratio}");
            // Third order of omega h = 0.015 at the coarsest step.
            assert!((extrapolated(&values) - exact).abs() < 1e-6 * exact, "{kind:?} {phase}");
        }
    }
}
