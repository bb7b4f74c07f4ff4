//! Causes of a difference without their parts.

use cohaul::analysis::compare::Cause;

/// Inertia, with impacts, and the engine: each at most once.
pub fn sides(causes: &[Cause]) -> Vec<Cause> {
    let mut sides: Vec<Cause> = causes.iter().map(|cause| if cause.is_of_engine() { Cause::Engine } else { Cause::Inertia }).collect();
    sides.dedup();
    sides
}
