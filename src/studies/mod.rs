//! Studies: each poses scenes, runs them, judges what comes back and writes its report, figures and files.

pub mod bench;
pub mod calibrate;
pub mod check;
pub mod compare;
pub mod journal;
pub mod known_answers;
pub mod methods;
pub mod paper;
pub mod regime;
pub mod run;
pub mod runner;
pub mod stress;
pub mod sweep;
pub mod verify;
