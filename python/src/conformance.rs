//! Questions with closed answers, put to an engine.

use std::time::SystemTime;

use cohaul::analysis::compare::EngineName;
use cohaul::backend::{BackendKind, BackendOptions, RapierOptions};
use cohaul::formats::stamped;
use cohaul::scenario::sha256_hex;
use cohaul_engines::Engine;
use cohaul_engines::engine::Open;
use cohaul_report::json;
use cohaul_report::manifest::{Libraries, Manifest};
use cohaul_report::text::Detail;
use cohaul_studies::conformance::files::{conformance_page, write_conformance};
use cohaul_studies::conformance::report::{self, conformance_markdown, conformance_text};
use cohaul_studies::conformance::{STEPS_S, all, first_scene, tasks};
use cohaul_studies::subject::{Meet, built_in, of_user};
use pyo3::exceptions::{PyArithmeticError, PyOSError, PyValueError};
use pyo3::prelude::*;

use crate::engine::Written;
use crate::options::{named, refused};
use crate::work::{computed, pool};

/// A finished conformance table.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Conformance {
    found: report::Conformance,
    started: SystemTime,
}

/// Asks an engine: one of the package by its name, or one that `make` makes.
#[pyfunction]
#[pyo3(signature = (name, make, step_s, threads, progress))]
pub fn conformance(
    py: Python,
    name: &str,
    make: Option<Py<PyAny>>,
    step_s: f64,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Conformance> {
    if !STEPS_S.contains(&step_s) {
        return Err(refused("step_s", &format!("must be from {:e} to {}", STEPS_S.start(), STEPS_S.end()), step_s));
    }
    let threads = pool(threads)?;
    let started = SystemTime::now();
    let ask = |engine: &EngineName, meet: &Meet, has_inertia: bool| {
        let tests = all();
        let tasks = tasks(&tests, meet, step_s, has_inertia);
        let answers = computed(py, progress, |watch| threads.install(|| tasks.finished(&|share| watch.go_on(share))))?;
        // Only an interrupt stops the work, and that is an exception already.
        Ok::<_, PyErr>(report::Conformance::new(engine.clone(), step_s, &tests, answers.expect("the work ended")))
    };
    let found = match make {
        None => {
            let kind = named::<BackendKind>("engine", name)?;
            ask(&Libraries::engine(kind), &built_in(kind, RapierOptions::default()), kind.has_inertia())
        }
        Some(make) => {
            let written = Written::new(py, make)?;
            let open = || written.open();
            let open: &Open = &open;
            let options = BackendOptions::new(BackendKind::Rapier, step_s);
            let met = py.allow_threads(|| Engine::meet(open, &first_scene(step_s), &options));
            written.check()?;
            let met = met.map_err(|what| PyValueError::new_err(format!("engine: {what}")))?;
            ask(met.name(), &of_user(&met), true)
        }
    }?;
    json::check(&found).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Conformance { found, started })
}

impl Conformance {
    fn manifest(&self, command: String) -> Manifest {
        let question = serde_json::json!({ "name": "conformance", "tests": self.found.questions() });
        let options = serde_json::json!({ "engine": self.found.engine, "step_s": self.found.step_s });
        Manifest::new(&question, sha256_hex(question.to_string().as_bytes()), None, &options, vec![command], self.started)
    }
}

#[pymethods]
impl Conformance {
    /// What `cohaul conformance --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.found)).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    /// What `cohaul conformance` prints.
    fn text(&self, is_full: bool) -> String {
        conformance_text(&self.found, if is_full { Detail::Full } else { Detail::Brief })
    }

    fn markdown(&self) -> String {
        conformance_markdown(&self.found)
    }

    /// The page that `cohaul conformance --out` writes.
    fn page(&self, command: String) -> String {
        conformance_page(&self.found, &self.manifest(command)).to_html()
    }

    /// Writes the files of `cohaul conformance --out`.
    fn write(&self, folder: std::path::PathBuf, command: String) -> PyResult<()> {
        write_conformance(&folder, &self.found, &self.manifest(command)).map_err(|error| PyOSError::new_err(error.to_string()))
    }
}
