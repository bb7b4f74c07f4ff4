//! One run.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use cohaul::analysis::estimate::{InertiaEstimate, with_estimate_if};
use cohaul::backend::BackendOptions;
use cohaul::formats::stamped;
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Controller, Keep, Outcome, Simulation, Trace, controller_of};
use cohaul_report::chart::{self, Labelled};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_studies::run::page::run_page;
use cohaul_studies::run::summary::RunSummary;
use pyo3::exceptions::PyArithmeticError;
use pyo3::prelude::*;

use crate::controller::Written;
use crate::options::{Asked, read};
use crate::scene::Scene;
use crate::trace::TraceData;
use crate::work::{Watch, computed};

/// A finished run.
#[pyclass(frozen, module = "cohaul._native")]
pub struct RunData {
    scenario: Arc<Scenario>,
    options: BackendOptions,
    trace: Arc<Trace>,
    outcome: Outcome,
    estimate: Option<InertiaEstimate>,
    wall_s: f64,
    started: SystemTime,
}

/// Runs a scenario to its end, under its own controller or under one written in Python.
#[pyfunction]
#[pyo3(signature = (scene, options, keep_trace, controller, progress))]
pub fn run(
    py: Python,
    scene: &Scene,
    options: &str,
    keep_trace: bool,
    controller: Option<Py<PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<RunData> {
    let scenario = Arc::clone(&scene.scenario);
    let options = read::<Asked>(options)?.options(&scenario)?;
    let written = controller.map(Written::new);
    let (started, clock) = (SystemTime::now(), Instant::now());
    let found = computed(py, progress, |watch| finished(&scenario, &options, keep_trace, written.as_ref(), watch))?;
    written.as_ref().map_or(Ok(()), |written| written.check())?;
    // Only an interrupt stops a run, and that is an exception already.
    let (trace, outcome, estimate) = found.expect("the run ended");
    let wall_s = clock.elapsed().as_secs_f64();
    Ok(RunData { scenario, options, trace: Arc::new(trace), outcome, estimate, wall_s, started })
}

fn finished(
    scenario: &Scenario,
    options: &BackendOptions,
    keep_trace: bool,
    written: Option<&Arc<Written>>,
    watch: &Watch,
) -> Option<(Trace, Outcome, Option<InertiaEstimate>)> {
    // A controller in Python is shown the attached tips.
    let keep = if keep_trace || written.is_some() { Keep::Trace } else { Keep::Outcome };
    let controller =
        || written.map_or_else(|| controller_of(scenario), |written| Box::new(written.instance(scenario)) as Box<dyn Controller>);
    let (backend, mut estimator) = with_estimate_if(scenario, options, true);
    let mut run = Simulation::from_parts(scenario, options, keep, controller(), backend);
    let afresh = |options: &BackendOptions| {
        let (backend, follower) = with_estimate_if(scenario, options, true);
        estimator = follower;
        Simulation::from_parts(scenario, options, keep, controller(), backend)
    };
    run.run_to_tolerance(afresh, |time| written.is_none_or(|written| written.is_well()) && watch.go_on(time / scenario.duration));
    let is_finished = run.is_finished();
    let (trace, outcome) = run.into_results();
    is_finished.then(|| (trace, outcome, estimator.map(|estimator| estimator.borrow().estimate())))
}

impl RunData {
    fn summary(&self) -> RunSummary<'_> {
        let run = Run {
            scenario: &self.scenario,
            options: &self.options,
            outcome: &self.outcome,
            path_length: None,
            wall_time: Some(self.wall_s),
        };
        RunSummary { run, inertia_estimate: self.estimate }
    }
}

#[pymethods]
impl RunData {
    /// What `cohaul run --json` prints.
    fn json(&self, py: Python) -> PyResult<String> {
        py.allow_threads(|| json::line(&stamped(&self.summary()))).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    fn trace(&self) -> TraceData {
        TraceData::new(Arc::clone(&self.trace), &self.scenario)
    }

    /// The page that `cohaul run --report` writes.
    fn page(&self, py: Python, command: String) -> String {
        let Self { scenario, options, .. } = self;
        py.allow_threads(|| {
            let manifest = Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, options, vec![command], self.started);
            run_page(&self.summary(), &self.trace, scenario, &manifest).to_html()
        })
    }

    /// Path, pulls, energy, heading and speed over time, as SVG.
    fn overview(&self, py: Python) -> String {
        let label = self.options.kind.name();
        py.allow_threads(|| chart::overview(&[Labelled { label, trace: &self.trace }], &chart::Scene::of(&self.scenario)))
    }
}
