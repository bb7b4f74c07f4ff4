//! A comparison of three backends.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use cohaul::analysis::compare::{Pathwise, Settings, ThreeWay, Tier};
use cohaul::backend::BackendKind;
use cohaul::formats::stamped;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Controller, Trace};
use cohaul_report::chart::{self, Labelled};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_studies::compare::comparison::{self, Tiers};
use cohaul_studies::compare::files::write_comparison;
use cohaul_studies::compare::page::{comparison_page, scene_of};
use pyo3::exceptions::{PyArithmeticError, PyOSError};
use pyo3::prelude::*;

use crate::controller::Makers;
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
#[pyo3(signature = (scene, settings, tiers, n_seeds, controller, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn compare(
    py: Python,
    scene: &Scene,
    settings: &str,
    tiers: Vec<String>,
    n_seeds: usize,
    controller: Option<Py<PyAny>>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Comparison> {
    let scenario = Arc::clone(&scene.scenario);
    let settings = read::<AskedComparison>(settings)?.settings(&scenario)?;
    let tiers = asked(&tiers, &scenario, controller.is_some())?;
    if n_seeds == 0 || n_seeds > 1_000_000 || scenario.seed.checked_add(n_seeds as u64 - 1).is_none() {
        return Err(refused("seeds", "must be from 1 to 1000000, and the last seed below 2^64", n_seeds));
    }
    let makers = controller.map(Makers::new);
    let threads = pool(threads)?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let found = computed(py, progress, |watch| threads.install(|| all(&scenario, &settings, &tiers, n_seeds, makers.as_ref(), watch)))?;
    makers.as_ref().map_or(Ok(()), Makers::check)?;
    // Only an interrupt stops a comparison, and that is an exception already.
    let found = found.expect("the comparison ended");
    let found = comparison::Comparison::new(&scenario, &settings, found, clock.elapsed().as_secs_f64());
    json::check(&found).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Comparison { scenario, settings, found, started })
}

fn asked(names: &[String], scenario: &Scenario, has_controller: bool) -> PyResult<Vec<Tier>> {
    let possible: &[Tier] = match scenario.drive {
        Drive::Tips(_) if !has_controller => &[Tier::Prescribed],
        _ => &[Tier::Replayed, Tier::ClosedLoop],
    };
    let tiers: Vec<Tier> = names.iter().map(|name| named("tiers", name)).collect::<PyResult<_>>()?;
    match tiers.iter().find(|tier| !possible.contains(tier)) {
        Some(_) if possible.len() == 1 => Err(refused("tiers", "must be prescribed for given tip paths", names.join(", "))),
        Some(_) => Err(refused("tiers", "must be replayed or closed-loop for ants or a controller", names.join(", "))),
        None => Ok(if tiers.is_empty() { possible.to_vec() } else { tiers }),
    }
}

/// The tiers one after the other; `None` when they were stopped.
fn all(scenario: &Scenario, settings: &Settings, tiers: &[Tier], n_seeds: usize, makers: Option<&Makers>, watch: &Watch) -> Option<Tiers> {
    let make = |scenario: &Scenario| -> Box<dyn Controller> { makers.expect("there is one").controller(scenario) };
    let runs = ThreeWay::new(scenario, settings);
    let runs = if makers.is_some() { runs.controller(&make) } else { runs };
    let mut found = Tiers::default();
    for (at, tier) in tiers.iter().enumerate() {
        let watch = |share: f64| makers.is_none_or(Makers::are_well) && watch.go_on((at as f64 + share) / tiers.len() as f64);
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
        let (tier, backend) = (named::<Tier>("tier", tier)?, named::<BackendKind>("backend", backend)?);
        let traces = self.traces(tier).ok_or_else(|| refused("tier", "must be one that was compared", format!("{tier:?}")))?;
        let at = BackendKind::COMPARED.iter().position(|kind| *kind == backend);
        let at = at.ok_or_else(|| refused("backend", "must be one that was compared", backend.name()))?;
        Ok(TraceData::new(Arc::new(traces[at].clone()), self.scenario.system.springs.len()))
    }

    /// Paths, differences and pulls over time, as SVG.
    fn overview(&self, py: Python, tier: &str) -> PyResult<String> {
        let tier = named::<Tier>("tier", tier)?;
        let traces = self.traces(tier).ok_or_else(|| refused("tier", "must be one that was compared", format!("{tier:?}")))?;
        let found = self.found.tiers.pathwise().find(|found| found.tier == tier);
        let scene = found.map_or_else(|| chart::Scene::of(&self.scenario), |found| scene_of(found, &self.scenario));
        Ok(py.allow_threads(|| chart::overview(&Labelled::compared(traces), &scene)))
    }
}
