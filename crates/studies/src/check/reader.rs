//! Reads a baseline's file and names every fault: unknown, missing and repeated keys, values of
//! another type, and broken rules.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::baseline::{Baseline, Build};
use super::format::{FORMAT, KEYS, PathEntry, VERSION};
use super::record::{Ending, Event, Record};
use super::rules;
use super::tolerance::Tolerances;
use cohaul::backend::BackendOptions;
use cohaul::scenario::bounded::{MOST_BYTES_OF_TABLE, read_text};
use cohaul::scenario::json::{join, read};
use cohaul::scenario::{Finding, Findings, Scenario, ScenarioError};

/// Baselines in the files `*.json` of a folder, in the order of their names.
///
/// # Errors
/// When the folder cannot be listed, or with every fault of every file, one on each line.
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

impl Baseline {
    /// The baseline in a file.
    ///
    /// # Errors
    /// When the file cannot be read or is not JSON, or with every broken rule.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        match File::open(path).and_then(|file| read_text(file, MOST_BYTES_OF_TABLE)) {
            Ok(text) => Self::parse(&text, &name, &file),
            Err(source) => Err(ScenarioError::Unreadable { file, source }),
        }
    }

    /// The baseline `name` in a JSON text; errors call the text `name_for_errors`.
    ///
    /// # Errors
    /// As [`Baseline::read`].
    pub fn parse(text: &str, name: &str, name_for_errors: &str) -> Result<Self, ScenarioError> {
        let (value, findings) = read(text).map_err(|error| error.of_file(name_for_errors))?;
        let mut reader = Reader { value, findings };
        match reader.baseline(name) {
            Some(baseline) if reader.findings.0.is_empty() => Ok(baseline),
            _ => Err(ScenarioError::Invalid { file: name_for_errors.to_owned(), findings: reader.findings.0 }),
        }
    }
}

/// Sections of a file that are still to be read, and the findings so far.
struct Reader {
    value: Value,
    findings: Findings,
}

impl Reader {
    /// The baseline, or `None` when a section cannot be read.
    fn baseline(&mut self, name: &str) -> Option<Baseline> {
        self.check_head()?;
        let build = self.section::<Build>("build", true);
        let scenario = self.scenario();
        // A file of an earlier build may not know all options of this one.
        let options = self.section::<BackendOptions>("options", false);
        let tolerances = self.section::<Tolerances>("tolerances", true);
        let ending = self.section::<Ending>("ending", true);
        let events = self.section::<Vec<Event>>("events", true);
        let path = self.section::<PathEntry>("path", true);
        if let Some(options) = &options {
            rules::options(options, &mut self.findings);
        }
        if let Some(tolerances) = &tolerances {
            rules::tolerances(tolerances, &mut self.findings);
        }
        if let Some(path) = &path {
            rules::path(path, ending.as_ref(), &mut self.findings);
        }
        if let Some(events) = &events {
            rules::events(events, ending.as_ref(), scenario.as_ref(), &mut self.findings);
        }
        if let Some(ending) = &ending {
            rules::ending(ending, scenario.as_ref(), &mut self.findings);
        }
        let record = Record { rows: path?.rows, events: events?, ending: ending? };
        Some(Baseline { name: name.to_owned(), scenario: scenario?, options: options?, build: build?, tolerances: tolerances?, record })
    }

    /// Checks format, version and keys; `None` when nothing else in the file can be checked.
    fn check_head(&mut self) -> Option<()> {
        let Value::Object(map) = &self.value else {
            self.findings.report("", "must be an object", text_of(&self.value));
            return None;
        };
        let heads = [("format", json!(FORMAT), ""), ("version", json!(VERSION), ", the one that this program reads")];
        for (key, must, note) in heads {
            let found = map.get(key);
            if found != Some(&must) {
                self.findings.report(key, format!("must be {must}{note}"), text_or_nothing(found));
                return None;
            }
        }
        for (key, value) in map.iter().filter(|(key, _)| !KEYS.contains(&key.as_str())) {
            self.findings.report(key, format!("is an unknown key; known here: {}", KEYS.join(", ")), text_of(value));
        }
        Some(())
    }

    fn scenario(&mut self) -> Option<Scenario> {
        let hash = self.section::<String>("scenario_sha256", true);
        let given = self.take("scenario")?;
        let scenario = match Scenario::parse(&given.to_string(), "scenario") {
            Ok(scenario) => scenario,
            Err(error) => {
                let inside = |finding: &Finding| Finding { path: join("scenario", &finding.path), ..finding.clone() };
                self.findings.0.extend(error.findings().iter().map(inside));
                return None;
            }
        };
        // Another build may expand the scenario differently, and its hash cannot be checked any
        // more.
        let is_expanded = serde_json::to_value(scenario.expanded()).is_ok_and(|expanded| expanded == given);
        if is_expanded && hash.as_ref().is_some_and(|hash| *hash != scenario.hash()) {
            let rule = format!("must be the hash of the scenario beside it, {}; a changed scenario is stored anew", scenario.hash());
            self.findings.report("scenario_sha256", rule, text_of(&json!(hash)));
        }
        Some(scenario)
    }

    /// One section. Unknown keys are faults, and so are missing keys when all are `required`.
    fn section<T: DeserializeOwned + Serialize>(&mut self, key: &str, required: bool) -> Option<T> {
        let given = self.take(key)?;
        match serde_path_to_error::deserialize::<_, T>(&given) {
            Ok(read) => {
                let known = serde_json::to_value(&read).expect("a baseline is plain data");
                self.compare_keys(key, &given, &known, required);
                Some(read)
            }
            Err(error) => {
                let inner = error.path().to_string();
                let path = if inner == "." { key.to_owned() } else { join(key, &inner).replace(".[", "[") };
                self.findings.report(path, format!("cannot be read: {}", error.inner()), text_or_nothing(value_at(&given, &inner)));
                None
            }
        }
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        let value = self.value.get_mut(key).map(Value::take);
        if value.is_none() {
            self.findings.report(key, "is required", "nothing");
        }
        value
    }

    fn compare_keys(&mut self, path: &str, given: &Value, known: &Value, required: bool) {
        match (given, known) {
            (Value::Object(given), Value::Object(known)) => {
                for (key, value) in given {
                    match known.get(key) {
                        Some(known) => self.compare_keys(&join(path, key), value, known, required),
                        None => {
                            let names: Vec<_> = known.keys().map(String::as_str).collect();
                            self.findings.report(
                                join(path, key),
                                format!("is an unknown key; known here: {}", names.join(", ")),
                                text_of(value),
                            );
                        }
                    }
                }
                for key in known.keys().filter(|key| required && !given.contains_key(*key)) {
                    self.findings.report(join(path, key), "is required", "nothing");
                }
            }
            (Value::Array(given), Value::Array(known)) => {
                for (at, (given, known)) in given.iter().zip(known).enumerate() {
                    self.compare_keys(&format!("{path}[{at}]"), given, known, required);
                }
            }
            _ => {}
        }
    }
}

/// Value at a path of keys and indices such as `a.b[2]`, if there is one.
fn value_at<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    let mut steps = path.split(['.', '[']).map(|step| step.trim_end_matches(']')).filter(|step| !step.is_empty());
    steps.try_fold(value, |at, step| match at {
        Value::Array(list) => list.get(step.parse::<usize>().ok()?),
        other => other.get(step),
    })
}

fn text_or_nothing(value: Option<&Value>) -> String {
    value.map_or("nothing".to_owned(), text_of)
}

/// Text of a value, short enough for one line.
fn text_of(value: &Value) -> String {
    const LONGEST: usize = 60;
    match value {
        Value::Object(_) => "an object".to_owned(),
        Value::Array(list) => format!("a list of {}", list.len()),
        other => {
            let text = other.to_string();
            if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST).chain("...".chars()).collect() }
        }
    }
}
