//! Values of surface files that may be written in more than one way.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// An arithmetic expression, or a plain number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula(pub String);

impl Default for Formula {
    fn default() -> Self {
        Self("0".to_owned())
    }
}

impl<'de> Deserialize<'de> for Formula {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(FormulaVisitor)
    }
}

struct FormulaVisitor;

impl Visitor<'_> for FormulaVisitor {
    type Value = Formula;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an expression such as \"2*sin(v)\", or a number")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<Formula, E> {
        Ok(Formula(x.to_owned()))
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Formula, E> {
        Ok(Formula(x.to_string()))
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Formula, E> {
        Ok(Formula(x.to_string()))
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Formula, E> {
        if x.is_finite() {
            Ok(Formula(x.to_string()))
        } else {
            Err(E::custom(format!("got {x}; expected a finite number")))
        }
    }
}

impl JsonSchema for Formula {
    fn schema_name() -> Cow<'static, str> {
        "Formula".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "description": "An arithmetic expression over the named variables, or a number.",
            "anyOf": [{ "type": "string" }, { "type": "number" }]
        })
    }
}

/// A number, or a list of such values: tables whose depth depends on the number of targets.
#[derive(Clone, Debug, PartialEq)]
pub enum Nest {
    /// One number.
    Number(f64),
    /// A list.
    List(Vec<Nest>),
}

impl Nest {
    /// Rows of numbers, when that is what it is.
    pub fn rows(&self) -> Option<Vec<Vec<f64>>> {
        let Self::List(rows) = self else { return None };
        let row = |row: &Self| match row {
            Self::List(all) => all.iter().map(Self::number).collect(),
            Self::Number(_) => None,
        };
        rows.iter().map(row).collect()
    }

    /// Several tables of rows, when that is what it is.
    pub fn tables(&self) -> Option<Vec<Vec<Vec<f64>>>> {
        let Self::List(tables) = self else { return None };
        tables.iter().map(Self::rows).collect()
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::List(_) => None,
        }
    }
}

impl<'de> Deserialize<'de> for Nest {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(NestVisitor)
    }
}

struct NestVisitor;

impl<'de> Visitor<'de> for NestVisitor {
    type Value = Nest;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or rows of numbers")
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Nest, E> {
        Ok(Nest::Number(x as f64))
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Nest, E> {
        Ok(Nest::Number(x as f64))
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Nest, E> {
        Ok(Nest::Number(x))
    }
    fn visit_seq<S: SeqAccess<'de>>(self, mut x: S) -> Result<Nest, S::Error> {
        let mut all = Vec::new();
        while let Some(item) = x.next_element()? {
            all.push(item);
        }
        Ok(Nest::List(all))
    }
}

impl JsonSchema for Nest {
    fn schema_name() -> Cow<'static, str> {
        "NumberOrRows".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "description": "A number, rows of numbers, or several tables of rows.",
            "type": ["number", "array"]
        })
    }
}
