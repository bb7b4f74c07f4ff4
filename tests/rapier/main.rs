//! Claims about physics put to the rapier backend.

mod bounces;
mod contact;
mod energy;
mod failure;
mod forces;
mod health;
mod obstacle_scenes;
mod outlines;
mod restore;
mod scenes;
mod skips;
mod slides;
mod springs;
mod stick;
