//! Claims about physics put to the rapier backend.

mod energy;
mod failure;
mod forces;
mod restore;
mod scenes;
mod skips;
mod slides;
mod springs;
mod stick;
