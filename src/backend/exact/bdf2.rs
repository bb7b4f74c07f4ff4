//! Step of second order for a load that goes on slipping: backward differences (BDF2) of its
//! position and heading.
//!
//! With the last step (d_n over h_n), the next one over h and w = h / h_n, the velocity at the end
//! is, up to an error of second order,
//!
//! ```text
//! h v = (d - a d_n) / b        a = w^2 / (1 + 2 w)    b = (1 + w) / (1 + 2 w)
//! ```
//!
//! Friction at the end opposes the slip of v there and balances the springs. That is again a
//! minimum, over x = d - a d_n:
//!
//! ```text
//! minimise over x    E(q + a d_n + x) + sum_i c_i |B_i x|
//! ```
//!
//! Here x is a shift along the axes of the load at the end, and a turn. These axes come from a
//! forecast, whose error is of second order as well. A step takes one solution, as implicit Euler
//! does (`increment`), and damps what it does not resolve (it is L-stable). It needs two earlier
//! steps in which all supports slip. Slip onsets, turns about a support, jumps and whatever else
//! does not lie near its forecast are left to Euler.

use serde::{Deserialize, Serialize};

use crate::backend::friction::FrictionSolver;
use crate::backend::increment::{Corrected, Course, Increment, Straight, Wanted, correct};
use crate::backend::numerics::LARGEST_RATIO;
use crate::backend::springs::{Place, SpringBlocks};
use crate::math::{Arc, Vec2, Vec3, shift_of};
use crate::model::System;

/// The last step of a load that slipped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Past {
    /// Shift of the load's origin (m, world).
    pub shift: Vec2,
    /// (rad)
    pub turn: f64,
    /// (s)
    pub duration: f64,
}

/// Weights a and b of a step over `ratio` times the duration of the last one; `None` where it is
/// too long for the method.
pub fn weights(ratio: f64) -> Option<(f64, f64)> {
    let whole = 1.0 + 2.0 * ratio;
    (ratio <= LARGEST_RATIO).then(|| (ratio * ratio / whole, (1.0 + ratio) / whole))
}

/// Step from `start` over `duration` (s), for a load that slips on all supports and did so in
/// `past`, on springs and on dashpots about the shapes that the past step carries on. `None` where
/// there is no such step near the `guess`, a body-twist increment (m, m, rad).
pub fn step(
    system: &System,
    (start, past): (&Place, &Past),
    duration: f64,
    guess: &Vec3,
    (springs, dashpots): (&mut SpringBlocks, Option<&mut SpringBlocks>),
    solver: &mut FrictionSolver,
) -> Option<Increment> {
    let (weight, _) = weights(duration / past.duration)?;
    let carried @ (shift, turned) = (weight * past.shift, weight * past.turn);
    let turn = start.turn;
    let axes = turn * Arc::of(guess.z).rotation();
    let near = axes.tr_mul(&(shift_of(&turn, guess) - shift)).push(guess.z - turned);
    let (ground, radius) = (&system.ground, system.load.radius);
    let mut objective = Straight { springs, dashpots, inertia: None, ground, start, radius, carried, axes, expected_turn: guess.z };
    let Corrected { at, mode, report } = correct(&mut objective, solver, radius, near, None, Wanted::Nearest)?;
    let increment = objective.found(&at, mode, report);
    objective.goes_on(&at, &increment).then_some(increment)
}
