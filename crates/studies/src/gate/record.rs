//! Stored errors of an engine on scenes, and their file.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use cohaul::analysis::compare::EngineName;
use cohaul::formats::{self, Format, Versioned, stamped};
use cohaul::scenario::Scenario;
use cohaul_report::json;
use cohaul_report::sibling::write_whole;

/// Errors of a build of an engine on scenes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub engine: EngineName,
    /// Version of the program that found the errors.
    pub cohaul: String,
    /// Longest step of the engine (s); `null` for the default of each scene.
    pub step_s: Option<f64>,
    pub scenes: Vec<SceneRecord>,
}

/// Errors on one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    pub name: String,
    /// The scenario as run, defaults filled in.
    pub scenario: Value,
    /// Why the engine does not take the scene; else left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Why there are no errors; else left out. A record with such a scene is never stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    pub quantities: Vec<Quantity>,
}

/// Errors of one quantity: of a path or a heading the largest, of others those of their numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Such as `path`.
    pub quantity: String,
    pub unit: String,
    pub errors: Vec<Error>,
}

/// Error of one number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Error {
    /// Such as `peak pull of spring 0`.
    pub name: String,
    /// Distance of the engine from the inertial run, in the unit.
    pub engine_error: f64,
    /// What that is known to, in the unit.
    pub reference_error: f64,
    /// Largest error that counts as agreement, in the unit.
    pub tolerance: f64,
}

impl Versioned for Record {
    const FORMAT: Format = formats::GATE_RECORD;
}

/// File of an engine in the folder of a gate: its name in plain letters.
pub fn file_name(engine: &str) -> String {
    let plain = |letter: char| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '-' };
    format!("{}.json", engine.trim_start_matches('.').chars().map(plain).collect::<String>())
}

impl Record {
    /// Writes the record, whole or not at all, in place of an earlier one.
    ///
    /// # Errors
    /// When a number is not finite, or the disk fails.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        let text = json::pretty(&stamped(self)).map_err(std::io::Error::other)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))
    }
}

impl SceneRecord {
    /// The scenario as it was run.
    ///
    /// # Errors
    /// When it is none that this program reads, in words.
    pub fn scenario(&self) -> Result<Scenario, String> {
        Scenario::parse(&self.scenario.to_string(), &self.name).map_err(|error| error.to_string())
    }
}
