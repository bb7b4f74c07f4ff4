//! Floor 4: the results that the paper prints, made again: four trials on every backend, beside what stands in the paper's text.
//!
//! The paper prints no step, no pulling speed, no sensing range and no values for its figures; what is compared are the numbers of its text. The ants'
//! parameters that it leaves open were fitted to those numbers ([`fit`]), on other seeds than those that are judged. A seed with its four
//! trials is the unit of every interval: ticks of one run are not independent.
//!
//! ```text
//! printed.rs  what the paper prints
//! trial.rs    the four trials as scenarios
//! facts.rs    what is kept of a run
//! change.rs   one change of mean in a series, and whether chance would make it
//! units.rs    runs of one seed, resampled together
//! maximum.rs  the largest pull of a sample of the printed size
//! measures.rs every quantity that is compared, and the claims
//! verdict.rs  match, near or differs
//! inertia.rs  conclusions that change with inertia
//! fit.rs      the parameters left open, tried out
//! shown.rs    one run for figures
//! suite.rs    all runs on all processors, kept when interrupted
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
