//! A measure of a run that is written in Python.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use cohaul::scenario::Scenario;
use cohaul::simulation::{Row, Trace};
use pyo3::prelude::*;

use crate::trace::TraceData;

/// A Python function of a trace, and the first exception that it raised.
pub struct Measure {
    pub name: &'static str,
    pub unit: &'static str,
    pub tolerance: Option<f64>,
    of: Py<PyAny>,
    scenario: Arc<Scenario>,
    raised: Mutex<Option<PyErr>>,
}

/// What Python says of a measure.
#[derive(FromPyObject)]
pub struct Asked {
    #[pyo3(item)]
    name: String,
    #[pyo3(item)]
    unit: String,
    #[pyo3(item)]
    of: Py<PyAny>,
    #[pyo3(item)]
    tolerance: Option<f64>,
}

impl Measure {
    pub fn new(asked: Asked, scenario: &Arc<Scenario>) -> Self {
        let Asked { name, unit, of, tolerance } = asked;
        Self { name: kept(name), unit: kept(unit), tolerance, of, scenario: Arc::clone(scenario), raised: Mutex::default() }
    }

    /// The number of a run; not finite after an exception.
    pub fn number(&self, rows: &[Row]) -> f64 {
        let trace = Arc::new(Trace { rows: rows.to_vec(), ..Trace::default() });
        let found = Python::with_gil(|py| self.of.call1(py, (TraceData::new(trace, &self.scenario),))?.extract::<f64>(py));
        found.unwrap_or_else(|error| {
            self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            f64::NAN
        })
    }

    /// Whether nothing was raised so far.
    pub fn is_well(&self) -> bool {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).is_none()
    }

    /// # Errors
    /// With what was raised.
    pub fn check(&self) -> PyResult<()> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }
}

/// A text that stays until the process ends; each text is kept once.
fn kept(text: String) -> &'static str {
    static KEPT: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept.get(text.as_str()) {
        return known;
    }
    let text: &'static str = Box::leak(text.into_boxed_str());
    kept.insert(text);
    text
}
