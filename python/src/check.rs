//! Stored baselines, and how runs differ from them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use cohaul::formats::stamped;
use cohaul::scenario::{Scenario, sha256_hex};
use cohaul::simulation::Health;
use cohaul_report::account_words;
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_studies::check as baselines;
use cohaul_studies::check::report::{CheckReport, check_text, this_build, write_check};
use cohaul_studies::check::{Baseline, Settings, Verdict, read_folder, usual_name, write_file};
use pyo3::exceptions::{PyArithmeticError, PyFileExistsError, PyOSError, PyValueError};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::options::{Asked, read, refused};
use crate::scene::{Scene, faults};
use crate::work::{computed, pool};

/// A finished check.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Check {
    report: CheckReport,
    started: SystemTime,
}

/// Runs the baselines of a folder again: all of them, or those of these names. With `scene`, that
/// one runs in place of the stored ones. `accepts` stores the new runs of those that differ.
#[pyfunction]
#[pyo3(signature = (folder, names, scene, is_exact, accepts, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn check(
    py: Python,
    folder: PathBuf,
    names: Option<Vec<String>>,
    scene: Option<&Scene>,
    is_exact: bool,
    accepts: bool,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Check> {
    let stored = match names {
        None => read_folder(&folder).map_err(PyValueError::new_err)?,
        Some(names) => names.iter().map(|name| named_baseline(&folder, name)).collect::<PyResult<_>>()?,
    };
    let (started, clock, threads) = (SystemTime::now(), Instant::now(), pool(threads)?);
    let settings = Settings { scenario: scene.map(|scene| Scenario::clone(&scene.scenario)), exact: is_exact };
    let work =
        |watch: &crate::work::Watch| threads.install(|| baselines::check(&stored, &settings, &this_build(), |share| watch.go_on(share)));
    // Only an interrupt stops the work, and that is an exception already.
    let checks = computed(py, progress, work)?.expect("the work ended");
    let mut report = CheckReport::new(checks, is_exact, clock.elapsed().as_secs_f64());
    if accepts {
        accept(&folder, &mut report)?;
    }
    json::check(&report).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Check { report, started })
}

fn named_baseline(folder: &Path, name: &str) -> PyResult<Baseline> {
    check_name(name)?;
    Baseline::read(&folder.join(format!("{name}.json"))).map_err(faults)
}

/// # Errors
/// When it is not the name of a file without its folder.
fn check_name(name: &str) -> PyResult<()> {
    let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name) && !name.starts_with('.');
    if is_plain { Ok(()) } else { Err(refused("name", "must be that of a file without its folder", format!("{name:?}"))) }
}

/// Stores each new result that differs from its baseline or belongs to another scenario.
fn accept(folder: &Path, report: &mut CheckReport) -> PyResult<()> {
    for check in &report.baselines {
        let is_new = match check.verdict {
            Verdict::Agrees => !check.scenario_changes.is_empty(),
            Verdict::Differs => true,
            Verdict::NotComputed => false,
        };
        if is_new {
            write_file(folder, &check.found).map_err(|error| PyOSError::new_err(error.to_string()))?;
            report.accepted.push(check.name.clone());
        }
    }
    Ok(())
}

/// Runs a scene and stores the result as a baseline in a folder. Returns its file.
#[pyfunction]
#[pyo3(signature = (scene, folder, name, stem, options, n_rows, replaces, progress))]
#[expect(clippy::too_many_arguments, reason = "Python names them")]
pub fn store_baseline(
    py: Python,
    scene: &Scene,
    folder: PathBuf,
    name: Option<String>,
    stem: &str,
    options: &str,
    n_rows: usize,
    replaces: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<PathBuf> {
    let scenario = &scene.scenario;
    let options = read::<Asked>(options)?.options(scenario)?;
    let name = name.unwrap_or_else(|| usual_name(stem, scenario, &options));
    check_name(&name)?;
    let path = folder.join(format!("{name}.json"));
    if path.exists() && !replaces {
        return Err(PyFileExistsError::new_err(format!(
            "{}: already exists; replace=True stores it anew, with new tolerances",
            path.display()
        )));
    }
    let run = computed(py, progress, |watch| baselines::run(scenario, &options, |time| watch.go_on(time / scenario.duration)))?;
    // Only an interrupt stops a run, and that is an exception already.
    let (trace, outcome) = run.expect("the run ended");
    if outcome.account.health == Health::Failed {
        let cause = account_words::cause(&outcome.account).unwrap_or_default();
        return Err(PyArithmeticError::new_err(format!("{}: not stored: {cause}", path.display())));
    }
    let baseline = Baseline::of(&name, scenario, &options, &this_build(), (&trace, &outcome), n_rows);
    write_file(&folder, &baseline).map_err(|error| PyOSError::new_err(error.to_string()))?;
    Ok(path)
}

#[pymethods]
impl Check {
    /// What `cohaul check --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.report)).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    /// What `cohaul check` prints.
    fn text(&self) -> String {
        check_text(&self.report)
    }

    /// Writes the files of `cohaul check --out`.
    fn write(&self, folder: PathBuf, command: String) -> PyResult<()> {
        let checks = &self.report.baselines;
        let scenarios: BTreeMap<&str, Value> = checks.iter().map(|of| (&*of.name, json::plain(&of.found.scenario.expanded()))).collect();
        let options: BTreeMap<&str, Value> = checks.iter().map(|of| (&*of.name, json!(of.options))).collect();
        let question = json!(scenarios);
        let options = json!({ "exact": self.report.exact, "baselines": options });
        let hash = sha256_hex(question.to_string().as_bytes());
        let manifest = Manifest::new(&question, hash, None, &options, vec![command], self.started);
        write_check(&folder, &self.report, &manifest).map_err(|error| PyOSError::new_err(error.to_string()))
    }
}
