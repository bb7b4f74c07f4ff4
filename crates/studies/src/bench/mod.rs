//! Benchmark: run time against error of every method.
//!
//! A run time is only meaningful beside the error that was reached. Every method therefore runs
//! every scene at several steps or tolerances, its error is measured against a reference of the
//! same kind (no inertia: a path without inertia, else one with it), and methods are compared at
//! equal error. Times are CPU times of the thread, in rounds over all methods and settings, so that
//! a busy minute of the machine affects all alike. The shortest time counts; the median shows how
//! busy the machine was.
//!
//! ```text
//! reference.rs    what errors are measured against
//! standard.rs     the scenes of a benchmark that is asked for no others
//! scene.rs        a scenario with its references, and the steps and tolerances to try
//! work.rs         one setting: its error, its times, or why it has none
//! equal_error.rs  the cheapest setting of each method at an error
//! problems.rs     friction problems of a run, and what is left of their conditions
//! solvers.rs      the exact solver against clarabel on them
//! growth.rs       cost of a step, or of a tick of ants, over the size of a scene
//! fit.rs          power laws and lines through costs
//! clock.rs        CPU time, least and median
//! host.rs         the machine
//! benchmark.rs    all measurements in turn, resumable
//! ```

mod benchmark;
mod clock;
mod equal_error;
pub mod figure;
pub mod files;
mod fit;
mod growth;
mod host;
pub mod page;
mod problems;
mod reference;
pub mod report;
mod scene;
mod solvers;
mod standard;
pub mod text;
mod work;

pub use benchmark::{BenchError, Effort, Measured, Plan, Watch, bench};
pub use clock::{MOST_SPREAD, NOISY_SHARE, Timing, is_noisy};
pub use equal_error::{EqualError, LEVELS, cheapest, equal_errors};
pub use fit::{Line, PowerLaw, line, power_law};
pub use growth::{Fit, Growth, GrowthPoint, Quantity, fits};
pub use host::Host;
pub use problems::{Problem, kkt_residual, problems_of};
pub use reference::Reference;
pub use scene::{Level, Scene, SceneFacts};
pub use solvers::{Sequence, Solver, SolverRow};
pub use standard::{STANDARD, crowd, four_ants, standard_scenes};
pub use work::{Ending, Row};
