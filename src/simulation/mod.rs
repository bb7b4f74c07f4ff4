//! One run: a controller moves spring tips, a backend moves the load, and a trace records both.
//!
//! ```text
//! run.rs          the loop: Simulation::step is the place to begin
//! controllers/    what moves the tips: ants, prescribed paths, a recorded run
//! hand.rs         an obstacle that is held by a spring
//! clock.rs        control ticks, parts of control periods, and the end
//! account.rs      whether the numbers of a run can be trusted, and why not
//! resolution.rs   how well the steps resolve the motion
//! rules.rs        the rules that decide it
//! trace.rs        what is recorded
//! checkpoints.rs  states of a run in memory, for a stop in the midst of a step
//! doubt_times.rs  when a run was first doubtful
//! repeats.rs      when a run begins again with smaller errors
//! saved.rs        saving and resuming
//! saved_run.rs    the state of a run as data
//! run_facts.rs    the numbers of a run, for every report
//! ```

mod account;
mod checkpoints;
mod clock;
pub mod controllers;
mod doubt_times;
mod hand;
mod repeats;
mod resolution;
pub mod rules;
mod run;
pub mod run_facts;
mod saved;
mod saved_run;
mod trace;

pub use crate::backend::{AttachedTip, AttachedTips};
pub use account::{Account, Cause, Finding, Health};
pub use clock::SAME_INSTANT;
pub use controllers::{Ants, Commands, Controller, Replay, Tips, View, controller_of, follow_ants};
pub use doubt_times::DoubtTimes;
pub use hand::{Hand, HandError};
pub use repeats::Repeats;
pub use resolution::Resolution;
pub use run::{MakeBackend, Simulation, backend_of};
pub use saved_run::SavedRun;
pub use trace::{Event, EventKind, Keep, Outcome, Row, Trace};
