//! The exact answer of one linear step with ground friction and side contacts.
//!
//! For a body-twist increment x with the gaps `g_k + n_k x >= 0` and the slips `s_k = s0_k + t_k x`
//! the conditions are
//!
//! ```text
//! H x - w + sum_i B_i' f_i = sum_k p_k n_k + tau_k t_k
//! |f_i| <= c_i,  f_i = c_i B_i x / |B_i x| where support i slips
//! p_k >= 0,  p_k (g_k + n_k x) = 0
//! |tau_k| <= mu_k p_k,  tau_k = -mu_k p_k sign(s_k) where contact k slips
//! ```
//!
//! Without side friction they are those of a convex minimum. With it they are not: rest and sliding
//! may both satisfy them. Sliding is then preferred, and rest is taken only if it is stable
//! (`rest_or_slide`). A load that rests goes on resting while its forces say that it cannot slide
//! (`go_on_resting`).

mod answer;
mod feasible;
mod linear;
mod modes;
mod offsets;
mod path;
mod problem;
mod relaxed;
mod rest;
mod search;
mod types;
mod unique;

pub use answer::{certificate, go_on_resting, may_rest, mode_newton, solve_contacts};
pub use linear::{Basis, MOST, System};
pub use types::{ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, Stage};
