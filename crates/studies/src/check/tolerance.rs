//! How far apart two runs may lie and still agree.
//!
//! The same build on the same machine repeats a run bit for bit. Another mathematical library or
//! compiler changes last digits, and these differences grow along the path. The default tolerances
//! are a share of the scales of the scene:
//!
//! ```text
//! length    the radius R of the load
//! angle     1 rad: this turn moves the edge of the load by R
//! force     the slip limit mu m g, or the largest pull of the run if that is larger
//! speed     sqrt(force R / m), which friction stops within half a radius, or the largest speed of the run
//! energy    force times R, or the largest work or energy of the run if that is larger
//! ```
//!
//! The share is 1e-8 in f64. With a library in which every sine, exponential or power may be wrong
//! by its last digit, the shipped scenes on all backends stay within 3e-12 of their scales over
//! their whole length, and no decision changes. In f32 the share is 1e-3: the rounding of the
//! engine, 6e-8 in each step, moves the paths of prescribed tips by up to 4e-5 with aligned
//! friction. A long run of ants in f32 repeats its decisions on one kind of machine only.

use serde::{Deserialize, Serialize};

use super::measure::{MEASURES, Quantity, Row};
use cohaul::backend::BackendOptions;
use cohaul::scenario::Scenario;

/// Tolerance over scale of a run in f64 (1).
const SHARE: f64 = 1e-8;
/// Tolerance over scale of a run of an engine in f32 (1).
const SHARE_IN_SINGLE: f64 = 1e-3;
/// Tolerance of counts (1). Last digits decide which steps near rest need a solve: up to 2 % of
/// fifty steps in f64, and 6 % in f32.
const COUNT_SHARE: f64 = 0.1;

/// Largest differences that agree; zero, the default, asks for the same number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tolerances {
    pub position_m: f64,
    pub heading_rad: f64,
    pub velocity_m_per_s: f64,
    pub turn_rate_rad_per_s: f64,
    pub energy_j: f64,
    pub pull_n: f64,
    /// Tolerance of the times of grasps, releases and the end (s).
    pub time_s: f64,
    /// Tolerance of a count over the stored count, or over all steps if these are more (1).
    pub count_share: f64,
}

impl Tolerances {
    /// Default tolerances of a run with these rows. A decision at another tick is another decision,
    /// so that the tolerance of times is half a control period.
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

    /// Tolerance of a quantity, in its unit.
    pub fn for_quantity(&self, quantity: Quantity) -> f64 {
        self.entries()[quantity as usize].1
    }

    /// Keys and values of all tolerances, in the order of their quantities.
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

/// Scales of a scene and a run.
struct Scales {
    /// (m)
    length: f64,
    /// (N)
    force: f64,
    /// (m/s)
    speed: f64,
    /// (J)
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
