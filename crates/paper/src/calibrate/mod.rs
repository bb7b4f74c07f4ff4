//! Springs as force sensors (Section III of the paper): fit to measurements, design for wanted
//! stiffnesses, and forces from recorded tips.
//!
//! ```text
//! case          three directions of loading, with the laws of Eq. (1) to (3) and linear laws
//! load_cell     readings on a grid of tip positions, as lookup table and by case
//! measurements  forces against displacements, trial by trial
//! trials        one slope from several trials, with its interval
//! fit           Young's modulus, kappa_rho and kappa_tau of measurements
//! design        dimensions for wanted stiffnesses
//! recording     tip positions from a camera or a run
//! units         headings in degrees
//! sensor        springs and the errors of their stiffnesses
//! forces        forces on the tips of a recording
//! behaviour     release law and steering of the ants on the tips of a recording
//! pulls         comparison of two samples of pulls
//! ```

pub mod behaviour;
mod case;
mod design;
mod dimensions;
mod equivalents;
mod figure;
pub mod files;
mod fit;
mod forces;
mod law;
mod load_cell;
mod measurements;
mod pulls;
mod quality;
mod recording;
mod sensor;
pub mod text;
mod trials;
mod units;

pub use case::{Case, MOST_TURN};
pub use design::{DesignReport, Held, Limits, Made, Target, Wanted, design, on_grid};
pub use dimensions::Dimensions;
pub use equivalents::{RadialEquivalents, SwingEquivalents, least_squares_stiffness};
pub use fit::{Calibration, CaseFit, LinearFit, Ranges, fit};
pub use forces::{Force, ForceSummary, ForcesReport, summaries, tip_forces};
pub use load_cell::{GridReport, LoadCell};
pub use measurements::{Measurement, Measurements, Trial};
pub use pulls::{PullComparison, PullSample, PullSeries, block_duration, compare_pulls};
pub use quality::{Bend, Goodness, Misfit};
pub use recording::{Recording, Sample, Tip};
pub use sensor::{FittedTo, Sensor};
pub use trials::{Estimate, Point, TrialSlope, Weighting, agreement, mean_of_cases, pool};
pub use units::headings_in_degrees;
