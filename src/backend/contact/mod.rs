//! Contact of a load with obstacles beside it.

mod solve;

pub use solve::{
    ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, Stage, certificate, mode_newton, solve_contacts,
};
