//! Sweeps through the program itself: one table whatever threads, shards and kills it went through,
//! and errors before any work.

mod common;
mod errors;
mod kills;
#[path = "../../common/root.rs"]
mod root;
mod same;
mod values;
