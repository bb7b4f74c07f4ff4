//! Midpoint positions: springs act at the middle of the step, friction on the velocity at its end.
//!
//! With q* the pose after half a step at the old velocity and x = h v the increment at the new one v,
//!
//! ```text
//! minimise over x    1/2 |x - h v_n|^2_M / h^2 + U(q* exp(b (x - x_n)), tips at the middle) / b + dashpots + sum_i c_i |B_i x| - L x
//! ```
//!
//! and the step ends at q* moved for half a step at v. For friction this is Moreau's rule (1988; theta = 1/2 for positions). For springs it is Newmark's with
//! gamma = 1/2 and beta = b: with b = 1/4 the implicit midpoint rule, stable at any step; with b = 1/12 Fox and Goodwin's, whose frequencies
//! are right to fourth order, where the step resolves all oscillations and nothing damps them. A load that slides straight and sticks ends where it should but for
//! (mu g h)^2 / (8 mu g) at most.
//!
//! Friction F at the end of the step, at velocity and heading, lets a support stick and turn the load exactly, but is half a step late where it changes; and a torque
//! of half of x times F is left, since x is a twist along an arc. Both are taken back by what the steps before know of them, the constant wrench
//!
//! ```text
//! L = -(F_n - F_(n-1)) / 2    with the torque    x_n x F_n / 2    added
//! ```
//!
//! of the same regime, which lags by no more than second order. Where friction does not give way to anything, its part follows z^2 = (z - 1) / 2, which is stable and damped by
//! sqrt(1/2) a step. A step that ends in another regime than its lead is from is taken without.

use serde::{Deserialize, Serialize};

use super::{Problem, Stepped};
use crate::backend::friction::{FrictionSolver, Regime};
use crate::backend::increment::{Coasting, Increment, Potential, Stage, minimise};
use crate::backend::springs::Place;
use crate::backend::{Motion, StepReport};
use crate::math::{Arc, Mat2, Pose, Twist, Vec2, Vec3};
use crate::model::System;
use crate::model::support::wrench_of;

/// Newmark's beta that cancels the error of frequencies; stable up to omega h = sqrt(6).
const FOX_GOODWIN: f64 = 1.0 / 12.0;
/// Newmark's beta that evaluates springs at the mean of both ends; stable at any step.
const MIDPOINT: f64 = 0.25;
/// Change of friction in one step, over the most that there can be (its torque about the load's radius), up to which it goes on so (1).
const LARGEST_CHANGE: f64 = 0.5;

pub(super) fn step(problem: Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist: old }, past, springs, mut dashpots, forecast, step, resolving_step } =
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
    let lead = past.and_then(|past| past.lead(&start, &coasted, step, system));
    let mut found = find(lead.unwrap_or_default());
    if lead.is_some() && past.is_some_and(|past| past.regime != found.regime) {
        // It does not go on as it did.
        let StepReport { n_solves, n_iterations, .. } = found.report;
        found = find(Vec3::zeros());
        found.report.n_solves += n_solves;
        found.report.n_iterations += n_iterations;
    }
    forecast.learn(&found, step);
    let Increment { twist: increment, shift, regime, report, .. } = found;
    let twist = Twist { linear: shift / step, angular: increment.z / step };
    let pose = drifted(&half_way, &twist, 0.5 * step);
    let slipping = system.ground.supports.iter().zip(solver.forces());
    let resistance: Vec3 = slipping.map(|(support, force): (_, &Vec2)| wrench_of(&support.offset, force)).sum();
    // Both velocities in axes in which a support that the load turns about stands.
    let moved = 0.5 * ((half_turn(coasted.z) * coasted.xy()).push(coasted.z) + increment);
    // Friction at the end velocity can push a load whose slip has turned back within the step; what that gives is part of the defect.
    let friction = (-resistance.dot(&moved)).max(0.0);
    let in_world = start.turn * half_turn(increment.z) * resistance.xy();
    let past = Past::after(past, regime, in_world.push(resistance.z), step);
    Stepped { motion: Motion { pose, twist }, stage: stage.place(&start, &increment).0.pose, friction, regime, past, report }
}

/// Friction of the last steps, all of one regime (N, N, N m; forces in world axes, torques about the load's origin).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Past {
    regime: Regime,
    last: Vec3,
    before: Option<Vec3>,
    /// Length of the last step (s).
    step: f64,
}

impl Past {
    /// After a further step with this friction; a load at rest has none.
    fn after(earlier: Option<Self>, regime: Regime, friction: Vec3, step: f64) -> Option<Self> {
        let before = earlier.filter(|earlier| earlier.regime == regime).map(|earlier| earlier.last);
        (regime != Regime::Stick).then_some(Self { regime, last: friction, before, step })
    }

    /// What friction is to be changed by for a step of second order, about `start`, whose axes it is in, if the load goes on as it did. `None` where that is not known.
    fn lead(&self, start: &Place, coasted: &Vec3, step: f64, system: &System) -> Option<Vec3> {
        let change = self.last - self.before?;
        let most = LARGEST_CHANGE * system.total_slip_limit();
        let is_steady = change.xy().norm_squared() < most * most && change.z.abs() < most * system.load.radius;
        // A longer step than the last one would follow it unsteadily.
        let back = -0.5 * (step / self.step).min(1.0) * change;
        let in_axes = |force: Vec2| start.turn.tr_mul(&force);
        let arm = 0.5 * coasted.xy().perp(&in_axes(self.last.xy()));
        is_steady.then(|| in_axes(back.xy()).push(back.z + arm))
    }
}

/// Rotation by half of a `turn` (rad).
fn half_turn(turn: f64) -> Mat2 {
    Arc::of(0.5 * turn).rotation()
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
