//! Many runs on all threads, as the table that `cohaul sweep` writes.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use cohaul::backend::BackendOptions;
use cohaul_studies::sweep::{Ask, Axis, Design, Plan, Sample, SweepError, Values, Variant, head_of, validate, work};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::Value;

use crate::options::{Asked, check_step, named, read, refused};
use crate::scene::{Scene, faults};
use crate::work::{computed, pool};

/// Rows of a sweep.
#[pyclass(frozen, module = "cohaul._native")]
pub struct SweepData {
    /// Name and kind of each column.
    #[pyo3(get)]
    columns: Vec<(String, String)>,
    /// The table as CSV, in the order of the cells.
    #[pyo3(get)]
    csv: String,
    #[pyo3(get)]
    n_rows: u64,
}

/// What is varied, from Python.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskedSweep {
    /// Path and values of each parameter: a list, or a text such as `log:1e-4:1e-2:7`.
    vary: Vec<(String, Value)>,
    sample: Option<(String, u64, Option<u64>)>,
    variants: Vec<Asked>,
    first_seed: Option<u64>,
    n_seeds: u64,
}

/// Runs every cell of the sweep.
#[pyfunction]
#[pyo3(signature = (scene, asked, threads, progress))]
pub fn sweep(py: Python, scene: &Scene, asked: &str, threads: Option<usize>, progress: Option<Py<PyAny>>) -> PyResult<SweepData> {
    let plan = plan(scene, read(asked)?)?;
    let n_cells = plan.identity.n_cells;
    if n_cells > MOST_CELLS {
        return Err(refused(
            "sweep",
            &format!("must have at most {MOST_CELLS} runs, which stay in memory; `cohaul sweep` takes more"),
            n_cells,
        ));
    }
    let pool = pool(threads)?;
    let lines = computed(py, progress, |watch| {
        let n_done = AtomicU64::new(0);
        let go_on = || watch.go_on(n_done.load(Relaxed) as f64 / n_cells as f64);
        validate(&plan, 0..n_cells, &pool, go_on)?;
        let mut lines = vec![String::new(); n_cells as usize];
        work(
            &plan,
            0..n_cells,
            &pool,
            |_| false,
            go_on,
            |cell, line| {
                line.clone_into(&mut lines[cell as usize]);
                n_done.fetch_add(1, Relaxed);
                Ok(())
            },
        )?;
        Ok(lines)
    })?;
    let lines: Vec<String> = lines.map_err(refusal)?;
    let columns = &plan.identity.columns;
    let csv = format!("{}\n{}\n", head_of(columns), lines.join("\n"));
    let columns = columns.iter().map(|column| (column.name.clone(), format!("{:?}", column.kind).to_lowercase())).collect();
    Ok(SweepData { columns, csv, n_rows: n_cells })
}

/// Most cells of a table in memory (1): some 1 GB.
const MOST_CELLS: u64 = 2_000_000;

fn plan(scene: &Scene, asked: AskedSweep) -> PyResult<Plan> {
    let axes = asked.vary.into_iter().map(|(path, values)| axis(&path, values)).collect::<Result<Vec<_>, _>>().map_err(refusal)?;
    let sample = match asked.sample {
        Some((method, n, seed)) => Some(Sample { method: named("sample", &method)?, n, seed }),
        None => None,
    };
    let period = scene.scenario.control_period;
    let variants: Vec<Variant> = asked.variants.iter().map(Asked::variant).collect::<PyResult<_>>()?;
    variants.iter().try_for_each(|variant| check_step(variant.step_s, period))?;
    let plan = Plan::new(Ask {
        file: scene.file.clone(),
        text: scene.text.clone(),
        design: Design::new(axes, sample).map_err(refusal)?,
        variants,
        first_seed: Some(asked.first_seed.unwrap_or(scene.scenario.seed)),
        n_seeds: asked.n_seeds,
    });
    let plan = plan.map_err(refusal)?;
    let options: Vec<BackendOptions> = plan.identity.variants.iter().map(|variant| variant.options(plan.base())).collect();
    match (1..options.len()).find(|at| options[..*at].contains(&options[*at])) {
        Some(_) => Err(refused("backend, step_s", "must name every backend and step once", "one again")),
        None => Ok(plan),
    }
}

/// Values of one parameter: a list, or a text such as `log:1e-4:1e-2:7`.
///
/// # Errors
/// When they are no values.
pub fn axis(path: &str, values: Value) -> Result<Axis, SweepError> {
    match values {
        Value::String(spec) => Axis::new(path, &spec),
        Value::Array(values) => {
            if values.is_empty() || values.iter().any(|value| !value.is_number() && !value.is_string()) {
                return Err(SweepError::axis(path, "must have at least one value, all numbers or words", Value::Array(values)));
            }
            if let Some(again) = (1..values.len()).find(|at| values[..*at].contains(&values[*at])) {
                return Err(SweepError::axis(path, "must have each value once", &values[again]));
            }
            Ok(Axis { path: path.to_owned(), values: Values::List(values) })
        }
        other => Err(SweepError::axis(path, "must be a list of values or a text", other)),
    }
}

/// The exception for an error of a sweep.
pub fn refusal(error: SweepError) -> PyErr {
    match error {
        SweepError::Scenario(error) => faults(error),
        SweepError::Axis { .. } | SweepError::Point { .. } => PyValueError::new_err(error.to_string()),
        other => PyRuntimeError::new_err(other.to_string()),
    }
}
