//! How far apart two runs may lie and still agree.
//!
//! A run is repeated bit for bit by the same build on the same machine. Another mathematical library or compiler changes last digits, and that grows
//! along the path. The defaults are a share of the scene's own scales:
//!
//! ```text
//! length    the load's radius R
//! angle     1 rad: R turned by it moves its rim by R
//! force     the slip limit mu m g, or the largest pull of the run if that is more
//! speed     sqrt(force R / m), the speed that friction stops within half a radius, or the largest speed of the run if that is more
//! energy    force times R, or the largest work or energy of the run if that is more
//! ```
//!
//! The share is 1e-8 in f64. With a library whose every sine, exponential or power may be off by a last digit, the shipped scenes on all backends stay
//! within 3e-12 of their scales over their whole length, and no decision falls differently. In f32 the share is 1e-3: the engine's rounding, 6e-8 a
//! step, moves the paths of prescribed tips by up to 4e-5 with aligned friction. A long run of ants in f32 keeps its decisions on one kind of machine only.

use serde::{Deserialize, Serialize};

use super::{MEASURES, Row};
use crate::backend::BackendOptions;
use crate::scenario::Scenario;

/// Share of the scales (1) that a run in f64 may be off.
const SHARE: f64 = 1e-8;
/// The same for an engine in f32.
const SHARE_IN_SINGLE: f64 = 1e-3;
/// Share (1) that counts may be off. Last digits decide which steps at the edge of rest need solving: up to 2 % in f64 and 6 % in f32, of fifty.
const COUNT_SHARE: f64 = 0.1;

/// What is compared; each has a tolerance of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    Position,
    Heading,
    Velocity,
    TurnRate,
    Energy,
    Pull,
    Time,
    Count,
}

impl Quantity {
    /// The quantity that has this unit in print.
    pub fn of_unit(unit: &str) -> Self {
        match unit {
            "m" => Self::Position,
            "rad" => Self::Heading,
            "m/s" => Self::Velocity,
            "rad/s" => Self::TurnRate,
            "J" => Self::Energy,
            "N" => Self::Pull,
            "s" => Self::Time,
            _ => Self::Count,
        }
    }
}

/// Differences up to these agree; zero asks for the same number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerances {
    pub position_m: f64,
    pub heading_rad: f64,
    pub velocity_m_per_s: f64,
    pub turn_rate_rad_per_s: f64,
    pub energy_j: f64,
    pub pull_n: f64,
    /// Of grasps, releases and the end.
    pub time_s: f64,
    /// Of a count over what is expected of it, and of solves or skips over all steps (1).
    pub count_share: f64,
}

impl Tolerances {
    pub const EXACT: Tolerances = Tolerances {
        position_m: 0.0,
        heading_rad: 0.0,
        velocity_m_per_s: 0.0,
        turn_rate_rad_per_s: 0.0,
        energy_j: 0.0,
        pull_n: 0.0,
        time_s: 0.0,
        count_share: 0.0,
    };

    /// The defaults for a run with these rows. A decision at another tick is another decision: times may be off by less than half a control period.
    pub fn of(scenario: &Scenario, options: &BackendOptions, rows: &[Row]) -> Self {
        let in_single = options.is_single_precision();
        let share = if in_single { SHARE_IN_SINGLE } else { SHARE };
        let Scales { length, force, speed, energy } = Scales::of(scenario, rows);
        Self {
            position_m: share * length,
            heading_rad: share,
            velocity_m_per_s: share * speed,
            turn_rate_rad_per_s: share * speed / length,
            energy_j: share * energy,
            pull_n: share * force,
            time_s: 0.5 * scenario.control_period,
            count_share: COUNT_SHARE,
        }
    }

    /// In the unit of the quantity.
    pub fn for_quantity(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Position => self.position_m,
            Quantity::Heading => self.heading_rad,
            Quantity::Velocity => self.velocity_m_per_s,
            Quantity::TurnRate => self.turn_rate_rad_per_s,
            Quantity::Energy => self.energy_j,
            Quantity::Pull => self.pull_n,
            Quantity::Time => self.time_s,
            Quantity::Count => self.count_share,
        }
    }

    /// Keys and values of all.
    pub fn entries(&self) -> [(&'static str, f64); 8] {
        [
            ("position_m", self.position_m),
            ("heading_rad", self.heading_rad),
            ("velocity_m_per_s", self.velocity_m_per_s),
            ("turn_rate_rad_per_s", self.turn_rate_rad_per_s),
            ("energy_j", self.energy_j),
            ("pull_n", self.pull_n),
            ("time_s", self.time_s),
            ("count_share", self.count_share),
        ]
    }
}

/// (m, N, m/s, J)
struct Scales {
    length: f64,
    force: f64,
    speed: f64,
    energy: f64,
}

impl Scales {
    fn of(scenario: &Scenario, rows: &[Row]) -> Self {
        let load = &scenario.system.load;
        let largest = |quantity: Quantity| {
            let measures = || MEASURES.iter().filter(move |measure| measure.quantity == quantity);
            rows.iter().flat_map(|row| measures().map(|measure| measure.size(row))).fold(0.0, f64::max)
        };
        let length = load.radius;
        let force = scenario.system.total_slip_limit().max(largest(Quantity::Pull));
        let moving = largest(Quantity::Velocity).max(length * largest(Quantity::TurnRate));
        Self {
            length,
            force,
            speed: (force * length / load.mass).sqrt().max(moving),
            energy: (force * length).max(largest(Quantity::Energy)),
        }
    }
}
