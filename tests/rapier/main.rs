//! Claims about physics put to the rapier backend.

mod contact;
mod energy;
mod failure;
mod forces;
mod obstacle_scenes;
mod restore;
mod scenes;
mod skips;
mod slides;
mod springs;
mod stick;
