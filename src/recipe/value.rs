//! Values that may be written in more than one way: a word or a table, a number or `auto`.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{
    Deserialize, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor,
};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// A plain value, or a table that says more.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PlainOr<A, B> {
    /// A number, a word or a list.
    Plain(A),
    /// A table.
    Table(B),
}

// derived untagged enums lose the place of an error inside them; a visitor keeps it
impl<'de, A: Deserialize<'de>, B: Deserialize<'de>> Deserialize<'de> for PlainOr<A, B> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(PlainOrVisitor(PhantomData))
    }
}

struct PlainOrVisitor<A, B>(PhantomData<(A, B)>);

impl<'de, A: Deserialize<'de>, B: Deserialize<'de>> Visitor<'de> for PlainOrVisitor<A, B> {
    type Value = PlainOr<A, B>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a plain value or a table")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<Self::Value, E> {
        A::deserialize(x.into_deserializer()).map(PlainOr::Plain)
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
        A::deserialize(x.into_deserializer()).map(PlainOr::Plain)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Self::Value, E> {
        A::deserialize(x.into_deserializer()).map(PlainOr::Plain)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
        A::deserialize(x.into_deserializer()).map(PlainOr::Plain)
    }
    fn visit_seq<S: SeqAccess<'de>>(self, x: S) -> Result<Self::Value, S::Error> {
        A::deserialize(SeqAccessDeserializer::new(x)).map(PlainOr::Plain)
    }
    fn visit_map<M: MapAccess<'de>>(self, x: M) -> Result<Self::Value, M::Error> {
        B::deserialize(MapAccessDeserializer::new(x)).map(PlainOr::Table)
    }
}

/// A value, or the word `auto`: chosen from the shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Auto<T> {
    /// `"auto"`
    #[default]
    Auto,
    /// What was typed.
    Value(T),
}

impl<T> Auto<T> {
    /// What was typed, if anything.
    pub fn value(&self) -> Option<&T> {
        match self {
            Self::Auto => None,
            Self::Value(x) => Some(x),
        }
    }
}

impl<T: Serialize> Serialize for Auto<T> {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => s.serialize_str("auto"),
            Self::Value(x) => x.serialize(s),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Auto<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(AutoVisitor(PhantomData))
    }
}

struct AutoVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for AutoVisitor<T> {
    type Value = Auto<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a list or \"auto\"")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<Self::Value, E> {
        match x {
            "auto" => Ok(Auto::Auto),
            _ => Err(E::unknown_variant(x, &["auto"])),
        }
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Self::Value, E> {
        T::deserialize(x.into_deserializer()).map(Auto::Value)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Self::Value, E> {
        T::deserialize(x.into_deserializer()).map(Auto::Value)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Self::Value, E> {
        T::deserialize(x.into_deserializer()).map(Auto::Value)
    }
    fn visit_seq<S: SeqAccess<'de>>(self, x: S) -> Result<Self::Value, S::Error> {
        T::deserialize(SeqAccessDeserializer::new(x)).map(Auto::Value)
    }
}

impl<T: JsonSchema> JsonSchema for Auto<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("AutoOr{}", T::schema_name()).into()
    }
    fn json_schema(g: &mut SchemaGenerator) -> Schema {
        let value = g.subschema_for::<T>();
        schemars::json_schema!({ "anyOf": [{ "const": "auto" }, value] })
    }
}
