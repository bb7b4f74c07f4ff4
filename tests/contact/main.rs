//! Known answers of loads that touch obstacles.

#[path = "../analytic/bounded.rs"]
mod bounded;
mod energy;
mod gap;
mod hand;
mod impacts;
mod inertial;
mod invariance;
mod pushing;
mod quasi_static;
mod random;
mod random_scene;
mod scenes;
mod squeezed;
mod steered;
