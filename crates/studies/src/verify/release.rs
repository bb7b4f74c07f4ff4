//! A load at rest between two springs, of which one is let go: the net force F0 is suddenly above
//! the slip limit f.
//!
//! Without inertia the load stops at the first balance, (F0 - f) / k. With it the load makes half
//! swings of 2 (F0 - (2 j + 1) f) / k to and fro while F0 - 2 j f > f, whatever its mass. One swing
//! with a dashpot overshoots by exp(-pi zeta / sqrt(1 - zeta^2)).

use std::f64::consts::{PI, TAU};

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{MASS, RADIAL, SLIP_STRETCH, SUPPORT_RADIUS, at_rest, isotropic, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::math::Vec2;

/// F0 / f; where a method without inertia and the undamped load stop (f / k).
pub const JUMPS: [(f64, f64, f64); 5] = [(1.2, 0.2, 0.4), (1.66, 0.66, 1.32), (2.5, 1.5, 3.0), (3.5, 2.5, 4.0), (6.0, 5.0, 6.0)];

#[derive(Clone, Copy)]
struct Jump {
    /// F0 / f (1).
    ratio: f64,
    /// Displacements without and with inertia (f / k).
    still: f64,
    swung: f64,
    mass_factor: f64,
    damping_ratio: f64,
}

pub fn cases() -> Vec<Case> {
    let undamped = JUMPS.map(|(ratio, still, swung)| {
        let jump = Jump { ratio, still, swung, mass_factor: 1.0, damping_ratio: 0.0 };
        case(jump, format!("release-{ratio}"), "2 (F0 - (2 j + 1) f) / k to and fro; without inertia (F0 - f) / k")
    });
    let light = Jump { ratio: 2.5, still: 1.5, swung: 3.0, mass_factor: 1e-4, damping_ratio: 0.0 };
    let light = case(light, "release-light".to_owned(), "2 (F0 - f) / k for any mass; without inertia (F0 - f) / k");
    let damped = [0.1, 0.3, 1.0].map(|damping_ratio: f64| {
        let swing = if damping_ratio < 1.0 { (-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp() } else { 0.0 };
        let jump = Jump { ratio: 2.5, still: 1.5, swung: 1.5 * (1.0 + swing), mass_factor: 1.0, damping_ratio };
        case(jump, format!("release-damped-{damping_ratio}"), "(F0 - f) / k (1 + exp(-pi zeta / sqrt(1 - zeta^2)))")
    });
    undamped.into_iter().chain([light]).chain(damped).collect()
}

fn case(jump: Jump, name: String, source: &str) -> Case {
    let Jump { ratio, mass_factor, damping_ratio, .. } = jump;
    Case {
        name,
        family: Family::Release,
        what: format!(
            "displacement of a load of {} mg after a release to {ratio} of the slip limit, damping ratio {damping_ratio}",
            1e6 * MASS * mass_factor
        ),
        source: source.to_owned(),
        run: Box::new(move |runs| way(&jump, runs)),
        plans: plans(&jump),
    }
}

/// omega h of the longest step with inertia (rad): a thousandth of a period.
const ANGLE: f64 = TAU / 1_000.0;

fn plans(jump: &Jump) -> Vec<Plan> {
    let period = period(jump);
    let swing = jump.ratio * SLIP_STRETCH;
    let n_swings = (0.5 * (jump.ratio + 1.0)).floor();
    let first = Bound::metres(n_swings * PI / 2.0 * ANGLE * swing, "numerical damping of omega h / 2 through each half swing");
    let limit = Bound::metres(ANGLE * ANGLE / 128.0 * swing, "stops between two steps leave some (omega h)^2 / 8 of the shortest step");
    let second = Bound::metres(n_swings * ANGLE * ANGLE * swing, "(omega h)^2: phase, and stops between two steps");
    if jump.damping_ratio >= 1.0 {
        // The load only creeps up to the balance, and no error of the path is left.
        let exact = Bound::metres(1e-13, "rounding of 0.1 m over some ten thousand steps, after a decay to 1e-15");
        return Method::all_judged_with_inertia().map(|method| Plan::exact(method, period / 1_000.0, 2, exact.clone())).collect();
    }
    let first_order = |method| Plan::first_order(method, period / 1_000.0, 4, first.clone(), limit.clone());
    let mut plans = vec![
        first_order(Method::INERTIAL_EULER),
        first_order(Method::RAPIER),
        // Half a period is no whole number of steps: the load stops within one.
        Plan::within(2.0, Method::INERTIAL_MIDPOINT, period / 997.3, 4, second),
    ];
    if jump.damping_ratio == 0.0 && jump.mass_factor == 1.0 {
        let exact = Bound::metres(1e-15 * (1.0 + jump.ratio), "rounding of stretches of F0 / k");
        plans.insert(0, Plan::exact(Method::QUASI_STATIC, period, 2, exact));
    }
    plans
}

/// (s)
fn period(jump: &Jump) -> f64 {
    TAU * (MASS * jump.mass_factor / RADIAL).sqrt()
}

/// Displacement of the load after the release (m).
fn way(jump: &Jump, runs: &Runs) -> Measured {
    let (stretch, period) = (jump.ratio * SLIP_STRETCH, period(jump));
    let mut system = paper_system(vec![isotropic(Vec2::zeros(), jump.damping_ratio); 2]);
    system.load.mass *= jump.mass_factor;
    system.load.inertia *= jump.mass_factor;
    let tips = [Vec2::new(stretch, 0.0), Vec2::new(-stretch, 0.0)];
    let mut run = runs.start(&system, at_rest());
    run.attach(0, tips[0]);
    run.attach(1, tips[1]);
    let mut report = run.advance(&tips, period / 8.0);
    run.release(1);
    // Three half swings at most. What a critical dashpot leaves falls as exp(-omega t).
    let n_periods = if jump.damping_ratio >= 1.0 { 6.0 } else { 3.0 };
    report.add(&run.advance(&tips, n_periods * period));
    let ways = if runs.kind.has_inertia() { jump.swung } else { jump.still };
    Measured { values: vec![Value::metres(run.motion().pose.position.x, ways * SLIP_STRETCH)], arm: SUPPORT_RADIUS, report }
}
