//! What the dashpots change in the motion without inertia.
//!
//! The quasi-static model has the dashpots of the scene. The paper's model has none: its path does
//! not depend on the speed of the tips. The damping effect is the difference of the two, beside the
//! inertia effect and no part of it. Whoever plans with the paper's model adds both.

use serde::Serialize;

use super::difference::Difference;
use super::settings::Settings;
use super::solution::{Question, Solution};
use crate::backend::{BackendKind, Status};
use crate::math::Vec2;
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

impl DampingEffect {
    /// The effect in a scene with damped springs, from the quasi-static run `with` them and one of
    /// this error (m), unless the settings ask for another one. `Some(None)` without such springs,
    /// or if a run has no answer; `None` if `watch` says no.
    pub(super) fn of(question: &Question, with: &Solution, error_m: f64, watch: impl Fn(f64) -> bool + Sync) -> Option<Option<Self>> {
        let Question { scenario, settings, references, .. } = *question;
        let system = &scenario.system;
        let damped = system.springs.iter().filter(|spring| system.dashpot(spring).0 > 0.0);
        let relaxation_s = damped.map(|spring| system.dashpot(spring).0 / spring.radial_stiffness).fold(0.0, f64::max);
        if relaxation_s == 0.0 || settings.rate_independent {
            return Some(None);
        }
        let reference_tolerance_m = settings.reference_tolerance_m.or(Some(error_m));
        let settings = Settings { rate_independent: true, reference_tolerance_m, ..*settings };
        let options = settings.under_error_control(scenario, BackendKind::QuasiStatic);
        let without = question.solution(&options, references, watch)?;
        if [with, &without].iter().any(|solution| solution.steps.status == Status::Failed) {
            return Some(None);
        }
        let path = Difference::between(&with.points, &without.points, system.load.radius);
        let [peak_net_pull_n, peak_net_pull_without_n] = [with, &without].map(peak_net_pull);
        Some(Some(Self { path, peak_net_pull_n, peak_net_pull_without_n, relaxation_s }))
    }
}

fn peak_net_pull(solution: &Solution) -> f64 {
    let net_pull = |row: &Row| row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm();
    solution.trace.rows.iter().map(net_pull).fold(0.0, f64::max)
}
