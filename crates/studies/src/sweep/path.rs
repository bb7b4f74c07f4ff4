//! Place of a parameter in a scenario: `springs[2].rest_length_m`, `springs.*.damping_ratio`, or a
//! JSON pointer, `/springs/2/rest_length_m`.

use serde_json::Value;

use super::error::SweepError;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path(Vec<Step>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
    /// Every entry of a list.
    Every,
}

impl Path {
    /// # Errors
    /// When a bracket is not closed, or a key is empty.
    pub fn parse(text: &str) -> Result<Self, SweepError> {
        let refused = || SweepError::axis(text, "must be keys joined by points, with indices in brackets", text);
        let mut steps = Vec::new();
        if let Some(pointer) = text.strip_prefix('/') {
            steps.extend(pointer.split('/').map(|part| step(&part.replace("~1", "/").replace("~0", "~"))));
        } else {
            for part in text.split('.') {
                let (key, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
                if !key.is_empty() {
                    steps.push(step(key));
                } else if rest.is_empty() || steps.is_empty() {
                    return Err(refused());
                }
                while let Some((index, after)) = rest.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
                    steps.push(step(index));
                    rest = after;
                }
                if !rest.is_empty() {
                    return Err(refused());
                }
            }
        }
        let is_named = |step: &Step| *step != Step::Key(String::new());
        if steps.iter().all(is_named) { Ok(Self(steps)) } else { Err(refused()) }
    }

    /// First of the values at this place; `None` when there is none or one of them is missing.
    pub fn first<'a>(&self, root: &'a Value) -> Option<&'a Value> {
        first(root, &self.0)
    }

    /// Sets every value at this place. The last key may be a new one. Returns `false` when there is
    /// no such place.
    #[must_use]
    pub fn set(&self, root: &mut Value, value: &Value) -> bool {
        set(root, &self.0, value)
    }

    pub fn begins_with(&self, key: &str) -> bool {
        matches!(self.0.first(), Some(Step::Key(first)) if first == key)
    }
}

fn step(text: &str) -> Step {
    match text {
        "*" => Step::Every,
        _ => text.parse().map_or_else(|_| Step::Key(text.to_owned()), Step::Index),
    }
}

fn first<'a>(value: &'a Value, steps: &[Step]) -> Option<&'a Value> {
    let Some((step, rest)) = steps.split_first() else { return Some(value) };
    match step {
        Step::Key(key) => first(value.as_object()?.get(key)?, rest),
        Step::Index(index) => first(value.as_array()?.get(*index)?, rest),
        Step::Every => {
            let found: Option<Vec<&Value>> = value.as_array()?.iter().map(|entry| first(entry, rest)).collect();
            found?.first().copied()
        }
    }
}

fn set(place: &mut Value, steps: &[Step], value: &Value) -> bool {
    let Some((step, rest)) = steps.split_first() else {
        *place = value.clone();
        return true;
    };
    match (step, place) {
        (Step::Key(key), Value::Object(map)) if rest.is_empty() => {
            map.insert(key.clone(), value.clone());
            true
        }
        (Step::Key(key), Value::Object(map)) => map.get_mut(key).is_some_and(|inner| set(inner, rest, value)),
        (Step::Index(index), Value::Array(list)) => list.get_mut(*index).is_some_and(|inner| set(inner, rest, value)),
        (Step::Every, Value::Array(list)) => !list.is_empty() && list.iter_mut().all(|inner| set(inner, rest, value)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn points_brackets_stars_and_pointers_lead_to_the_same_place() {
        let scene = json!({ "springs": [{ "k": 1 }, { "k": 2 }], "load": { "mass_kg": 3 } });
        let at = |path: &str| Path::parse(path).unwrap().first(&scene).cloned();
        for path in ["springs[1].k", "springs.1.k", "/springs/1/k"] {
            assert_eq!(at(path), Some(json!(2)), "{path}");
        }
        assert_eq!(at("springs.*.k"), Some(json!(1)));
        assert_eq!(at("springs[*].k"), Some(json!(1)));
        for path in ["springs[2].k", "springs.*.l", "load.*", "load.mass_kg.x", "nothing"] {
            assert_eq!(at(path), None, "{path}");
        }
        for path in ["", ".", "load..mass", "[0]", "load[0", "load[0]x", "/"] {
            assert!(Path::parse(path).is_err(), "{path}");
        }
    }

    #[test]
    fn a_star_sets_every_entry_and_a_last_key_may_be_new() {
        let mut scene = json!({ "springs": [{ "k": 1 }, { "k": 2 }] });
        assert!(Path::parse("springs.*.k").unwrap().set(&mut scene, &json!(7)));
        assert!(Path::parse("springs[0].z").unwrap().set(&mut scene, &json!(0)));
        assert_eq!(scene, json!({ "springs": [{ "k": 7, "z": 0 }, { "k": 7 }] }));
        assert!(!Path::parse("load.mass_kg").unwrap().set(&mut scene, &json!(0)));
    }
}
