//! A baseline's file: JSON with one row, event or short list a line, so that it can be read, edited by hand and compared line by line.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{Baseline, COLUMNS, reader};
use crate::output::json;
use crate::scenario::ScenarioError;

/// The value of `format` in every baseline.
pub const FORMAT: &str = "cohaul baseline";
/// The one version of the format that is read and written.
pub const VERSION: u64 = 1;

/// The keys of a file, in its order.
pub(super) const KEYS: [&str; 10] =
    ["format", "version", "build", "scenario_sha256", "scenario", "options", "tolerances", "ending", "events", "path"];

/// The baselines in the files `*.json` of a folder, in the order of their names.
///
/// # Errors
/// When the folder cannot be listed, or some files are no baselines: every fault of every file, one a line.
pub fn read_folder(folder: &Path) -> Result<Vec<Baseline>, String> {
    let listed = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<PathBuf>>>();
    let mut paths = listed().map_err(|error| format!("{}: cannot be listed: {error}", folder.display()))?;
    let is_hidden = |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "json") && !is_hidden(path));
    paths.sort();
    if paths.is_empty() {
        return Err(format!("{}: holds no baseline (*.json); `cohaul check store` makes some", folder.display()));
    }
    let (mut baselines, mut faults) = (Vec::new(), Vec::new());
    for path in &paths {
        match Baseline::read(path) {
            Ok(baseline) => baselines.push(baseline),
            Err(error) => faults.push(error.to_string()),
        }
    }
    if faults.is_empty() { Ok(baselines) } else { Err(faults.join("\n")) }
}

/// Writes a baseline to `folder/NAME.json`, whole or not at all, in place of an earlier one. The folder is made when it is missing.
///
/// # Errors
/// When the disk fails.
pub fn write_file(folder: &Path, baseline: &Baseline) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    let partial = folder.join(format!(".{}.partial-{}", baseline.name, std::process::id()));
    let write = || {
        let mut file = fs::File::create(&partial)?;
        file.write_all(baseline.to_json().as_bytes())?;
        file.sync_all()?;
        fs::rename(&partial, folder.join(baseline.file_name()))
    };
    write().inspect_err(|_| drop(fs::remove_file(&partial)))
}

impl Baseline {
    pub fn file_name(&self) -> String {
        format!("{}.json", self.name)
    }

    /// The baseline in a file.
    ///
    /// # Errors
    /// When the file cannot be read, is not JSON, or breaks a rule: then with every finding. They are told as those of a scenario.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        match fs::read_to_string(path) {
            Ok(text) => Self::parse(&text, &name, &file),
            Err(source) => Err(ScenarioError::Unreadable { file, source }),
        }
    }

    /// The baseline `name` that the JSON `text` describes; errors call it `name_for_errors`.
    ///
    /// # Errors
    /// As [`Baseline::read`].
    pub fn parse(text: &str, name: &str, name_for_errors: &str) -> Result<Self, ScenarioError> {
        reader::parse(text, name, name_for_errors)
    }

    /// The whole file. Floats have all their digits.
    pub fn to_json(&self) -> String {
        let values = [
            json!(FORMAT),
            json!(VERSION),
            json::plain(&self.build),
            json!(self.scenario.hash()),
            json::plain(&self.scenario.expanded()),
            json::plain(&self.options),
            json::plain(&self.tolerances),
            json::plain(&self.record.ending),
            json::plain(&self.record.events),
            json!({ "columns": COLUMNS, "rows": json::plain(&self.record.rows) }),
        ];
        let sections = KEYS.iter().zip(&values).map(|(key, value)| format!("  \"{key}\": {}", layout(value, 2)));
        format!("{{\n{}\n}}\n", sections.collect::<Vec<_>>().join(",\n"))
    }
}

/// A value as text: what is short or a list of plain values on one line, the rest with an entry a line, indented by `indent` and two more.
fn layout(value: &Value, indent: usize) -> String {
    const WIDTH: usize = 100;
    let whole = value.to_string();
    let is_plain = |value: &Value| !value.is_object() && !value.is_array();
    let inner = " ".repeat(indent + 2);
    let (open, entries, close) = match value {
        Value::Array(list) if whole.len() > WIDTH && !list.iter().all(is_plain) => {
            ('[', list.iter().map(|entry| format!("{inner}{}", layout(entry, indent + 2))).collect::<Vec<_>>(), ']')
        }
        Value::Object(map) if whole.len() > WIDTH => {
            let entry = |(key, value): (&String, &Value)| format!("{inner}{}: {}", json!(key), layout(value, indent + 2));
            ('{', map.iter().map(entry).collect(), '}')
        }
        _ => return whole,
    };
    format!("{open}\n{}\n{}{close}", entries.join(",\n"), " ".repeat(indent))
}
