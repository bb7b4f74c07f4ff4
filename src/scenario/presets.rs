//! The numbers of the ants: the paper's where it prints them, inferred ones where it does not. All of them stand here and nowhere else.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AntDrive;
use crate::math::Vec2;
use crate::model::behaviour::{Pace, ReleaseLaw};

/// A named set of the ants' parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The set that comes closest to the numbers printed in the paper's text, with releases as a hazard at every tick: rates do not depend on the control period.
    #[default]
    Default,
    /// Pulling ants as fast as searching ones (0.08 m/s), with a decision period that keeps forces in range.
    PaperSpeed,
    /// Releases at decisions a period apart after each grasp, with the printed probability; the best set of that kind.
    Aged,
    /// The printed probabilities at every tick, forces in newtons. Meant for a control period of 0.08 s, at which forces come out as printed.
    LiteralNewtons,
    /// The printed probabilities at every tick, forces in millinewtons: in effect a hard limit at 10 mN. Meant for the same control period.
    LiteralMillinewtons,
}

impl Preset {
    pub const ALL: [Preset; 5] = [Preset::Default, Preset::PaperSpeed, Preset::Aged, Preset::LiteralNewtons, Preset::LiteralMillinewtons];

    /// Its name in scenarios and options.
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

/// `n_ants` ants with the parameters of `preset`.
pub fn ants(preset: Preset, n_ants: usize) -> AntDrive {
    let standard = standard(n_ants);
    let pulling = |pull_speed: f64, period: f64| AntDrive { pull_speed, release: ReleaseLaw { period, ..standard.release }, ..standard };
    match preset {
        Preset::Default => standard,
        Preset::PaperSpeed => AntDrive { sensing_range: 0.0215, ..pulling(0.08, 0.106) },
        Preset::Aged => AntDrive { release_pace: Pace::Aged, sensing_range: 0.0205, ..pulling(0.08, 0.08) },
        Preset::LiteralNewtons => AntDrive { grasp_pace: Pace::PerTick, release_pace: Pace::PerTick, ..pulling(0.08, 0.08) },
        Preset::LiteralMillinewtons => {
            let literal = ants(Preset::LiteralNewtons, n_ants);
            AntDrive { release: ReleaseLaw { steepness: 1e5, ..literal.release }, ..literal }
        }
    }
}

/// Printed in the paper: nest, search speed, variance (without unit), grasp probability, strong pull, steepness (without unit). The rest
/// is inferred from what those give: speed, reach, half angle and decision period of pulling ants are the fit of `cohaul paper`.
fn standard(n_ants: usize) -> AntDrive {
    AntDrive {
        n_ants,
        nest_position: Vec2::new(0.2, -0.17),
        arrival_radius: 0.01,
        start_half_width: 0.15,
        search_speed: 0.08,
        pull_speed: 0.05,
        sensing_range: 0.019,
        target_variance: 0.01,
        target_redraw_period: 0.01,
        steering_gain: 10.0,
        steering_half_angle: 0.6,
        control_offset: 0.0,
        grasp_probability: 0.2,
        grasp_decision_period: 0.0025,
        grasp_pace: Pace::Hazard,
        release: ReleaseLaw { strong_pull: 0.02, steepness: 100.0, period: 0.175 },
        release_pace: Pace::Hazard,
    }
}
