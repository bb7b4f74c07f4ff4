//! Engines of others as backends of `cohaul`, which a comparison puts in the place of rapier.
//!
//! An engine answers requests of [`protocol`], one JSON object a line, over a [`Channel`]: a
//! [`pipe`] to a program, or whatever else carries lines. [`Driven`] is the backend that asks them.
//! What an engine does not compute, the comparison does not judge.
//!
//! ```text
//! protocol.rs  the requests and the answers
//! springs.rs   forces of the springs, which an engine may ask for
//! channel.rs   what carries lines, and what was wrong with an engine
//! pipe.rs      a program as an engine
//! driven.rs    the backend
//! engine.rs    an engine with its name, and a backend for each run
//! ```

pub mod channel;
pub mod driven;
pub mod engine;
pub mod pipe;
pub mod protocol;
pub mod springs;

pub use channel::{Channel, Complaint};
pub use driven::{Driven, NoStart};
pub use engine::Engine;
pub use pipe::Pipe;
pub use springs::Springs;
