//! As the mass goes to zero at fixed friction, the dynamics becomes the method without inertia: as
//! the square root of the mass where the load starts to slip, with the mass itself at the end.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{LOAD_RADIUS, MASS, SUPPORT_RADIUS, at_rest, paper_springs, paper_system, path, reference_tips};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::StepReport;
use cohaul::math::Pose;

pub fn cases() -> Vec<Case> {
    vec![at_the_end(), at_the_onset()]
}

/// Where the load only follows, inertia is a force of the mass times its acceleration: the first
/// power.
fn at_the_end() -> Case {
    let run = |runs: &Runs| power(runs, [2.5e-5, 6.25e-6], 1.0, 1.0, |gaps| gaps.last().copied().unwrap_or(f64::NAN));
    Case {
        name: "mass-end".to_owned(),
        family: Family::Mass,
        what: "power of the mass with which the end of the reference scene nears that without inertia, from 25 to 6 mg".to_owned(),
        source: "inertia as a small force: the first power".to_owned(),
        run: Box::new(run),
        // The midpoint rule keeps the swings of the onset, which hide the gap at the end.
        plans: plans(
            &[Method::INERTIAL_EULER],
            1.0 / 8_000.0,
            0.02,
            "swings of the onset are damped away; the second power is 1e-3 of the first",
        ),
    }
}

/// At the onset the load is as fast as without inertia only after a swing, of amplitude v / omega.
fn at_the_onset() -> Case {
    let run = |runs: &Runs| power(runs, [4e-6, 1e-6], 0.09, 0.5, |gaps| gaps.iter().copied().fold(0.0, f64::max));
    Case {
        name: "mass-onset".to_owned(),
        family: Family::Mass,
        what: "power of the mass with which the largest gap just after the onset closes, from 4 to 1 mg".to_owned(),
        source: "a swing of amplitude v / omega: the square root".to_owned(),
        run: Box::new(run),
        plans: plans(&[Method::INERTIAL_EULER, Method::INERTIAL_MIDPOINT], 0.09 / 20_000.0, 0.05, "the tips' paths bend within a swing"),
    }
}

fn plans(methods: &[Method], step_s: f64, bound: f64, reason: &str) -> Vec<Plan> {
    methods.iter().map(|method| Plan::within(0.0, *method, step_s, 1, Bound::ratio(bound, reason))).collect()
}

/// Power of the mass between two masses, with which `size` of the gaps along the path shrinks; both
/// methods at the same step.
fn power(runs: &Runs, masses: [f64; 2], duration: f64, known: f64, size: impl Fn(&[f64]) -> f64) -> Measured {
    let (still, mut report) = path_of(MASS, &Runs::of(Method::QUASI_STATIC.options(runs.step_s)), duration);
    let [heavy, light] = masses.map(|mass| {
        let (moving, of_moving) = path_of(mass, runs, duration);
        report.add(&of_moving);
        let gaps: Vec<f64> = still.iter().zip(&moving).map(|(one, other)| (one.position - other.position).norm()).collect();
        size(&gaps)
    });
    let power = (heavy / light).ln() / (masses[0] / masses[1]).ln();
    Measured { values: vec![Value::ratio(power, known)], arm: SUPPORT_RADIUS, report }
}

/// Path in the reference scene of a load of `mass` (kg) with the paper's friction.
fn path_of(mass: f64, runs: &Runs, duration: f64) -> (Vec<Pose>, StepReport) {
    let mut system = paper_system(paper_springs(4));
    system.load.mass = mass;
    system.load.inertia = 0.5 * mass * LOAD_RADIUS * LOAD_RADIUS;
    // The tips' clock is that of the scene: a second of it in all.
    path(&system, at_rest(), runs, &reference_tips, duration)
}
