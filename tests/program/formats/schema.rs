//! Key paths of scenarios, from the schema: it has all keys, and the program reads by it.

use cohaul::scenario::format::schema;
use serde_json::Value;

use crate::keys::{Keys, join};

/// All keys of a scenario. A part of a compound outline has the keys of an outline again, and is
/// entered once.
pub fn keys() -> Keys {
    let mut keys = Keys::new();
    visit(&mut keys, "", schema(), &[]);
    keys
}

fn visit(keys: &mut Keys, path: &str, schema_here: &Value, above: &[&str]) {
    if let Some(name) = schema_here["$ref"].as_str() {
        if !above.contains(&name) {
            let definition = schema().pointer(name.trim_start_matches('#')).expect("the schema refers to its own definitions");
            visit(keys, path, definition, &[above, &[name]].concat());
        }
        return;
    }
    if let Some(branches) = schema_here["oneOf"].as_array() {
        branches.iter().for_each(|branch| visit(keys, path, branch, above));
        return;
    }
    let types = type_of(schema_here);
    if !path.is_empty() {
        keys.entry(path.to_owned()).or_default().insert(types.to_owned());
    }
    for (key, value) in schema_here["properties"].as_object().into_iter().flatten() {
        visit(keys, &join(path, key), value, above);
    }
    if schema_here["items"].is_object() {
        visit(keys, &format!("{path}[]"), &schema_here["items"], above);
    }
}

fn type_of(schema: &Value) -> &'static str {
    match schema["type"].as_str() {
        Some("object") => "object",
        Some("array") => "list",
        Some("number" | "integer") => "number",
        Some("string") => "text",
        _ if schema["const"].is_string() || schema["enum"].is_array() => "text",
        other => panic!("a type that scenarios do not have: {other:?} in {schema}"),
    }
}
