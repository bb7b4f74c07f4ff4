//! Answers to the friction problem, and what they say about the contact with the ground.

use serde::{Deserialize, Serialize};

use crate::math::{Vec2, Vec3};

/// Solver of the friction problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConeSolver {
    /// Exact methods in three variables.
    #[default]
    Exact,
    /// The interior-point solver clarabel, for comparison.
    Clarabel,
}

/// The minimiser of the friction problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    /// Contact mode of this increment.
    pub mode: ContactMode,
    /// Largest violation of the optimality conditions, relative to the forces in them (1).
    pub residual: f64,
    /// Newton iterations that were needed.
    pub n_iterations: u32,
}

/// Which supports stick to the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactMode {
    /// All supports stick: the load does not move.
    Stick,
    /// One support sticks, and the load turns about it. It is named by its index in the ground; of
    /// several supports on the same point the first one is named.
    Pinned(usize),
    /// No support sticks.
    Slip,
}

/// Last answer of a solver, in scaled units. The start of the next search decides its last bits, so
/// it belongs to the state of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WarmStart {
    /// Twist of the last slipping answer: the next one is likely to be near.
    pub(super) twist: Option<Vec3>,
    /// Cone that the load turned about in the last answer.
    pub(super) pin: Option<usize>,
    /// Whether the last answer was a slip with this twist.
    #[serde(default)]
    pub(super) slipped: bool,
    /// Forces f_i, one per cone.
    pub(in crate::backend) forces: Vec<Vec2>,
}

/// An answer in scaled units, before it is kept. Its forces stand in the solver's warm start.
pub(super) struct Candidate {
    pub twist: Vec3,
    /// Contact mode; a pinned support is named by its cone.
    pub mode: ContactMode,
}
