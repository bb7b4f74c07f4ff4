//! Changes of JSON: numbers, keys, types, lengths, and parts of other files.

use serde_json::{Value, json};

use crate::bytes::{LONGEST, NUMBERS, one_of};
use crate::draws::Draws;

/// One of the files, changed in one to three places.
pub fn changed(files: &[Value], draws: &mut Draws) -> Vec<u8> {
    let mut file = one_of(files, draws).clone();
    for _ in 0..=draws.below(3) {
        change(&mut file, files, draws);
    }
    let mut text = file.to_string();
    if draws.is(0.03) {
        give_a_key_twice(&mut text, draws);
    }
    text.truncate(LONGEST);
    text.into_bytes()
}

fn change(file: &mut Value, files: &[Value], draws: &mut Draws) {
    let other = one_of(files, draws);
    let part = nth(other, draws.below(size(other))).clone();
    let place = place(file, draws.below(size(file)));
    if place.is_number() && draws.is(0.6) {
        *place = number(place.as_f64().unwrap_or_default(), draws);
        return;
    }
    match (draws.below(6), place) {
        (0, place) => *place = odd(draws),
        (1, place) => *place = part,
        (_, Value::Object(map)) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            let Some(key) = keys.get(draws.below(keys.len().max(1))) else { return };
            let Some(value) = map.remove(key) else { return };
            let second = one_of(&keys, draws).clone();
            match draws.below(4) {
                0 => {}
                1 => drop(map.insert(format!("{key}{}", one_of(&["_", "s", "\0", "ü", " "], draws)), value)),
                2 => {
                    let other = map.insert(second, value).unwrap_or_default();
                    map.insert(key.clone(), other);
                }
                _ => {
                    // A part of the same name in another file fits best.
                    let same = all(other).into_iter().find_map(|value| value.get(key)).cloned();
                    map.insert(key.clone(), same.unwrap_or(part));
                }
            }
        }
        (_, Value::Array(list)) => change_length(list, part, draws),
        (_, place) => *place = odd(draws),
    }
}

fn change_length(list: &mut Vec<Value>, part: Value, draws: &mut Draws) {
    let at = draws.below(list.len().max(1));
    match (draws.below(5), list.get(at).cloned()) {
        (0, _) => list.truncate(at),
        (1, Some(_)) => drop(list.remove(at)),
        (2, Some(value)) => {
            let n = if draws.is(0.05) { 1000 } else { 1 + draws.below(4) };
            drop(list.splice(at..at, vec![value; n]));
        }
        (3, Some(_)) => list.swap(at, 0),
        _ => list.insert(at, part),
    }
}

/// An odd number, or one that is larger or smaller than it was.
fn number(before: f64, draws: &mut Draws) -> Value {
    match draws.below(4) {
        0 => serde_json::from_str::<Value>(one_of::<&str>(&NUMBERS, draws)).expect("it is a number"),
        1 => json!(before * 10f64.powf(draws.between(-3.0, 3.0))),
        2 => json!(before * one_of(&[-1.0, 0.0, 0.5, 2.0, 1.0 + f64::EPSILON, 1e3, 1e-3, 1e9, 1e-9], draws)),
        _ => json!(before + draws.between(-1.0, 1.0)),
    }
}

fn odd(draws: &mut Draws) -> Value {
    let deep = (0..200).fold(json!(0), |inner, _| json!([inner]));
    let long = "x".repeat(if draws.is(0.1) { 100_000 } else { 10 });
    let odd =
        [json!(null), json!("x"), json!(true), json!([]), json!({}), json!(""), json!(long), json!([0, 0]), json!("\u{202e}ü\0"), deep];
    if draws.is(0.3) { number(1.0, draws) } else { one_of(&odd, draws).clone() }
}

/// Puts a key before itself, with another value.
fn give_a_key_twice(text: &mut String, draws: &mut Draws) {
    let ends: Vec<usize> = text.match_indices("\":").map(|(at, _)| at).collect();
    let Some(end) = ends.get(draws.below(ends.len().max(1))) else { return };
    let Some(begin) = text[..*end].rfind('"') else { return };
    let twice = format!("{}\":0,", &text[begin..*end]);
    text.insert_str(begin, &twice);
}

fn children(value: &Value) -> Vec<&Value> {
    match value {
        Value::Object(map) => map.values().collect(),
        Value::Array(list) => list.iter().collect(),
        _ => Vec::new(),
    }
}

/// Number of all values in a value, itself included.
pub fn size(value: &Value) -> usize {
    1 + children(value).into_iter().map(size).sum::<usize>()
}

fn all(value: &Value) -> Vec<&Value> {
    let below = children(value).into_iter().flat_map(all);
    [value].into_iter().chain(below).collect()
}

fn nth(value: &Value, mut n: usize) -> &Value {
    if n == 0 {
        return value;
    }
    n -= 1;
    for child in children(value) {
        let within = size(child);
        if n < within {
            return nth(child, n);
        }
        n -= within;
    }
    value
}

/// Place of value number `n`, counted with the value itself as 0.
fn place(value: &mut Value, mut n: usize) -> &mut Value {
    if n == 0 {
        return value;
    }
    n -= 1;
    let keys: Vec<(String, usize)> = match value {
        Value::Object(map) => map.iter().map(|(key, child)| (key.clone(), size(child))).collect(),
        Value::Array(list) => list.iter().enumerate().map(|(at, child)| (at.to_string(), size(child))).collect(),
        _ => Vec::new(),
    };
    for (key, within) in keys {
        if n < within {
            let child = match value {
                Value::Object(map) => map.get_mut(&key),
                Value::Array(list) => key.parse::<usize>().ok().and_then(|at| list.get_mut(at)),
                _ => None,
            };
            return place(child.expect("it is there"), n);
        }
        n -= within;
    }
    unreachable!("it has so many values")
}

/// The value without each of its parts, the largest ones first.
pub fn without_a_part(value: &Value) -> Vec<Value> {
    let mut parts = Vec::new();
    pointers(value, String::new(), &mut parts);
    parts.sort_by_key(|(size, _)| std::cmp::Reverse(*size));
    parts.into_iter().filter_map(|(_, pointer)| without(value, &pointer)).collect()
}

fn pointers(value: &Value, at: String, found: &mut Vec<(usize, String)>) {
    let mut below = |key: &str, child: &Value| {
        let pointer = format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
        found.push((size(child), pointer.clone()));
        pointers(child, pointer, found);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, child)| below(key, child)),
        Value::Array(list) => list.iter().enumerate().for_each(|(at, child)| below(&at.to_string(), child)),
        _ => {}
    }
}

fn without(value: &Value, pointer: &str) -> Option<Value> {
    let mut value = value.clone();
    let (parent, key) = pointer.rsplit_once('/')?;
    match value.pointer_mut(parent)? {
        Value::Object(map) => drop(map.remove(&key.replace("~1", "/").replace("~0", "~"))),
        Value::Array(list) => drop(list.remove(key.parse().ok()?)),
        _ => return None,
    }
    Some(value)
}
