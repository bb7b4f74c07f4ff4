//! What a step with contacts is made of: the pairs of features that may touch, and their gaps and
//! slips at an increment.

use smallvec::SmallVec;

use super::solve::{SideForce, SideMode};
use super::surroundings::{Pair, Surroundings};
use crate::backend::increment::Course;
use crate::backend::numerics::GAP_ROUNDING;
use crate::backend::springs::Place;
use crate::math::{Pose, Vec3};
use crate::model::Reaction;

/// A pair of features that may touch in a step.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub pair: Pair,
    /// The load at the start of the step in the frame of the obstacle then, and in that of the
    /// obstacle at the end of the step.
    pub before: Place,
    pub start: Place,
    /// Gap at the start, with the obstacle at its end, over that which counts as closed (m).
    pub gap: f64,
    /// Slip coordinate at the start, with the obstacle there (m), and its change until the obstacle
    /// is at its end (m).
    pub slip: f64,
    pub slipped: f64,
    /// Gap that counts as closed (m): zero, or for a load with inertia what rounding makes of it at
    /// the start. To close that within a step would take a speed.
    pub closed: f64,
}

impl Candidate {
    /// Rounding of the gap and of the slip of a load of this `length` (m).
    pub fn rounding(&self, length: f64) -> f64 {
        gap_rounding(&self.start.pose, length)
    }
}

/// Rounding of the gap and of the slip of a load of this `length` (m) at a pose.
pub fn gap_rounding(pose: &Pose, length: f64) -> f64 {
    GAP_ROUNDING * (pose.position.norm() + length * (1.0 + pose.heading.abs()))
}

/// Candidates of a step.
pub type Candidates = SmallVec<[Candidate; 2]>;

/// Contacts of a step: one entry a candidate.
pub type Sides = SmallVec<[(SideMode, SideForce); 4]>;

/// A step to be found: everything but the contacts, and the candidates.
pub struct ContactStep<'a, C> {
    pub step: &'a mut C,
    pub surroundings: &'a Surroundings,
    pub candidates: &'a [Candidate],
    /// Increment at which the search begins.
    pub start_at: Vec3,
    /// Largest number of its linear steps (1).
    pub most_steps: usize,
}

/// Gap and slip of a candidate in the step, with their derivatives by the increment.
pub struct Local {
    pub gap: Reaction,
    pub slip: Reaction,
    /// See [`Surroundings::beyond`] (m).
    pub beyond: f64,
}

/// Gaps and slips of all candidates.
pub type Locals = SmallVec<[Local; 4]>;

impl<C: Course> ContactStep<'_, C> {
    /// Gaps and slips at an increment.
    pub fn fill_locals(&self, at: &Vec3, locals: &mut Locals) {
        let moved = self.step.moved(at);
        let local = |candidate: &Candidate| {
            let Candidate { pair: pair @ Pair { features, .. }, before, start, .. } = candidate;
            let travel = self.step.seen(start, at, &moved);
            let place = start.after(&travel);
            let gap = candidate.gap + features.gap_change([start, &place], &travel);
            let slip = candidate.slipped + features.slip_change([start, &place], &travel);
            Local {
                gap: self.step.by_increment(&features.gap_with_derivatives(&place, gap), at, &moved),
                slip: self.step.by_increment(&features.slip_with_derivatives(&place, slip), at, &moved),
                beyond: self.surroundings.beyond(pair, [before, &place]),
            }
        };
        locals.clear();
        locals.extend(self.candidates.iter().map(local));
    }
}
