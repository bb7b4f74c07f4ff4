//! One spring through the centre whose tip leaves at a constant speed: rest, onset, slip, hold.
//!
//! Without inertia x = v t - f / k from t = f / (k v) on, the play operator, exact at its nodes
//! however coarse. With inertia x = v tau - (v / omega) sin omega tau from the onset on: the load
//! touches rest every period but does not stay.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{MASS, RADIAL, SLIP_LIMIT, SLIP_STRETCH, SUPPORT_RADIUS, at_rest, isotropic, natural_rate, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, StepReport};
use cohaul::math::Vec2;

/// Speed of the tip (m/s), onset of slip (s) and v / omega (m), printed with nine and eleven
/// digits.
pub const PULLS: [(f64, f64, f64); 3] =
    [(0.005, 6.61879518, 0.24544034684e-3), (0.02, 1.65469880, 0.98176138735e-3), (0.08, 0.41367469880, 3.92704554939e-3)];

/// With the tip held after 0.5 s at 80 mm/s: x at the hold and at the end (m), with inertia, and x
/// (m) without.
pub const HOLD: (f64, f64, f64) = (3.04801451521e-3, 1.2955923139613e-2, 6.90602409639e-3);

pub fn cases() -> Vec<Case> {
    let play = PULLS.map(|(speed, onset, _)| play(speed, onset));
    let ripples = [(0.005, 2.0), (0.02, 5.0), (0.08, 5.0)].map(|(speed, phase)| ripple(speed, phase));
    let damped = [2.0, 6.0].map(|phase| damped(0.08, 0.3, phase));
    play.into_iter().chain(ripples).chain([hold()]).chain(damped).collect()
}

fn play(speed: f64, onset: f64) -> Case {
    let bound = Bound::metres(1e-12, "exact at its nodes: rounding of places of 0.1 m over hundreds of steps");
    Case {
        name: format!("pull-play-{speed}-m-s"),
        family: Family::Pull,
        what: format!("rest up to the onset at {onset:.4} s, then a lag of f / k"),
        source: "x = v t - f / k".to_owned(),
        run: Box::new(move |runs| {
            let (mut run, mut report) = (runs.start(&paper_system(vec![isotropic(Vec2::zeros(), 0.0)]), at_rest()), StepReport::default());
            run.attach(0, Vec2::zeros());
            let onset = SLIP_STRETCH / speed;
            let mut at = |from: f64, to: f64| {
                report.add(&run.advance(&[Vec2::new(speed * to, 0.0)], to - from));
                run.motion().pose.position.x
            };
            let (before, after) = (at(0.0, 0.999_999_999 * onset), at(0.999_999_999 * onset, 2.5 * onset));
            let values = vec![Value::metres(before, 0.0), Value::metres(after, 2.5 * speed * onset - SLIP_STRETCH)];
            Measured { values, arm: SUPPORT_RADIUS, report }
        }),
        plans: vec![Plan::exact(Method::QUASI_STATIC, 0.7 * onset, 4, bound)],
    }
}

fn ripple(speed: f64, phase: f64) -> Case {
    let tau = phase / natural_rate();
    let amplitude = speed / natural_rate();
    let known = speed * tau - amplitude * phase.sin();
    Case {
        name: format!("pull-ripple-{speed}-m-s"),
        family: Family::Pull,
        what: format!("place after {phase} rad of the ripple that follows the onset"),
        source: "x = v tau - (v / omega) sin omega tau".to_owned(),
        run: Box::new(move |runs| slipping(runs, 0.0, speed, tau, known)),
        plans: ripple_plans(tau, amplitude),
    }
}

/// Slip with a dashpot beside the spring: it begins at k s + c v = f, and the stretch less f / k is
/// a damped oscillation from -c v / k at rate v.
fn damped(speed: f64, damping_ratio: f64, phase: f64) -> Case {
    let (rate, tau) = (natural_rate(), phase / natural_rate());
    let damped_rate = rate * (1.0 - damping_ratio * damping_ratio).sqrt();
    let offset = -dashpot(damping_ratio) * speed / RADIAL;
    let decay = (-damping_ratio * rate * tau).exp();
    let quarter = (speed + damping_ratio * rate * offset) / damped_rate;
    let over = decay * (offset * (damped_rate * tau).cos() + quarter * (damped_rate * tau).sin());
    let known = speed * tau + offset - over;
    Case {
        name: format!("pull-damped-{phase}-rad"),
        family: Family::Pull,
        what: format!("place after {phase} rad with a damping ratio of {damping_ratio}"),
        source: "damped oscillation from the onset at k s + c v = f".to_owned(),
        run: Box::new(move |runs| slipping(runs, damping_ratio, speed, tau, known)),
        plans: ripple_plans(tau, speed / rate),
    }
}

/// Through `tau` (s) of a ripple of this amplitude (m).
fn ripple_plans(tau: f64, amplitude: f64) -> Vec<Plan> {
    let step_s = tau / 200.0;
    let angle = natural_rate() * step_s;
    let phase = natural_rate() * tau;
    let first =
        Bound::metres(amplitude * angle * (1.0 + 0.5 * phase), "omega h of the ripple a radian: damping by omega h / 2, and half a step");
    let limit = Bound::metres(1e-6 * amplitude, "(omega h)^3 of the ripple is 1e-6 and less");
    let second = Bound::metres(amplitude * angle * angle * (1.0 + phase) / 6.0, "(omega h)^2 / 6 of the ripple a radian");
    let first_order = |method| Plan::first_order(method, step_s, 4, first.clone(), limit.clone());
    vec![
        first_order(Method::INERTIAL_EULER),
        first_order(Method::RAPIER),
        Plan::of_order(2.0, Method::INERTIAL_MIDPOINT, step_s, 4, second),
    ]
}

/// c (N s/m).
fn dashpot(damping_ratio: f64) -> f64 {
    2.0 * damping_ratio * (RADIAL * MASS).sqrt()
}

/// Place `tau` (s) after the instant at which the load is about to slip.
fn slipping(runs: &Runs, damping_ratio: f64, speed: f64, tau: f64, known: f64) -> Measured {
    // A dashpot helps the spring by c v from the start.
    let stretch = (SLIP_LIMIT - dashpot(damping_ratio) * speed) / RADIAL;
    let tip = |time: f64| Vec2::new(stretch + speed * time, 0.0);
    let mut run = runs.start(&paper_system(vec![isotropic(Vec2::zeros(), damping_ratio)]), at_rest());
    run.attach(0, tip(0.0));
    let report = run.advance(&[tip(tau)], tau);
    Measured { values: vec![Value::metres(run.motion().pose.position.x, known)], arm: SUPPORT_RADIUS, report }
}

/// The tip is held after 0.5 s at 80 mm/s; the load stops 0.111 s later.
fn hold() -> Case {
    let (speed, ramp) = (0.08, 0.5);
    let first =
        Bound::metres(2.1e-4, "0.19 mm short at 1 ms, as an independent implicit Euler; a tenth for the place of events within steps");
    let limit = Bound::metres(1e-6, "onset and hold lie within steps: some (omega h)^2 of the ripple of 4 mm");
    let second = Bound::metres(2e-6, "(omega h)^2 / 200 of the ripple of 4 mm");
    let first_order = |method| Plan::first_order(method, 1e-3, 4, first.clone(), limit.clone());
    Case {
        name: "pull-and-hold".to_owned(),
        family: Family::Pull,
        what: "place when a tip at 80 mm/s stops after 0.5 s, and where the load ends".to_owned(),
        source: "x_hold + 2 (v / omega) |sin(omega tau / 2)|; without inertia v t - f / k".to_owned(),
        run: Box::new(move |runs| {
            let mut run: Box<dyn Backend> = runs.start(&paper_system(vec![isotropic(Vec2::zeros(), 0.0)]), at_rest());
            run.attach(0, Vec2::zeros());
            let end = [Vec2::new(speed * ramp, 0.0)];
            let mut report = run.advance(&end, ramp);
            let at_hold = run.motion().pose.position.x;
            report.add(&run.advance(&end, 0.2));
            let at_end = run.motion().pose.position.x;
            let known = if runs.kind.has_inertia() { (HOLD.0, HOLD.1) } else { (HOLD.2, HOLD.2) };
            Measured { values: vec![Value::metres(at_hold, known.0), Value::metres(at_end, known.1)], arm: SUPPORT_RADIUS, report }
        }),
        plans: vec![
            Plan::exact(Method::QUASI_STATIC, 0.5, 3, Bound::metres(1e-14, "exact at its nodes: digits of the known answer")),
            first_order(Method::INERTIAL_EULER),
            first_order(Method::RAPIER),
            Plan::within(2.0, Method::INERTIAL_MIDPOINT, 1e-3, 4, second),
        ],
    }
}
