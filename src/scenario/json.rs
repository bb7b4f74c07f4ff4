//! Text to a JSON value. A key that is given twice is a finding, since a plain reader would drop
//! one of the two.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::error::{Findings, ScenarioError};

/// Error of a text that is not JSON.
pub struct SyntaxError(serde_json::Error);

impl SyntaxError {
    pub fn of_file(self, file: &str) -> ScenarioError {
        let (line, column) = (self.0.line(), self.0.column());
        let told = self.0.to_string();
        // serde_json appends the place, which has fields of its own here.
        let reason = told.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&told).to_string();
        ScenarioError::NotJson { file: file.to_string(), line, column, reason }
    }
}

/// The text without the byte order mark that some editors put first.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The value of `text`, with a finding for each key that is given twice.
///
/// # Errors
/// When the text is not JSON, or a number in it is too large for a float.
pub fn read(text: &str) -> Result<(Value, Findings), SyntaxError> {
    let mut findings = Findings::default();
    let mut source = serde_json::Deserializer::from_str(without_mark(text));
    let place = Place { path: String::new(), findings: &mut findings };
    let value = place.deserialize(&mut source).map_err(SyntaxError)?;
    source.end().map_err(SyntaxError)?;
    Ok((value, findings))
}

/// The number, with zero in place of minus zero: equal scenarios then have equal hashes.
pub fn plain(value: f64) -> f64 {
    value + 0.0
}

/// `key` inside of `path`.
pub fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_string() } else { format!("{path}.{key}") }
}

struct Place<'a> {
    path: String,
    findings: &'a mut Findings,
}

impl Place<'_> {
    fn at(&mut self, path: String) -> Place<'_> {
        Place { path, findings: self.findings }
    }
}

impl<'de> DeserializeSeed<'de> for Place<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, source: D) -> Result<Value, D::Error> {
        source.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Place<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(plain(value).into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut source: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        loop {
            let path = format!("{}[{}]", self.path, list.len());
            match source.next_element_seed(self.at(path))? {
                Some(value) => list.push(value),
                None => return Ok(list.into()),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut source: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = source.next_key::<String>()? {
            let path = join(&self.path, &key);
            let value = source.next_value_seed(self.at(path.clone()))?;
            if map.contains_key(&key) {
                self.findings.report(path, "must be given once", "it a second time");
            }
            map.insert(key, value);
        }
        Ok(map.into())
    }
}
