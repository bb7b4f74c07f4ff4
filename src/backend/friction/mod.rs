//! The friction problem in three variables, used by all backends.
//!
//! For a symmetric H and a wrench w, both in load axes, the body-twist increment x of the load
//! minimises
//!
//! ```text
//! 1/2 x'Hx - w'x + sum_i c_i |B_i x|
//!
//! B_i x        slip of support i, Eq. (12)
//! c_i = mu N_i  its slip limit, Eq. (13)
//! ```
//!
//! At the minimum `H x - w + sum_i B_i' f_i = 0`, with `f_i = c_i B_i x / |B_i x|` where support i
//! slips and `|f_i| <= c_i` where it sticks. The problem is convex, so any x that satisfies these
//! conditions is the answer.
//!
//! [`FrictionSolver`] hands a problem to the exact methods of `exact`, or to the interior-point
//! solver of [`self::clarabel`]. The exact methods work in units of the supports' extent and of the
//! sum of the limits, so that no tolerance has a dimension. Where the supports stand close together
//! off the origin, they work about a point among the supports (`cones`).

pub mod clarabel;
pub(super) mod cones;
mod corrector;
mod exact;
mod problem;
mod rest;
mod solver;

pub use exact::gliding::Tangent;
pub use problem::{ConeSolver, ContactMode, FrictionSolution, WarmStart};
pub use rest::move_back_within;
pub use solver::FrictionSolver;

#[cfg(test)]
mod tests;
