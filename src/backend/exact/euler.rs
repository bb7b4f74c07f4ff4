//! Implicit Euler: the quasi-static step with the mass matrix added.
//!
//! ```text
//! minimise over x    1/2 |q exp x - q - h v|^2_M / h^2 + U(q exp x, tips at the end) + dashpots + sum_i c_i |B_i x|
//! ```
//!
//! The conditions of contact hold at the end of the step as well, for a load that touches an
//! obstacle.

use super::one_step::{Among, Problem, Stepped};
use crate::backend::contact::Task;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Coasting, Increment, Potential, Step, minimise};
use crate::backend::report::Motion;
use crate::backend::springs::Place;
use crate::math::{Pose, Twist, Vec3};

pub fn step(problem: Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist }, springs, dashpots, forecast, among, step, .. } = problem;
    let inertia = Some(Coasting::of(&system.load, &twist, step));
    let potential = Potential { dashpots, inertia, ..Potential::of(springs, Place::of(&before)) };
    let guess = forecast.increment(step);
    let (found, side) = match among {
        None => (minimise(potential, &system.ground, solver, system.load.radius, guess), None),
        Some(Among { obstacles, touching, end, scope }) => {
            let mut at_end = Step { potential, ground: &system.ground, length: system.load.radius };
            let task = Task::inertial(end, step, guess, scope, false);
            let (found, side) = obstacles.find(system, &mut at_end, solver, touching, &task);
            (found, Some(side))
        }
    };
    forecast.learn(&found, step);
    let Increment { twist: increment, shift, friction, mode, report } = found;
    let pose = Pose { position: before.position + shift, heading: before.heading + increment.z };
    let pushed_out = side.as_ref().map(|side| side.push_out).filter(|out| *out != Vec3::zeros());
    let pose = pushed_out.map_or(pose, |out| pose.moved_by(&out));
    let twist = Twist { linear: shift / step, angular: increment.z / step };
    Stepped { motion: Motion { pose, twist }, stage: pose, friction, mode, past: None, side, report }
}
