//! The page of scenario keys, from the JSON schema.

use std::fmt::Write;

use serde_json::{Map, Value};

const TITLE: &str = "# Scenario keys

Generated from `cohaul scenario schema`. A scenario is one JSON object in SI units; angles are in
radians, counter-clockwise. Unknown keys are errors. A key without a default must be given, unless
its description says what happens without it.
";

pub fn page(schema: &Value) -> String {
    let mut page = TITLE.to_owned();
    page += "\n## Scenario\n";
    section(&mut page, schema);
    for name in in_order(schema) {
        let definition = &schema["$defs"][&name];
        write!(page, "\n## {}\n", title(&name)).expect("a string takes all");
        section(&mut page, definition);
    }
    page
}

/// Names of definitions, each once, in the order in which they are first named.
fn in_order(schema: &Value) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut at = 0;
    let mut text = without_definitions(schema);
    loop {
        for name in text.match_indices("#/$defs/").map(|(start, prefix)| name_at(&text[start + prefix.len()..])) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let Some(next) = names.get(at) else { return names };
        text = schema["$defs"][next].to_string();
        at += 1;
    }
}

fn without_definitions(schema: &Value) -> String {
    let entries = schema.as_object().into_iter().flatten().filter(|(key, _)| *key != "$defs");
    Value::Object(entries.map(|(key, value)| (key.clone(), value.clone())).collect::<Map<_, _>>()).to_string()
}

fn name_at(text: &str) -> String {
    text.chars().take_while(|char| char.is_alphanumeric() || *char == '_').collect()
}

/// `RingOfSprings` as "Ring of springs", `LoadEntry` as "Load".
fn title(name: &str) -> String {
    let mut title = String::new();
    for char in name.trim_end_matches("Entry").chars() {
        if char.is_uppercase() && !title.is_empty() {
            title.push(' ');
            title.extend(char.to_lowercase());
        } else {
            title.push(char);
        }
    }
    title
}

fn section(page: &mut String, definition: &Value) {
    let mut say = |text: String| {
        page.push_str(&text);
        page.push('\n');
    };
    if let Some(text) = definition["description"].as_str() {
        say(format!("\n{}", wrapped(text)));
    }
    if let Some(keys) = definition["properties"].as_object() {
        say("\n| key | value | default | meaning |\n|---|---|---|---|".to_owned());
        let required = definition["required"].as_array().cloned().unwrap_or_default();
        for (key, value) in keys {
            let default = match &value["default"] {
                Value::Null if required.iter().any(|name| name == key) => "required".to_owned(),
                Value::Null => String::new(),
                default => format!("`{default}`"),
            };
            say(format!("| `{key}` | {} | {default} | {} |", kind(value), description(value)));
        }
    }
    let choices = definition["oneOf"].as_array().map(Vec::as_slice).unwrap_or_default();
    if choices.iter().any(|value| value["const"].is_string()) {
        say("\n| value | meaning |\n|---|---|".to_owned());
        for value in choices {
            say(format!("| `{}` | {} |", value["const"], description(value)));
        }
    } else if !choices.is_empty() {
        say("\nOne of:\n".to_owned());
        for choice in choices {
            say(format!("- {}", kind(choice)));
        }
    }
    if let Some(values) = definition["enum"].as_array() {
        say(format!("\nOne of {}.", values.iter().map(|value| format!("`{value}`")).collect::<Vec<_>>().join(", ")));
    }
}

fn description(value: &Value) -> String {
    value["description"].as_str().unwrap_or_default().replace('\n', " ").replace('|', "\\|")
}

/// Prose in lines of at most 100 columns.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last_mut().expect("there is a line");
        if last.is_empty() {
            last.push_str(word);
        } else if last.chars().count() + 1 + word.chars().count() <= 100 {
            *last += &format!(" {word}");
        } else {
            lines.push(word.to_owned());
        }
    }
    lines.join("\n")
}

/// The type of a value in words, a definition as a link.
fn kind(value: &Value) -> String {
    if let Some(name) = value["$ref"].as_str() {
        let title = title(name.trim_start_matches("#/$defs/"));
        return format!("[{title}](#{})", title.to_lowercase().replace(' ', "-"));
    }
    if let Some(choices) = value["oneOf"].as_array() {
        return choices.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    let kinds = match &value["type"] {
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).filter(|kind| *kind != "null").collect::<Vec<_>>().join(" or "),
        kind => kind.as_str().unwrap_or("any").to_owned(),
    };
    match (kinds.as_str(), value["minItems"].as_u64()) {
        ("array", Some(n)) => format!("{n} of {}", kind(&value["items"])),
        ("array", None) => format!("list of {}", kind(&value["items"])),
        _ => kinds,
    }
}
