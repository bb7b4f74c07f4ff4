//! Comparison of the three backends: where they agree, and what causes a difference.
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
//! difference.rs  distance of two paths
//! divergence.rs  first divergence of two paths, and the attribution to triggers
//! numbers.rs     epsilon, Phi and zeta of a run, and what theory predicts from them
//! pathwise.rs    comparison of paths
//! ensemble.rs    comparison of distributions
//! verdict.rs     the result in one word
//! suggestion.rs  changes that make a difference smaller than the tolerance
//! ```

mod difference;
mod divergence;
mod ensemble;
mod numbers;
mod pathwise;
mod settings;
mod solution;
mod suggestion;
mod three_way;
mod verdict;

pub use difference::Difference;
pub use divergence::Divergence;
pub use ensemble::{ClosedLoop, Distribution, FirstDifferentDecision, Measure, PairedDifference};
pub use numbers::{Numbers, Predicted};
pub use pathwise::{EdgeDisplacement, FirstDivergence, Pathwise, ReferenceError};
pub use settings::{MakeController, Settings, Tier};
pub use solution::{Point, Solution};
pub use suggestion::SuggestedChange;
pub use three_way::ThreeWay;
pub use verdict::{Cause, Verdict};
