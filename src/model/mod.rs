//! The paper's laws, without state: springs, load, supports, ants and their decisions.
//!
//! Equation numbers are those of Berman, Lindsey, Sakar, Kumar, Pratt, "Study of group food
//! retrieval by ants as a model for multi-robot collective transport strategies", Robotics: Science
//! and Systems VI, 2010.

pub mod ant;
pub mod avoidance;
pub mod behaviour;
pub mod geometry;
pub mod interaction;
pub mod load;
mod motion;
pub mod open_choices;
mod outline;
pub mod paper;
pub mod spring;
pub mod spring_design;
pub mod support;
pub mod team;
pub mod uniform_supports;
mod world;

pub use interaction::interaction_force;
pub use load::{Load, System};
pub use motion::Motion;
pub use outline::{Outline, OutlinePart};
pub use spring::{PolarSpring, Reaction, SpringLaw, SpringShape};
pub use spring_design::SpringDesign;
pub use support::{Ground, SupportPoint};
pub use world::{Obstacle, ObstaclePath, ObstaclePose, SideFrictionRule, World};
