//! The quasi-static method on damped springs: known answers, the limit of vanishing mass at the
//! same dashpots, and what dashpots must not change.
//!
//! Known answers are closed forms derived on paper, or numbers of a program that shares no code
//! with this one.

mod doorway;
mod known;
mod limit;
mod scene;
mod steps;
