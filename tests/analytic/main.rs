//! Known answers, backend by backend, and what must hold without knowing the answer.
//!
//! Known answers are closed forms derived on paper, or numbers of programs that share no code with
//! this one; each says which.

#[path = "../common/mod.rs"]
mod common;

mod bounded;
mod centre_pull;
mod creep;
mod deformed;
mod energy;
mod invariance;
mod limit_surface;
mod midpoint;
mod off_centre;
mod pulls;
mod reference;
mod release;
mod rope;
mod second_order;
mod slide;
mod snap;
mod spring_law;
mod towing;
mod tripod;
mod vanishing_mass;
