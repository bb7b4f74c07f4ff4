//! Named sets of the ants' parameters: printed values of the paper, and inferred ones where it
//! prints none.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AntDrive;
use crate::model::avoidance::Avoidance;
use crate::model::behaviour::{GraspPace, ReleaseLaw, ReleasePace};
use crate::model::paper;

/// Named set of the ants' parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The set that comes closest to the printed results of the paper. Ants decide at every tick
    /// with a hazard, so that rates do not depend on the control period.
    #[default]
    Default,
    /// Pulling ants walk as fast as searching ants, at 0.08 m/s. The time between release decisions
    /// keeps forces in the printed range.
    PaperSpeed,
    /// Ants decide to release once per decision period after each grasp, with the printed
    /// probability. Of such sets this one fits the printed results best.
    Aged,
    /// Ants decide at every tick with the printed probabilities, for forces in newtons. With a
    /// control period of 0.08 s the forces are as printed.
    LiteralNewtons,
    /// Ants decide at every tick with the printed probabilities, for forces in millinewtons. The
    /// release is then nearly a hard limit at 10 mN. It is meant for a control period of 0.08 s.
    LiteralMillinewtons,
}

impl Preset {
    /// All presets, the default first.
    pub const ALL: [Preset; 5] = [Preset::Default, Preset::PaperSpeed, Preset::Aged, Preset::LiteralNewtons, Preset::LiteralMillinewtons];

    /// Name in scenarios and options.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Default => "default",
            Preset::PaperSpeed => "paper-speed",
            Preset::Aged => "aged",
            Preset::LiteralNewtons => "literal-newtons",
            Preset::LiteralMillinewtons => "literal-millinewtons",
        }
    }
}

/// Drive by `n_ants` ants with the parameters of `preset`.
pub fn ants(preset: Preset, n_ants: usize) -> AntDrive {
    let standard = standard(n_ants);
    let pulling = |pull_speed: f64, period: f64| AntDrive { pull_speed, release: ReleaseLaw { period, ..standard.release }, ..standard };
    match preset {
        Preset::Default => standard,
        Preset::PaperSpeed => AntDrive { sensing_range: 0.0215, ..pulling(paper::SEARCH_SPEED_M_PER_S, 0.106) },
        Preset::Aged => AntDrive { release_pace: ReleasePace::Aged, sensing_range: 0.0205, ..pulling(paper::SEARCH_SPEED_M_PER_S, 0.08) },
        Preset::LiteralNewtons => {
            AntDrive { grasp_pace: GraspPace::PerTick, release_pace: ReleasePace::PerTick, ..pulling(paper::SEARCH_SPEED_M_PER_S, 0.08) }
        }
        Preset::LiteralMillinewtons => {
            let literal = ants(Preset::LiteralNewtons, n_ants);
            AntDrive { release: ReleaseLaw { steepness: 1e5, ..literal.release }, ..literal }
        }
    }
}

/// Ants of the default preset. What the paper does not print is inferred from what it prints:
/// speed, reach, half angle and decision period of pulling ants are the fit of `cohaul paper`. Two
/// printed numbers are replaced: the half angle of 60 deg by that fit, and the offset of 2 mm by
/// zero, since Eq. (23) has none for a pulling ant.
fn standard(n_ants: usize) -> AntDrive {
    AntDrive {
        n_ants,
        nest_position: paper::NEST_POSITION_M,
        arrival_radius: 0.01,
        start_half_width: 0.15,
        search_speed: paper::SEARCH_SPEED_M_PER_S,
        pull_speed: 0.05,
        sensing_range: 0.019,
        target_variance: paper::TARGET_VARIANCE_M2,
        target_redraw_period: 0.01,
        steering_gain: paper::STEERING_GAIN_PER_S,
        steering_half_angle: 0.6,
        control_offset: 0.0,
        grasp_probability: paper::GRASP_PROBABILITY,
        grasp_decision_period: 0.0025,
        grasp_pace: GraspPace::Hazard,
        release: ReleaseLaw { strong_pull: paper::STRONG_PULL_N, steepness: paper::RELEASE_STEEPNESS_PER_N, period: 0.175 },
        release_pace: ReleasePace::Hazard,
        avoidance: Avoidance::None,
        body_radius: 0.002,
        look_ahead: 0.03,
    }
}
