//! Changes besides those of the run: keys of the scenario, versions and the machine.

use serde::Serialize;
use serde_json::Value;

use super::baseline::Build;
use cohaul::scenario::Scenario;

/// A key of the expanded scenario whose value has changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScenarioChange {
    /// Keys joined by dots, indices in brackets.
    pub path: String,
    /// `null` where there was nothing.
    pub stored: Value,
    /// `null` where there is nothing.
    pub now: Value,
}

/// A change of a library, the program or the machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BuildChange {
    pub what: String,
    pub stored: Option<String>,
    pub now: Option<String>,
}

/// Every difference between two expanded scenarios.
pub fn of_scenarios(stored: &Scenario, now: &Scenario) -> Vec<ScenarioChange> {
    let [stored, now] = [stored, now].map(|scenario| serde_json::to_value(scenario.expanded()).expect("a scenario is plain data"));
    let mut changes = Vec::new();
    visit("", &stored, &now, &mut changes);
    changes
}

fn visit(path: &str, stored: &Value, now: &Value, changes: &mut Vec<ScenarioChange>) {
    match (stored, now) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                visit(&inner, a.get(key).unwrap_or(&Value::Null), b.get(key).unwrap_or(&Value::Null), changes);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for at in 0..a.len().max(b.len()) {
                visit(&format!("{path}[{at}]"), a.get(at).unwrap_or(&Value::Null), b.get(at).unwrap_or(&Value::Null), changes);
            }
        }
        _ if stored != now => changes.push(ScenarioChange { path: path.to_owned(), stored: stored.clone(), now: now.clone() }),
        _ => {}
    }
}

/// Every difference between two builds, except their commits.
pub fn of_builds(stored: &Build, now: &Build) -> Vec<BuildChange> {
    let added = now.0.keys().filter(|key| !stored.0.contains_key(*key));
    let what = stored.0.keys().chain(added).filter(|key| *key != Build::COMMIT && stored.0.get(*key) != now.0.get(*key));
    what.map(|key| BuildChange { what: key.clone(), stored: stored.0.get(key).cloned(), now: now.0.get(key).cloned() }).collect()
}
