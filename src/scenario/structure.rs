//! Comparison of the shape of a file with the schema of the format: every key that is missing,
//! unknown or of the wrong type is found at its place. Deserialization into the types of the format
//! would stop at the first fault, and could not locate it inside an untagged enum (serde issue
//! 1621). The comparison supports those parts of JSON Schema that the schema of the format uses.

use serde_json::{Map, Value};

use super::error::{Findings, cut};
use super::format;
use super::json::join;
use super::nearest::nearest;

/// Adds a finding for every difference in shape, and removes unknown keys from `value`, so that the
/// rest can still be read. Returns the paths whose value cannot be read.
pub fn compare(value: &mut Value, findings: &mut Findings) -> Vec<String> {
    let schema = format::schema();
    let mut comparison = Comparison { schema, findings, misfits: Vec::new() };
    comparison.visit(schema, value, "");
    comparison.misfits
}

struct Comparison<'a> {
    schema: &'a Value,
    findings: &'a mut Findings,
    misfits: Vec<String>,
}

impl<'a> Comparison<'a> {
    fn visit(&mut self, schema: &'a Value, value: &mut Value, path: &str) {
        let schema = self.resolved(schema);
        if let Some(words) = words(schema) {
            if !value.as_str().is_some_and(|word| words.contains(&word)) {
                self.misfit(path, &one_of_near(&words, value), &said(value));
            }
        } else if let Some(branches) = schema["oneOf"].as_array() {
            self.visit_alternative(branches, value, path);
        } else if !fits_type(schema, value) {
            self.misfit(path, &format!("must be {}", type_name(schema)), &said(value));
        } else if let Value::Object(map) = value {
            self.visit_object(schema, map, path);
        } else if let Value::Array(list) = value {
            self.visit_array(schema, list, path);
        }
    }

    fn visit_object(&mut self, schema: &'a Value, map: &mut Map<String, Value>, path: &str) {
        let Some(properties) = schema["properties"].as_object() else { return };
        map.retain(|key, value| {
            let known = properties.contains_key(key);
            if !known {
                self.findings.report(join(path, key), unknown_key(key, properties), said(value));
            }
            known
        });
        for key in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            if !map.contains_key(key) {
                self.misfit(&join(path, key), "is required", "nothing");
            }
        }
        for (key, value) in map.iter_mut() {
            self.visit(&properties[key], value, &join(path, key));
        }
        if schema["maxProperties"].as_u64().is_some_and(|n| n != map.len() as u64) {
            let keys = |map: &Map<String, Value>| map.keys().cloned().collect::<Vec<_>>().join(", ");
            let found = if map.is_empty() { "none".to_owned() } else { keys(map) };
            self.misfit(path, &format!("must have exactly one of the keys {}", keys(properties)), &found);
        }
    }

    fn visit_array(&mut self, schema: &'a Value, list: &mut [Value], path: &str) {
        if let Some(length) = schema["minItems"].as_u64().filter(|&length| length != list.len() as u64) {
            return self.misfit(path, &format!("must be a list of {length} numbers"), &said_list(list));
        }
        for (index, value) in list.iter_mut().enumerate() {
            self.visit(&schema["items"], value, &format!("{path}[{index}]"));
        }
    }

    /// Continues with the branch that `value` is meant for.
    fn visit_alternative(&mut self, branches: &'a [Value], value: &mut Value, path: &str) {
        let branches: Vec<&'a Value> = branches.iter().map(|branch| self.resolved(branch)).collect();
        let Some(key) = self.discriminator(&branches) else {
            if let Some((map, known)) = value.as_object().zip(unmatched_keys(&branches, value)) {
                // No key tells which branch is meant: those of all branches are possible.
                map.iter().for_each(|(key, value)| self.misfit(&join(path, key), &unknown_key(key, &known), &said(value)));
                return;
            }
            return match nearest_branch(&branches, value) {
                Some(branch) => self.visit(branch, value, path),
                None => {
                    let mut types: Vec<_> = branches.iter().map(|branch| type_name(branch)).collect();
                    types.dedup();
                    self.misfit(path, &format!("must be {}", types.join(" or ")), &said(value))
                }
            };
        };
        let kinds: Vec<&str> = branches.iter().filter_map(|branch| words(self.resolved(&branch["properties"][key]))).flatten().collect();
        match value.get(key) {
            None if value.is_object() => self.misfit(&join(path, key), &format!("is required and {}", one_of(&kinds)), "nothing"),
            None => self.misfit(path, "must be an object", &said(value)),
            Some(kind) => match kinds.iter().position(|word| kind == word) {
                Some(index) => self.visit(branches[index], value, path),
                None => self.misfit(&join(path, key), &one_of_near(&kinds, kind), &said(kind)),
            },
        }
    }

    /// The key that distinguishes the branches: in each of them it has only one possible word.
    fn discriminator(&self, branches: &[&'a Value]) -> Option<&'a str> {
        let is_word = |branch: &&'a Value, key: &str| {
            let property = branch.get("properties").and_then(|properties| properties.get(key));
            property.is_some_and(|schema| words(self.resolved(schema)).is_some_and(|words| words.len() == 1))
        };
        let keys = branches.first()?.get("properties")?.as_object()?.keys();
        keys.map(String::as_str).find(|key| branches.iter().all(|branch| is_word(branch, key)))
    }

    fn resolved(&self, schema: &'a Value) -> &'a Value {
        let target = schema.get("$ref").and_then(Value::as_str).and_then(|reference| reference.strip_prefix('#'));
        match target {
            Some(pointer) => self.schema.pointer(pointer).expect("the schema refers to its own definitions"),
            None => schema,
        }
    }

    fn misfit(&mut self, path: &str, rule: &str, found: &str) {
        self.findings.report(path, rule, found);
        self.misfits.push(path.to_string());
    }
}

/// The words that a schema allows, if it allows only words.
fn words(schema: &Value) -> Option<Vec<&str>> {
    if let Some(word) = schema["const"].as_str() {
        return Some(vec![word]);
    }
    if let Some(list) = schema["enum"].as_array() {
        return list.iter().map(Value::as_str).collect();
    }
    let branches = schema["oneOf"].as_array()?;
    Some(branches.iter().map(words).collect::<Option<Vec<_>>>()?.concat())
}

/// The branch of fitting type that has most of the keys of `value`; the last one of several.
fn nearest_branch<'a>(branches: &[&'a Value], value: &Value) -> Option<&'a Value> {
    let n_known = |branch: &&&'a Value| {
        let keys = value.as_object().into_iter().flat_map(Map::keys);
        keys.filter(|key| branch["properties"].get(key.as_str()).is_some()).count()
    };
    branches.iter().filter(|branch| fits_type(branch, value)).max_by_key(n_known).copied()
}

/// The keys of all branches for objects, if there are several and none has a key of `value`.
fn unmatched_keys(branches: &[&Value], value: &Value) -> Option<Map<String, Value>> {
    let fitting = || branches.iter().filter(|branch| fits_type(branch, value));
    let known: Map<String, Value> = fitting()
        .filter_map(|branch| branch["properties"].as_object())
        .flatten()
        .map(|(key, schema)| (key.clone(), schema.clone()))
        .collect();
    let keys = value.as_object()?;
    (fitting().count() > 1 && !keys.is_empty() && !keys.keys().any(|key| known.contains_key(key))).then_some(known)
}

fn fits_type(schema: &Value, value: &Value) -> bool {
    match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("number") => value.is_number(),
        // Whole numbers of the format are counts, indices or seeds.
        Some("integer") => value.is_u64(),
        Some("string") => value.is_string(),
        other => panic!("the format's schema has a type that is not supported: {other:?} in {schema}"),
    }
}

fn type_name(schema: &Value) -> &'static str {
    match schema["type"].as_str() {
        Some("object") => "an object",
        Some("array") => "a list",
        Some("integer") => "a whole number from 0 to 2^64 - 1, without decimal point or exponent",
        Some("string") => "a text",
        _ => "a number",
    }
}

fn one_of(words: &[&str]) -> String {
    let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.as_slice() {
        [only] => format!("must be {only}"),
        several => format!("must be one of {}", several.join(", ")),
    }
}

/// The same, with the word that may be meant.
fn one_of_near(words: &[&str], found: &Value) -> String {
    let near = found.as_str().and_then(|found| nearest(found, words.iter().copied()));
    near.map_or_else(|| one_of(words), |near| format!("{}; did you mean \"{near}\"?", one_of(words)))
}

/// Description of a value, short enough for one line.
fn said(value: &Value) -> String {
    const LONGEST: usize = 60;
    match value {
        Value::Object(_) => "an object".to_string(),
        Value::Array(list) => said_list(list),
        other => cut(other.to_string(), LONGEST),
    }
}

fn said_list(list: &[Value]) -> String {
    format!("a list of {}", list.len())
}

fn unknown_key(key: &str, known: &Map<String, Value>) -> String {
    match nearest(key, known.keys().map(String::as_str)) {
        Some(other) => format!("is an unknown key; did you mean `{other}`?"),
        None => format!("is an unknown key; known keys are {}", known.keys().map(String::as_str).collect::<Vec<_>>().join(", ")),
    }
}
