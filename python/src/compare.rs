//! A comparison of three backends.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use cohaul::analysis::compare::{EngineName, Pathwise, Settings, ThreeWay, Tier};
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::formats::stamped;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Controller, Trace};
use cohaul_engines::Engine;
use cohaul_engines::engine::Open;
use cohaul_report::chart::{self, Labelled};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_studies::compare::comparison::{self, Tiers};
use cohaul_studies::compare::files::write_comparison;
use cohaul_studies::compare::page::{comparison_page, scene_of};
use pyo3::exceptions::{PyArithmeticError, PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::controller::Makers;
use crate::engine::Written;
use crate::options::{AskedComparison, named, read, refused};
use crate::scene::Scene;
use crate::trace::TraceData;
use crate::work::{Watch, computed, pool};

/// A finished comparison.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Comparison {
    scenario: Arc<Scenario>,
    settings: Settings,
    found: comparison::Comparison,
    started: SystemTime,
}

/// Compares the backends on a scenario, in the tiers asked for or in all that it has. `controller`
/// is a function that makes a controller for a seed.
#[pyfunction]
#[pyo3(signature = (scene, settings, tiers, n_seeds, controller, engine, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn compare(
    py: Python,
    scene: &Scene,
    settings: &str,
    tiers: Vec<String>,
    n_seeds: usize,
    controller: Option<Py<PyAny>>,
    engine: Option<Py<PyAny>>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Comparison> {
    let scenario = Arc::clone(&scene.scenario);
    let settings = read::<AskedComparison>(settings)?.settings(&scenario)?;
    let tiers = asked(&tiers, &scenario, [controller.is_some(), engine.is_some()])?;
    if n_seeds == 0 || n_seeds > 1_000_000 || scenario.seed.checked_add(n_seeds as u64 - 1).is_none() {
        return Err(refused("seeds", "must be from 1 to 1000000, and the last seed below 2^64", n_seeds));
    }
    let makers = controller.map(Makers::new);
    let threads = pool(threads)?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let written = engine.map(|make| Written::new(py, make)).transpose()?;
    let open = || written.as_ref().expect("there is one").open();
    let open: &Open = &open;
    let engine = match &written {
        None => None,
        Some(written) => {
            let options = settings.at_fixed_step(&scenario, BackendKind::Rapier);
            let met = py.allow_threads(|| Engine::meet(open, &scenario, &options));
            written.check()?;
            Some(met.map_err(|what| PyValueError::new_err(format!("engine: {what}")))?)
        }
    };
    let own = Own { makers: makers.as_ref(), engine: engine.as_ref() };
    let found = computed(py, progress, |watch| threads.install(|| all(&scenario, &settings, &tiers, n_seeds, own, watch)));
    written.as_ref().map_or(Ok(()), |written| written.check())?;
    if let Some(what) = engine.as_ref().and_then(Engine::complaint) {
        return Err(PyValueError::new_err(format!("engine: {what}")));
    }
    let found = found?;
    makers.as_ref().map_or(Ok(()), Makers::check)?;
    // Only an interrupt stops a comparison, and that is an exception already.
    let found = found.expect("the comparison ended");
    let found = comparison::Comparison::new(&scenario, &settings, found, clock.elapsed().as_secs_f64());
    json::check(&found).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Comparison { scenario, settings, found, started })
}

fn asked(names: &[String], scenario: &Scenario, [has_controller, has_engine]: [bool; 2]) -> PyResult<Vec<Tier>> {
    let possible: &[Tier] = match scenario.drive {
        Drive::Tips(_) if !has_controller => &[Tier::Prescribed],
        _ if has_engine => &[Tier::Replayed],
        _ => &[Tier::Replayed, Tier::ClosedLoop],
    };
    let tiers: Vec<Tier> = names.iter().map(|name| named("tiers", name)).collect::<PyResult<_>>()?;
    match tiers.iter().find(|tier| !possible.contains(tier)) {
        Some(_) if possible == [Tier::Replayed] => Err(refused("tiers", "must be replayed for ants with an engine", names.join(", "))),
        Some(_) if possible.len() == 1 => Err(refused("tiers", "must be prescribed for given tip paths", names.join(", "))),
        Some(_) => Err(refused("tiers", "must be replayed or closed-loop for ants or a controller", names.join(", "))),
        None => Ok(if tiers.is_empty() { possible.to_vec() } else { tiers }),
    }
}

/// What is written in Python.
#[derive(Clone, Copy)]
struct Own<'a> {
    makers: Option<&'a Makers>,
    engine: Option<&'a Engine<'a>>,
}

/// The tiers one after the other; `None` when they were stopped.
fn all(scenario: &Scenario, settings: &Settings, tiers: &[Tier], n_seeds: usize, own: Own, watch: &Watch) -> Option<Tiers> {
    let Own { makers, engine } = own;
    let make = |scenario: &Scenario| -> Box<dyn Controller> { makers.expect("there is one").controller(scenario) };
    let make_engine = |scenario: &Scenario, options: &BackendOptions| engine.expect("there is one").backend(scenario, options);
    let runs = ThreeWay::new(scenario, settings);
    let runs = if makers.is_some() { runs.controller(&make) } else { runs };
    let runs = engine.map_or(runs, |engine| runs.engine(&make_engine).named(engine.name()));
    let are_well = || makers.is_none_or(Makers::are_well) && engine.is_none_or(Engine::is_well);
    let mut found = Tiers::default();
    for (at, tier) in tiers.iter().enumerate() {
        let watch = |share: f64| are_well() && watch.go_on((at as f64 + share) / tiers.len() as f64);
        match tier {
            Tier::Prescribed => found.prescribed = Some(runs.prescribed(watch)?),
            Tier::Replayed => found.replayed = Some(runs.replayed(watch)?),
            Tier::ClosedLoop => found.closed_loop = Some(runs.closed_loop(n_seeds, watch)?),
            // It has no name by which it could be asked for.
            Tier::Controlled => {}
        }
    }
    Some(found)
}

impl Comparison {
    fn manifest(&self, command: String) -> Manifest {
        let Self { scenario, settings, started, .. } = self;
        Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, settings, vec![command], *started)
    }

    /// Names of the runs of a tier.
    fn names(&self, tier: Tier) -> [&str; 3] {
        self.found.tiers.engine(tier).map_or(["quasi-static", "inertial", "rapier"], EngineName::after_exact)
    }

    /// Traces of a tier, in the order of the backends.
    fn traces(&self, tier: Tier) -> Option<Vec<&Trace>> {
        let tiers = &self.found.tiers;
        match tier {
            Tier::ClosedLoop => tiers.closed_loop.as_ref().map(|found| found.traces.iter().collect()),
            Tier::Prescribed => traces_of(tiers.prescribed.as_ref()),
            Tier::Replayed => traces_of(tiers.replayed.as_ref()),
            Tier::Controlled => None,
        }
    }
}

fn traces_of(found: Option<&Pathwise>) -> Option<Vec<&Trace>> {
    Some(found?.solutions.iter().map(|solution| &solution.trace).collect())
}

#[pymethods]
impl Comparison {
    /// What `cohaul compare --json` prints.
    fn json(&self, py: Python) -> PyResult<String> {
        py.allow_threads(|| json::line(&stamped(&self.found))).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    /// The page that `cohaul compare --out` writes, with its replay.
    fn page(&self, py: Python, command: String) -> String {
        py.allow_threads(|| comparison_page(&self.found, &self.scenario, &self.manifest(command)).to_html())
    }

    /// Writes the files of `cohaul compare --out`.
    fn write(&self, py: Python, folder: std::path::PathBuf, command: String) -> PyResult<()> {
        let written = py.allow_threads(|| write_comparison(&folder, &self.found, &self.scenario, None, &self.manifest(command)));
        written.map_err(|error| PyOSError::new_err(error.to_string()))
    }

    fn trace(&self, tier: &str, backend: &str) -> PyResult<TraceData> {
        let tier = named::<Tier>("tier", tier)?;
        let traces = self.traces(tier).ok_or_else(|| refused("tier", "must be one that was compared", format!("{tier:?}")))?;
        let at = self.names(tier).iter().position(|name| *name == backend);
        let at = at.ok_or_else(|| refused("backend", "must be one that was compared", backend))?;
        Ok(TraceData::new(Arc::new(traces[at].clone()), self.scenario.system.springs.len()))
    }

    /// Paths, differences and pulls over time, as SVG.
    fn overview(&self, py: Python, tier: &str) -> PyResult<String> {
        let tier = named::<Tier>("tier", tier)?;
        let traces = self.traces(tier).ok_or_else(|| refused("tier", "must be one that was compared", format!("{tier:?}")))?;
        let found = self.found.tiers.pathwise().find(|found| found.tier == tier);
        let scene = found.map_or_else(|| chart::Scene::of(&self.scenario), |found| scene_of(found, &self.scenario));
        Ok(py.allow_threads(|| chart::overview(&Labelled::compared(self.names(tier), traces), &scene)))
    }
}
