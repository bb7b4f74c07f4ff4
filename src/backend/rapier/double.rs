//! The engine in double precision: `world.rs` with `rapier2d_f64`.

pub(super) use rapier2d_f64 as engine;

/// Floating-point type of this engine.
pub(super) type Real = f64;

// The files are included once per precision: the two crates share no types, and a macro or a copy
// would be harder to read.
#[allow(clippy::duplicate_mod)]
#[path = "convert.rs"]
mod convert;
#[allow(clippy::duplicate_mod)]
#[path = "impact.rs"]
mod impact;
#[allow(clippy::duplicate_mod)]
#[path = "obstacles.rs"]
mod obstacles;
#[allow(clippy::duplicate_mod)]
#[path = "shapes.rs"]
mod shapes;
#[allow(clippy::duplicate_mod)]
#[path = "world.rs"]
mod world;

pub(super) use world::World;
