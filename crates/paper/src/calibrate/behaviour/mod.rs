//! Behaviour of ants from recorded tips: when they let go under a pull, Eq. (18), and how they
//! steer and how fast they walk while they pull, Eq. (21) to (23).
//!
//! ```text
//! attachments   one ant at one spring, from a grasp to a release
//! holds         release law by maximum likelihood, and a check of its fit
//! path          path of a pulled tip, with its derivatives
//! steering      gain, half angle and speed by least squares on paths
//! profile       minimum of a cost, and intervals by its profile
//! report        results as text, figure and files
//! ```

mod attachments;
mod holds;
mod path;
mod profile;
mod report;
mod steering;

pub use attachments::{Attachment, Attachments, Held, attachments};
pub use holds::{Bin, Exposure, HoldFit, aged_exposures, exposures, fit as fit_holds};
pub use profile::Parameter;
pub use report::{Asked, BehaviourReport, write_behaviour};
pub(crate) use report::{figure as release_figure, table as release_table};
pub use steering::{SteeringFit, fit as fit_steering};
