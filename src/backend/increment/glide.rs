//! Newton's method on springs and friction at once, from a guess: for a load that goes on turning about one support, or all of whose supports go on slipping.

use super::{ABSOLUTE_TOLERANCE, LARGEST_RESIDUAL, RELATIVE_TOLERANCE};
use crate::backend::StepReport;
use crate::backend::friction::{EXACT, FrictionSolver, Regime, Tangent};
use crate::math::{PositiveDefinite, Vec3};
use crate::model::Reaction;

/// What an increment is to minimise, besides friction.
pub(in crate::backend) trait Objective {
    /// Energy (J), gradient and Hessian by the increment, at the increment `at` (m, m, rad).
    fn at(&mut self, at: &Vec3) -> Reaction;

    /// The gradient alone.
    fn gradient(&mut self, at: &Vec3) -> Vec3;

    /// Rounding of places over the extent of the load (1).
    fn rounding(&self) -> f64;
}

/// Which of the minima counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::backend) enum Wanted {
    /// The only one: the springs' energy is convex.
    Only,
    /// The nearest one, also where friction has to make up for springs whose energy is not convex.
    Nearest,
}

/// Where it led.
pub(in crate::backend) struct Glided {
    /// (m, m, rad)
    pub at: Vec3,
    pub regime: Regime,
    pub report: StepReport,
}

/// Where a guess takes more, the descent from rest is the better way.
const MOST_GLIDING: u64 = 6;
/// Second correction, over the size of the increment, after which a third one can still be far smaller (1).
const STRETCHED: f64 = 0.05;
/// Correction, over the size of the increment, that is none (1).
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Correction, over the size of the increment, up to which the next ones need no derivative of their own: what that leaves of an increment is its third power (1).
const CLOSE: f64 = 3e-5;
/// How Newton's method gets on from a guess.
struct Approach {
    n_iterations: u64,
    /// Size of the last correction.
    last: f64,
}

enum Next {
    /// Where it is, it is exact to rounding.
    Done,
    Correct,
    /// It leads elsewhere, if anywhere.
    GiveUp,
}

impl Approach {
    const NEW: Approach = Approach { n_iterations: 0, last: f64::INFINITY };

    /// Whether the last correction was that small at an increment of size `extent`.
    fn is_close(&self, extent: f64) -> bool {
        self.last <= CLOSE * extent
    }

    /// What to do about a `correction` of this size, at an increment of size `extent` with this residual and with this `rounding` of places (1).
    fn judge(&mut self, correction: f64, extent: f64, residual: f64, rounding: f64) -> Next {
        let tolerance = RELATIVE_TOLERANCE * extent + ABSOLUTE_TOLERANCE + rounding;
        // One more iteration costs little and takes the last digits; what a forecast is off by would grow from one to the next.
        let tolerance_here = if self.n_iterations == 0 { ROUNDING * extent } else { tolerance };
        if correction <= tolerance_here && (residual <= EXACT || self.last <= tolerance) {
            return if residual <= LARGEST_RESIDUAL { Next::Done } else { Next::GiveUp };
        }
        self.n_iterations += 1;
        // Newton's method that converges does so fast; a guess that is off by half of itself is none. The first correction turns the slip along a tangent, and the
        // second may have more to do with taking the length back that this has added.
        let most = match self.n_iterations {
            1 => 0.5 * extent,
            2 => (0.5 * self.last).max(STRETCHED * extent),
            _ => 0.5 * self.last,
        };
        let is_near = correction <= most.max(tolerance);
        self.last = correction;
        if is_near && self.n_iterations < MOST_GLIDING { Next::Correct } else { Next::GiveUp }
    }
}

/// `None` when it does not lead from `guess`, where the objective is `there` if that is known, to a minimum as `wanted` in a few iterations. `length` (m) is the extent
/// of the load.
pub(in crate::backend) fn glide<O: Objective>(
    objective: &mut O,
    solver: &mut FrictionSolver,
    length: f64,
    guess: Vec3,
    there: Option<Reaction>,
    wanted: Wanted,
) -> Option<Glided> {
    let pin = solver.unit_turn();
    let mut at = pin.map_or(guess, |(unit_turn, _)| guess.z * unit_turn);
    let per_length = 1.0 / length;
    let size = |twist: &Vec3| per_length * twist.xy().norm() + twist.z.abs();
    let mut approach = Approach::NEW;
    let mut there = there.filter(|_| at == guess).unwrap_or_else(|| objective.at(&at));
    let mut tangent: Option<Tangent> = None;
    loop {
        let extent = size(&at);
        let has_derivative = !approach.is_close(extent);
        if approach.n_iterations > 0 {
            if has_derivative {
                there = objective.at(&at);
            } else {
                there.gradient = objective.gradient(&at);
            }
        }
        let Reaction { gradient, hessian, .. } = &there;
        let (step, residual) = match pin {
            Some((unit_turn, _)) => {
                let (step, residual) = solver.pivoting_step(at.z, gradient, hessian)?;
                (step * unit_turn, residual)
            }
            None => solver.gliding_step(&at, gradient, has_derivative.then_some(hessian), &mut tangent)?,
        };
        let next = approach.judge(size(&step), extent, residual, objective.rounding());
        if wanted == Wanted::Only && has_derivative && PositiveDefinite::new(hessian).is_none() {
            return None;
        }
        match next {
            Next::GiveUp => return None,
            Next::Correct => at = pin.map_or(at + step, |(unit_turn, _)| (at.z + step.z) * unit_turn),
            Next::Done => {
                let regime = match pin {
                    Some((_, support)) => solver.keep_pivoting(at.z, gradient).then_some(Regime::Pinned(support))?,
                    None => solver.keep_gliding(&at),
                };
                let n_iterations = approach.n_iterations;
                return Some(Glided {
                    at,
                    regime,
                    report: StepReport { residual, n_steps: 1, n_solves: 1, n_iterations, ..StepReport::default() },
                });
            }
        }
    }
}
