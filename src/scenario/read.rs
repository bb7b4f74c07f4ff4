//! From a file to a scenario.

use std::fs::File;
use std::path::Path;

use serde_json::Value;

use super::bounded::{MOST_BYTES, read_text};
use super::data::Scenario;
use super::error::{Finding, ScenarioError};
use super::{json, structure, validate};
use crate::formats::SCENARIO;

impl Scenario {
    /// The scenario in the JSON file at `path`.
    ///
    /// # Errors
    /// When the file cannot be read, is larger than 64 MiB, is not JSON, or breaks rules of the
    /// format. The error lists every broken rule.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let name = path.display().to_string();
        match File::open(path).and_then(|file| read_text(file, MOST_BYTES)) {
            Ok(text) => Self::parse(&text, &name),
            Err(source) => Err(ScenarioError::Unreadable { file: name, source }),
        }
    }

    /// The scenario in the JSON `text`. Errors name the file `name_for_errors`.
    ///
    /// ```
    /// use cohaul::scenario::Scenario;
    ///
    /// let text = r#"{
    ///     "name": "a slide", "duration_s": 1, "control_period_s": 0.001,
    ///     "load": { "mass_kg": -0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.2, 0] },
    ///     "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
    ///     "springs": [],
    ///     "drive": { "kind": "tips", "paths": [] }
    /// }"#;
    /// let error = Scenario::parse(text, "slide.json").unwrap_err();
    /// assert_eq!(error.to_string(), "slide.json: load.mass_kg: must be positive, found -0.0016");
    /// ```
    ///
    /// # Errors
    /// When the text is not JSON or breaks rules of the format, as for [`Scenario::read`].
    pub fn parse(text: &str, name_for_errors: &str) -> Result<Self, ScenarioError> {
        let (mut value, mut findings) = json::read(text).map_err(|error| error.of_file(name_for_errors))?;
        if let Some(finding) = newer_version(&value) {
            return Err(ScenarioError::Invalid { file: name_for_errors.to_string(), findings: vec![finding] });
        }
        let misfits = structure::compare(&mut value, &mut findings);
        let draft = validate::Draft::read(value, &misfits, &mut findings);
        validate::scenario(draft, findings).map_err(|findings| ScenarioError::Invalid { file: name_for_errors.to_string(), findings })
    }
}

/// The only finding of a file of a newer version, whose other keys this program does not know.
fn newer_version(value: &Value) -> Option<Finding> {
    let found = value.get("format")?.as_u64().filter(|found| *found > u64::from(SCENARIO.version))?;
    Some(Finding { path: "format".to_owned(), rule: SCENARIO.version_rule(), found: found.to_string() })
}
