//! Maps of comparisons over parameters of a scene, and thresholds of one.

use std::path::PathBuf;
use std::time::SystemTime;

use cohaul::analysis::compare::Settings;
use cohaul::formats::stamped;
use cohaul::scenario::sha256_hex;
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_report::table::Table;
use cohaul_studies::runner::Records;
use cohaul_studies::sweep::{Axis, Plan, SweepError, present_value, validate};
use cohaul_studies::threshold::files::{thresholds_figure, thresholds_page, write_thresholds};
use cohaul_studies::threshold::report::Thresholds;
use cohaul_studies::threshold::{Asked, search};
use cohaul_studies::vary::files::{map_figure, map_page, write_map};
use cohaul_studies::vary::report::Map;
use cohaul_studies::vary::{Question, plan, tasks};
use pyo3::exceptions::{PyArithmeticError, PyOSError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use serde_json::{Value, json};

use crate::options::{AskedComparison, read};
use crate::scene::Scene;
use crate::sweep::{axis, refusal};
use crate::work::{computed, pool};

/// A map of comparisons.
#[pyclass(frozen, module = "cohaul._native")]
pub struct MapData {
    found: Map,
    question: Value,
    started: SystemTime,
}

/// Ranges of a parameter in which quasi-static is valid.
#[pyclass(frozen, module = "cohaul._native")]
pub struct ThresholdData {
    found: Thresholds,
    question: Value,
    started: SystemTime,
}

/// Compares the backends on a scene over one parameter or two, of which `vary` has path and values.
#[pyfunction]
#[pyo3(signature = (scene, vary, settings, is_everywhere, threads, progress))]
pub fn compare_map(
    py: Python,
    scene: &Scene,
    vary: &str,
    settings: &str,
    is_everywhere: bool,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<MapData> {
    let started = SystemTime::now();
    let asked: Vec<(String, Value)> = read(vary)?;
    let axes: Result<Vec<Axis>, _> = asked.into_iter().map(|(path, values)| axis(&path, values)).collect();
    let (plan, settings) = planned(scene, axes.map_err(refusal)?, settings)?;
    let (question, pool) = (Question { settings, everywhere: is_everywhere }, pool(threads)?);
    let found = computed(py, progress, |watch| {
        check(&plan, &pool)?;
        Ok::<_, SweepError>(pool.install(|| tasks(&plan, &question).finished(&|share| watch.go_on(share))))
    })?;
    // Only an interrupt stops the work, and that is an exception already.
    let cells = found.map_err(refusal)?.expect("the work ended");
    let found = Map::new(&plan, &question, cells, seconds_since(started));
    json::check(&found).map_err(no_number)?;
    Ok(MapData { found, question: json!({ "name": "compare", "sweep": plan.identity, "question": question }), started })
}

/// Looks for the values of the parameter `asked` up to which quasi-static is valid.
#[pyfunction]
#[pyo3(signature = (scene, asked, settings, threads, progress))]
pub fn threshold(
    py: Python,
    scene: &Scene,
    asked: &str,
    settings: &str,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<ThresholdData> {
    let started = SystemTime::now();
    let asked: Asked = asked.parse().map_err(refusal)?;
    let present = if asked.needs_present_value() { present_value(&scene.text, &scene.file, &asked.path).map_err(refusal)? } else { 1.0 };
    let (plan, settings) = planned(scene, vec![asked.axis(present).map_err(refusal)?], settings)?;
    let pool = pool(threads)?;
    let found = computed(py, progress, |watch| {
        check(&plan, &pool)?;
        let mut records = Records::in_memory();
        let n = pool.install(|| search(&plan, &settings, &mut records, &|share| watch.go_on(share))).expect("memory does not fail");
        Ok::<_, SweepError>(records.complete(n).ok().map(|(points, _)| points))
    })?;
    // Only an interrupt stops the work, and that is an exception already.
    let points = found.map_err(refusal)?.expect("the work ended");
    let found = Thresholds::new(&plan, &settings, &points, seconds_since(started));
    json::check(&found).map_err(no_number)?;
    Ok(ThresholdData { found, question: json!({ "name": "threshold", "sweep": plan.identity, "settings": settings }), started })
}

fn planned(scene: &Scene, axes: Vec<Axis>, settings: &str) -> PyResult<(Plan, Settings)> {
    // Suggestions are tried on one scene, and not at each point.
    let settings = Settings { check_suggestions: false, ..read::<AskedComparison>(settings)?.settings(&scene.scenario)? };
    let plan = plan(scene.file.clone(), scene.text.clone(), axes, Some(scene.scenario.seed), &settings).map_err(refusal)?;
    Ok((plan, settings))
}

/// # Errors
/// When a point is no scenario.
fn check(plan: &Plan, pool: &ThreadPool) -> Result<(), SweepError> {
    validate(plan, 0..plan.identity.n_cells, pool, || true)
}

fn seconds_since(started: SystemTime) -> f64 {
    started.elapsed().map_or(0.0, |elapsed| elapsed.as_secs_f64())
}

fn no_number(error: impl ToString) -> PyErr {
    PyArithmeticError::new_err(error.to_string())
}

fn manifest(question: &Value, command: String, started: SystemTime) -> Manifest {
    Manifest::new(question, sha256_hex(question.to_string().as_bytes()), None, &json!({}), vec![command], started)
}

fn csv(table: &Table) -> PyResult<String> {
    let mut bytes = Vec::new();
    table.write_csv(&mut bytes).map_err(no_number)?;
    Ok(String::from_utf8(bytes).expect("a table is text"))
}

#[pymethods]
impl MapData {
    /// What `cohaul compare --vary --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.found)).map_err(no_number)
    }

    /// What `cohaul compare --vary` prints.
    fn text(&self) -> String {
        self.found.text()
    }

    /// All numbers of all points, as `cohaul compare --vary --out` writes them.
    fn csv(&self) -> PyResult<String> {
        csv(&self.found.table())
    }

    /// The map as SVG.
    fn figure(&self) -> String {
        map_figure(&self.found)
    }

    /// The page that `cohaul compare --vary --out` writes.
    fn page(&self, command: String) -> String {
        map_page(&self.found, map_figure(&self.found), &manifest(&self.question, command, self.started)).to_html()
    }

    /// Writes the files of `cohaul compare --vary --out`.
    fn write(&self, folder: PathBuf, command: String) -> PyResult<()> {
        let written = write_map(&folder, &self.found, &manifest(&self.question, command, self.started));
        written.map_err(|error| PyOSError::new_err(error.to_string()))
    }
}

#[pymethods]
impl ThresholdData {
    /// What `cohaul compare --threshold --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.found)).map_err(no_number)
    }

    /// What `cohaul compare --threshold` prints.
    fn text(&self) -> String {
        self.found.text()
    }

    /// All numbers of all points, as `cohaul compare --threshold --out` writes them.
    fn csv(&self) -> PyResult<String> {
        csv(&self.found.table_of_points())
    }

    /// The curves as SVG.
    fn figure(&self) -> String {
        thresholds_figure(&self.found)
    }

    /// The page that `cohaul compare --threshold --out` writes.
    fn page(&self, command: String) -> String {
        thresholds_page(&self.found, thresholds_figure(&self.found), &manifest(&self.question, command, self.started)).to_html()
    }

    /// Writes the files of `cohaul compare --threshold --out`.
    fn write(&self, folder: PathBuf, command: String) -> PyResult<()> {
        let written = write_thresholds(&folder, &self.found, &manifest(&self.question, command, self.started));
        written.map_err(|error| PyOSError::new_err(error.to_string()))
    }
}
