//! Loads, springs and tips of the tests: the paper's load, with its own outline.

use crate::verify::scenes::{LOAD_RADIUS, RADIAL, SLIP_LIMIT, moving, paper_system};
use cohaul::math::Vec2;
use cohaul::model::{Motion, Outline, PolarSpring, System};
use cohaul::scenario::{Drive, Scenario, TipPath, Waypoint};

/// Stretch of a spring of the paper at which a load that it pulls slips (m).
pub const SLIP_STRETCH: f64 = SLIP_LIMIT / RADIAL;
/// How well a closed formula is known, over its value (1): rounding.
pub const CLOSED: f64 = 1e-12;

/// The paper's load on springs.
pub fn load_on(springs: Vec<PolarSpring>) -> System {
    let mut system = paper_system(springs);
    system.world.outline = Outline::disc(LOAD_RADIUS);
    system
}

/// A run of a duration (s) in control periods (s), from a start, with tips along paths.
pub fn scenario(name: &str, system: System, start: Motion, [duration, control_period]: [f64; 2], tips: Vec<TipPath>) -> Scenario {
    Scenario { name: name.to_owned(), duration, control_period, seed: 1, system, start, drive: Drive::Tips(tips) }
}

/// The paper's load with a velocity (m/s) and a turn rate (rad/s) on the ground alone.
pub fn thrown(name: &str, [vx, vy, turn_rate]: [f64; 3], times: [f64; 2]) -> Scenario {
    scenario(name, load_on(Vec::new()), moving(vx, vy, turn_rate), times, Vec::new())
}

/// A tip that goes along straight lines between times (s) and places (m).
pub fn tip(spring: usize, waypoints: &[(f64, [f64; 2])]) -> TipPath {
    let waypoint = |(time, [x, y]): &(f64, [f64; 2])| Waypoint { time: *time, position: Vec2::new(*x, *y) };
    TipPath { spring, waypoints: waypoints.iter().map(waypoint).collect(), release: None }
}
