//! Which backends are shown, and their options.

use serde::{Deserialize, Serialize};

use cohaul::backend::{BackendKind, BackendOptions, RapierOptions};
use cohaul::scenario::Scenario;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Backends that are shown, in their order.
    pub backends: Vec<BackendKind>,
    /// Longest step of each backend in the order of `BackendKind::ALL` (s); the default where there
    /// is none.
    pub steps_s: [Option<f64>; BackendKind::ALL.len()],
    pub rapier: RapierOptions,
}

impl Default for Settings {
    fn default() -> Self {
        Self { backends: BackendKind::ALL.to_vec(), steps_s: [None; BackendKind::ALL.len()], rapier: RapierOptions::default() }
    }
}

/// Part of a control period that a step takes at least (1): a page stays live.
const SHORTEST: f64 = 1e-3;

impl Settings {
    pub fn options(&self, kind: BackendKind, scenario: &Scenario) -> BackendOptions {
        let options = BackendOptions::at_step(self.steps_s[kind as usize], kind, &scenario.system, scenario.control_period);
        BackendOptions { rapier: self.rapier, ..options }
    }

    /// # Errors
    /// With the rule that is broken.
    pub fn check(&self, scenario: &Scenario) -> Result<(), String> {
        let is_sorted = self.backends.windows(2).all(|pair| (pair[0] as usize) < pair[1] as usize);
        if self.backends.is_empty() || !is_sorted {
            return Err("settings.backends: must be one or more backends, each once and in their order".to_owned());
        }
        let period = scenario.control_period;
        let is_possible = |step: &f64| *step >= SHORTEST * period && *step <= period;
        match self.steps_s.iter().flatten().find(|step| !is_possible(step)) {
            Some(step) => Err(format!("settings.steps_s: must be from {} to {period} s, found {step}", SHORTEST * period)),
            None => Ok(()),
        }
    }
}
