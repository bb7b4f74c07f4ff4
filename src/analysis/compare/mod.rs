//! Comparison of two exact backends with an engine: where they agree, and what causes a difference.
//!
//! There are three tiers, because the paths of ants that decide for themselves separate at the
//! first decision that differs. [`Tier::Prescribed`] compares paths under prescribed tip motions.
//! [`Tier::Replayed`] compares paths under the recorded grasps, releases and tip motions of one
//! run. [`Tier::ClosedLoop`] compares distributions over paired seeds. [`ThreeWay`] runs them.
//!
//! ```text
//! settings.rs    tiers, steps and tolerances
//! three_way.rs   the entry: one question to three backends
//! solution.rs    path of one backend with its numerical error
//! engine.rs      name of the engine
//! doubt.rs       why the result of an exact run cannot be trusted, and from when on
//! same_stop.rs   places that hold both exact loads and that the engine passes
//! difference.rs  distance of two paths
//! damping.rs     what the dashpots change without inertia
//! course.rs      pulls, speed and energy of a run at its ticks
//! divergence.rs  first divergence of two runs
//! attributed.rs  attribution of the inertia effect to triggers
//! numbers.rs     epsilon, Phi and zeta of a run, and what theory predicts from them
//! parts.rs       what the differences consist of
//! pathwise.rs    comparison of paths
//! seed_runs.rs   runs of one seed on the three backends
//! ensemble.rs    comparison of distributions
//! seeds.rs       number of seeds that would decide
//! verdict.rs     two answers, the word that follows from them, and causes
//! reduced.rs     numbers of the three runs, from their courses
//! quantity.rs    the result for one quantity: path, heading, a force, speed or energy
//! verdicts.rs    the results for all quantities of a comparison of paths
//! jump_mode.rs   oscillation of the load on its springs at the largest jump
//! suggestion.rs  changes that make a difference smaller than the tolerance
//! trial.rs       runs that try these changes
//! ```

mod attributed;
mod course;
mod damping;
mod difference;
mod divergence;
mod doubt;
mod engine;
mod ensemble;
mod jump_mode;
mod limit;
mod numbers;
mod parts;
mod pathwise;
mod quantity;
mod question;
mod reduced;
mod same_stop;
mod seed_runs;
mod seeds;
mod settings;
mod solution;
mod suggestion;
mod three_way;
mod trial;
mod verdict;
mod verdicts;

pub use damping::DampingEffect;
pub(super) use damping::is_damped;
pub use difference::Difference;
pub use divergence::Divergence;
pub use doubt::{Doubt, DoubtKind};
pub use engine::EngineName;
pub use ensemble::{ClosedLoop, Distribution, FirstDifferentDecision, Measure, MeasureVerdict, PairedDifference, SeedDoubt};
pub use numbers::{Numbers, Predicted};
pub use parts::Parts;
pub use pathwise::{EdgeDisplacement, Pathwise, ReferenceError};
pub use quantity::{FirstDivergence, Open, QuantityVerdict, Verdicts};
pub use reduced::RunMeasure;
pub use seed_runs::SeedRuns;
pub use settings::{LEAST_HALVINGS, LEAST_MOTION, MakeController, OwnMeasure, Settings, Tier};
pub use solution::{Point, Solution};
pub use suggestion::{SuggestedChange, Tried};
pub use three_way::ThreeWay;
pub use trial::LONGEST as LONGEST_TRIAL;
pub use verdict::{Answers, Cause, EngineAnswer, InertiaAnswer, Verdict};
