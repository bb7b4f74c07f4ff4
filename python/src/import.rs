//! Scenarios from recordings and drawings.

use cohaul::formats::stamped;
use cohaul::scenario::ScenarioError;
use cohaul_recordings::account::Account;
use cohaul_recordings::import::{Asked, import};
use cohaul_recordings::tracks::Reading;
use cohaul_recordings::tracks::export::{write_tips, write_tracks};
use cohaul_report::json;
use cohaul_report::lines::TableError;
use pyo3::exceptions::PyArithmeticError;
use pyo3::prelude::*;

use crate::options::read;
use crate::scene::faults;
use crate::work::{guarded, internal};

/// A scenario that was imported: its JSON, what was done, and the tables of tracks and tips.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Import {
    #[pyo3(get)]
    scenario: String,
    #[pyo3(get)]
    tracks: Option<String>,
    #[pyo3(get)]
    tips: Option<String>,
    account: Account,
}

#[pymethods]
impl Import {
    /// What `cohaul scenario import --json` prints.
    fn json(&self) -> PyResult<String> {
        json::line(&stamped(&self.account)).map_err(|error| PyArithmeticError::new_err(error.to_string()))
    }

    /// What `cohaul scenario import --out` prints.
    fn text(&self) -> String {
        self.account.text()
    }
}

/// Makes a scenario of files, each with its name, on another scenario.
#[pyfunction]
pub fn import_scenario(py: Python, files: Vec<(String, Vec<u8>)>, like: Option<(String, Vec<u8>)>, asked: &str) -> PyResult<Import> {
    let asked = read::<Asked>(asked)?;
    let files: Vec<Reading> = files.iter().map(|(file, bytes)| Reading { file, bytes }).collect();
    let like = like.as_ref().map(|(file, bytes)| Reading { file, bytes });
    let found =
        py.allow_threads(|| guarded(|| import(&files, like, &asked))).map_err(internal)?.map_err(|error| faults(keywords(error)))?;
    let table = |write: &dyn Fn(&mut Vec<u8>) -> Result<(), TableError>| {
        let mut table = Vec::new();
        write(&mut table).map_err(|error| PyArithmeticError::new_err(error.to_string()))?;
        Ok::<_, PyErr>(String::from_utf8(table).expect("a table is text"))
    };
    let tracks = found.tracks.as_ref().map(|tracks| table(&|out| write_tracks(tracks, out))).transpose()?;
    let tips = found.tips.as_ref().map(|tips| table(&|out| write_tips(tips, out).map(|_| ()))).transpose()?;
    let scenario = json::plain(&found.scenario.expanded()).to_string();
    Ok(Import { scenario, tracks, tips, account: found.account })
}

/// The error with options of the program as keywords.
fn keywords(error: ScenarioError) -> ScenarioError {
    match error {
        ScenarioError::Invalid { file, mut findings } => {
            for finding in &mut findings {
                if let Some(option) = finding.path.strip_prefix("--") {
                    finding.path = option.replace('-', "_");
                }
            }
            ScenarioError::Invalid { file, findings }
        }
        other => other,
    }
}
