//! Midpoint positions: springs act at the middle of the step, friction on the velocity at its end.
//!
//! With q* the pose after half a step at the old velocity and x = h v the increment at the new one v,
//!
//! ```text
//! minimise over x    1/2 |x - h v_n|^2_M / h^2 + U(q* exp(b (x - x_n)), tips at the middle) / b + dashpots + sum_i c_i |B_i x|
//! ```
//!
//! and the step ends at q* moved for half a step at v. For friction this is Moreau's rule (1988; theta = 1/2 for positions). For springs it is Newmark's with
//! gamma = 1/2 and beta = b: with b = 1/4 the implicit midpoint rule, stable at any step; with b = 1/12 Fox and Goodwin's, whose frequencies
//! are right to fourth order, where the step resolves all oscillations and nothing damps them. A load that slides straight and sticks ends where it should but for
//! (mu g h)^2 / (8 mu g) at most. Friction follows the end velocity, so a slip that turns makes the step first order with a small constant.

use super::{Problem, Stepped};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Coasting, Increment, Potential, Stage, minimise};
use crate::backend::spring_blocks::Place;
use crate::math::{Pose, Twist, Vec2, Vec3};
use crate::model::support::wrench_of;

/// Newmark's beta that cancels the error of frequencies; stable up to omega h = sqrt(6).
const FOX_GOODWIN: f64 = 1.0 / 12.0;
/// Newmark's beta that evaluates springs at the mean of both ends; stable at any step.
const MIDPOINT: f64 = 0.25;

pub(super) fn step(problem: Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist: old }, springs, dashpots, forecast, step, resolving_step } = problem;
    let half_way = drifted(&before, &old, 0.5 * step);
    let start = Place::of(&half_way);
    let coasted = in_body(&start, &old, step);
    let share = if step <= resolving_step { FOX_GOODWIN } else { MIDPOINT };
    let stage = Stage { offset: -share * coasted, share };
    let potential = Potential { start, springs, dashpots, inertia: Some(Coasting::of(&system.load, &old, step)), springs_at: Some(stage) };
    let found = minimise(potential, &system.ground, solver, system.load.radius, forecast.increment(step));
    forecast.learn(&found, step);
    let Increment { twist: increment, shift, regime, report, .. } = found;
    let twist = Twist { linear: shift / step, angular: increment.z / step };
    let pose = drifted(&half_way, &twist, 0.5 * step);
    let moved = 0.5 * (coasted + increment);
    let slipping = system.ground.supports.iter().zip(solver.forces());
    let resistance: Vec3 = slipping.map(|(support, force): (_, &Vec2)| wrench_of(&support.offset, force)).sum();
    // Friction at the end velocity can push a load whose slip has turned back within the step; what that gives is part of the defect.
    let friction = (-resistance.dot(&moved)).max(0.0);
    Stepped { motion: Motion { pose, twist }, stage: stage.place(&start, &increment).0.pose, friction, regime, report }
}

/// Where a load at `pose` is after moving with `twist` for `time` (s).
fn drifted(pose: &Pose, twist: &Twist, time: f64) -> Pose {
    Pose { position: pose.position + time * twist.linear, heading: pose.heading + time * twist.angular }
}

/// The increment of `twist` over `time` (s) in the axes of a load at this place (m, m, rad).
fn in_body(at: &Place, twist: &Twist, time: f64) -> Vec3 {
    let linear = at.turn.tr_mul(&twist.linear);
    time * Vec3::new(linear.x, linear.y, twist.angular)
}
