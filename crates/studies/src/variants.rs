//! Plain enums by the names under which they are serialized.

use serde::de::value::{Error as ValueError, StrDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

/// All variants of an enum without aliases, in their order.
pub fn all<T: DeserializeOwned>() -> impl Iterator<Item = T> {
    let variant = |name: StrDeserializer<'static, ValueError>| T::deserialize(name).expect("an enum reads its own names");
    names::<T>().iter().map(move |name| variant(name.into_deserializer()))
}

/// The serialized names of an enum's variants, aliases too.
pub fn names<T: DeserializeOwned>() -> &'static [&'static str] {
    let mut names = Names(&[]);
    let _ = T::deserialize(&mut names);
    names.0
}

/// Takes the names that a type expects and gives it no value.
struct Names(&'static [&'static str]);

impl<'de> Deserializer<'de> for &mut Names {
    type Error = ValueError;

    fn deserialize_enum<V: Visitor<'de>>(self, _: &str, names: &'static [&'static str], _: V) -> Result<V::Value, Self::Error> {
        self.0 = names;
        Err(Error::custom("no value"))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
        Err(Error::custom("no value"))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}
