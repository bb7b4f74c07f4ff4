//! A load let go with a speed or a turn rate alone: constant deceleration, so distance and angle
//! are known in closed form.
//!
//! Implicit Euler brakes at the end of each step, so each falls short by a h^2 / 2: v0 h / 2 in
//! all. The midpoint step is exact but for the step in which the load stops from less than a h, at
//! most (a h)^2 / (8 a).

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{GRAVITY, MU, SUPPORT_RADIUS, moving, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::Motion;

/// Start speed (m/s) and v0^2 / (2 mu g) (m), worked out in decimal arithmetic.
pub const SLIDES: [(f64, f64); 4] = [(0.01, 3.6405999709e-6), (0.08, 2.3299839814e-4), (0.5, 9.1014999272e-3), (1.0, 3.6405999709e-2)];
/// Start turn rate (rad/s) and omega0^2 I / (2 f a) (rad), worked out in decimal arithmetic.
pub const SPINS: [(f64, f64); 2] = [(10.0, 3.33114897335e-2), (50.0, 0.832787243338)];
/// f a / I of the paper's load (rad/s^2).
pub const SPIN_DECELERATION: f64 = 1500.98360656;
/// Digits that the known answers have.
pub const PRINTED: f64 = 2e-11;

pub fn cases() -> Vec<Case> {
    SLIDES.map(|(speed, way)| slide(speed, way)).into_iter().chain(SPINS.map(|(rate, angle)| spin(rate, angle))).collect()
}

fn slide(speed: f64, way: f64) -> Case {
    let time_to_stop = speed / (MU * GRAVITY);
    let answer = move |end: Motion| Value::metres(end.pose.position.norm(), way);
    Case {
        name: format!("slide-{speed}-m-s"),
        family: Family::Slide,
        what: format!("distance of a load that starts at {speed} m/s"),
        source: "v0^2 / (2 mu g)".to_owned(),
        run: Box::new(move |runs| stopped(runs, moving(0.6 * speed, -0.8 * speed, 0.0), time_to_stop, answer)),
        plans: plans(Bound::metres, way, speed, time_to_stop, |_| 0.0),
    }
}

fn spin(rate: f64, angle: f64) -> Case {
    let time_to_stop = rate / SPIN_DECELERATION;
    // The engine turns by arctan(omega h) a step: short by (omega h)^3 / 3, summed over a linear
    // decay.
    let arctan = move |step: f64| (rate * step).powi(2) * rate * time_to_stop / 12.0;
    let answer = move |end: Motion| Value::radians(-end.pose.heading, angle);
    Case {
        name: format!("spin-{rate}-rad-s"),
        family: Family::Slide,
        what: format!("angle of a load that starts at {rate} rad/s"),
        source: "omega0^2 I / (2 f a)".to_owned(),
        run: Box::new(move |runs| stopped(runs, moving(0.0, 0.0, -rate), time_to_stop, answer)),
        plans: plans(Bound::radians, angle, rate, time_to_stop, arctan),
    }
}

/// The value at the end of a start that lasts `time_to_stop` (s).
fn stopped(runs: &Runs, start: Motion, time_to_stop: f64, answer: impl Fn(Motion) -> Value) -> Measured {
    let mut run = runs.start(&paper_system(Vec::new()), start);
    let report = run.advance(&[], 1.2 * time_to_stop);
    Measured { values: vec![answer(run.motion())], arm: SUPPORT_RADIUS, report }
}

/// Plans of a stop: `bound` makes a bound in the unit of the answer, `start` is the speed in it,
/// and `lag` is the second-order error of the engine at a step.
fn plans(bound: fn(f64, &str) -> Bound, known: f64, start: f64, time_to_stop: f64, lag: impl Fn(f64) -> f64) -> Vec<Plan> {
    let (step_s, n_levels) = (time_to_stop / 100.0, 4);
    let rounding = 4.0 * PRINTED * known;
    let first_order = |method, lag: f64, reason: &str| {
        // A millionth for the known answer's own digits beside an offset that is exact.
        let offset = bound((1.0 + 1e-6) * (0.5 * start * step_s + lag), reason);
        // The lag of a hundred steps is a fiftieth smaller in the third order, which the table
        // takes as well; of that an eighth may be left.
        let digits = bound(rounding + lag / 3_000.0, "digits of the known answer; the engine's arctan in the third order");
        Plan::first_order(method, step_s, n_levels, offset, digits)
    };
    // The load stops within a step.
    let uneven = time_to_stop / 40.3;
    let last_step = bound(start / time_to_stop * uneven * uneven / 8.0 + rounding, "a h^2 / 8: the step in which it stops");
    vec![
        first_order(Method::INERTIAL_EULER, 0.0, "v0 h / 2: steps brake at their end"),
        first_order(Method::RAPIER, lag(step_s), "v0 h / 2: steps brake at their end; the engine turns by arctan(omega h)"),
        Plan::within(2.0, Method::INERTIAL_MIDPOINT, uneven, 4, last_step),
    ]
}
