//! Choices about the ants that the paper does not print, each with its range.
//!
//! Section VII prints the parameters of [`super::paper::ANTS`]. A simulation needs more than that.
//! What it needs beyond stands here once: the table of deviations in the book shows this list, and
//! a search over parameter sets varies it.

use serde::Serialize;

/// A choice that the paper leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenChoice {
    pub name: &'static str,
    /// Path of its key in a scenario; `None` where the program allows one way only.
    pub key: Option<&'static str>,
    pub unit: &'static str,
    pub range: Range,
    /// Why the paper leaves it open, and what bounds the range.
    pub reason: &'static str,
}

/// Values that an open choice may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Numbers from `low` to `high`. Steps are ratios where `is_logarithmic`, differences
    /// otherwise.
    Between { low: f64, high: f64, is_logarithmic: bool },
    /// One of these numbers.
    Numbers(&'static [f64]),
    /// One of these words.
    Words(&'static [&'static str]),
    /// Only this way.
    Fixed(&'static str),
}

/// A value of an open choice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Chosen {
    Number(f64),
    Word(&'static str),
}

impl Range {
    /// The value at the fraction `share` of the range, from 0 to below 1. Numbers and words of a
    /// list have equal parts of it; `None` where there is one way only.
    pub fn at(&self, share: f64) -> Option<Chosen> {
        let place = |n: usize| ((share * n as f64) as usize).min(n - 1);
        match *self {
            Range::Between { low, high, is_logarithmic: true } => Some(Chosen::Number(low * (high / low).powf(share))),
            Range::Between { low, high, is_logarithmic: false } => Some(Chosen::Number(low + share * (high - low))),
            Range::Numbers(all) => Some(Chosen::Number(all[place(all.len())])),
            Range::Words(all) => Some(Chosen::Word(all[place(all.len())])),
            Range::Fixed(_) => None,
        }
    }
}

const fn linear(low: f64, high: f64) -> Range {
    Range::Between { low, high, is_logarithmic: false }
}

const fn logarithmic(low: f64, high: f64) -> Range {
    Range::Between { low, high, is_logarithmic: true }
}

/// Every open choice about the ants.
pub const OPEN_CHOICES: [OpenChoice; 15] = [
    OpenChoice {
        name: "speed in Transport",
        key: Some("drive.pull_speed_m_per_s"),
        unit: "m/s",
        range: logarithmic(0.012, 0.08),
        reason: "Section VII prints 0.08 m/s for Search only, and a pulling ant walks backwards. The time to the nest goes as one over it; the printed 83 s ask for about 0.02 m/s.",
    },
    OpenChoice {
        name: "release decision period",
        key: Some("drive.release_decision_period_s"),
        unit: "s",
        range: logarithmic(0.05, 1.5),
        reason: "Eq. 18 is a probability per time step, and no step is printed. A spring gains 2.7 to 20 mN within one period: at most F_m.",
    },
    OpenChoice {
        name: "times of release decisions",
        key: Some("drive.release_pace"),
        unit: "",
        range: Range::Words(&["hazard", "aged", "per-tick"]),
        reason: "No time step is printed: a rate, one decision per period after a grasp, or one at every control period.",
    },
    OpenChoice {
        name: "unit of zeta",
        key: Some("drive.release_steepness_per_n"),
        unit: "1/N",
        range: Range::Numbers(&[100.0, 1e5]),
        reason: "zeta = 100 has no unit: per newton or per millinewton. The largest printed pull, 36.5 mN, excludes the second.",
    },
    OpenChoice {
        name: "grasp decision period",
        key: Some("drive.grasp_decision_period_s"),
        unit: "s",
        range: logarithmic(0.0025, 0.1),
        reason: "p_1 is a probability per time step, and no step is printed. From the control period to that of a literal step.",
    },
    OpenChoice {
        name: "times of grasp decisions",
        key: Some("drive.grasp_pace"),
        unit: "",
        range: Range::Words(&["hazard", "per-tick"]),
        reason: "No time step is printed: a rate, or one decision at every control period.",
    },
    OpenChoice {
        name: "sensing range",
        key: Some("drive.sensing_range_m"),
        unit: "m",
        range: linear(0.005, 0.03),
        reason: "Section VI names it without a value. From half the length of an ant to three lengths.",
    },
    OpenChoice {
        name: "nest radius",
        key: Some("drive.arrival_radius_m"),
        unit: "m",
        range: linear(0.005, 0.03),
        reason: "Section VI calls rho a small constant. Up to a tenth of the distance to the nest.",
    },
    OpenChoice {
        name: "start area (half width)",
        key: Some("drive.start_half_width_m"),
        unit: "m",
        range: linear(0.05, 0.3),
        reason: "Section VII says uniformly random, and prints no area. From the structure's surroundings to beyond the nest.",
    },
    OpenChoice {
        name: "redraw period of the believed position",
        key: Some("drive.target_redraw_period_s"),
        unit: "s",
        range: logarithmic(0.0025, 0.1),
        reason: "Redrawn at each time step, and no step is printed.",
    },
    OpenChoice {
        name: "control period",
        key: Some("control_period_s"),
        unit: "s",
        range: Range::Numbers(&[0.00125, 0.0025, 0.005]),
        reason: "The time step of the ants is not printed. Rates do not depend on it; an attachment ends half a period late.",
    },
    OpenChoice {
        name: "jump of a grasping ant to the tip",
        key: None,
        unit: "",
        range: Range::Fixed("at once"),
        reason: "An ant latches onto a tip that enters its sensing range: it is at the tip at once. The jump is at most the sensing range.",
    },
    OpenChoice {
        name: "regrasp",
        key: None,
        unit: "",
        range: Range::Fixed("from the next control period on"),
        reason: "Section VI lets an ant that has let go search at once. It may grasp the same tip.",
    },
    OpenChoice {
        name: "distance of the supports",
        key: Some("ground.supports.tripod.radius_m"),
        unit: "m",
        range: linear(0.0061, 0.0122),
        reason: "Section V gives the supports no coordinates. From half the radius of the load to its edge; a uniform disc has 2/3.",
    },
    OpenChoice {
        name: "start of the load",
        key: Some("load.position_m"),
        unit: "m",
        range: Range::Fixed("origin, heading 0"),
        reason: "Section VII prints the nest, and no start. The nest is then 262 mm away.",
    },
];
