//! Midpoint rule: springs act at the middle of the step, friction on the velocity at its end.
//!
//! With q* the pose after half a step at the old velocity and x = h v the increment at the new one
//! v,
//!
//! ```text
//! minimise over x    1/2 |x - h v_n|^2_M / h^2 + U(q* exp(b (x - x_n)), tips at the middle) / b + dashpots + sum_i c_i |B_i x| - L x
//! ```
//!
//! and the step ends at q* moved for half a step at v. For friction this is Moreau's rule (1988;
//! theta = 1/2 for positions). For springs it is Newmark's with gamma = 1/2 and beta = b. With b =
//! 1/4 that is the implicit midpoint rule, stable at any step. With b = 1/12 it is Fox and
//! Goodwin's, whose frequencies are right to fourth order; it is used where the step resolves all
//! oscillations and nothing damps them. A load that slides straight and sticks ends where it
//! should, up to (mu g h)^2 / (8 mu g).
//!
//! Friction F at the end of the step, at velocity and heading, lets a support stick and turn the
//! load exactly, but is half a step late where it changes. A torque of half of x times F is left as
//! well, since x is a twist along an arc. Both are corrected by what the steps before know of them,
//! the constant wrench
//!
//! ```text
//! L = -(F_n - F_(n-1)) / 2    with the torque    x_n x F_n / 2    added
//! ```
//!
//! of the same contact mode, which lags by second order only. Where friction gives way to nothing,
//! its part follows z^2 = (z - 1) / 2, which is stable and damped by sqrt(1/2) a step. A step that
//! ends in another mode than that of its correction is taken without it.

use super::one_step::{PastFriction, Problem, Stepped};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::increment::{Coasting, Increment, Potential, Stage, minimise};
use crate::backend::numerics::{FOX_GOODWIN, LARGEST_FRICTION_CHANGE, MIDPOINT};
use crate::backend::report::{Motion, StepReport};
use crate::backend::springs::Place;
use crate::math::{Arc, Mat2, Pose, Twist, Vec2, Vec3};
use crate::model::System;
use crate::model::support::wrench_of;

pub fn step(problem: Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist: old }, past, springs, mut dashpots, forecast, step, resolving_step, .. } =
        problem;
    let half_way = drifted(&before, &old, 0.5 * step);
    let start = Place::of(&half_way);
    let coasted = in_body(&start, &old, step);
    let share = if step <= resolving_step { FOX_GOODWIN } else { MIDPOINT };
    let stage = Stage { offset: -share * coasted, share };
    let mut find = |constant_wrench| {
        let (inertia, springs_at) = (Some(Coasting::of(&system.load, &old, step)), Some(stage));
        let dashpots = dashpots.as_deref_mut();
        let potential = Potential { dashpots, inertia, springs_at, constant_wrench, ..Potential::of(springs, start) };
        minimise(potential, &system.ground, solver, system.load.radius, forecast.increment(step))
    };
    let correction = past.and_then(|past| correction(&past, &start, &coasted, step, system));
    let mut found = find(correction.unwrap_or_default());
    if correction.is_some() && past.is_some_and(|past| past.mode != found.mode) {
        let StepReport { n_solves, n_iterations, .. } = found.report;
        found = find(Vec3::zeros());
        found.report.n_solves += n_solves;
        found.report.n_iterations += n_iterations;
    }
    forecast.learn(&found, step);
    let Increment { twist: increment, shift, mode, report, .. } = found;
    let twist = Twist { linear: shift / step, angular: increment.z / step };
    let pose = drifted(&half_way, &twist, 0.5 * step);
    let slipping = system.ground.supports.iter().zip(solver.forces());
    let resistance: Vec3 = slipping.map(|(support, force): (_, &Vec2)| wrench_of(&support.offset, force)).sum();
    // Both velocities in axes in which a support that the load turns about stands still.
    let moved = 0.5 * ((half_turn(coasted.z) * coasted.xy()).push(coasted.z) + increment);
    // Friction at the end velocity can push a load whose slip has reversed within the step. What
    // that gives is part of the defect.
    let friction = (-resistance.dot(&moved)).max(0.0);
    let in_world = start.turn * half_turn(increment.z) * resistance.xy();
    let past = friction_after(past, mode, in_world.push(resistance.z), step);
    Stepped { motion: Motion { pose, twist }, stage: stage.place(&start, &increment).0.pose, friction, mode, past, side: None, report }
}

/// Friction after a further step; `None` for a load at rest.
fn friction_after(earlier: Option<PastFriction>, mode: ContactMode, friction: Vec3, step: f64) -> Option<PastFriction> {
    let before = earlier.filter(|earlier| earlier.mode == mode).map(|earlier| earlier.last);
    (mode != ContactMode::Stick).then_some(PastFriction { mode, last: friction, before, step })
}

/// Wrench L that makes the step one of second order if the load goes on as it did, in the axes of
/// `start`. `None` where it is not known.
fn correction(past: &PastFriction, start: &Place, coasted: &Vec3, step: f64, system: &System) -> Option<Vec3> {
    let change = past.last - past.before?;
    let most = LARGEST_FRICTION_CHANGE * system.total_slip_limit();
    let is_steady = change.xy().norm_squared() < most * most && change.z.abs() < most * system.load.radius;
    // A step longer than the last one would make it unstable.
    let back = -0.5 * (step / past.step).min(1.0) * change;
    let in_axes = |force: Vec2| start.turn.tr_mul(&force);
    let arm = 0.5 * coasted.xy().perp(&in_axes(past.last.xy()));
    is_steady.then(|| in_axes(back.xy()).push(back.z + arm))
}

/// Rotation by half of a `turn` (rad).
fn half_turn(turn: f64) -> Mat2 {
    Arc::of(0.5 * turn).rotation()
}

/// Pose of a load that moves from `pose` with `twist` for `time` (s).
fn drifted(pose: &Pose, twist: &Twist, time: f64) -> Pose {
    Pose { position: pose.position + time * twist.linear, heading: pose.heading + time * twist.angular }
}

/// Increment of `twist` over `time` (s) in the axes of a load at this place (m, m, rad).
fn in_body(at: &Place, twist: &Twist, time: f64) -> Vec3 {
    let linear = at.turn.tr_mul(&twist.linear);
    time * Vec3::new(linear.x, linear.y, twist.angular)
}
