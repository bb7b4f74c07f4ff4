//! What only saves time. Every result is the same without it, up to what each [`Skip`] says, and
//! the theory can be read without this folder.
//!
//! ```text
//! stick_certificate  proof that a load at rest cannot slip before its tips have moved so far
//! forecast           where Newton's method starts while the load goes on as it did
//! ```

mod forecast;
mod stick_certificate;

pub(super) use forecast::Forecast;
pub(super) use stick_certificate::StickCertificate;
