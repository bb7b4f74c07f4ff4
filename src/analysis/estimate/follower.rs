//! The estimate, and what follows a load to make one.

use serde::Serialize;

use super::displacement::Largest;
use crate::analysis::trigger::ByTrigger;
use crate::backend::{RestoreError, Transition, TransitionKind};
use crate::math::{Pose, Vec2};

/// Largest edge displacement that counts as agreement, divided by the path length (1).
pub const TOLERANCE_SHARE: f64 = 0.01;
/// Factor by which an estimate must lie below or above the tolerance to decide (1). Of 2,000 random
/// scenes none is measured on the other side: `results/2026-11-26-answers`.
pub const CLEAR: f64 = 3.0;

/// Estimated inertia effect on a quasi-static run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InertiaEstimate {
    /// Largest edge displacement (m).
    pub edge_displacement_max_m: f64,
    /// Edge displacement at the end of the run (m).
    pub edge_displacement_final_m: f64,
    /// Left out if inertia never moves the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<Largest>,
    /// Largest edge displacements, each after the last disturbance that was at least as large as
    /// the oscillation that it met.
    pub by_trigger: ByTrigger,
    /// Length scale of the tolerance (m): the quasi-static path length, or the largest edge
    /// displacement from the start with inertia if that is longer.
    pub path_length_m: f64,
    /// Share of the quasi-static path length that lies in jumps (1).
    #[serde(skip_serializing_if = "crate::math::is_zero")]
    pub jump_share: f64,
    /// Largest edge displacement divided by the path length (1); zero for a load at rest.
    pub share: f64,
    /// Whether inertia is negligible within 1 % of the path, left out where that is not known; see
    /// [`InertiaEstimate::is_negligible_within`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_negligible: Option<bool>,
    /// Whether the reduced inertial model turned too far from the load: the lengths above are then
    /// orders of magnitude.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_invalid: bool,
    /// Whether the load, with inertia or without, touched an obstacle.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub touches_obstacle: bool,
}

impl InertiaEstimate {
    /// With the share and whether it is negligible, which follow from the lengths.
    pub(super) fn concluded(mut self) -> Self {
        let (effect, length) = (self.edge_displacement_max_m, self.path_length_m);
        self.share = if length > 0.0 { effect / length } else { 0.0 };
        self.is_negligible = self.is_negligible_within(TOLERANCE_SHARE * length);
        self
    }

    /// Whether inertia is negligible within a tolerance (m). It is not for an invalid model. `None`
    /// for an estimate within a factor of 3 of the tolerance.
    pub fn is_negligible_within(&self, tolerance_m: f64) -> Option<bool> {
        match self.edge_displacement_max_m {
            _ if self.is_invalid => Some(false),
            effect if effect <= tolerance_m / CLEAR => Some(true),
            effect => (effect >= CLEAR * tolerance_m).then_some(false),
        }
    }
}

/// What follows a load, and estimates the inertia effect on it.
pub(super) trait Follower: Send {
    /// As [`super::Estimator::attach`].
    fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose);
    /// As [`super::Estimator::release`].
    fn release(&mut self, spring: usize, pose: &Pose);
    /// As [`super::Estimator::note`].
    fn note(&mut self, transitions: &[Transition]);
    /// As [`super::Estimator::advance`].
    fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64);
    /// As [`super::Estimator::estimate`].
    fn estimate(&self) -> InertiaEstimate;
    /// As [`super::Estimator::save`].
    fn save(&self) -> serde_json::Value;
    /// As [`super::Estimator::restore`].
    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError>;
}

/// Edge displacement (m) of each quasi-static jump among the transitions of a load of this radius
/// (m).
pub(super) fn jump_lengths(transitions: &[Transition], radius: f64) -> impl Iterator<Item = f64> {
    transitions.iter().filter_map(move |transition| match transition.kind {
        TransitionKind::Jump { shift, turn, .. } => Some(shift + radius * turn.abs()),
        _ => None,
    })
}

/// Share of a path length (m) that lies in jumps of this length (m). A jump and the slide after it
/// in one tick may go back and forth, so that the tick is shorter than the jump.
pub(super) fn jump_share(jumps: f64, path: f64) -> f64 {
    if path > 0.0 { (jumps / path).min(1.0) } else { 0.0 }
}
