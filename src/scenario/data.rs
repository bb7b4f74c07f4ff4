//! A run as data.

use crate::math::Vec2;
use crate::model::avoidance::Avoidance;
use crate::model::behaviour::{GraspPace, ReleaseLaw, ReleasePace};
use crate::model::{Motion, System};

/// Two instants are one when they are nearer than this share of a control period (1).
pub const SAME_INSTANT: f64 = 1e-9;

/// One run, checked against all rules when it was read. After a change in code,
/// `scenario.expanded().checked(name)` checks it again. Nothing in it changes during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Name of the run, in a few words.
    pub name: String,
    /// Longest simulated time (s). A run with ants ends earlier when the load arrives.
    pub duration: f64,
    /// Time between two decisions of the ants and two rows of the trace (s).
    pub control_period: f64,
    /// Seed of all random streams.
    pub seed: u64,
    /// Load, ground and springs.
    pub system: System,
    /// Motion of the load at the start.
    pub start: Motion,
    /// Motion of the tips.
    pub drive: Drive,
}

/// Motion of the tips: prescribed paths, or ants.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Prescribed paths. Those of one spring follow each other in time.
    Tips(Vec<TipPath>),
    /// Ants, in a closed loop with the load.
    Ants(AntDrive),
}

/// The prescribed path of one tip.
#[derive(Clone, Debug, PartialEq)]
pub struct TipPath {
    /// Index of the spring.
    pub spring: usize,
    /// Waypoints with strictly increasing times. The spring is attached at the time of the first
    /// one. The tip moves in straight lines between them and stays at the last one.
    pub waypoints: Vec<Waypoint>,
    /// Time at which the spring is released, later than the first waypoint; `None` for never (s).
    pub release: Option<f64>,
}

/// Position of a tip at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Time (s).
    pub time: f64,
    /// Position (m, world).
    pub position: Vec2,
}

/// Ants and their behaviour (Eq. 17-23). The schema of the format marks values that the paper does
/// not print.
#[derive(Clone, Debug, PartialEq)]
pub struct AntDrive {
    /// Number of ants (1).
    pub n_ants: usize,
    /// Position of the nest, r_n (m, world).
    pub nest_position: Vec2,
    /// Distance of the load's origin from the nest at which the load has arrived, rho (m).
    pub arrival_radius: f64,
    /// Half width of the square about the load in which the ants start, uniformly distributed (m).
    pub start_half_width: f64,
    /// Walking speed of a searching ant, v_i (m/s).
    pub search_speed: f64,
    /// Walking speed of a pulling ant, v_i (m/s).
    pub pull_speed: f64,
    /// Distance within which a searching ant senses the tip of a free spring, r_s (m).
    pub sensing_range: f64,
    /// Variance of the believed position of the load on each axis, sigma^2 (m^2).
    pub target_variance: f64,
    /// Time between two draws of the believed position (s).
    pub target_redraw_period: f64,
    /// Turn rate over heading error, k (1/s).
    pub steering_gain: f64,
    /// Largest angle between a pull and its spring, beta (rad).
    pub steering_half_angle: f64,
    /// Distance from the mandibles of a searching ant to the point about which it turns, r (m).
    pub control_offset: f64,
    /// Probability of grasping a tip in reach per grasp decision period, p_1 (1).
    pub grasp_probability: f64,
    /// Time between two grasp decisions, D_a (s).
    pub grasp_decision_period: f64,
    /// Times of the grasp decisions.
    pub grasp_pace: GraspPace,
    /// Dependence of releases on the pull.
    pub release: ReleaseLaw,
    /// Times of the release decisions.
    pub release_pace: ReleasePace,
    /// How ants avoid obstacles and the load.
    pub avoidance: Avoidance,
    /// Radius of the disc that an ant keeps clear about its position (m).
    pub body_radius: f64,
    /// Distance at which a searching ant begins to turn aside (m).
    pub look_ahead: f64,
}
