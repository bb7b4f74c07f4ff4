//! Known answers of loads that touch obstacles.

mod gap;
mod inertial;
mod invariance;
mod quasi_static;
mod random;
mod random_scene;
mod scenes;
