//! Implicit Euler: the quasi-static step with the mass matrix added.
//!
//! ```text
//! minimise over x    1/2 |q exp x - q - h v|^2_M / h^2 + U(q exp x, tips at the end) + dashpots + sum_i c_i |B_i x|
//! ```

use super::dashpots::Dashpots;
use super::{Problem, Stepped};
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Coasting, Increment, Potential, Stage, minimise};
use crate::math::Twist;

pub(super) fn step(problem: &Problem, solver: &mut FrictionSolver) -> Stepped {
    let Problem { system, start: Motion { pose: before, twist }, last, held, step, .. } = *problem;
    let dashpots = Dashpots::new(system, held, last, &before, step);
    let potential = Potential {
        start: before,
        springs: &[(&system.springs, held), (&dashpots.springs, &dashpots.held)],
        inertia: Some(Coasting::of(&system.load, &twist, step)),
        springs_at: Stage::END,
    };
    let Increment { twist: increment, friction, regime, report } = minimise(&potential, &system.ground, solver, system.load.radius);
    let pose = before.moved_by(&increment);
    let twist = Twist { linear: before.shift_by(&increment) / step, angular: increment.z / step };
    Stepped { motion: Motion { pose, twist }, stage: pose, friction, regime, dashpots, report }
}
