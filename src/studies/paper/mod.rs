//! Reproduction of the results in the paper's text: four trials on every backend.
//!
//! The paper prints no step, no pulling speed, no sensing range and no values of its figures. The
//! numbers of its text are compared. The parameters of the ants that it does not print were fitted
//! to those numbers ([`fit`]), with other seeds than those of the comparison. Every interval is
//! over seeds with their four trials, because the ticks of one run are not independent.
//!
//! ```text
//! trial.rs    the four trials as scenarios
//! facts.rs    numbers of one run
//! change.rs   one change of mean in a series, and its significance
//! units.rs    runs of one seed, resampled together
//! maximum.rs  the largest pull of a sample of the printed size
//! measures.rs all compared quantities, and the claims
//! verdict.rs  match, near or differs
//! inertia.rs  conclusions that change with inertia
//! fit.rs      search for the parameters that are not printed
//! shown.rs    one run for figures
//! suite.rs    all runs as tasks
//! ```

pub mod change;
mod facts;
pub mod figure;
pub mod figure_run;
pub mod files;
pub mod fit;
mod inertia;
mod maximum;
mod measures;
pub mod readme;
pub mod report;
mod shown;
mod style;
mod suite;
pub mod text;
mod trial;
mod units;
mod verdict;
pub mod why;

pub use change::{Change, change_of_mean};
pub use facts::{BLOCK, ChangeAt, Changes, OfSize, RunFacts, Series, WINDOW_S, run, series_of};
pub use inertia::{Conclusion, Standing, conclusions};
pub use maximum::{Extreme, extreme};
pub use measures::{Claim, MEASURES, Measure, Sample, Speeds, claims, load_speeds};
pub use shown::{Shown, Snapshot, shown};
pub use suite::{Answer, Plan, Replayed, Set, Task, tasks};
pub use trial::{Case, LITERAL_PERIOD_S, Trial};
pub use units::{Estimate, Unit, difference, estimate, paired, units};
pub use verdict::{Grade, Printed, grade, graded};
