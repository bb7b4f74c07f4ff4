//! Newton's method on springs and friction at once, from a guess, for a load that goes on turning
//! about one support or slipping on all of them.

use super::objective::Objective;
use crate::backend::friction::{ContactMode, FrictionSolver, Tangent};
use crate::backend::numerics::{
    ABSOLUTE_TOLERANCE, CLOSE_CORRECTION, CORRECTION_ROUNDING, CORRECTOR_ITERATIONS, EXACT, LARGEST_RESIDUAL, RELATIVE_TOLERANCE, STRETCHED,
};
use crate::backend::report::StepReport;
use crate::math::{PositiveDefinite, Vec3};
use crate::model::Reaction;

/// Minimum that is accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// The only one: the springs' energy is convex.
    Only,
    /// The nearest one, also where only friction makes up for springs whose energy is not convex.
    Nearest,
}

/// Minimum that the corrector found.
pub struct Corrected {
    /// (m, m, rad)
    pub at: Vec3,
    pub mode: ContactMode,
    pub report: StepReport,
}

/// Progress of Newton's method from a guess.
struct Approach {
    n_iterations: u64,
    /// Size of the last correction.
    last: f64,
}

enum Next {
    /// The increment is exact to rounding.
    Done,
    Correct,
    /// The method leads elsewhere, if anywhere.
    GiveUp,
}

impl Approach {
    const NEW: Approach = Approach { n_iterations: 0, last: f64::INFINITY };

    /// Whether the last correction was small at an increment of size `extent`.
    fn is_close(&self, extent: f64) -> bool {
        self.last <= CLOSE_CORRECTION * extent
    }

    /// Judges a `correction` of this size, at an increment of size `extent` with this residual and
    /// this `rounding` of places (1).
    fn judge(&mut self, correction: f64, extent: f64, residual: f64, rounding: f64) -> Next {
        let tolerance = RELATIVE_TOLERANCE * extent + ABSOLUTE_TOLERANCE + rounding;
        // One more iteration costs little and takes the last digits. The error of a forecast would
        // grow from one to the next.
        let tolerance_here = if self.n_iterations == 0 { CORRECTION_ROUNDING * extent } else { tolerance };
        if correction <= tolerance_here && (residual <= EXACT || self.last <= tolerance) {
            return if residual <= LARGEST_RESIDUAL { Next::Done } else { Next::GiveUp };
        }
        self.n_iterations += 1;
        // Newton's method converges fast or not at all, and a guess with an error of half its size
        // is none. The first correction turns the slip along a tangent. The second may mainly take
        // back the length that this has added.
        let most = match self.n_iterations {
            1 => 0.5 * extent,
            2 => (0.5 * self.last).max(STRETCHED * extent),
            _ => 0.5 * self.last,
        };
        let is_near = correction <= most.max(tolerance);
        self.last = correction;
        if is_near && self.n_iterations < CORRECTOR_ITERATIONS { Next::Correct } else { Next::GiveUp }
    }
}

/// Minimum of the objective plus friction near `guess`, where the objective is `there` if that is
/// known. `None` when a few iterations do not lead to a minimum as `wanted`. `length` (m) is the
/// extent of the load.
pub fn correct<O: Objective>(
    objective: &mut O,
    solver: &mut FrictionSolver,
    length: f64,
    guess: Vec3,
    there: Option<Reaction>,
    wanted: Wanted,
) -> Option<Corrected> {
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
                let mode = match pin {
                    Some((_, support)) => solver.keep_pivoting(at.z, gradient).then_some(ContactMode::Pinned(support))?,
                    None => solver.keep_gliding(&at),
                };
                let n_iterations = approach.n_iterations;
                return Some(Corrected {
                    at,
                    mode,
                    report: StepReport { residual, n_steps: 1, n_solves: 1, n_iterations, ..StepReport::default() },
                });
            }
        }
    }
}
