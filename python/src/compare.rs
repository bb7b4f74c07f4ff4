//! A comparison of three backends.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use cohaul::analysis::compare::{OwnMeasure, Pathwise, Settings, ThreeWay, Tier};
use cohaul::backend::BackendKind;
use cohaul::formats::stamped;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Controller, Row};
use cohaul_engines::Engine;
use cohaul_engines::engine::Open;
use cohaul_report::chart::{self, Labelled};
use cohaul_report::json;
use cohaul_report::manifest::{Libraries, Manifest};
use cohaul_studies::compare::beside::recorded_path;
use cohaul_studies::compare::comparison::{self, Refusal, Tiers};
use cohaul_studies::compare::files::write_comparison;
use cohaul_studies::compare::page::{comparison_page, scene_of};
use pyo3::exceptions::{PyArithmeticError, PyNotImplementedError, PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::controller::Makers;
use crate::engine::Asked;
use crate::measure::{self, Measure};
use crate::options::{AskedComparison, read, refused};
use crate::scene::{Scene, faults};
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
/// is a function that makes a controller for a seed, `measure` one of a trace, and `beside` the
/// name and the text of a table with a path recorded elsewhere.
#[pyfunction]
#[pyo3(signature = (scene, settings, tiers, n_seeds, controller, measure, engines, beside, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn compare(
    py: Python,
    scene: &Scene,
    settings: &str,
    tiers: Vec<String>,
    n_seeds: usize,
    controller: Option<Py<PyAny>>,
    measure: Option<measure::Asked>,
    engines: Vec<Py<PyAny>>,
    beside: Option<(String, String)>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Comparison> {
    let scenario = Arc::clone(&scene.scenario);
    let settings = read::<AskedComparison>(settings)?.settings(&scenario)?;
    let engines: Vec<Asked> = engines.into_iter().map(|engine| Asked::new(py, engine)).collect::<PyResult<_>>()?;
    let are_foreign = engines.iter().any(|engine| !matches!(engine, Asked::Rapier));
    let tiers = asked(&tiers, &scenario, [controller.is_some(), are_foreign])?;
    if n_seeds == 0 || n_seeds > 1_000_000 || scenario.seed.checked_add(n_seeds as u64 - 1).is_none() {
        return Err(refused("seeds", "must be from 1 to 1000000, and the last seed below 2^64", n_seeds));
    }
    let recorded = beside.as_ref().map(|(name, text)| recorded_path(text, name).map_err(faults)).transpose()?;
    let (makers, measure) = (controller.map(Makers::new), measure.map(|asked| Measure::new(asked, &scenario)));
    let threads = pool(threads)?;
    let (started, clock) = (SystemTime::now(), Instant::now());
    let opens: Vec<_> = engines.iter().map(|asked| || asked.open()).collect();
    let options = settings.at_fixed_step(&scenario, BackendKind::Rapier);
    let meet = |(asked, open): (&Asked, _)| match asked {
        Asked::Rapier => Ok(Engine::rapier(Libraries::USED.rapier2d)),
        _ => py.allow_threads(|| Engine::meet(open, &scenario, &options)),
    };
    let met: Result<Vec<Engine>, String> = engines.iter().zip(opens.iter().map(|open| open as &Open)).map(meet).collect();
    engines.iter().try_for_each(Asked::check)?;
    let wrong = |what: String| PyValueError::new_err(format!("engine: {what}"));
    let met = if engines.is_empty() { vec![Engine::rapier(Libraries::USED.rapier2d)] } else { met.map_err(wrong)? };
    Engine::check_names(&met).map_err(wrong)?;
    let willing = Engine::willing(&met).map_err(|what| PyNotImplementedError::new_err(format!("engine: {what}")));
    let (willing, refused_by) = willing?;
    let own = Own { makers: makers.as_ref(), measure: measure.as_ref(), engines: &willing };
    let found = computed(py, progress, |watch| threads.install(|| all(&scenario, &settings, &tiers, n_seeds, own, watch)));
    engines.iter().try_for_each(Asked::check)?;
    if let Some(what) = met.iter().find_map(Engine::complaint) {
        return Err(wrong(what));
    }
    let found = found?;
    makers.as_ref().map_or(Ok(()), Makers::check)?;
    measure.as_ref().map_or(Ok(()), Measure::check)?;
    // Only an interrupt stops a comparison, and that is an exception already.
    let (found, others) = found.expect("the comparison ended");
    let found = comparison::Comparison::new(&scenario, &settings, found, clock.elapsed().as_secs_f64());
    let mut found = found.with_other_engines(others, Refusal::of(&refused_by));
    if let (Some((name, _)), Some(path)) = (&beside, recorded) {
        found.lay_beside(name, path).map_err(|rule| PyValueError::new_err(format!("beside: {rule}")))?;
    }
    json::check(&found).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Comparison { scenario, settings, found, started })
}

fn asked(names: &[String], scenario: &Scenario, [has_controller, has_engine]: [bool; 2]) -> PyResult<Vec<Tier>> {
    let possible: &[Tier] = match scenario.drive {
        Drive::Tips(_) if !has_controller => &[Tier::Prescribed],
        _ if has_controller && has_engine => &[Tier::Replayed, Tier::Controlled],
        _ if has_engine => &[Tier::Replayed],
        _ if has_controller => &[Tier::Replayed, Tier::ClosedLoop, Tier::Controlled],
        _ => &[Tier::Replayed, Tier::ClosedLoop],
    };
    let tiers: Vec<Tier> = names.iter().map(|name| tier_named("tiers", name)).collect::<PyResult<_>>()?;
    match tiers.iter().find(|tier| !possible.contains(tier)) {
        Some(_) if possible == [Tier::Replayed] => Err(refused("tiers", "must be replayed for ants with an engine", names.join(", "))),
        Some(_) if possible.len() == 1 => Err(refused("tiers", "must be prescribed for given tip paths", names.join(", "))),
        Some(_) if !has_controller => Err(refused("tiers", "must be replayed or closed-loop for ants", names.join(", "))),
        Some(_) if has_engine => Err(refused("tiers", "must be replayed or controlled for a controller with an engine", names.join(", "))),
        Some(_) => Err(refused("tiers", "must be replayed, closed-loop or controlled for a controller", names.join(", "))),
        None if tiers.is_empty() => Ok(possible.iter().copied().filter(|tier| *tier != Tier::Controlled).collect()),
        None => Ok(tiers),
    }
}

/// The tier of a name.
fn tier_named(path: &str, name: &str) -> PyResult<Tier> {
    match name {
        "prescribed" => Ok(Tier::Prescribed),
        "replayed" => Ok(Tier::Replayed),
        "controlled" => Ok(Tier::Controlled),
        "closed-loop" | "closed_loop" => Ok(Tier::ClosedLoop),
        _ => Err(refused(path, "must be prescribed, replayed, controlled or closed-loop", format!("{name:?}"))),
    }
}

/// What may be written in Python.
#[derive(Clone, Copy)]
struct Own<'a> {
    makers: Option<&'a Makers>,
    measure: Option<&'a Measure>,
    engines: &'a [&'a Engine<'a>],
}

/// The tiers one after the other, and the paths of all engines but the first; `None` when they were
/// stopped.
fn all(
    scenario: &Scenario,
    settings: &Settings,
    tiers: &[Tier],
    n_seeds: usize,
    own: Own,
    watch: &Watch,
) -> Option<(Tiers, Vec<Pathwise>)> {
    let Own { makers, measure, engines } = own;
    let make = |scenario: &Scenario| -> Box<dyn Controller> { makers.expect("there is one").controller(scenario) };
    let runs = ThreeWay::new(scenario, settings);
    let runs = if makers.is_some() { runs.controller(&make) } else { runs };
    let number = |rows: &[Row]| measure.map_or(f64::NAN, |measure| measure.number(rows));
    let own = measure.map(|measure| OwnMeasure { name: measure.name, unit: measure.unit, of: &number, tolerance: measure.tolerance });
    let runs = own.as_ref().map_or(runs, |own| runs.measure(own));
    let are_well =
        || makers.is_none_or(Makers::are_well) && measure.is_none_or(Measure::is_well) && engines.iter().all(|engine| engine.is_well());
    let (mut found, mut others, n_parts) = (Tiers::default(), Vec::new(), (tiers.len() * engines.len()) as f64);
    for (at, tier) in tiers.iter().enumerate() {
        let paths = |nth: usize, beside: Option<&Pathwise>| {
            let watch = |share: f64| are_well() && watch.go_on(((at * engines.len() + nth) as f64 + share) / n_parts);
            engines[nth].paths(runs, *tier, beside, watch)
        };
        if *tier == Tier::ClosedLoop {
            found.closed_loop = Some(runs.closed_loop(n_seeds, |share| are_well() && watch.go_on((at as f64 + share) / n_parts))?);
            continue;
        }
        let first = paths(0, None)?;
        for nth in 1..engines.len() {
            others.push(paths(nth, Some(&first))?);
        }
        *match tier {
            Tier::Prescribed => &mut found.prescribed,
            Tier::Controlled => &mut found.controlled,
            Tier::Replayed | Tier::ClosedLoop => &mut found.replayed,
        } = Some(first);
    }
    Some((found, others))
}

impl Comparison {
    fn manifest(&self, command: String) -> Manifest {
        let Self { scenario, settings, started, .. } = self;
        Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, settings, vec![command], *started)
    }

    /// Runs of a tier: those of the exact backends, then those of the engines.
    fn runs(&self, tier: &str) -> PyResult<(Tier, Vec<Labelled<'_>>)> {
        let tier = tier_named("tier", tier)?;
        let runs = match self.found.tiers.pathwise().find(|found| found.tier == tier) {
            Some(found) => Some(self.found.runs(found)),
            None => {
                let found = self.found.tiers.closed_loop.as_ref().filter(|found| found.tier == tier);
                found.map(|found| Labelled::compared(found.engine.after_exact(), &found.traces))
            }
        };
        let runs = runs.ok_or_else(|| refused("tier", "must be one that was compared", format!("{tier:?}")))?;
        Ok((tier, runs))
    }
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
        let (_, runs) = self.runs(tier)?;
        let run = runs.iter().find(|run| run.label == backend);
        let run = run.ok_or_else(|| refused("backend", "must be one that was compared", backend))?;
        Ok(TraceData::new(Arc::new(run.trace.clone()), &self.scenario))
    }

    /// Paths, differences and pulls over time, as SVG.
    fn overview(&self, py: Python, tier: &str) -> PyResult<String> {
        let (tier, runs) = self.runs(tier)?;
        let found = self.found.tiers.pathwise().find(|found| found.tier == tier);
        let scene = found.map_or_else(|| chart::Scene::of(&self.scenario), |found| scene_of(found, &self.scenario));
        Ok(py.allow_threads(|| chart::overview(&runs, &scene)))
    }
}
