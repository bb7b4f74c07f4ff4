//! What a comparison asks of every backend.

use super::engine::EngineName;
use super::settings::{MakeController, OwnMeasure, Settings, Tier};
use super::solution::Solution;
use super::verdicts::Extras;
use crate::backend::BackendOptions;
use crate::scenario::Scenario;
use crate::simulation::MakeBackend;

/// What a comparison asks of every backend.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub tier: Tier,
    pub scenario: &'a Scenario,
    pub settings: &'a Settings,
    /// Makes rapier, or what replaces it, with its name.
    pub engine: (&'a EngineName, &'a MakeBackend<'a>),
    /// Makes the quasi-static and the inertial backend.
    pub references: &'a MakeBackend<'a>,
    pub controller: &'a MakeController<'a>,
    pub own: Option<&'a OwnMeasure<'a>>,
    /// Paths of another engine's comparison of the same scene, of which the exact ones are taken.
    pub exact: Option<(&'a [Solution; 3], &'a Extras)>,
}

impl Question<'_> {
    /// Path on the backends from `make`: see [`Solution::find`].
    pub fn solution(&self, options: &BackendOptions, make: &MakeBackend, watch: impl Fn(f64) -> bool + Sync) -> Option<Solution> {
        let n_parts = self.settings.parts_of_period(self.tier, self.scenario);
        Solution::find(self.scenario, options, (n_parts, self.settings.halvings), make, || (self.controller)(self.scenario), watch)
    }
}
