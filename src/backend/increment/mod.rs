//! One time-incremental step: the body-twist increment that minimises potential plus friction.
//!
//! ```text
//! minimise over x    E(q exp x) + sum_i c_i |B_i x|
//! ```
//!
//! E is the elastic energy with the tips where they are at the end of the step. With inertia, half
//! the mass matrix over the squared step about the pose that the load would coast to is added.
//! Without inertia this is the paper's max-min principle, Eq. (15), in its time-incremental form:
//! the printed instantaneous form fixes a direction but no speed. `Deviation:` Eq. (11)-(16) are
//! posed for increments, not velocities.
//!
//! The constant-twist path from q to q exp x dissipates just sum_i c_i |B_i x| with constant B_i,
//! so that the problem is the same in every world frame. E is not convex in general. The minimum
//! wanted is the one that descent from rest reaches.
//!
//! ```text
//! objective  what is minimised, besides friction;  potential: its energy, with all derivatives
//! straight   the same about a step that goes on from the last one
//! corrector  Newton's method on springs and friction at once, from a guess
//! descent    proximal Newton's method from rest: the cone problem with the Hessian of E, made positive
//!            definite where it is not, and a line search on the true objective
//! minimise   the one from a guess where it is good, the other elsewhere
//! ```

mod corrector;
mod descent;
mod minimise;
mod objective;
mod potential;
mod straight;

pub(super) use corrector::{Corrected, Wanted, correct};
pub use descent::{positive_definite, shortened};
pub use minimise::{minimise, minimise_step};
pub use objective::Objective;
pub use potential::{Coasting, Course, Increment, Potential, Stage, Step, by_increment, friction_loss, in_body_increments};
pub use straight::Straight;
