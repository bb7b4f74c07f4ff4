//! From a baseline's file to a baseline. Every fault is named: keys that are unknown, missing or given twice, values of another type, and what
//! breaks a rule.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::file::KEYS;
use super::rules::{self, Faults};
use super::{Baseline, Build, Ending, Event, FORMAT, Record, Row, Tolerances, VERSION};
use crate::backend::BackendOptions;
use crate::scenario::json::{join, read};
use crate::scenario::{Finding, Scenario, ScenarioError};

/// Rows under the names of their columns.
#[derive(Serialize, Deserialize)]
pub struct PathEntry {
    pub columns: Vec<String>,
    pub rows: Vec<Row>,
}

/// # Errors
/// As [`Baseline::read`].
pub fn parse(text: &str, name: &str, name_for_errors: &str) -> Result<Baseline, ScenarioError> {
    let (value, twice) = read(text).map_err(|error| error.of_file(name_for_errors))?;
    let mut reader = Reader { value, faults: Faults(twice.0) };
    match reader.baseline(name) {
        Some(baseline) if reader.faults.0.is_empty() => Ok(baseline),
        _ => Err(ScenarioError::Invalid { file: name_for_errors.to_owned(), findings: reader.faults.0 }),
    }
}

/// A file on its way to a baseline.
struct Reader {
    value: Value,
    faults: Faults,
}

impl Reader {
    /// `None` when a section cannot be read; faults say why.
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
            rules::options(options, &mut self.faults);
        }
        if let Some(tolerances) = &tolerances {
            rules::tolerances(tolerances, &mut self.faults);
        }
        if let Some(path) = &path {
            rules::path(path, ending.as_ref(), &mut self.faults);
        }
        if let Some(events) = &events {
            rules::events(events, ending.as_ref(), scenario.as_ref(), &mut self.faults);
        }
        if let Some(ending) = &ending {
            rules::ending(ending, scenario.as_ref(), &mut self.faults);
        }
        let record = Record { rows: path?.rows, events: events?, ending: ending? };
        Some(Baseline { name: name.to_owned(), scenario: scenario?, options: options?, build: build?, tolerances: tolerances?, record })
    }

    /// Format, version and keys; `None` when nothing else can be told of such a file.
    fn check_head(&mut self) -> Option<()> {
        let Value::Object(map) = &self.value else {
            self.faults.report("", "must be an object", said(&self.value));
            return None;
        };
        let heads = [("format", json!(FORMAT), ""), ("version", json!(VERSION), ", the one that this program reads")];
        for (key, must, note) in heads {
            let found = map.get(key);
            if found != Some(&must) {
                self.faults.report(key, format!("must be {must}{note}"), said_or_nothing(found));
                return None;
            }
        }
        for (key, value) in map.iter().filter(|(key, _)| !KEYS.contains(&key.as_str())) {
            self.faults.report(key, format!("is an unknown key; known here: {}", KEYS.join(", ")), said(value));
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
                self.faults.0.extend(error.findings().iter().map(inside));
                return None;
            }
        };
        // What another build of the format would expand differently had another hash there, which cannot be told any more.
        let is_expanded = serde_json::to_value(scenario.expanded()).is_ok_and(|expanded| expanded == given);
        if is_expanded && hash.as_ref().is_some_and(|hash| *hash != scenario.hash()) {
            let rule = format!("must be the hash of the scenario beside it, {}; a changed scenario is stored anew", scenario.hash());
            self.faults.report("scenario_sha256", rule, said(&json!(hash)));
        }
        Some(scenario)
    }

    /// A section as its type; keys that the type does not know are faults, and those that the file has not when all are `required`.
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
                self.faults.report(&path, format!("cannot be read: {}", error.inner()), said_or_nothing(value_at(&given, &inner)));
                None
            }
        }
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        let value = self.value.get_mut(key).map(Value::take);
        if value.is_none() {
            self.faults.report(key, "is required", "nothing");
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
                            self.faults.report(
                                &join(path, key),
                                format!("is an unknown key; known here: {}", names.join(", ")),
                                said(value),
                            );
                        }
                    }
                }
                for key in known.keys().filter(|key| required && !given.contains_key(*key)) {
                    self.faults.report(&join(path, key), "is required", "nothing");
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

/// The value at a path of keys and indices as `a.b[2]`, if it leads somewhere.
fn value_at<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    let mut steps = path.split(['.', '[']).map(|step| step.trim_end_matches(']')).filter(|step| !step.is_empty());
    steps.try_fold(value, |at, step| match at {
        Value::Array(list) => list.get(step.parse::<usize>().ok()?),
        other => other.get(step),
    })
}

fn said_or_nothing(value: Option<&Value>) -> String {
    value.map_or("nothing".to_owned(), said)
}

/// What stands there, short enough for one line.
fn said(value: &Value) -> String {
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
