//! Key paths of JSON with the types of their values, and their comparison with a stored list.

use std::collections::{BTreeMap, BTreeSet};

use cohaul::formats::Format;
use serde_json::Value;

/// Types of the value at each path.
pub type Keys = BTreeMap<String, BTreeSet<String>>;

/// Parts of a format that are not compared key by key.
#[derive(Clone, Copy, Default)]
pub struct Parts {
    /// Paths of other formats inside of this one, and of values of any shape: they are not entered.
    pub opaque: &'static [&'static str],
    /// Paths of objects whose keys are data, such as names of files. Their keys are listed as `*`.
    pub maps: &'static [&'static str],
}

/// Adds the paths of `value`.
pub fn add(keys: &mut Keys, path: &str, value: &Value, parts: Parts) {
    if !path.is_empty() {
        keys.entry(path.to_owned()).or_default().insert(type_of(value).to_owned());
    }
    if parts.opaque.contains(&path) {
        return;
    }
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let key = if parts.maps.contains(&path) { "*" } else { key };
                add(keys, &join(path, key), value, parts);
            }
        }
        Value::Array(list) => list.iter().for_each(|value| add(keys, &format!("{path}[]"), value, parts)),
        _ => {}
    }
}

/// `key` inside of `path`.
pub fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn type_of(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Array(_) => "list",
        Value::Object(_) => "object",
    }
}

/// Text of a list: the version, then a path with its types on each line.
pub fn text_of(version: u32, keys: &Keys) -> String {
    let line =
        |(path, types): (&String, &BTreeSet<String>)| format!("{path}: {}\n", types.iter().cloned().collect::<Vec<_>>().join(" or "));
    format!("version {version}\n\n{}", keys.iter().map(line).collect::<String>())
}

/// Version and keys of a list.
///
/// # Panics
/// When the text is no list.
pub fn read(text: &str) -> (u32, Keys) {
    let mut lines = text.lines().filter(|line| !line.is_empty());
    let version = lines.next().and_then(|line| line.strip_prefix("version ")).and_then(|version| version.parse().ok());
    let key = |line: &str| {
        let (path, types) = line.rsplit_once(": ").unwrap_or_else(|| panic!("a path and its types: {line}"));
        (path.to_owned(), types.split(" or ").map(str::to_owned).collect())
    };
    (version.expect("a list begins with its version"), lines.map(key).collect())
}

/// Why the outputs do not fit the stored list of a format, and the list that would fit, if the
/// version allows one.
#[derive(Debug)]
pub struct Misfit {
    pub why: Vec<String>,
    pub list: Option<Keys>,
}

/// Compares the keys of outputs with the stored list of their format.
///
/// # Errors
/// When keys were added, changed or lost, or when the list is of another version.
pub fn compare(format: &Format, stored: Option<&str>, found: &Keys) -> Result<(), Misfit> {
    let Format { name, version, .. } = format;
    let Some((stored_version, stored)) = stored.map(read) else {
        return Err(Misfit { why: vec![format!("{name:?} has no stored list of its keys")], list: Some(found.clone()) });
    };
    if stored_version != *version {
        let why = vec![format!("the stored list of {name:?} is of version {stored_version}, the program writes version {version}")];
        return Err(Misfit { why, list: (stored_version < *version).then(|| found.clone()) });
    }
    let needs = format!("this needs version {} of {name:?} in src/formats.rs", version + 1);
    let mut broken: Vec<String> =
        stored.keys().filter(|path| !found.contains_key(*path)).map(|path| format!("the key {path} is gone: {needs}")).collect();
    let mut added = Vec::new();
    for (path, types) in found {
        match stored.get(path) {
            None => added.push(format!("the key {path} of {name:?} is new: the version stays, and the list needs it")),
            // Whoever reads a key that was only seen as null knows nothing of its type.
            Some(before) if !types.is_subset(before) && before.iter().all(|kind| kind == "null") => {
                added.push(format!("the type of the key {path} of {name:?} was only known as null: the list needs it"));
            }
            Some(before) if !types.is_subset(before) => {
                let [before, now] = [before, types].map(|types| types.iter().cloned().collect::<Vec<_>>().join(" or "));
                broken.push(format!("the key {path} was {before}, and is {now}: {needs}"));
            }
            Some(_) => {}
        }
    }
    match (broken.is_empty(), added.is_empty()) {
        (true, true) => Ok(()),
        (true, false) => {
            let mut list = stored;
            found.iter().for_each(|(path, types)| list.entry(path.clone()).or_default().extend(types.iter().cloned()));
            Err(Misfit { why: added, list: Some(list) })
        }
        (false, _) => Err(Misfit { why: broken.into_iter().chain(added).collect(), list: None }),
    }
}

#[test]
fn keys_may_be_added_but_lost_or_changed_ones_need_another_version() {
    let keys = |value: Value| {
        let mut keys = Keys::new();
        add(&mut keys, "", &value, Parts { opaque: &["any"], maps: &["files"] });
        keys
    };
    let format = cohaul::formats::RUN;
    let before =
        keys(serde_json::json!({ "end": [{ "x_m": 1.0 }, { "x_m": null }], "files": { "a.csv": "" }, "any": { "a": 1 }, "ok": true }));
    let stored = text_of(format.version, &before);
    assert_eq!(
        stored,
        "version 1\n\nany: object\nend: list\nend[]: object\nend[].x_m: null or number\nfiles: object\nfiles.*: text\nok: boolean\n"
    );
    assert!(compare(&format, Some(&stored), &before).is_ok());
    let misfit = |stored: &str, now: &Keys| compare(&format, Some(stored), now).expect_err("a misfit");
    let more = keys(serde_json::json!({ "end": [{ "x_m": 1.0 }], "files": { "b.csv": "" }, "any": {}, "ok": true, "y_m": 2.0 }));
    let added = misfit(&stored, &more);
    assert_eq!(added.why, ["the key y_m of \"cohaul run\" is new: the version stays, and the list needs it"]);
    // Types that these outputs lack stay in the list.
    assert_eq!(text_of(1, &added.list.expect("a list")), stored.clone() + "y_m: number\n");
    let lost = misfit(&stored, &keys(serde_json::json!({ "end": [{ "x_m": "1" }], "files": { "b.csv": "" }, "any": {} })));
    assert_eq!(
        lost.why,
        [
            "the key ok is gone: this needs version 2 of \"cohaul run\" in src/formats.rs",
            "the key end[].x_m was null or number, and is text: this needs version 2 of \"cohaul run\" in src/formats.rs",
        ]
    );
    assert!(lost.list.is_none());
    // Another version may have any keys, and a list of a newer one is never replaced.
    assert!(misfit(&stored.replace("version 1", "version 0"), &more).list.is_some());
    assert!(misfit(&stored.replace("version 1", "version 2"), &more).list.is_none());
}
