//! A stored run: what was run, how, by what, and what came out.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::record::Record;
use super::tolerance::Tolerances;
use cohaul::backend::{BackendOptions, default_step};
use cohaul::scenario::Scenario;
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Outcome, Trace};

#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    /// Name of its file, without folder and ending.
    pub name: String,
    pub scenario: Scenario,
    pub options: BackendOptions,
    /// Versions of the build that ran it.
    pub build: Build,
    pub tolerances: Tolerances,
    pub record: Record,
}

/// Names and versions of the program, its libraries and the machine.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Build(pub BTreeMap<String, String>);

impl Build {
    pub const COMMIT: &str = "commit";
}

impl Baseline {
    /// Baseline of a run with the default tolerances and at most `n_rows` rows.
    pub fn of(name: &str, scenario: &Scenario, options: &BackendOptions, build: &Build, run: (&Trace, &Outcome), n_rows: usize) -> Self {
        let (trace, outcome) = run;
        let record = Record::of(trace, &Run { scenario, options, outcome, path_length: None, wall_time: None }, n_rows);
        Self {
            name: name.to_owned(),
            scenario: scenario.clone(),
            options: *options,
            build: build.clone(),
            tolerances: Tolerances::of(scenario, options, &record.rows),
            record,
        }
    }
}

/// Usual name of a baseline of the scenario file `stem`: the backend, and each option that differs
/// from its default.
pub fn usual_name(stem: &str, scenario: &Scenario, options: &BackendOptions) -> String {
    let step = default_step(options.kind, &scenario.system, scenario.control_period);
    let value = |options: &BackendOptions| serde_json::to_value(options).expect("options are plain data");
    let mut words = vec![stem.to_owned(), options.kind.name().to_owned()];
    unusual("", &value(options), &value(&BackendOptions::new(options.kind, step)), &mut words);
    words.join("-")
}

/// Adds a word for each value that differs from that in `usual`.
fn unusual(key: &str, value: &Value, usual: &Value, words: &mut Vec<String>) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| unusual(key, value, &usual[key], words)),
        _ if value == usual => {}
        Value::String(word) => words.push(word.clone()),
        other => words.push(format!("{}-{other}", key.replace('_', "-"))),
    }
}
