//! Claims about physics put to the rapier backend.

mod energy;
mod failure;
mod restore;
mod scenes;
mod slides;
mod springs;
mod stick;
