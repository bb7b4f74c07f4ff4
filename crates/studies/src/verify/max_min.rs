//! The max-min problem as the paper prints it, put to every step in which the load slides.
//!
//! Eq. 15 and 16 maximise a power over the twists of the load: that of the springs less that of
//! friction, for twists n in a bounded set. Here w is the wrench of the springs on the load and
//! h(n) the friction power, the sum of c |B n| over the supports, which is what the inner minimum
//! of Eq. 15 leaves. The bounded set is the unit ball of |n|^2 = v_x^2 + v_y^2 + (a omega)^2 with
//! the distance a of the supports. The maximum of w.n - h(n) over it is the distance of w from the
//! wrenches that friction can hold, and the maximiser is the direction of that distance. Clarabel
//! finds both; it shares no code with the solver of the backend.
//!
//! At the end of a step the maximum should be zero: no direction has power to spare. With the tips
//! moved and the load yet to follow it is positive, and its maximiser should be the direction of
//! the step. Both hold in the limit of short steps, since the wrench changes within a step. A jump
//! has no such limit: the printed problem fixes no distance, and jumps are left out.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Errors, Measured, Value};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::friction::clarabel::ClarabelSolver;
use cohaul::backend::{Backend, BackendOptions, StepReport, TransitionKind};
use cohaul::math::{Mat3, Pose, Vec3, increment_of, rotation};
use cohaul::model::System;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Controller, Keep, Replay, Simulation};

/// Time of the run of four ants that is looked at (s).
const DURATION_S: f64 = 40.0;
/// The longest step (s), at which the ants decide, and the number of its halvings with it.
const LONGEST_STEP_S: f64 = 2.5e-3;
const N_STEPS: usize = 3;

/// A step in which the load slides.
struct Slide {
    /// Wrench of the springs on the load (N, N, N m; load axes) with the tips moved and the load
    /// yet to follow, and after the step.
    before: Vec3,
    after: Vec3,
    /// Body-twist increment of the load (m, m, rad).
    increment: Vec3,
}

pub fn cases() -> Vec<Case> {
    // A tip at 0.025 m/s pulls with 0.04 mN more after a step, and four of them with 0.17 mN, of 22
    // mN that friction holds. The direction turns by that share, 7.6 mrad, times the curvature of
    // the limit surface, for which there is room up to eight.
    let errors = Errors { radians: Some(0.06), ratio: Some(3e-6), ..Errors::NONE };
    let reason = "the wrench changes by 0.8 % of the slip limit in a step; clarabel finds the power to 1e-6".to_owned();
    let of_angle = Bound { errors: Errors { ratio: None, ..errors }, reason: reason.clone() };
    let of_power = Bound { errors: Errors { radians: None, ..errors }, reason };
    vec![
        case(
            "max-min-direction",
            "largest angle between a sliding step and the maximiser of the printed power",
            |runs| of_largest(runs, angle, |angle| Value::radians(angle, 0.0)),
            Plan::of_order(1.0, Method::QUASI_STATIC, LONGEST_STEP_S, N_STEPS, of_angle),
        ),
        case(
            "max-min-power",
            "largest printed power of any direction after a sliding step, over the slip limit",
            |runs| of_largest(runs, power_left, |power| Value::ratio(power, 0.0)),
            Plan::exact(Method::QUASI_STATIC, LONGEST_STEP_S, N_STEPS, of_power),
        ),
    ]
}

fn case(name: &str, what: &str, run: fn(&Runs) -> Measured, plan: Plan) -> Case {
    let source = "Eq. (15) and (16)".to_owned();
    Case { name: name.to_owned(), family: Family::MaxMin, what: what.to_owned(), source, run: Box::new(run), plans: vec![plan] }
}

/// The largest number that `look` finds; not a number without any, which no bound allows.
fn of_largest(options: &BackendOptions, look: Look, value: fn(f64) -> Value) -> Measured {
    let (found, report) = four_ants(options, look);
    Measured { values: vec![value(found.into_iter().fold(f64::NAN, f64::max))], arm: 1.0, report }
}

/// Puts a question to one sliding step.
type Look = fn(&mut Problem, &Slide) -> f64;

/// Angle between the step and the maximiser (rad).
fn angle(problem: &mut Problem, slide: &Slide) -> f64 {
    let (_, direction) = problem.maximum(&slide.before);
    problem.angle(&direction, &slide.increment)
}

/// Largest power of any direction after the step, over the slip limit of the load (1).
fn power_left(problem: &mut Problem, slide: &Slide) -> f64 {
    problem.maximum(&slide.after).0 / problem.slip_limit
}

/// What `look` finds at the sliding steps of four ants on four springs: their run at the longest
/// step, repeated with the same grasps, releases and tips at the step of `options`.
fn four_ants(options: &BackendOptions, look: Look) -> (Vec<f64>, StepReport) {
    let text = include_str!("../../../../scenarios/paper/four-ants-four-springs.json");
    let mut scenario = Scenario::parse(text, "four ants").expect("scenarios of the project are valid");
    (scenario.duration, scenario.control_period) = (DURATION_S, LONGEST_STEP_S);
    let mut run = Simulation::new(&scenario, &Method::QUASI_STATIC.options(LONGEST_STEP_S), Keep::Trace);
    run.run(|_| true);
    let (recorded, _) = run.into_results();
    let replay: Box<dyn Controller> = Box::new(Replay::new(Arc::new(recorded), scenario.system.springs.len()));
    let n_parts = (LONGEST_STEP_S / options.step_s).round() as u64;
    let mut run = Simulation::with_controller(&scenario, options, Keep::Outcome, replay).with_rows_per_period(n_parts);
    let (mut problem, mut found) = (Problem::new(&scenario.system), Vec::new());
    while !run.is_finished() {
        let before = run.motion().pose;
        run.step();
        let slide = problem.slide(before, run.backend());
        found.extend(slide.map(|slide| look(&mut problem, &slide)));
    }
    let (_, outcome) = run.into_results();
    (found, outcome.steps)
}

struct Problem<'a> {
    system: &'a System,
    solver: ClarabelSolver,
    /// Distance of the supports from the load's centre (m).
    arm: f64,
    /// (N)
    slip_limit: f64,
    /// Swing of each spring when it was last looked at (rad).
    swings: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(system: &'a System) -> Self {
        let arm = system.ground.supports[0].offset.norm();
        Self {
            system,
            solver: ClarabelSolver::new(&system.ground, arm),
            arm,
            slip_limit: system.total_slip_limit(),
            swings: vec![0.0; system.springs.len()],
        }
    }

    /// What happened in the last step of `backend`, from the pose `before`; `None` where the load
    /// rested or jumped.
    fn slide(&mut self, before: Pose, backend: &dyn Backend) -> Option<Slide> {
        let after = backend.motion().pose;
        let increment = increment_of(&rotation(before.heading), &(after.position - before.position), after.heading - before.heading);
        let [before, after] = [before, after].map(|pose| self.wrench(backend, &pose));
        let jumps = backend.transitions().iter().any(|transition| matches!(transition.kind, TransitionKind::Jump { .. }));
        (!jumps && increment != Vec3::zeros()).then_some(Slide { before, after, increment })
    }

    /// Wrench of the springs on the load at `pose` (N, N, N m; load axes), with the tips of
    /// `backend`.
    fn wrench(&mut self, backend: &dyn Backend, pose: &Pose) -> Vec3 {
        let mut wrench = Vec3::zeros();
        for (at, (spring, swing)) in self.system.springs.iter().zip(&mut self.swings).enumerate() {
            let Some(tip) = backend.tip(at) else {
                *swing = 0.0;
                continue;
            };
            let shape = spring.shape(pose, &tip, *swing);
            *swing = shape.swing;
            let pull = rotation(-pose.heading) * spring.pull(pose, &shape);
            wrench += pull.push(pose.to_local(&tip).perp(&pull));
        }
        wrench
    }

    /// Largest power w.n - h(n) of a direction, at unit speed (N), and the direction.
    fn maximum(&mut self, wrench: &Vec3) -> (f64, Vec3) {
        // The minimum of |x|^2 / 2 - w.x + h(x) has its direction, and its length as the power.
        let found = self.solver.solve(&Mat3::from_diagonal(&Vec3::new(1.0, 1.0, self.arm * self.arm)), wrench).increment;
        (self.scaled(&found).norm(), found)
    }

    fn scaled(&self, twist: &Vec3) -> Vec3 {
        Vec3::new(twist.x, twist.y, self.arm * twist.z)
    }

    /// (rad)
    fn angle(&self, one: &Vec3, other: &Vec3) -> f64 {
        let (one, other) = (self.scaled(one), self.scaled(other));
        if one == Vec3::zeros() || other == Vec3::zeros() { FRAC_PI_2 } else { one.cross(&other).norm().atan2(one.dot(&other)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten thousand sliding steps, and a direction that is off by a degree has power to gain: the
    /// comparison can fail.
    #[test]
    fn a_direction_that_is_off_is_seen() {
        let (sizes, _) = four_ants(&Method::QUASI_STATIC.options(0.5 * LONGEST_STEP_S), |_, slide| slide.increment.norm());
        assert!(sizes.len() > 10_000 && sizes.iter().all(|size| *size > 0.0), "{}", sizes.len());
        let scenario = Scenario::read("../../scenarios/paper/four-ants-four-springs.json".as_ref()).unwrap();
        let mut problem = Problem::new(&scenario.system);
        let outside = Vec3::new(1.1 * problem.slip_limit, 0.0, 0.0);
        let (power, direction) = problem.maximum(&outside);
        // The distance to the limit surface, which friction ends at the slip limit along x.
        assert!((power - 0.1 * problem.slip_limit).abs() < 1e-6 * problem.slip_limit);
        let (sin, cos) = 1f64.to_radians().sin_cos();
        assert!((problem.angle(&direction, &Vec3::new(cos, sin, 0.0)) - 1f64.to_radians()).abs() < 1e-6);
    }
}
