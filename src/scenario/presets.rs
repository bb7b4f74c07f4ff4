//! The numbers of the ants: the paper's where it prints them, inferred ones where it does not. All of them stand here and nowhere else.

use std::f64::consts::FRAC_PI_3;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AntDrive;
use crate::math::Vec2;
use crate::model::behaviour::{Pace, ReleaseLaw};

/// A named set of the ants' parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The set that comes closest to the numbers printed in the paper's text.
    #[default]
    Default,
    /// Pulling ants as fast as searching ones (0.08 m/s), with decisions every 0.1 s so that forces stay in range.
    PaperSpeed,
    /// Releases as a hazard at every tick, with a decision period of 0.2 s: results do not depend on the control period.
    Hazard,
    /// The printed probabilities at every tick, forces in newtons.
    LiteralNewtons,
    /// The printed probabilities at every tick, forces in millinewtons: in effect a hard limit at 10 mN.
    LiteralMillinewtons,
}

impl Preset {
    pub const ALL: [Preset; 5] = [Preset::Default, Preset::PaperSpeed, Preset::Hazard, Preset::LiteralNewtons, Preset::LiteralMillinewtons];
}

/// `n_ants` ants with the parameters of `preset`.
pub fn ants(preset: Preset, n_ants: usize) -> AntDrive {
    let standard = standard(n_ants);
    match preset {
        Preset::Default => standard,
        Preset::PaperSpeed => AntDrive { pull_speed: 0.08, release: ReleaseLaw { period: 0.10, ..standard.release }, ..standard },
        Preset::Hazard => AntDrive { release_pace: Pace::Hazard, release: ReleaseLaw { period: 0.20, ..standard.release }, ..standard },
        Preset::LiteralNewtons => AntDrive { grasp_pace: Pace::PerTick, release_pace: Pace::PerTick, ..standard },
        Preset::LiteralMillinewtons => {
            AntDrive { release: ReleaseLaw { steepness: 1e5, ..standard.release }, ..ants(Preset::LiteralNewtons, n_ants) }
        }
    }
}

/// Printed in the paper: nest, search speed, variance (without unit), grasp probability, strong pull, steepness (without unit). The rest
/// is inferred from what those give.
fn standard(n_ants: usize) -> AntDrive {
    AntDrive {
        n_ants,
        nest_position: Vec2::new(0.2, -0.17),
        arrival_radius: 0.01,
        start_half_width: 0.15,
        search_speed: 0.08,
        pull_speed: 0.03,
        sensing_range: 0.015,
        target_variance: 0.01,
        target_redraw_period: 0.01,
        steering_gain: 10.0,
        steering_half_angle: FRAC_PI_3,
        control_offset: 0.0,
        grasp_probability: 0.2,
        grasp_decision_period: 0.0025,
        grasp_pace: Pace::Hazard,
        release: ReleaseLaw { strong_pull: 0.02, steepness: 100.0, period: 0.25 },
        release_pace: Pace::Aged,
    }
}
