//! Floor 4: springs as force sensors (Section III of the paper): fitted to measurements, designed for stiffnesses, and read on recordings.
//!
//! ```text
//! dimensions.rs  the spring's shape without its material
//! case.rs        the three ways of pulling at a tip, their laws (Eq. 1-3) and the linear ones
//! table.rs       CSV with named faults
//! measurements.rs  forces against displacements, trial by trial
//! trials.rs      one slope of several trials, with its interval
//! fit.rs         E, kappa_rho and kappa_tau of measurements
//! quality.rs     how well a law fits, and where it does not
//! equivalents.rs which stretch a linear stiffness stands for
//! design.rs      member lengths and width for wanted stiffnesses
//! recording.rs   tips as a camera saw them
//! sensor.rs      springs and how well they are known
//! forces.rs      the ants' forces on them
//! generated.rs   measurements with a known truth
//! ```

mod case;
mod design;
mod dimensions;
mod equivalents;
pub mod figure;
mod fit;
mod forces;
pub mod generated;
mod measurements;
mod quality;
mod recording;
pub mod report;
mod sensor;
mod table;
pub mod text;
mod trials;

pub use case::{Case, MOST_TURN};
pub use design::{Held, Limits, Made, Target, Wanted, design, on_grid};
pub use dimensions::Dimensions;
pub use equivalents::{RadialEquivalents, SwingEquivalents, least_squares_stiffness};
pub use fit::{Calibration, CaseFit, LinearFit, Ranges, fit};
pub use forces::{Force, ForceSummary, TipForces, summaries, tip_forces};
pub use measurements::{Measurement, Measurements, Trial};
pub use quality::{Bend, Goodness, Misfit};
pub use recording::{Recording, Sample, Tip};
pub use sensor::{FittedTo, Sensor};
pub use table::InputError;
pub use trials::{Estimate, Point, TrialSlope, Weighting, agreement, mean_of_cases, pool};
