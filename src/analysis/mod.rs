//! What runs say about inertia: an estimate beside one run, and the comparison of several.

pub mod compare;
pub mod estimate;
