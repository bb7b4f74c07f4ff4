//! Thresholds: up to which value of a parameter quasi-static is valid, against laws that are
//! derived on paper; and the scaled scenes behind the parameters `speed`, `size` and `inertia`.
//!
//! ```text
//! known.rs     thresholds in known laws
//! scaled.rs    similarity of scaled scenes
//! search.rs    what a search says of what it cannot tell, and a search that was stopped
//! scenes.rs    the scenes of the laws
//! program.rs   the command
//! ```

mod known;
mod program;
#[path = "../../common/root.rs"]
mod root;
mod scaled;
mod scenes;
mod search;
