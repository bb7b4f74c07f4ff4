//! What trackers get wrong, put right within stated bounds: swapped names, jumps, gaps and noise.
//!
//! ```text
//! limits.rs       the bounds, and their defaults from the recording itself
//! swaps.rs        two tracks whose names were swapped
//! jumps.rs        places far off their track for a short time
//! attachments.rs  tracks of tips as attachments: gaps that are bridged, and releases
//! smooth.rs       the smoothest path within a bound, and an estimate of the noise
//! ```

mod attachments;
mod jumps;
mod limits;
mod smooth;
mod swaps;

pub use attachments::{Attachment, attachments};
pub use jumps::leave_out_jumps;
pub use limits::{Bounds, Limits};
pub use smooth::{note_noise, smooth, smooth_headings};
pub use swaps::undo_swaps;
