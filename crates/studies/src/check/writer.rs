//! Writes a baseline as JSON with one row, event or short list on each line, so that it can be
//! read, edited by hand and compared line by line.

use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::baseline::Baseline;
use super::format::{FORMAT, KEYS, VERSION};
use super::measure::COLUMNS;
use cohaul_report::json;
use cohaul_report::sibling::write_whole;

/// Writes a baseline to `folder/NAME.json`, whole or not at all, and replaces an earlier one. The
/// folder is created when it is missing.
///
/// # Errors
/// When the disk fails.
pub fn write_file(folder: &Path, baseline: &Baseline) -> std::io::Result<()> {
    write_whole(&folder.join(baseline.file_name()), |file| file.write_all(baseline.to_json().as_bytes()))
}

impl Baseline {
    pub fn file_name(&self) -> String {
        format!("{}.json", self.name)
    }

    /// Text of the file, with every digit.
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

/// Text of a value. A short value or a list of plain values is one line; any other has one line for
/// each entry, indented by two more than `indent`.
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
