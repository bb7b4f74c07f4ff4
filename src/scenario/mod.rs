//! Floor 2: a run as data. A scenario file is read, checked whole and expanded into a [`Scenario`]; nothing else of the program sees the
//! file.

mod error;
mod expand;
pub(crate) mod json;
mod structure;
mod validate;

pub mod format;
pub mod presets;

use std::fs;
use std::path::Path;

use crate::math::Vec2;
use crate::model::behaviour::{Pace, ReleaseLaw};
use crate::model::{Motion, System};

pub use error::{Finding, ScenarioError};

/// One run, as checked when it was read or built: its numbers make sense. Who changes them in code asks again by `scenario.expanded().checked(name)`
/// ([`format::ScenarioFile::checked`]). Nothing here changes during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    pub name: String,
    /// Longest simulated time (s); a run of ants ends earlier when the load arrives.
    pub duration: f64,
    /// Clock of behaviour and of the trace (s).
    pub control_period: f64,
    /// Key of all chance.
    pub seed: u64,
    pub system: System,
    pub start: Motion,
    pub drive: Drive,
}

impl Scenario {
    /// The scenario in the JSON file at `path`.
    ///
    /// # Errors
    /// When the file cannot be read, is not JSON, or breaks a rule of the format: then with every finding, not only the first.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let name = path.display().to_string();
        match fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &name),
            Err(source) => Err(ScenarioError::Unreadable { file: name, source }),
        }
    }

    /// The scenario that the JSON `text` describes; errors call it `name_for_errors`.
    ///
    /// ```
    /// use cohaul::scenario::Scenario;
    ///
    /// let text = r#"{
    ///     "name": "a slide", "duration_s": 1, "control_period_s": 0.001,
    ///     "load": { "mass_kg": -0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.2, 0] },
    ///     "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
    ///     "springs": [],
    ///     "drive": { "kind": "tips", "paths": [] }
    /// }"#;
    /// let error = Scenario::parse(text, "slide.json").unwrap_err();
    /// assert_eq!(error.to_string(), "slide.json: load.mass_kg: must be positive, found -0.0016");
    /// ```
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn parse(text: &str, name_for_errors: &str) -> Result<Self, ScenarioError> {
        let (mut value, mut findings) = json::read(text).map_err(|error| error.of_file(name_for_errors))?;
        let misfits = structure::compare(&mut value, &mut findings);
        let draft = validate::Draft::read(value, &misfits, &mut findings);
        validate::scenario(draft, findings).map_err(|findings| ScenarioError::Invalid { file: name_for_errors.to_string(), findings })
    }
}

/// What moves the tips.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Prescribed paths of the tips, at most one per spring.
    Tips(Vec<TipPath>),
    /// The behaviour model closed around the load.
    Ants(AntDrive),
}

/// The prescribed path of one tip.
#[derive(Clone, Debug, PartialEq)]
pub struct TipPath {
    pub spring: usize,
    /// Straight between waypoints, held after the last. The spring is grasped at the first one's time. Times increase strictly.
    pub waypoints: Vec<Waypoint>,
    /// Time at which the spring is let go (s), after the first waypoint's; from the end of the run on it stays held.
    pub release: Option<f64>,
}

/// Where a tip is at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// (s)
    pub time: f64,
    /// (m, world)
    pub position: Vec2,
}

/// Ants and their behaviour (Eq. 17-23). Values the paper does not print are inferred and marked so in the format's schema.
#[derive(Clone, Debug, PartialEq)]
pub struct AntDrive {
    pub n_ants: usize,
    /// r_n (m, world).
    pub nest_position: Vec2,
    /// rho: the load has arrived when its origin is this close to the nest (m).
    pub arrival_radius: f64,
    /// Ants start uniformly in a square of this half width about the load (m), facing anywhere.
    pub start_half_width: f64,
    /// v_i of a searching ant (m/s).
    pub search_speed: f64,
    /// v_i of a pulling ant (m/s).
    pub pull_speed: f64,
    /// r_s: reach within which a searching ant notices the tip of a free spring (m).
    pub sensing_range: f64,
    /// sigma^2 of the believed about the true position of the load, each axis (m^2).
    pub target_variance: f64,
    /// Time between two beliefs (s).
    pub target_redraw_period: f64,
    /// k (1/s).
    pub steering_gain: f64,
    /// beta (rad).
    pub steering_half_angle: f64,
    /// r: from the point about which an ant turns to its mandibles (m).
    pub control_offset: f64,
    /// p_1, per grasp decision period (1).
    pub grasp_probability: f64,
    /// D_a (s).
    pub grasp_decision_period: f64,
    pub grasp_pace: Pace,
    pub release: ReleaseLaw,
    pub release_pace: Pace,
}
