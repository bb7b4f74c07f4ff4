//! The drive: prescribed paths of the tips, or ants.
//!
//! Each kind is a struct with its own `kind` key, not a variant of an internally tagged enum: the schema then has one closed object a
//! kind, against which every key can be checked where it stands.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::behaviour::Pace;
use crate::scenario::AntDrive;
use crate::scenario::presets::{self, Preset};

/// What moves the tips of the springs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum DriveEntry {
    Tips(TipsEntry),
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
    pub kind: TipsKind,
    /// At most one path a spring; a spring without one stays free.
    pub paths: Vec<PathEntry>,
}

/// The path of one tip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathEntry {
    /// Index of the spring (1).
    pub spring: usize,
    /// [time (s), x (m), y (m)] in world axes: straight between, held after the last. The spring is grasped at the first one's time.
    pub waypoints: Vec<[f64; 3]>,
    /// When the spring is let go (s). Without it never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64")]
    pub release_s: Option<f64>,
}

/// Ants that search, grasp, pull and let go. Every default is that of the preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AntsEntry {
    pub kind: AntsKind,
    /// How many ants (1).
    pub n_ants: usize,
    /// Where defaults come from. A key that is given beats its preset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Preset", extend("default" = "default"))]
    pub preset: Option<Preset>,
    /// Where the load is to go (m, world). Inferred: the paper gives the position, the load's start is taken as the origin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 2]", extend("default" = <[f64; 2]>::from(standard().nest_position)))]
    pub nest_position_m: Option<[f64; 2]>,
    /// The load has arrived when its origin is this close to the nest (m). Inferred: the paper says "small".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().arrival_radius))]
    pub arrival_radius_m: Option<f64>,
    /// Ants start uniformly in a square of this half width about the load (m). Inferred: the paper says "uniform".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().start_half_width))]
    pub start_half_width_m: Option<f64>,
    /// Walking speed of a searching ant (m/s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().search_speed))]
    pub search_speed_m_per_s: Option<f64>,
    /// Walking speed of a pulling ant (m/s). Inferred: fits the printed forces and times best.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().pull_speed))]
    pub pull_speed_m_per_s: Option<f64>,
    /// Reach within which a searching ant notices the tip of a free spring (m). Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().sensing_range))]
    pub sensing_range_m: Option<f64>,
    /// Variance, on each axis, of where an ant believes the load to be (m^2). Inferred: the unit; the number is printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().target_variance))]
    pub target_variance_m2: Option<f64>,
    /// Time between two beliefs (s). Inferred: the paper redraws at each step of a step that it does not print.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().target_redraw_period))]
    pub target_redraw_period_s: Option<f64>,
    /// Turn rate over heading error (1/s). Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().steering_gain))]
    pub steering_gain_per_s: Option<f64>,
    /// How far off its spring's direction an ant may pull (rad). Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().steering_half_angle))]
    pub steering_half_angle_rad: Option<f64>,
    /// From the point about which an ant turns to its mandibles (m). Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().control_offset))]
    pub control_offset_m: Option<f64>,
    /// Probability of grasping a free tip in reach, per decision period (1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().grasp_probability))]
    pub grasp_probability: Option<f64>,
    /// Time between two grasp decisions (s). Inferred: grasps must be much faster than releases to give the printed group sizes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().grasp_decision_period))]
    pub grasp_decision_period_s: Option<f64>,
    /// When an ant draws for a grasp. Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "GraspPace", extend("default" = "hazard"))]
    pub grasp_pace: Option<GraspPace>,
    /// Pull at twice the even odds of letting go (N).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.strong_pull))]
    pub strong_pull_n: Option<f64>,
    /// Steepness of the odds of letting go over the pull (1/N). Inferred: the unit; the number is printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.steepness))]
    pub release_steepness_per_n: Option<f64>,
    /// Time between two release decisions (s). Inferred: fits the printed forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", extend("default" = standard().release.period))]
    pub release_decision_period_s: Option<f64>,
    /// When an ant draws for a release. Inferred: not printed in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "ReleasePace", extend("default" = "hazard"))]
    pub release_pace: Option<ReleasePace>,
}

/// When an ant draws for a grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GraspPace {
    /// At every tick, with the hazard that the probability per decision period amounts to.
    Hazard,
    /// At every tick, with the probability itself: the literal reading, which depends on the control period.
    PerTick,
}

/// When an ant draws for a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReleasePace {
    /// Every decision period after its grasp, with the printed probability.
    Aged,
    /// At every tick, with the hazard that the printed probability per decision period amounts to.
    Hazard,
    /// At every tick, with the printed probability: the literal reading, which depends on the control period.
    PerTick,
}

impl GraspPace {
    pub fn pace(self) -> Pace {
        match self {
            GraspPace::Hazard => Pace::Hazard,
            GraspPace::PerTick => Pace::PerTick,
        }
    }

    /// # Panics
    /// On [`Pace::Aged`]: before its grasp an ant has no age.
    pub fn of(pace: Pace) -> Self {
        match pace {
            Pace::Hazard => GraspPace::Hazard,
            Pace::PerTick => GraspPace::PerTick,
            Pace::Aged => panic!("a grasp has no age"),
        }
    }
}

impl ReleasePace {
    pub fn pace(self) -> Pace {
        match self {
            ReleasePace::Aged => Pace::Aged,
            ReleasePace::Hazard => Pace::Hazard,
            ReleasePace::PerTick => Pace::PerTick,
        }
    }

    pub fn of(pace: Pace) -> Self {
        match pace {
            Pace::Aged => ReleasePace::Aged,
            Pace::Hazard => ReleasePace::Hazard,
            Pace::PerTick => ReleasePace::PerTick,
        }
    }
}

fn standard() -> AntDrive {
    presets::ants(Preset::Default, 1)
}
