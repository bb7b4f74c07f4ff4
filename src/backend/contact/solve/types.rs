//! What is asked of the contact solver, and what it answers.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use crate::backend::friction::ContactMode;
use crate::math::{Mat3, Vec2, Vec3};

/// One entry per side contact. Most loads have few.
pub type PerContact<T> = SmallVec<[T; 4]>;

/// One side contact, linearised about no increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow {
    /// Derivative of the gap by the body-twist increment (1, 1, m).
    pub normal: Vec3,
    /// Derivative of the slip by the body-twist increment (1, 1, m).
    pub tangent: Vec3,
    /// Gap without an increment (m).
    pub gap: f64,
    /// Slip so far in this step, without an increment (m).
    pub slip: f64,
    /// Coulomb's coefficient of friction between load and obstacle (1).
    pub friction_coefficient: f64,
}

/// What a side contact does in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SideMode {
    /// Nothing touches.
    Open,
    /// The contact is closed and does not slip.
    Stick,
    /// The contact is closed and slips along its tangent (`forward`), or against it.
    Slide {
        /// Whether the slip is positive.
        forward: bool,
    },
}

/// Force of an obstacle on the load at one contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SideForce {
    /// Force along the row's normal (N), positive where the obstacle pushes.
    pub normal: f64,
    /// Friction force along the row's tangent (N).
    pub tangential: f64,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The increment satisfies all conditions.
    Converged,
    /// No increment satisfies the gaps: the load is squeezed.
    Infeasible,
    /// No answer was found. The best increment known is reported with its residual.
    NotConverged,
}

/// Method that found an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Newton's method in the modes of the last step, or rest that goes on.
    Warm,
    /// Nothing touches.
    Free,
    /// Newton's method in the modes that the increment without contacts shows.
    Guess,
    /// The step without side friction, in which no contact slips.
    Frictionless,
    /// Newton's method in the modes that the step without side friction shows.
    Modes,
    /// Newton's method on the limit of slipping, to which a step without side friction is close.
    Limit,
    /// The convex step with friction cones, in which no contact slips, and which stays at rest when
    /// it is disturbed.
    StableRest,
    /// The convex step with friction cones and slip offsets.
    Offsets,
    /// The smoothed conditions of Coulomb's law.
    Smoothed,
    /// Newton's method in every combination of modes.
    Enumeration,
    /// Any method. The answer satisfies all conditions, but a small disturbance of it grows, and no
    /// stable answer was found.
    Unstable,
    /// No method.
    Failed,
}

/// Increment and forces that a solve found.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    /// Contact mode with the ground.
    pub ground_mode: ContactMode,
    /// Friction resistance of each support of the ground (N, load axes), along its slip.
    pub ground_forces: SmallVec<[Vec2; 8]>,
    /// Force at each side contact.
    pub forces: PerContact<SideForce>,
    /// Mode of each side contact.
    pub modes: PerContact<SideMode>,
    /// Largest violation of the conditions of the step, as by [`super::certificate`] (1).
    pub residual: f64,
    /// How the solve ended.
    pub ending: Ending,
    /// Side contacts that no increment can keep from overlapping together; empty unless the ending
    /// is [`Ending::Infeasible`].
    pub conflict: PerContact<usize>,
    /// Whether these are the only forces that belong to the increment. In a jam, and at rest, the
    /// ground and the obstacles can share the drive in many ways.
    pub are_forces_unique: bool,
    /// Method that found the answer.
    pub stage: Stage,
    /// Number of cone problems and smoothed paths that were solved.
    pub n_solves: u32,
    /// Number of Newton iterations of all kinds.
    pub n_iterations: u32,
}

/// Forces on a load other than those of ground and obstacles, and its side contacts.
#[derive(Clone, Copy, Debug)]
pub struct ContactSystem<'a> {
    /// Derivative of the elastic and inertial forces by the increment, symmetric and positive
    /// semidefinite (N/m, N, N m/rad).
    pub hessian: &'a Mat3,
    /// Wrench on the load without an increment (N, N, N m; load axes).
    pub drive: &'a Vec3,
    /// Side contacts.
    pub rows: &'a [ContactRow],
}
