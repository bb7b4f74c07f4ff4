//! The exact methods: one backend for the quasi-static method and the methods with inertia.
//!
//! ```text
//! backend        the calls of a backend;  load: what all methods share, and what a method may choose
//! quasi_static   balance at every instant, after the paper;  jumps: where the balance is lost
//! relaxation     what becomes of a jump on damped springs;  viscous: their dashpots
//! flow           where a jump ends if its path bends
//! bdf2           its step of second order
//! inertial       the equation of motion, by  euler  or  midpoint, with dashpots
//! resolution     steps short enough for the springs as they are attached
//! contact        what is known of the load's contact with the ground;  side: with obstacles
//! among_obstacles  what all methods do with obstacles between their steps
//! waypoints      instants at which obstacles change their velocity
//! extrapolation  macro-steps under error control;  control: their tolerances and errors;
//! progress       which one is next, and the work that they take
//! ```

mod among_obstacles;
mod backend;
mod bdf2;
mod contact;
mod control;
mod dashpots;
mod euler;
mod extrapolation;
mod flow;
mod impacts;
mod inertial;
mod jumps;
mod load;
mod midpoint;
mod one_step;
mod progress;
mod quasi_static;
mod relaxation;
mod resolution;
mod side;
mod touching;
mod viscous;
mod waypoints;

pub use control::{Column, Control};
pub use load::Exact;
pub use one_step::Integrator;
