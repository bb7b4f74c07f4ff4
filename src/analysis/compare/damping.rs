//! What the dashpots change in the motion without inertia.
//!
//! The quasi-static model has the dashpots of the scene. The paper's model has none: its path does
//! not depend on the speed of the tips. The damping effect is the difference of the two, beside the
//! inertia effect and no part of it. Whoever plans with the paper's model adds both.

use serde::Serialize;

use super::difference::Difference;
use super::pathwise::{Pathwise, reference_error_for};
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
}

impl DampingEffect {
    /// The effect in a scene with damped springs, to the error that a verdict on the paths found
    /// needs: `Some(None)` without such springs, or if the run has no answer. `None` if `watch` says
    /// no.
    pub(super) fn of(question: &Question, found: &Pathwise, watch: impl Fn(f64) -> bool + Sync) -> Option<Option<Self>> {
        let Question { scenario, settings, references, .. } = *question;
        let system = &scenario.system;
        let is_damped = system.springs.iter().any(|spring| system.dashpot(spring) != (0.0, 0.0));
        if !is_damped || settings.rate_independent {
            return Some(None);
        }
        let reference_tolerance_m = settings.reference_tolerance_m.or(Some(reference_error_for(found.tolerance_m)));
        let settings = Settings { rate_independent: true, reference_tolerance_m, ..*settings };
        let options = settings.under_error_control(scenario, BackendKind::QuasiStatic);
        let without = question.solution(&options, references, watch)?;
        let with = &found.solutions[0];
        if [with, &without].iter().any(|solution| solution.steps.status == Status::Failed) {
            return Some(None);
        }
        let path = Difference::between(&with.points, &without.points, system.load.radius);
        Some(Some(Self { path, peak_net_pull_n: peak_net_pull(with), peak_net_pull_without_n: peak_net_pull(&without) }))
    }
}

fn peak_net_pull(solution: &Solution) -> f64 {
    let net_pull = |row: &Row| row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm();
    solution.trace.rows.iter().map(net_pull).fold(0.0, f64::max)
}
