//! Sweeps through the program itself: one table whatever threads, shards and kills it went through,
//! and errors before any work.

mod common;
mod errors;
mod kills;
mod same;
mod values;
