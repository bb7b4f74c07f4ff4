//! What stands in one column of one row.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::quantity::quantity;

/// What the fields of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// From 0 to 2^64 - 1.
    Whole,
    Number,
    Word,
    /// `true` or `false`.
    Truth,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Field {
    Empty,
    Whole(u64),
    /// A finite number, in SI units.
    Number(f64),
    Word(String),
    Truth(bool),
}

impl Field {
    /// Kind of the field; `None` of an empty one.
    pub fn kind(&self) -> Option<Kind> {
        match self {
            Field::Empty => None,
            Field::Whole(_) => Some(Kind::Whole),
            Field::Number(_) => Some(Kind::Number),
            Field::Word(_) => Some(Kind::Word),
            Field::Truth(_) => Some(Kind::Truth),
        }
    }

    /// The value of a number, whole or not.
    pub fn number(&self) -> Option<f64> {
        match self {
            Field::Number(value) => Some(*value),
            Field::Whole(value) => Some(*value as f64),
            _ => None,
        }
    }

    /// The value, where it is a number that no file may hold.
    pub fn not_finite(&self) -> Option<f64> {
        self.number().filter(|value| !value.is_finite())
    }

    /// The field of a JSON value in a column of this kind.
    pub fn of_value(value: &Value, kind: Kind) -> Self {
        match (kind, value) {
            (Kind::Whole, _) => value.as_u64().map_or(Field::Empty, Field::Whole),
            (Kind::Number, _) => value.as_f64().map_or(Field::Empty, Field::Number),
            (_, Value::String(word)) => Field::Word(word.clone()),
            _ => Field::Word(value.to_string()),
        }
    }

    /// The field that was written as `text` in a column of this kind; `None` where the text does
    /// not fit.
    pub fn parse(text: &str, kind: Kind) -> Option<Self> {
        if text.is_empty() {
            return Some(Field::Empty);
        }
        match kind {
            Kind::Whole => text.parse().ok().map(Field::Whole),
            Kind::Number => text.parse().ok().filter(|value: &f64| value.is_finite()).map(Field::Number),
            Kind::Word => Some(Field::Word(text.to_owned())),
            Kind::Truth => text.parse().ok().map(Field::Truth),
        }
    }

    /// Appends the field to a line of CSV, with the fewest digits that read back as the same
    /// number.
    ///
    /// A word stays on one line and stands in quotes where it would be taken for several fields.
    pub fn write(&self, line: &mut String) {
        match self {
            Field::Empty => {}
            Field::Whole(value) => line.push_str(&value.to_string()),
            Field::Number(value) => line.push_str(zmij::Buffer::new().format_finite(*value)),
            Field::Word(word) => {
                let word = word.replace(['\n', '\r'], " ");
                if word.contains([',', '"']) {
                    line.push_str(&format!("\"{}\"", word.replace('"', "\"\"")));
                } else {
                    line.push_str(&word);
                }
            }
            Field::Truth(value) => line.push_str(if *value { "true" } else { "false" }),
        }
    }

    /// The field as people read it; numbers have four digits and `unit`.
    pub fn text(&self, unit: &str) -> String {
        match self {
            Field::Empty => "-".to_owned(),
            Field::Whole(value) => format!("{value} {unit}").trim_end().to_owned(),
            Field::Number(value) => quantity(*value, unit),
            Field::Word(word) => word.clone(),
            Field::Truth(value) => if *value { "yes" } else { "no" }.to_owned(),
        }
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Field::Number(value)
    }
}

impl From<u64> for Field {
    fn from(value: u64) -> Self {
        Field::Whole(value)
    }
}

impl From<usize> for Field {
    fn from(value: usize) -> Self {
        Field::Whole(value as u64)
    }
}

impl From<bool> for Field {
    fn from(value: bool) -> Self {
        Field::Truth(value)
    }
}

impl From<&str> for Field {
    fn from(value: &str) -> Self {
        Field::Word(value.to_owned())
    }
}

impl From<String> for Field {
    fn from(value: String) -> Self {
        Field::Word(value)
    }
}

impl<T: Into<Field>> From<Option<T>> for Field {
    fn from(value: Option<T>) -> Self {
        value.map_or(Field::Empty, Into::into)
    }
}
