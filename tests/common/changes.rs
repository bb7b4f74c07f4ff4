//! Changes of scenario files.

use serde_json::Value;

/// Sets what a JSON pointer names, in the last step also a new key; null takes the key out.
pub fn changed(mut file: Value, at: &str, put: Value) -> Value {
    let (parent, key) = at.rsplit_once('/').unwrap();
    match file.pointer_mut(parent).unwrap_or_else(|| panic!("{at}")) {
        Value::Object(map) if put.is_null() => drop(map.remove(key).unwrap_or_else(|| panic!("{at}"))),
        Value::Object(map) => drop(map.insert(key.to_string(), put)),
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = put,
        other => panic!("{at} leads into {other}"),
    }
    file
}
