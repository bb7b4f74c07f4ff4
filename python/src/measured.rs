//! Measured runs beside simulated ones.

use std::time::{Instant, SystemTime};

use cohaul::formats::stamped;
use cohaul::scenario::sha256_hex;
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_report::text::Detail;
use cohaul_studies::measured::ask::{FittedScene, TableText, fitted, joined};
use cohaul_studies::measured::files::{measured_page, write_measured};
use cohaul_studies::measured::recording::{MeasuredRun, Reading};
use cohaul_studies::measured::report::{self, Beside};
use cohaul_studies::measured::run::{Question, with_rapier};
use cohaul_studies::measured::scene::{SceneTemplate, Start};
use cohaul_studies::measured::tasks;
use cohaul_studies::measured::text::text;
use pyo3::exceptions::{PyArithmeticError, PyOSError, PyValueError};
use pyo3::prelude::*;
use serde::Deserialize;

use crate::options::read;
use crate::scene::Scene;
use crate::work::{computed, pool};

/// What is asked. All but the scene's own defaults may be left out.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct AskedMeasured {
    columns: Vec<(String, String)>,
    least_confidence: f64,
    start: Option<Start>,
    smooth_m: Option<f64>,
    largest_shift_m: Option<f64>,
    longest_gap_s: Option<f64>,
    uncertainty: Option<[f64; 2]>,
    fit: Vec<String>,
    fit_runs: Option<usize>,
    tolerance_m: Option<f64>,
    with_rapier: bool,
}

impl AskedMeasured {
    fn question(&self, template: &SceneTemplate) -> Question {
        let mut question = Question { has_engine: self.with_rapier, ..Question::usual(template) };
        let preparation = &mut question.preparation;
        preparation.start = self.start.unwrap_or(preparation.start);
        preparation.bound_m = self.smooth_m;
        preparation.longest_gap_s = self.longest_gap_s;
        preparation.largest_shift_m = self.largest_shift_m.unwrap_or(preparation.largest_shift_m);
        question.settings.reference_tolerance_m = self.tolerance_m.or(question.settings.reference_tolerance_m);
        question
    }
}

/// Measured runs that were compared.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Measured {
    found: report::Measured,
    template: SceneTemplate,
    runs: Vec<MeasuredRun>,
    hash: String,
    started: SystemTime,
}

/// Compares the runs in `tables` (name, stem and CSV text of each) with simulated ones.
#[pyfunction]
#[pyo3(signature = (scene, tables, asked, threads, progress))]
pub fn measured(
    py: Python,
    scene: &Scene,
    tables: Vec<(String, String, String)>,
    asked: &str,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Measured> {
    let refused = |what: String| PyValueError::new_err(what);
    let (started, clock) = (SystemTime::now(), Instant::now());
    let asked = read::<AskedMeasured>(asked)?;
    let written = serde_json::to_string(&scene.scenario.expanded()).expect("a scenario is plain data");
    let template = SceneTemplate::new(&written, "scenario").map_err(|error| refused(error.to_string()))?;
    let reading = Reading { columns: asked.columns.clone(), least_confidence: asked.least_confidence };
    let tables: Vec<TableText> = tables.into_iter().map(|(name, stem, text)| TableText { name, stem, text }).collect();
    let (recording, hash) = joined(&tables, &template, &reading).map_err(|error| refused(error.to_string()))?;
    let (runs, question, threads) = (recording.runs, asked.question(&template), pool(threads)?);
    let uncertainty = asked.uncertainty.or_else(|| runs.iter().find_map(|run| run.uncertainty));
    let work = |watch: &crate::work::Watch| {
        threads.install(|| {
            // A fit takes about as long as half of the comparisons.
            let share = if asked.fit.is_empty() { 0.0 } else { 0.3 };
            let fit = match asked.fit[..] {
                [] => None,
                _ => {
                    match fitted(&asked.fit, asked.fit_runs, (&template, &runs), &question, uncertainty, &|done| watch.go_on(share * done))?
                    {
                        Some(fitted) => Some(fitted),
                        None => return Ok(None),
                    }
                }
            };
            let (scene, checked) = fit.as_ref().map_or((&template, &runs[..]), |fit| (&fit.template, fit.checked(&runs)));
            let compare = with_rapier(asked.with_rapier);
            let records = tasks(scene, checked, &question, &*compare).finished(&|done| watch.go_on(share + (1.0 - share) * done));
            Ok::<_, String>(records.map(|records| (records, fit)))
        })
    };
    let found = computed(py, progress, work)?.map_err(|why| refused(format!("fit: {why}")))?;
    // Only an interrupt stops the work, and that is an exception already.
    let (records, fit): (_, Option<FittedScene>) = found.expect("the work ended");
    let checked = fit.as_ref().map_or(&runs[..], |fit| fit.checked(&runs)).to_vec();
    let beside = Beside {
        scenario: template.base.name.clone(),
        recording: tables.into_iter().map(|table| table.name).collect(),
        question,
        notes: recording.notes,
        fit: fit.as_ref().map(|fit| fit.fit.clone()),
        uncertainty,
        radius: template.base.system.load.radius,
        wall_s: clock.elapsed().as_secs_f64(),
    };
    let found = report::Measured::new(records, beside);
    json::check(&found).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
    Ok(Measured { found, template: fit.map_or(template, |fit| fit.template), runs: checked, hash, started })
}

impl Measured {
    fn manifest(&self, command: String) -> Manifest {
        let scenario = self.template.base.expanded();
        let question =
            serde_json::json!({ "name": "measured", "recording": self.found.recording, "sha256": self.hash, "scenario": scenario });
        let options = serde_json::json!({ "question": self.found.question });
        Manifest::new(&question, sha256_hex(question.to_string().as_bytes()), None, &options, vec![command], self.started)
    }
}

#[pymethods]
impl Measured {
    /// What `cohaul measured --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.found)).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    /// What `cohaul measured` prints.
    fn text(&self, is_full: bool) -> String {
        text(&self.found, if is_full { Detail::Full } else { Detail::Brief })
    }

    /// The page that `cohaul measured --out` writes.
    fn page(&self, command: String) -> String {
        measured_page(&self.found, (&self.template, &self.runs, &self.found.question), &self.manifest(command)).to_html()
    }

    /// Writes the files of `cohaul measured --out`.
    fn write(&self, folder: std::path::PathBuf, command: String) -> PyResult<()> {
        let scenes = (&self.template, &self.runs[..], &self.found.question);
        write_measured(&folder, &self.found, scenes, &self.manifest(command)).map_err(|error| PyOSError::new_err(error.to_string()))
    }
}
