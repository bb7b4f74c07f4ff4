//! Contact of the load with obstacles, for the exact backends.
//!
//! ```text
//! features      corners and edges of an outline
//! corners       which of them touch where corner meets corner
//! gap           gap and slip of two features, with all derivatives
//! gate          whether a load lies inside an obstacle, told without features
//! surroundings  which features may touch, and how far the obstacles are
//! solve         one linear step with contacts, exactly
//! candidates    what a step with contacts is made of
//! newton        Newton's method on one nonlinear step in given contact modes
//! step          one nonlinear step with contacts
//! search        one step with the features within reach, and shorter ones where it has no answer
//! answer        an answer of such a step, and what it leaves behind
//! displacement  what a load meets along a displacement
//! touching      contacts that are closed, and the faces that they make
//! impact        the velocity after an impact;  impact_law: the law that it follows
//! obstacles     when a step needs them, and the contacts between two steps
//! ```

mod answer;
mod candidates;
mod corners;
mod displacement;
mod features;
mod gap;
mod gate;
mod impact;
mod impact_law;
mod linear;
mod newton;
mod obstacles;
mod search;
mod solve;
mod step;
mod surroundings;
mod touching;

pub use candidates::gap_rounding;
pub use impact::{Instant, Reflection, SpeedLimits, Strike, Turn};
pub use obstacles::{Obstacles, Resistance, Scope, SideWork, Task};
pub use solve::{
    ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, Stage, certificate, go_on_resting, mode_newton,
    solve_contacts,
};
pub use surroundings::PairKey;
pub use touching::{Faces, Touching, transitions};
