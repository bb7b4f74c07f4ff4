//! Named sets of the ants' parameters: printed values of the paper, inferred ones where it prints
//! none, and what each set replaces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::AntDrive;
use crate::model::avoidance::Avoidance;
use crate::model::behaviour::{GraspPace, ReleaseLaw, ReleasePace};
use crate::model::paper::{self, PrintedParameter};

/// Named set of the ants' parameters.
///
/// Section VII of the paper prints eight of them. The preset "paper", which is the default, has all
/// eight. The others say which they replace, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Every value that the paper prints. What it does not print is that of the accepted parameter
    /// set that is closest to the printed pulls and group sizes, to three digits. Ants decide at
    /// every tick with a hazard, so that rates do not depend on the control period.
    #[default]
    Paper,
    /// A fit to the printed pulls and group sizes that may replace the printed half angle. It
    /// departs from two printed values: `steering_half_angle_rad` is 0.6 in place of 60 degrees,
    /// and `control_offset_m` is 0 in place of 2 mm.
    Fitted,
    /// Pulling ants walk as fast as searching ants, at 0.08 m/s. The time between release decisions
    /// keeps forces in the printed range. It departs from the printed `steering_half_angle_rad` and
    /// `control_offset_m` as the preset "fitted" does.
    PaperSpeed,
    /// Ants decide to release once per decision period after each grasp, with the printed
    /// probability. It departs from the printed `steering_half_angle_rad` and `control_offset_m` as
    /// the preset "fitted" does.
    Aged,
    /// Ants decide at every tick with the printed probabilities, for forces in newtons. It has
    /// every printed value. With a control period of 0.08 s the forces are as printed.
    LiteralNewtons,
    /// Ants decide at every tick with the printed probabilities, for forces in millinewtons:
    /// `release_steepness_per_n` is then 1e5, and every other value is as printed. The release is
    /// nearly a hard limit at 10 mN.
    LiteralMillinewtons,
}

/// A printed parameter that a preset replaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    pub printed: PrintedParameter,
    /// Value in the preset.
    pub value: f64,
    pub reason: &'static str,
}

impl Preset {
    /// All presets, the default first.
    pub const ALL: [Preset; 6] =
        [Preset::Paper, Preset::Fitted, Preset::PaperSpeed, Preset::Aged, Preset::LiteralNewtons, Preset::LiteralMillinewtons];

    /// Name in scenarios and options.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Paper => "paper",
            Preset::Fitted => "fitted",
            Preset::PaperSpeed => "paper-speed",
            Preset::Aged => "aged",
            Preset::LiteralNewtons => "literal-newtons",
            Preset::LiteralMillinewtons => "literal-millinewtons",
        }
    }

    /// Printed parameters that this preset replaces, in the order of [`paper::ANTS`].
    pub fn departures(self) -> Vec<Departure> {
        let ants = ants(self, 1);
        let of = |printed: &PrintedParameter| {
            let value = value(&ants, printed.key);
            (value != printed.value).then(|| Departure { printed: *printed, value, reason: reason(printed.key) })
        };
        paper::ANTS.iter().filter_map(of).collect()
    }
}

/// Value of the printed parameter with this key.
///
/// # Panics
/// With a key that is not in [`paper::ANTS`].
fn value(ants: &AntDrive, key: &str) -> f64 {
    match key {
        "search_speed_m_per_s" => ants.search_speed,
        "target_variance_m2" => ants.target_variance,
        "steering_gain_per_s" => ants.steering_gain,
        "steering_half_angle_rad" => ants.steering_half_angle,
        "control_offset_m" => ants.control_offset,
        "grasp_probability" => ants.grasp_probability,
        "strong_pull_n" => ants.release.strong_pull,
        "release_steepness_per_n" => ants.release.steepness,
        _ => unreachable!("{key} is no printed parameter"),
    }
}

/// Why presets replace the printed parameter with this key.
fn reason(key: &str) -> &'static str {
    match key {
        "steering_half_angle_rad" => "fitted to the printed pulls and group sizes",
        "control_offset_m" => "left out of the fit: it moves searching ants only",
        "release_steepness_per_n" => "the printed 100 read per millinewton",
        _ => "",
    }
}

/// Drive by `n_ants` ants with the parameters of `preset`.
pub fn ants(preset: Preset, n_ants: usize) -> AntDrive {
    let fitted = fitted(n_ants);
    let pulling = |pull_speed: f64, period: f64| AntDrive { pull_speed, release: ReleaseLaw { period, ..fitted.release }, ..fitted };
    match preset {
        Preset::Paper => as_printed(n_ants),
        Preset::Fitted => fitted,
        Preset::PaperSpeed => AntDrive { sensing_range: 0.0215, ..pulling(paper::SEARCH_SPEED_M_PER_S, 0.106) },
        Preset::Aged => AntDrive { release_pace: ReleasePace::Aged, sensing_range: 0.0205, ..pulling(paper::SEARCH_SPEED_M_PER_S, 0.08) },
        Preset::LiteralNewtons => {
            let printed = as_printed(n_ants);
            AntDrive {
                pull_speed: paper::SEARCH_SPEED_M_PER_S,
                grasp_pace: GraspPace::PerTick,
                release: ReleaseLaw { period: 0.08, ..printed.release },
                release_pace: ReleasePace::PerTick,
                ..printed
            }
        }
        Preset::LiteralMillinewtons => {
            let literal = ants(Preset::LiteralNewtons, n_ants);
            AntDrive { release: ReleaseLaw { steepness: 1e5, ..literal.release }, ..literal }
        }
    }
}

/// Ants with all printed values. What the paper does not print is, to three digits, the accepted
/// set of the smallest distance in `results/2026-11-25-parameter-search/accepted.csv`. Its pulls go
/// from 0.02 m/s on; `results/2026-11-30-parameter-search` ranks others beside it.
fn as_printed(n_ants: usize) -> AntDrive {
    AntDrive {
        n_ants,
        nest_position: paper::NEST_POSITION_M,
        arrival_radius: 0.0114,
        start_half_width: 0.169,
        search_speed: paper::SEARCH_SPEED_M_PER_S,
        pull_speed: 0.0252,
        sensing_range: 0.0214,
        target_variance: paper::TARGET_VARIANCE_M2,
        target_redraw_period: 0.0109,
        steering_gain: paper::STEERING_GAIN_PER_S,
        steering_half_angle: paper::STEERING_HALF_ANGLE_RAD,
        control_offset: paper::CONTROL_OFFSET_M,
        grasp_probability: paper::GRASP_PROBABILITY,
        grasp_decision_period: 0.0172,
        grasp_pace: GraspPace::Hazard,
        release: ReleaseLaw { strong_pull: paper::STRONG_PULL_N, steepness: paper::RELEASE_STEEPNESS_PER_N, period: 0.518 },
        release_pace: ReleasePace::Hazard,
        avoidance: Avoidance::None,
        body_radius: 0.002,
        look_ahead: 0.03,
    }
}

/// Ants fitted to the printed pulls and group sizes, among sets that may replace the printed half
/// angle.
fn fitted(n_ants: usize) -> AntDrive {
    let printed = as_printed(n_ants);
    AntDrive {
        arrival_radius: 0.01,
        start_half_width: 0.15,
        pull_speed: 0.05,
        sensing_range: 0.019,
        target_redraw_period: 0.01,
        steering_half_angle: 0.6,
        control_offset: 0.0,
        grasp_decision_period: 0.0025,
        release: ReleaseLaw { period: 0.175, ..printed.release },
        ..printed
    }
}
