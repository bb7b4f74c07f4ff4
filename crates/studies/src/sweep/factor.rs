//! Parameters that are factors on a whole scene: its speed, its size, and the inertia of its load.

use super::axis::INERTIA;
use super::error::SweepError;
use cohaul::scenario::Scenario;

/// What is multiplied; 1 is the scene as given. `src/scenario/scaled.rs` says what follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factor {
    /// Speed of everything that drives the load.
    Speed,
    /// All lengths, with all else similar.
    Size,
    /// Mass and moment of inertia at the same normal loads and dashpots.
    Inertia,
}

impl Factor {
    /// The factor that a parameter of this name is.
    pub fn named(path: &str) -> Option<Self> {
        match path {
            "speed" => Some(Factor::Speed),
            "size" => Some(Factor::Size),
            "inertia" | INERTIA => Some(Factor::Inertia),
            _ => None,
        }
    }

    /// Whether a scene has what the factor `path` multiplies.
    ///
    /// # Errors
    /// When nothing in the scene has a speed.
    pub fn check(self, path: &str, scenario: &Scenario) -> Result<(), SweepError> {
        let is_at_rest = self == Factor::Speed && scenario.drive_speed() == 0.0;
        let rule = "must have a tip, an obstacle or a start with a speed";
        if is_at_rest { Err(SweepError::axis(path, rule, "all at rest")) } else { Ok(()) }
    }

    /// Multiplies by a `factor` (1).
    pub fn apply(self, scenario: &mut Scenario, factor: f64) {
        match self {
            Factor::Speed => scenario.scale_speed(factor),
            Factor::Size => scenario.scale_size(factor),
            Factor::Inertia => scenario.system.scale_inertia(factor),
        }
    }
}
