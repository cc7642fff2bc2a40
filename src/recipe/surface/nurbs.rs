//! `nurbs` and `nurbs-morph` (Ju and Goldman 2003).

use super::{Kind, Nest};
use crate::recipe::TimeFn;
use crate::recipe::primitive::one;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::value::{SeqAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

/// A rational B-spline. A curve has one row, one degree, and no `knots_v`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Nurbs {
    /// `nurbs`.
    #[schemars(extend("const" = "nurbs"))]
    pub kind: Kind,
    /// Degree along u and, for surfaces, along v.
    pub degree: Vec<usize>,
    /// Knots along u, as many as points in a row plus degree plus one.
    pub knots_u: Vec<f64>,
    /// Knots along v.
    #[serde(default)]
    pub knots_v: Option<Vec<f64>>,
    /// Rows along u of `[x, y, z, weight]`, a row a step of v.
    pub net: Vec<Vec<[f64; 4]>>,
    /// Size of one unit, mm.
    #[serde(default = "one")]
    pub scale: f64,
}

/// A morph of two or more rational B-splines.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NurbsMorph {
    /// `nurbs-morph`.
    #[schemars(extend("const" = "nurbs-morph"))]
    pub kind: Kind,
    /// Files of kind `nurbs`, all curves or all surfaces.
    pub targets: Vec<PathBuf>,
    /// `weighted` by the masses, or `linear`.
    #[serde(default)]
    pub averaging: Averaging,
    /// Weights of all targets at equal steps of t, a row a step; two targets do without.
    #[serde(default)]
    pub weights: Vec<Vec<f64>>,
    /// A factor on the masses of each target.
    #[serde(default)]
    pub scale: Vec<f64>,
    /// Masses of each target on the common net; by default its weights.
    #[serde(default)]
    pub masses: Vec<Vec<Vec<f64>>>,
    /// Wanted distances at some t.
    #[serde(default)]
    pub design: Vec<Design>,
}

/// Which average.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Averaging {
    /// Of the points as they are.
    Linear,
    /// Of the points by their masses.
    #[default]
    Weighted,
}

/// How far each control shall be at a time.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// When, between 0 and 1.
    pub t: f64,
    /// Distance of each control of the common net from the first target, 0 to 1: one number for all,
    /// or rows; with more than two targets one such table for each but the first. By default what it
    /// is without this design.
    #[serde(default)]
    pub distance: Option<Nest>,
    /// Weight of each control.
    #[serde(default)]
    pub weights: Option<Vec<Vec<f64>>>,
    /// Areas whose controls are pulled to a distance of their own, one after the other.
    #[serde(default)]
    pub impact: Vec<Impact>,
}

/// An area of impact: an ellipse in the (u, v) plane.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Impact {
    /// Its centre (u, v); curves take no notice of v.
    pub centre: [f64; 2],
    /// Its half axes along u and v.
    pub radius: [f64; 2],
    /// The distance, or share of `target`, at the centre.
    pub to: f64,
    /// Which target's share is pulled, counted from 0.
    #[serde(default = "second")]
    pub target: usize,
    /// How the pull fades towards the rim.
    #[serde(default)]
    pub falloff: Falloff,
}

fn second() -> usize {
    1
}

/// How a pull fades from the centre, 0, to the rim, 1: `smooth`, `linear`, or 1 - u(d) of a function
/// of the distance, written like a function of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Falloff {
    /// Flat at the centre and at the rim.
    #[default]
    Smooth,
    /// In a straight line.
    Linear,
    /// By a function.
    Custom(TimeFn),
}

impl<'de> Deserialize<'de> for Falloff {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(FalloffVisitor)
    }
}

struct FalloffVisitor;

impl<'de> Visitor<'de> for FalloffVisitor {
    type Value = Falloff;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"smooth\", \"linear\", or a function such as \"t^2\" or a table")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<Falloff, E> {
        match x {
            "smooth" => Ok(Falloff::Smooth),
            "linear" => Ok(Falloff::Linear),
            _ if x == "t" || x.starts_with("t^") => {
                TimeFn::deserialize(StrDeserializer::new(x)).map(Falloff::Custom)
            }
            _ => Err(E::unknown_variant(x, &["smooth", "linear", "t^2"])),
        }
    }
    fn visit_seq<S: SeqAccess<'de>>(self, x: S) -> Result<Falloff, S::Error> {
        TimeFn::deserialize(SeqAccessDeserializer::new(x)).map(Falloff::Custom)
    }
}

impl JsonSchema for Falloff {
    fn schema_name() -> Cow<'static, str> {
        "Falloff".into()
    }
    fn json_schema(g: &mut SchemaGenerator) -> Schema {
        let function = g.subschema_for::<TimeFn>();
        schemars::json_schema!({ "anyOf": [{ "enum": ["smooth", "linear"] }, function] })
    }
}
