//! Implicit Euler: the quasi-static step with the mass matrix added.
//!
//! ```text
//! minimise over x    1/2 |q exp x - q - h v|^2_M / h^2 + U(q exp x, tips at the end) + dashpots + sum_i c_i |B_i x|
//! ```

use super::one_step::{Problem, Stepped};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Coasting, Increment, Potential, minimise};
use crate::backend::springs::Place;
use crate::math::{Pose, Twist};

pub fn step(problem: Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist }, springs, dashpots, forecast, step, .. } = problem;
    let inertia = Some(Coasting::of(&system.load, &twist, step));
    let potential = Potential { dashpots, inertia, ..Potential::of(springs, Place::of(&before)) };
    let found = minimise(potential, &system.ground, solver, system.load.radius, forecast.increment(step));
    forecast.learn(&found, step);
    let Increment { twist: increment, shift, friction, mode, report } = found;
    let pose = Pose { position: before.position + shift, heading: before.heading + increment.z };
    let twist = Twist { linear: shift / step, angular: increment.z / step };
    Stepped { motion: Motion { pose, twist }, stage: pose, friction, mode, past: None, report }
}
