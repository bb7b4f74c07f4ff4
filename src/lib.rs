//! Collective transport of a load by ants: one behaviour model, several ways of moving the load,
//! and a comparison that says where they agree.
//!
//! A quasi-static run neglects the load's inertia. A run of a rigid-body engine has inertia, and
//! the engine's numerical error. A third run, the same springs and exact friction with the mass
//! matrix added, tells the two apart:
//!
//! ```text
//! inertia effect = inertial - quasi-static
//! engine error   = rapier   - inertial
//! own error      = how far quasi-static and inertial may still be wrong
//! ```
//!
//! Units are SI, angles are in radians, counter-clockwise. Floors, each using only those above it
//! in this list: [`math`], [`model`], [`scenario`], [`backend`], [`simulation`], [`analysis`],
//! [`output`], [`studies`], [`cli`].
#![forbid(unsafe_code)]

pub mod analysis;
pub mod backend;
#[cfg(feature = "program")]
pub mod cli;
pub mod math;
pub mod model;
pub mod output;
pub mod scenario;
pub mod simulation;
#[cfg(feature = "figures")]
pub mod studies;

/// The examples of the book run as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/src/library.md")]
struct Book;
