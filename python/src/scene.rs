//! A checked scenario.

use std::sync::Arc;

use cohaul::scenario::shipped::names;
use cohaul::scenario::{Drive, Scenario, ScenarioError};
use cohaul_report::json;
use pyo3::prelude::*;

use crate::work::{guarded, internal, raised};

/// Names and texts of the scenes that come with the package.
#[pyfunction]
pub fn shipped() -> Vec<(&'static str, &'static str)> {
    names().filter_map(|name| Some((name, cohaul::scenario::shipped::shipped(name)?))).collect()
}

/// A scenario that keeps all rules, and the text that it was read from.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Scene {
    pub scenario: Arc<Scenario>,
    pub text: String,
    pub file: String,
}

#[pymethods]
impl Scene {
    #[staticmethod]
    fn parse(text: String, file: String) -> PyResult<Self> {
        let scenario = guarded(|| Scenario::parse(&text, &file)).map_err(internal)?.map_err(faults)?;
        Ok(Self { scenario: Arc::new(scenario), text, file })
    }

    fn with_seed(&self, seed: u64) -> Self {
        let scenario = Arc::new(Scenario { seed, ..self.scenario.as_ref().clone() });
        Self { scenario, text: self.text.clone(), file: self.file.clone() }
    }

    /// The scenario with all defaults filled in, as JSON.
    fn expanded(&self) -> String {
        json::plain(&self.scenario.expanded()).to_string()
    }

    fn warnings(&self) -> Vec<String> {
        self.scenario.warnings().iter().map(ToString::to_string).collect()
    }

    fn hash(&self) -> String {
        self.scenario.hash()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.scenario.name
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.scenario.seed
    }

    #[getter]
    fn duration_s(&self) -> f64 {
        self.scenario.duration
    }

    #[getter]
    fn control_period_s(&self) -> f64 {
        self.scenario.control_period
    }

    #[getter]
    fn n_springs(&self) -> usize {
        self.scenario.system.springs.len()
    }

    #[getter]
    fn drive(&self) -> &'static str {
        match self.scenario.drive {
            Drive::Tips(_) => "tips",
            Drive::Ants(_) => "ants",
        }
    }

    /// Radius of the load's outline about its origin (m).
    #[getter]
    fn radius_m(&self) -> f64 {
        self.scenario.system.load.radius
    }

    /// Sum of the slip limits of all supports (N).
    #[getter]
    fn slip_limit_n(&self) -> f64 {
        self.scenario.system.total_slip_limit()
    }
}

/// The exception that lists every fault.
pub fn faults(error: ScenarioError) -> PyErr {
    let faults: Vec<(String, String, String)> =
        error.findings().iter().map(|finding| (finding.path.clone(), finding.rule.clone(), finding.found.clone())).collect();
    raised("ScenarioError", (error.to_string(), faults))
}
