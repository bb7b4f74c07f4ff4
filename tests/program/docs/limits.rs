//! What README, book and help say that the program does not do. Each such sentence stands in
//! [`LIMITS`] with what shows that it is true, so that it fails when the program learns it.

use serde_json::Value;

/// Words of sentences that deny something.
const DENIALS: [&str; 8] =
    ["not modelled", "cannot", "not supported", "does not support", "is not possible", "not implemented", "no way to", "not yet"];

/// What shows that a sentence is true.
enum Shown {
    /// No key of a scenario has one of these words.
    NoKey(&'static [&'static str]),
    /// A scenario has one object under this key, and not a list.
    Only(&'static str),
    /// It follows from the theory or from the sentence itself, whatever the program does.
    Logic,
}

/// Words of a sentence that denies something, and what shows that it is true.
const LIMITS: &[(&str, &[Shown])] = &[
    ("contact between loads", &[Shown::Only("load")]),
    ("tilting", &[Shown::NoKey(&["tilt", "pitch", "roll", "height"])]),
    ("cannot be told apart", &[Shown::Logic]),
    ("cannot tell", &[Shown::Logic]),
    ("paths cannot be compared", &[Shown::Logic]),
    ("ledger cannot account for", &[Shown::Logic]),
    ("cannot be trusted", &[Shown::Logic]),
    ("cannot push away", &[Shown::Logic]),
    ("cannot slip before", &[Shown::Logic]),
    ("the simulation cannot go on", &[Shown::Logic]),
    ("cannot undo", &[Shown::Logic]),
    ("cannot be read", &[Shown::Logic]),
    ("cannot be written", &[Shown::Logic]),
];

/// The sentences of a page that deny something and are in no list, and those whose list is false.
pub fn false_denials(path: &str, text: &str, schema: &Value) -> Vec<String> {
    sentences(text).filter_map(|sentence| Some(format!("{path}: {}: {sentence}", wrong(&sentence, schema)?))).collect()
}

/// Why a sentence is not shown to be true.
fn wrong(sentence: &str, schema: &Value) -> Option<String> {
    let lower = sentence.to_lowercase();
    if !DENIALS.iter().any(|denial| lower.contains(denial)) {
        return None;
    }
    let known: Vec<_> = LIMITS.iter().filter(|(words, _)| lower.contains(words)).collect();
    if known.is_empty() {
        return Some("is in no list of tests/program/docs/limits.rs".to_owned());
    }
    let failed = known.iter().find(|(_, shown)| !shown.iter().all(|shown| shown.holds(schema)));
    if let Some((words, _)) = failed {
        return Some(format!("the program has `{words}`"));
    }
    // What else such a sentence lists must not be a key.
    let is_list = lower.contains("not modelled");
    let is_key = |word: &&str| schema["properties"][*word]["type"] == "array";
    lower.split(|letter: char| !letter.is_alphanumeric()).filter(|_| is_list).find(is_key).map(|key| format!("scenarios have `{key}`"))
}

impl Shown {
    fn holds(&self, schema: &Value) -> bool {
        match self {
            Self::NoKey(words) => !keys(schema).iter().any(|key| key.split('_').any(|part| words.contains(&part))),
            Self::Only(key) => !schema["properties"][*key].to_string().contains("\"array\""),
            Self::Logic => true,
        }
    }
}

/// All keys of a scenario.
fn keys(schema: &Value) -> Vec<String> {
    let own = schema.get("properties").and_then(Value::as_object).into_iter().flatten().map(|(key, _)| key.clone());
    let inner: Vec<&Value> = match schema {
        Value::Object(all) => all.values().collect(),
        Value::Array(all) => all.iter().collect(),
        _ => Vec::new(),
    };
    own.chain(inner.into_iter().flat_map(keys)).collect()
}

/// Sentences of a page outside of code blocks, each on one line.
fn sentences(text: &str) -> impl Iterator<Item = String> {
    let mut is_code = false;
    let lines = text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    });
    let joined = lines.collect::<Vec<_>>().join("\n");
    let parts: Vec<String> = joined.split("\n\n").map(|part| part.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    parts.into_iter().flat_map(|part| part.split(". ").map(str::to_owned).collect::<Vec<_>>())
}

#[test]
fn a_denial_fails_when_the_program_has_it() {
    let schema: Value = serde_json::from_str(&super::printed(&["scenario", "schema"])).expect("the schema is JSON");
    let wrong = |sentence: &str| wrong(sentence, &schema).is_some();
    assert!(wrong("Obstacles, contact between loads, and tilting of the load are not modelled."));
    assert!(wrong("Springs cannot have dashpots.") && wrong("Walls are not supported."));
    assert!(!wrong("Contact between loads is not modelled.") && !wrong("Obstacles stand or move."));
    assert!(!Shown::NoKey(&["restitution"]).holds(&schema) && !Shown::Only("obstacles").holds(&schema));
}
