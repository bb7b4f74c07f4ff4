//! What the dashpots change in the motion without inertia.
//!
//! The quasi-static model has the dashpots of the scene. The paper's model has none: its path does
//! not depend on the speed of the tips. The damping effect is the difference of the two, beside the
//! inertia effect and no part of it. Whoever plans with the paper's model adds both.

use serde::Serialize;

use super::difference::Difference;
use super::solution::Solution;
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::Row;

/// Quasi-static minus rate-independent quasi-static.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingEffect {
    /// Distance of the paths.
    #[serde(flatten)]
    pub path: Difference,
    /// Largest net pull of all tips with the dashpots (N).
    pub peak_net_pull_n: f64,
    /// Largest net pull of all tips without the dashpots (N).
    pub peak_net_pull_without_n: f64,
    /// Longest time in which a damped spring relaxes, c / k (s). Where the rate-independent load
    /// jumps, the load relaxes within a few of these.
    pub relaxation_s: f64,
}

/// Whether a spring has a dashpot.
pub(in crate::analysis) fn is_damped(scenario: &Scenario) -> bool {
    relaxation(scenario) > 0.0
}

/// Longest time in which a damped spring relaxes, c / k (s); zero without damped springs.
fn relaxation(scenario: &Scenario) -> f64 {
    let system = &scenario.system;
    let damped = system.springs.iter().filter(|spring| system.dashpot(spring).0 > 0.0);
    damped.map(|spring| system.dashpot(spring).0 / spring.radial_stiffness).fold(0.0, f64::max)
}

impl DampingEffect {
    /// The effect from the quasi-static runs `with` and `without` dashpots.
    pub(super) fn between(scenario: &Scenario, with: &Solution, without: &Solution) -> Self {
        let path = Difference::between(&with.points, &without.points, scenario.system.load.radius);
        let [peak_net_pull_n, peak_net_pull_without_n] = [with, without].map(peak_net_pull);
        Self { path, peak_net_pull_n, peak_net_pull_without_n, relaxation_s: relaxation(scenario) }
    }
}

fn peak_net_pull(solution: &Solution) -> f64 {
    let net_pull = |row: &Row| row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm();
    solution.trace.rows.iter().map(net_pull).fold(0.0, f64::max)
}
