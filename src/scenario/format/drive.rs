//! The drive: prescribed paths of the tips, or ants.
//!
//! Each kind is a struct with its own `kind` key, not a variant of an internally tagged enum. The
//! schema then has one closed object per kind, against which every key can be checked at its place.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::avoidance::Avoidance;
use crate::model::behaviour::{GraspPace, ReleasePace};
use crate::scenario::AntDrive;
use crate::scenario::presets::{self, Preset};

/// The motion of the tips: prescribed paths, or ants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum DriveEntry {
    /// Prescribed paths of the tips.
    Tips(TipsEntry),
    /// Ants that search, grasp, pull and release.
    Ants(Box<AntsEntry>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TipsKind {
    Tips,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AntsKind {
    Ants,
}

/// Prescribed paths of the tips.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TipsEntry {
    /// Kind of the drive: "tips".
    pub kind: TipsKind,
    /// Paths of the tips. A spring may have several, one after another: each but the last one is
    /// released before the next one begins, or at that instant. A spring without a path stays free.
    pub paths: Vec<PathEntry>,
}

/// The path of one tip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathEntry {
    /// Index of the spring, from 0 (1).
    pub spring: usize,
    /// Waypoints [time (s), x (m), y (m)] in world axes. The spring is attached at the time of the
    /// first one. The tip moves in straight lines at constant speed between waypoints, and stays at
    /// the last one.
    pub waypoints: Vec<[f64; 3]>,
    /// Time at which the spring is released (s). The default is never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub release_s: Option<f64>,
}

/// Ants that search for a tip, grasp it, pull and release it. The default of every key is that of
/// the preset; the defaults stated here are those of the preset "paper", which has every value that
/// the paper prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AntsEntry {
    /// Kind of the drive: "ants".
    pub kind: AntsKind,
    /// Number of ants (1).
    pub n_ants: usize,
    /// Named set of parameters for all keys that are left out. The default is "paper".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Preset", extend("default" = "paper"))]
    pub preset: Option<Preset>,
    /// Position of the nest, to which the ants pull the load (m, world axes). The default is
    /// printed in the paper, with the start of the load as the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 2]", extend("default" = <[f64; 2]>::from(standard().nest_position)))]
    pub nest_position_m: Option<[f64; 2]>,
    /// Distance of the load's origin from the nest at which the load has arrived (m). The default
    /// is inferred: the paper says "small".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().arrival_radius))]
    pub arrival_radius_m: Option<f64>,
    /// Half width of the square about the load in which the ants start, uniformly distributed (m).
    /// The default is inferred: the paper prints no size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().start_half_width))]
    pub start_half_width_m: Option<f64>,
    /// Walking speed of a searching ant (m/s). The default is printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().search_speed))]
    pub search_speed_m_per_s: Option<f64>,
    /// Walking speed of a pulling ant (m/s). The default is inferred: with it the printed forces
    /// and group sizes are met best.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().pull_speed))]
    pub pull_speed_m_per_s: Option<f64>,
    /// Distance within which a searching ant senses the tip of a free spring (m). The default is
    /// inferred: the paper does not print it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().sensing_range))]
    pub sensing_range_m: Option<f64>,
    /// Variance, on each axis, of the position at which an ant believes the load to be (m^2). The
    /// default is printed in the paper without a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().target_variance))]
    pub target_variance_m2: Option<f64>,
    /// Time between two draws of that position (s). The default is inferred: the paper draws at
    /// each time step, and does not print the step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().target_redraw_period))]
    pub target_redraw_period_s: Option<f64>,
    /// Turn rate of an ant over its heading error (1/s). The default is printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().steering_gain))]
    pub steering_gain_per_s: Option<f64>,
    /// Largest angle between the pull of an ant and the direction of its spring (rad). The
    /// default, 60 degrees, is printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().steering_half_angle))]
    pub steering_half_angle_rad: Option<f64>,
    /// Distance from the mandibles of a searching ant to the point about which it turns (m). A
    /// pulling ant turns about its mandibles. The default is printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().control_offset))]
    pub control_offset_m: Option<f64>,
    /// Probability of grasping a free tip in reach, per decision period (1). The default is printed
    /// in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().grasp_probability))]
    pub grasp_probability: Option<f64>,
    /// Time between two grasp decisions (s). The default is inferred: the printed group sizes need
    /// grasps that are much faster than releases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().grasp_decision_period))]
    pub grasp_decision_period_s: Option<f64>,
    /// Times at which an ant decides to grasp. The default, "hazard", is inferred: the paper does
    /// not print its time step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "GraspPace", extend("default" = "hazard"))]
    pub grasp_pace: Option<GraspPace>,
    /// Force close to the largest that an ant can apply (N). The release probability is 1/2 at half
    /// of it. The default is printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.strong_pull))]
    pub strong_pull_n: Option<f64>,
    /// Steepness of the release probability over the pull (1/N). The default is printed in the
    /// paper without a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.steepness))]
    pub release_steepness_per_n: Option<f64>,
    /// Time between two release decisions (s). The default is inferred: with it the
    /// printed forces and group sizes are met best.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.period))]
    pub release_decision_period_s: Option<f64>,
    /// Times at which an ant decides to release. The default, "hazard", is inferred: the paper does
    /// not print its time step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "ReleasePace", extend("default" = "hazard"))]
    pub release_pace: Option<ReleasePace>,
    /// How ants avoid obstacles, and searching ants the load too. The default is "sidestep" in a
    /// scenario with obstacles and "none" in one without, inferred: the paper has no obstacles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Avoidance")]
    pub avoidance: Option<Avoidance>,
    /// Radius of the disc that an ant keeps clear about its position, that is, about its mandibles
    /// (m). It has no effect where `avoidance` is "none". The default is inferred: half the width
    /// of an ant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().body_radius))]
    pub body_radius_m: Option<f64>,
    /// Distance to an obstacle at which a searching ant begins to turn aside (m). It has no effect
    /// where `avoidance` is "none". The default is inferred: three lengths of an ant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().look_ahead))]
    pub look_ahead_m: Option<f64>,
}

fn standard() -> AntDrive {
    presets::ants(Preset::default(), 1)
}
