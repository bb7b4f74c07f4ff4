//! Error that is allowed in a run, and what it means for a single macro-step.

use serde::{Deserialize, Serialize};

use super::exact::{Column, Control};
use super::numerics::{LARGEST_MACRO_STEP_ERROR, MACRO_STEP_SHARE, MOST_TIGHTENED, SMALLEST_MACRO_STEP_ERROR};
use super::report::PoseError;
use crate::model::{Load, System};

/// Error that the pose of a run may have at any time, for given attachments, releases and tip
/// motions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Largest error of the position (m).
    pub position_m: f64,
    /// Largest error of the heading (rad).
    pub heading_rad: f64,
    /// Number of times that the errors of the macro-steps have been divided by ten because their
    /// sum, the error of the run, was too large (1).
    #[serde(default)]
    pub tightened: u32,
}

impl Tolerance {
    /// Tolerance that allows a shift of `position_m` (m), and a turn by which the edge of the load
    /// moves as far.
    pub fn at_edge(position_m: f64, load: &Load) -> Self {
        Self { position_m, heading_rad: position_m / load.radius, tightened: 0 }
    }

    /// This tolerance with a tenth of the error of each macro-step; `None` when smaller errors
    /// would not help any more.
    pub fn tightened(&self) -> Option<Self> {
        (self.tightened < MOST_TIGHTENED).then_some(Self { tightened: self.tightened + 1, ..*self })
    }

    /// Whether the repetitions that are left may bring this error within the tolerance: each
    /// divides the errors of the macro-steps by ten.
    pub fn may_reach(&self, error: &PoseError) -> bool {
        let excess = (error.position / self.position_m).max(error.heading / self.heading_rad);
        excess <= 10f64.powi(MOST_TIGHTENED.saturating_sub(self.tightened) as i32)
    }

    /// Whether an error is within the tolerance.
    pub fn allows(&self, error: &PoseError) -> bool {
        error.position <= self.position_m && error.heading <= self.heading_rad
    }

    pub(super) fn control(&self, system: &System, settling_time: Option<f64>) -> Control {
        let load = &system.load;
        // The force of friction, or of a spring stretched by the load's radius. The error of an
        // energy is that force times the error of the position.
        let stiffness = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
        let force = system.total_slip_limit() + stiffness * load.radius;
        let share = MACRO_STEP_SHARE * 0.1f64.powi(self.tightened as i32);
        let of_step = |error: f64, size: f64| (share * error).clamp(SMALLEST_MACRO_STEP_ERROR * size, LARGEST_MACRO_STEP_ERROR * size);
        Control {
            position: of_step(self.position_m, load.radius),
            heading: of_step(self.heading_rad, 1.0),
            energy: of_step(self.position_m, load.radius) * force,
            settling_time,
            keeps: Column::Last,
        }
    }
}
