//! What a step with contacts is made of: the pairs of features that may touch, and their gaps and
//! slips at an increment.

use smallvec::SmallVec;

use super::solve::{SideForce, SideMode};
use super::surroundings::{Pair, Surroundings};
use crate::backend::increment::Course;
use crate::backend::springs::Place;
use crate::math::{Pose, Vec3};
use crate::model::Reaction;

/// Gap over the load's radius that is rounding (1).
pub const CLOSED: f64 = 1e-11;
/// Rounding of a gap and of a slip, over the sum of the lengths that they come from (1). In a step,
/// a load that leans on a corner may move by no more than thousands of it, and a slip that is
/// rounding must not point its friction.
const ROUNDED: f64 = 2.0 * f64::EPSILON;

/// A pair of features that may touch in a step.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub pair: Pair,
    /// The load at the start of the step in the frame of the obstacle at its end.
    pub start: Place,
    /// Slip coordinate at the start, with the obstacle there (m).
    pub slip: f64,
    /// Least gap at the end (m): zero, or for a load with inertia that overlaps by rounding at the
    /// start, as much as there. To close an overlap within a step would take a speed.
    pub least_gap: f64,
}

impl Candidate {
    /// Rounding of the gap and of the slip of a load of this `length` (m).
    pub fn rounding(&self, length: f64) -> f64 {
        gap_rounding(&self.start.pose, length)
    }
}

/// Rounding of the gap and of the slip of a load of this `length` (m) at a pose.
pub fn gap_rounding(pose: &Pose, length: f64) -> f64 {
    ROUNDED * (pose.position.norm() + length * (1.0 + pose.heading.abs()))
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
}

/// Gap and slip of a candidate with their derivatives by the increment.
pub struct Local {
    pub gap: Reaction,
    pub slip: Reaction,
    /// See [`Surroundings::pair_beyond`] (m).
    pub beyond: f64,
}

/// Gaps and slips of all candidates.
pub type Locals = SmallVec<[Local; 4]>;

impl<C: Course> ContactStep<'_, C> {
    /// Gaps and slips at an increment.
    pub fn fill_locals(&self, at: &Vec3, locals: &mut Locals) {
        let moved = self.step.moved(at);
        let local = |candidate: &Candidate| {
            let place = self.step.seen(&candidate.start, at, &moved);
            let Pair { features, .. } = &candidate.pair;
            let mut gap = self.step.by_increment(&features.gap_with_derivatives(&place), at, &moved);
            gap.energy -= candidate.least_gap;
            Local {
                gap,
                slip: self.step.by_increment(&features.slip_with_derivatives(&place, candidate.slip), at, &moved),
                beyond: self.surroundings.pair_beyond(&candidate.pair, &place),
            }
        };
        locals.clear();
        locals.extend(self.candidates.iter().map(local));
    }
}
