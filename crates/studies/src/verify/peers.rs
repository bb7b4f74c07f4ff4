//! The scenes on which engines are compared, at their step of 1 ms and below: a disc of 38.5 mm and
//! 1.6 g on three supports at 20 mm.
//!
//! In a slide, the error of an engine without a model error is its step over the stopping time,
//! 6.75 % at 1 ms, and that vanishes with the step. What does not is the engine's own.

use super::case::{Bound, Case, Expected, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{
    GRAVITY, MASS, MU, RADIAL, SLIP_LIMIT, SLIP_STRETCH, at_rest, isotropic, moving, natural_rate, paper_system, peers_system,
};
use crate::known_answers::{pulled_after_onset, slide_distance};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, BackendKind, Motion, StepReport};
use cohaul::math::{Pose, Twist, Vec2};

/// Supports from the centre (m).
const ARM: f64 = 0.02;
/// Start speed (m/s) and turn rates of the spin and of both at once (rad/s).
const SPEED: f64 = 0.2;
const SPIN: f64 = 20.0;
const SLOW_SPIN: f64 = 10.0;
/// Speed of the tip (m/s) and its duration (s).
const PULL: f64 = 5e-3;
const DURATION: f64 = 20.0;

pub fn cases() -> Vec<Case> {
    vec![slide(), spin(), slide_and_spin(), pull(), ripple(), creep()]
}

fn peer(name: &str, what: &str, source: &str, run: impl Fn(&Runs) -> Measured + Send + Sync + 'static, plans: Vec<Plan>) -> Case {
    let (name, what, source) = (name.to_owned(), what.to_owned(), source.to_owned());
    Case { name, family: Family::Peers, what, source, run: Box::new(run), plans }
}

/// v0^2 / (2 mu g) (m).
fn slide_way() -> f64 {
    slide_distance(SPEED, MU * GRAVITY)
}

fn slide() -> Case {
    let way = slide_way();
    let run = move |runs: &Runs| {
        let (pose, report) = coasted(moving(SPEED, 0.0, 0.0), runs);
        Measured { values: vec![Value::metres(pose.position.x, way)], arm: ARM, report }
    };
    let first = Bound::metres(SPEED * 1e-3 / 2.0, "v0 h / 2: steps brake at their end");
    let limit = Bound::metres(
        MU * GRAVITY * 1.25e-4 * 1.25e-4 / 2.0,
        "the place of the stop within a step leaves a h^2 / 8, up to four times over",
    );
    let midpoint = Bound::metres(1.3e-3 * way, "0.13 %: the step in which it stops");
    peer("peers-slide", "length of a slide at 0.2 m/s", "v0^2 / (2 mu g)", run, stop_plans(first, limit, Expected::Within(2.0), midpoint))
}

fn spin() -> Case {
    let system = peers_system(Vec::new());
    let angle = SPIN * SPIN * system.load.inertia / (2.0 * SLIP_LIMIT * ARM);
    let alpha = SLIP_LIMIT * ARM / system.load.inertia;
    let run = move |runs: &Runs| {
        let (pose, report) = coasted(moving(0.0, 0.0, SPIN), runs);
        Measured { values: vec![Value::radians(pose.heading, angle)], arm: ARM, report }
    };
    let first = Bound::radians(SPIN * 1e-3 / 2.0 * 1.01, "omega0 h / 2: steps brake at their end; the engine's arctan adds a thousandth");
    let limit =
        Bound::radians(alpha * 1.25e-4 * 1.25e-4 / 2.0, "the place of the stop within a step leaves alpha h^2 / 8, up to four times over");
    let midpoint = Bound::radians(2e-5 * angle, "0.002 %, and no more at shorter steps: the step in which it stops");
    peer(
        "peers-spin",
        "angle of a spin at 20 rad/s",
        "omega0^2 I / (2 f a)",
        run,
        stop_plans(first, limit, Expected::Within(0.0), midpoint),
    )
}

/// At 0.2 m/s and 10 rad/s the first support starts at rest, and stays: it holds 4.4 mN of its 7.3
/// mN at the start. The load turns about it.
fn slide_and_spin() -> Case {
    let load = peers_system(Vec::new()).load;
    let angle = SLOW_SPIN * SLOW_SPIN * (load.inertia + MASS * ARM * ARM) * 3f64.sqrt() / (4.0 * SLIP_LIMIT * ARM);
    let known = [ARM * angle.sin(), ARM * (1.0 - angle.cos()), angle];
    let way = ARM * 2.0 * (0.5 * angle).sin();
    let run = move |runs: &Runs| {
        let (pose, report) = coasted(moving(SPEED, 0.0, SLOW_SPIN), runs);
        let values = Value::pose([pose.position.x, pose.position.y, pose.heading], known);
        Measured { values: values.to_vec(), arm: ARM, report }
    };
    let first = Bound::pose(SPEED * 1e-3 / 2.0 * 1.1, SLOW_SPIN * 1e-3 / 2.0 * 1.1, "v0 h / 2, omega0 h / 2: steps brake at their end");
    let alpha = SLOW_SPIN * SLOW_SPIN / (2.0 * angle);
    let left = alpha * 1.25e-4 * 1.25e-4 / 2.0;
    let limit = Bound::pose(left * ARM, left, "the place of the stop within a step leaves alpha h^2 / 8, up to four times over");
    let midpoint = Bound::pose(2e-4 * way, 2e-4 * angle, "0.02 %: the step in which it stops");
    let source = "rotation about the support that starts at rest: omega0^2 / (2 alpha)";
    peer(
        "peers-slide-and-spin",
        "end of a slide at 0.2 m/s with 10 rad/s",
        source,
        run,
        stop_plans(first, limit, Expected::Within(2.0), midpoint),
    )
}

/// Euler and the engine are first order without a floor; midpoint is within what an exact cone step
/// is known for.
fn stop_plans(first: Bound, limit: Bound, expected: Expected, midpoint: Bound) -> Vec<Plan> {
    let first_order = |method| Plan::first_order(method, 1e-3, 5, first.clone(), limit.clone());
    vec![
        first_order(Method::INERTIAL_EULER),
        Plan { expected, ..Plan::within(0.0, Method::INERTIAL_MIDPOINT, 1e-3, 4, midpoint) },
        first_order(Method::RAPIER),
        Plan::shown(Method::RAPIER_ENGINE_DEFAULTS, 1e-3, 4),
    ]
}

/// End of a load that starts with a speed and is left alone: the longest stop takes 54 ms.
fn coasted(start: Motion, runs: &Runs) -> (Pose, StepReport) {
    let mut run = runs.start(&peers_system(Vec::new()), start);
    let report = run.advance(&[], 0.1);
    (run.motion().pose, report)
}

/// Place at the end (m) less what it lags behind the tip without inertia.
fn pulled_exactly(kind: BackendKind, duration: f64) -> f64 {
    let since = duration - SLIP_STRETCH / PULL;
    if kind.has_inertia() { pulled_after_onset(PULL, natural_rate(), since) } else { PULL * since }
}

fn pull() -> Case {
    let run = |runs: &Runs| {
        let mut run = pulled_load(runs);
        let report = run.advance(&[Vec2::new(PULL * DURATION, 0.0)], DURATION);
        let known = pulled_exactly(runs.kind, DURATION);
        Measured { values: vec![Value::metres(run.motion().pose.position.x, known)], arm: ARM, report }
    };
    let way = pulled_exactly(BackendKind::Inertial, DURATION);
    let damped =
        Bound::metres(1.1 * PULL / natural_rate(), "13 s of ripple are damped away: v / omega; a tenth for the onset within its step");
    let plans = vec![
        Plan::exact(Method::QUASI_STATIC, 8.0, 4, Bound::metres(1e-9, "exact at any step")),
        Plan::within(0.0, Method::INERTIAL_EULER, 1e-3, 3, damped.clone()),
        Plan::of_order(2.0, Method::INERTIAL_MIDPOINT, 1e-3, 3, Bound::metres(2e-5 * way, "0.002 %: the onset within its step")),
        Plan::within(0.0, Method::RAPIER, 1e-3, 3, damped),
        Plan::shown(Method::RAPIER_ENGINE_DEFAULTS, 1e-3, 3),
    ];
    let source = "v t - (v / omega) sin omega t from the onset; v t without inertia";
    peer("peers-pull", "place after 20 s of pull at 5 mm/s", source, run, plans)
}

/// Amplitude of the ripple in the last period over v / omega: one is right, less is numerical
/// damping, more is stick-slip that is not there.
fn ripple() -> Case {
    let run = |runs: &Runs| {
        let mut run = pulled_load(runs);
        let period = std::f64::consts::TAU / natural_rate();
        let from = DURATION - period;
        let mut report = run.advance(&[Vec2::new(PULL * from, 0.0)], from);
        let n = 32;
        let mut waves = (0.0, 0.0);
        for i in 1..=n {
            let share = f64::from(i) / f64::from(n);
            let time = from + share * period;
            report.add(&run.advance(&[Vec2::new(PULL * time, 0.0)], period / f64::from(n)));
            // The tips' straight lag has no part in the first harmonic.
            let lag = PULL * time - SLIP_STRETCH - run.motion().pose.position.x;
            let (sin, cos) = (std::f64::consts::TAU * share).sin_cos();
            waves = (waves.0 + lag * sin, waves.1 + lag * cos);
        }
        let amplitude = 2.0 / f64::from(n) * f64::hypot(waves.0, waves.1);
        Measured { values: vec![Value::ratio(amplitude * natural_rate() / PULL, 1.0)], arm: ARM, report }
    };
    let damped = Bound::ratio(0.95, "damping by omega h / 2 over 13 s leaves 6 % at 1 ms, and more at shorter steps");
    let plans = vec![
        Plan::within(0.0, Method::INERTIAL_EULER, 1e-3, 3, damped.clone()),
        Plan::within(0.0, Method::INERTIAL_MIDPOINT, 1e-3, 3, Bound::ratio(1e-3, "the midpoint rule damps nothing")),
        Plan::within(0.0, Method::RAPIER, 1e-3, 3, damped),
        Plan::shown(Method::RAPIER_ENGINE_DEFAULTS, 1e-3, 3),
    ];
    peer("peers-ripple", "amplitude of the ripple in the last period of that pull, over v / omega", "1: nothing damps it", run, plans)
}

/// The load with its spring in hand.
fn pulled_load(runs: &Runs) -> Box<dyn Backend> {
    let mut run = runs.start(&peers_system(vec![isotropic(Vec2::zeros(), 0.0)]), at_rest());
    run.attach(0, Vec2::zeros());
    run
}

/// A minute at 0.9 of the limit, turned and away from the origin, through the centre and at the
/// edge of the paper's load.
fn creep() -> Case {
    let run = |runs: &Runs| {
        let mut report = StepReport::default();
        let ways = [0.0, 0.0122].map(|arm| Value::metres(way_in_a_minute(arm, runs, &mut report), 0.0));
        Measured { values: ways.to_vec(), arm: ARM, report }
    };
    let rest = Bound::metres(1e-9, "1 nm: friction that sticks does not creep");
    let plan = |method| Plan::exact(method, 1e-3, 1, rest.clone());
    let plans = Method::all_judged().map(plan).chain([Plan::shown(Method::RAPIER_ENGINE_DEFAULTS, 1e-3, 1)]);
    peer("peers-creep", "displacement in 60 s at 0.9 of the limit", "0: below the limit nothing moves", run, plans.collect())
}

fn way_in_a_minute(arm: f64, runs: &Runs, report: &mut StepReport) -> f64 {
    let start = Motion { pose: Pose::new(0.11, -0.07, 0.83), twist: Twist::ZERO };
    let a = super::scenes::SUPPORT_RADIUS;
    let critical = SLIP_LIMIT * a * (arm + a) / (arm * arm + a * arm + a * a);
    // Support 0 lies along y.
    let root = Vec2::new(0.0, arm);
    let tip = start.pose.to_world(&(root + Vec2::new(0.9 * critical / RADIAL, 0.0)));
    let mut run = runs.start(&paper_system(vec![isotropic(root, 0.0)]), start);
    run.attach(0, tip);
    report.add(&run.advance(&[tip], 60.0));
    super::scenes::distance(&start.pose, &run.motion().pose)
}
