//! JSON that leaves the program. A number that is not finite is refused and its path is named:
//! `serde_json` alone would write `null` for it.

use std::fmt::Display;

use serde::Serialize;
use serde::ser::{self, Serializer};
use serde_json::Value;

/// A result contains a number that no file may hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path} is {value}: results must be finite numbers")]
pub struct NotFinite {
    /// Keys and indices that lead to the number, as `end.position_m[0]`.
    pub path: String,
    /// NaN or an infinity.
    pub value: f64,
}

/// Checks that every number in `data` is finite.
///
/// # Errors
/// The first number that is NaN or infinite.
///
/// # Panics
/// When `data` cannot be written as JSON, which is a defect of its type.
pub fn check(data: &impl Serialize) -> Result<(), NotFinite> {
    data.serialize(Finite::default()).map_err(|error| match error {
        Refused::Number(NotFinite { path, value }) => NotFinite { path: path.trim_start_matches('.').to_owned(), value },
        Refused::Other(message) => panic!("{message}"),
    })
}

/// Writes `data` as indented JSON that ends in a line end.
///
/// # Errors
/// As [`check`].
pub fn pretty(data: &impl Serialize) -> Result<String, NotFinite> {
    check(data)?;
    Ok(serde_json::to_string_pretty(data).expect("keys are text") + "\n")
}

/// Writes `data` as JSON on one line, without a line end.
///
/// # Errors
/// As [`check`].
pub fn line(data: &impl Serialize) -> Result<String, NotFinite> {
    check(data)?;
    Ok(serde_json::to_string(data).expect("keys are text"))
}

/// Converts `data` to a JSON value.
///
/// # Errors
/// As [`check`].
pub fn value(data: &impl Serialize) -> Result<Value, NotFinite> {
    check(data)?;
    Ok(serde_json::to_value(data).expect("keys are text"))
}

/// Converts `data` to a JSON value, where every number is known to be finite, as in a scenario.
///
/// # Panics
/// When a number is not finite.
pub fn plain(data: &impl Serialize) -> Value {
    value(data).unwrap_or_else(|error| panic!("{error}"))
}

/// A serializer that writes nothing and fails at the first number that is not finite.
#[derive(Clone, Copy, Default)]
struct Finite {
    /// Elements of a list that were looked at so far.
    n_elements: usize,
}

#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error(transparent)]
    Number(NotFinite),
    #[error("{0}")]
    Other(String),
}

/// Looks at one part of a value; `place` is where the part stands, as `[3]` or `.key`.
fn look<T: Serialize + ?Sized>(part: &T, place: impl FnOnce() -> String) -> Result<(), Refused> {
    part.serialize(Finite::default()).map_err(|error| match error {
        Refused::Number(NotFinite { path, value }) => Refused::Number(NotFinite { path: place() + &path, value }),
        other => other,
    })
}

impl ser::Error for Refused {
    fn custom<T: Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }
}

/// Methods that accept a value without a look at it.
macro_rules! accept {
    ($($method:ident($($value:ty),*);)*) => {
        $(fn $method(self, $(_: $value),*) -> Result<(), Refused> { Ok(()) })*
    };
}

/// Methods that begin a value of several parts.
macro_rules! begin {
    ($($method:ident($($value:ty),*) -> $part:ident;)*) => {
        $(type $part = Self; fn $method(self, $(_: $value),*) -> Result<Self, Refused> { Ok(self) })*
    };
}

impl Serializer for Finite {
    type Ok = ();
    type Error = Refused;

    accept! {
        serialize_bool(bool); serialize_i8(i8); serialize_i16(i16); serialize_i32(i32); serialize_i64(i64); serialize_i128(i128);
        serialize_u8(u8); serialize_u16(u16); serialize_u32(u32); serialize_u64(u64); serialize_u128(u128);
        serialize_char(char); serialize_str(&str); serialize_bytes(&[u8]); serialize_none(); serialize_unit();
        serialize_unit_struct(&'static str); serialize_unit_variant(&'static str, u32, &'static str);
    }

    begin! {
        serialize_seq(Option<usize>) -> SerializeSeq;
        serialize_tuple(usize) -> SerializeTuple;
        serialize_tuple_struct(&'static str, usize) -> SerializeTupleStruct;
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> SerializeTupleVariant;
        serialize_map(Option<usize>) -> SerializeMap;
        serialize_struct(&'static str, usize) -> SerializeStruct;
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> SerializeStructVariant;
    }

    fn serialize_f32(self, value: f32) -> Result<(), Refused> {
        self.serialize_f64(f64::from(value))
    }

    fn serialize_f64(self, value: f64) -> Result<(), Refused> {
        if value.is_finite() { Ok(()) } else { Err(Refused::Number(NotFinite { path: String::new(), value })) }
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), Refused> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<(), Refused> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        value: &T,
    ) -> Result<(), Refused> {
        look(value, || format!(".{name}"))
    }
}

/// Values of several parts: elements of lists, or fields.
macro_rules! parts {
    ($($part:ident: $method:ident($($key:ident)?);)*) => {$(
        impl ser::$part for Finite {
            type Ok = ();
            type Error = Refused;

            fn $method<T: Serialize + ?Sized>(&mut self, $($key: &'static str,)? value: &T) -> Result<(), Refused> {
                self.n_elements += 1;
                look(value, || {
                    $(if true { return format!(".{}", $key); })?
                    format!("[{}]", self.n_elements - 1)
                })
            }

            fn end(self) -> Result<(), Refused> {
                Ok(())
            }
        }
    )*};
}

parts! {
    SerializeSeq: serialize_element();
    SerializeTuple: serialize_element();
    SerializeTupleStruct: serialize_field();
    SerializeTupleVariant: serialize_field();
    SerializeStruct: serialize_field(key);
    SerializeStructVariant: serialize_field(key);
}

impl ser::SerializeMap for Finite {
    type Ok = ();
    type Error = Refused;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, _: &T) -> Result<(), Refused> {
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Refused> {
        look(value, || ".?".to_owned())
    }

    fn serialize_entry<K: Serialize + ?Sized, V: Serialize + ?Sized>(&mut self, key: &K, value: &V) -> Result<(), Refused> {
        look(value, || format!(".{}", serde_json::to_string(key).unwrap_or_default().trim_matches('"')))
    }

    fn end(self) -> Result<(), Refused> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(Serialize)]
    struct Run {
        end: End,
        by_name: BTreeMap<&'static str, Shape>,
        share: Option<f64>,
    }

    #[derive(Serialize)]
    struct End {
        position_m: [f64; 2],
    }

    #[derive(Serialize)]
    enum Shape {
        Disc { radius_m: f64 },
        Ring(f64, f64),
        Length(f32),
    }

    fn run(shape: Shape) -> Run {
        Run { end: End { position_m: [1.0, -0.0] }, by_name: BTreeMap::from([("shape", shape)]), share: None }
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_wherever_it_stands() {
        let good = run(Shape::Disc { radius_m: f64::MAX });
        assert_eq!(line(&good).unwrap(), serde_json::to_string(&good).unwrap());
        let in_place = Run { end: End { position_m: [0.0, f64::NAN] }, ..run(Shape::Length(1.0)) };
        let shared = Run { share: Some(f64::NEG_INFINITY), ..run(Shape::Length(1.0)) };
        for (bad, path) in [
            (in_place, "end.position_m[1]"),
            (shared, "share"),
            (run(Shape::Disc { radius_m: f64::NAN }), "by_name.shape.radius_m"),
            (run(Shape::Ring(1.0, f64::INFINITY)), "by_name.shape[1]"),
            (run(Shape::Length(f32::NAN)), "by_name.shape.Length"),
        ] {
            let error = pretty(&bad).unwrap_err();
            assert_eq!(error.path, path, "{error}");
            assert!(!error.value.is_finite() && value(&bad).is_err());
        }
    }
}
