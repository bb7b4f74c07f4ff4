//! The program `cohaul`: its command line and its live page.
#![forbid(unsafe_code)]

pub mod cli;
pub mod live;
