//! Reproduction of the results in the paper's text: four trials on every backend.
//!
//! The paper prints no step, no pulling speed, no sensing range and no values of its figures. The
//! numbers of its text are compared. The parameters of the ants that it does not print were chosen
//! by some of those numbers ([`search`]), with other seeds than those of the comparison; such a
//! number is called calibrated. Every interval is over seeds with their four trials, because
//! the ticks of one run are not independent.
//!
//! ```text
//! trial.rs    the four trials as scenarios
//! facts.rs    numbers of one run
//! window.rs   the part of a run in which a phase change is looked for
//! change.rs   one change of mean in a series, and its significance
//! phase.rs    the printed change of three series at once
//! force.rs    the inertial force, as a camera would see it
//! units.rs    runs of one seed, resampled together
//! sampling.rs samples of pulls: from which trials, and when
//! maximum.rs  the largest pull of a sample of the printed size
//! mixture.rs  the printed sample counts as a mixture of the trials
//! by_size.rs  sums over all runs by the number of pulling ants
//! group_size.rs  load speed by the number of pulling ants
//! measures.rs all compared quantities
//! claims.rs   what the paper says in words, with the models that contradict it
//! printed_facts.rs  all printed numbers and claims as one list
//! verdict.rs  match, near, calibrated, differs or undecided
//! hold.rs     chance that one ant's pull reaches the friction of the load
//! readings.rs the printed facts under several readings
//! readme.rs   tables with notes, as Markdown and as a page
//! table.rs    the table of quantities, and what is not reproduced
//! experiment.rs  what the paper measured on ants, and the inertial force of all runs
//! inertia.rs  conclusions that change with inertia
//! standstill.rs  times without progress before obstacles
//! search/     all parameter sets that the paper allows
//! shown.rs    one run for figures
//! transport.rs  the series of one recording or run, with the test for a phase change
//! suite.rs    all runs as tasks
//! ```

mod by_size;
pub mod change;
mod claims;
mod experiment;
mod facts;
pub mod figure;
pub mod figure_run;
pub mod files;
mod force;
mod group_size;
mod hold;
mod inertia;
mod maximum;
mod measures;
mod mixture;
mod phase;
mod printed_facts;
pub mod readings;
pub mod readme;
pub mod report;
mod sampling;
pub mod search;
mod shown;
pub mod standstill;
mod style;
mod suite;
mod table;
pub mod text;
mod transport;
mod trial;
mod units;
mod verdict;
mod window;

pub use change::Change;
pub use claims::{Claim, Null, claims};
pub use experiment::{Experiment, ForceRow, experiment, force_rows};
pub use facts::{At, BLOCK, ChangeOf, Changes, OfSize, RunFacts, Series, WINDOW_S, WINDOWS, run, series_in_window, series_of, ticks_in};
pub use group_size::{Speeds, load_speeds};
pub use hold::chance_to_move;
pub use inertia::{Conclusion, Standing, conclusions};
pub use maximum::{Extreme, largest};
pub use measures::{Measure, PhaseSign, measures};
pub use mixture::{Mixture, TrialShare, mixture, printed_share};
pub use printed_facts::{Fact, NEAR_PULL, NEAR_SHARE, facts_of, printed_facts};
pub use sampling::{Sample, Sampling};
pub(crate) use shown::springs as shown_springs;
pub use shown::{Shown, Snapshot, shown};
pub use suite::{Answer, Plan, Replayed, Set, Task, tasks};
pub use table::{Missed, OtherSet, TableRow, missed, table};
pub use transport::{OfGroup, Transport};
pub use trial::{Case, LITERAL_PERIOD_S, Trial};
pub use units::{Estimate, Unit, difference, estimate, paired, units, with_interval};
pub use verdict::{Grade, Own, Printed};
pub use window::{END_BEFORE_NEST_M, gathered, window};
