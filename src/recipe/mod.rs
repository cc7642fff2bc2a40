//! The recipe: a text that says which shapes to morph, how, and what to write.
//!
//! TOML for people, JSON with the same keys for programs. Unknown keys are errors that name the
//! nearest known key. Lengths are millimetres, angles degrees, t in [0, 1]. Everything here is
//! plain data as typed; the `scene` makes objects of it.

mod anchors;
mod bulk;
mod features;
mod json;
mod method;
mod output;
mod primitive;
mod shapes;
mod solid;
mod source;
mod strict;
pub mod surface;
mod time;
mod value;

pub use crate::num::near::{did_you_mean, nearest};
pub use anchors::AnchorEntry;
pub use features::{ElementEntry, ElementShape, FeatureEntry, FeatureMorph, MeshShape};
pub use method::{
    BlendEntry, FormEntry, InnerEntry, MethodEntry, MorphEntry, OneOrMany, SpaceTimeEntry,
    StyleEntry, TransportEntry, WeightingEntry, WeightingKind, Weights,
};
pub use output::{GridEntry, MesherEntry, NameOrNames, OutputEntry};
pub use primitive::{BoxShape, CapsuleShape, CylinderShape, EllipsoidShape, Primitive, PrismShape};
pub use shapes::{
    CurveEntry, LengthUnit, Place, PlaceLike, ShapeEntry, SignEntry, SkinEntry, ThickenEntry,
    ThickenWhich, UpAxis,
};
pub use solid::{Mirror, Op, Part, Solid, SolidKind};
pub(crate) use source::join;
pub use source::{Problem, RecipeError, Source, kind, read_text};
pub use surface::{SurfaceEntry, SurfaceMethod, parse_surface, surface_schema};
pub use time::{TimeFn, Times, numbers};
pub use value::{Auto, PlainOr};

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::de::value::{Error as WordError, StrDeserializer};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The recipe version this program reads.
pub const VERSION: u32 = 1;

/// A whole recipe.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of the format: 1.
    pub version: u32,
    /// What the recipe is called.
    #[serde(default, skip_serializing_if = "primitive::is_default")]
    pub name: String,
    /// How finely space is sampled.
    #[serde(default, skip_serializing_if = "primitive::is_default")]
    pub grid: GridEntry,
    /// The shapes, by name.
    pub shapes: BTreeMap<String, ShapeEntry>,
    /// Features that stand on the shapes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<FeatureEntry>,
    /// Points that correspond, for `method = "warp"`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub anchors: Vec<AnchorEntry>,
    /// How the shapes become one.
    #[serde(default, skip_serializing_if = "primitive::is_default")]
    pub morph: MorphEntry,
    /// Several results of one recipe; each overrides what it names of `[morph]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hybrids: Vec<MorphEntry>,
    /// What is written.
    #[serde(default, skip_serializing_if = "primitive::is_default")]
    pub output: OutputEntry,
}

impl Recipe {
    /// Reads a recipe; `file` names it in errors and tells TOML from JSON.
    ///
    /// # Errors
    /// Bad grammar, unknown keys, values that mean nothing: with file, line and key.
    pub fn parse(text: &str, file: &Path) -> Result<(Self, Source), RecipeError> {
        let (recipe, source): (Self, _) = Source::read(text, file)?;
        recipe.validate().map_err(|p| source.locate(p))?;
        Ok((recipe, source))
    }

    /// The hybrids to make, `[morph]` filled in, and the key each stands under. Without
    /// `[[hybrids]]`, `[morph]` itself is the only one.
    pub fn variants(&self) -> Vec<(String, MorphEntry)> {
        if self.hybrids.is_empty() {
            return vec![("morph".to_owned(), self.morph.clone())];
        }
        let over = |(i, h): (usize, &MorphEntry)| (format!("hybrids[{i}]"), h.over(&self.morph));
        self.hybrids.iter().enumerate().map(over).collect()
    }

    /// What is wrong beyond the grammar.
    ///
    /// # Errors
    /// The first thing that is, by its key.
    pub fn validate(&self) -> Result<(), Problem> {
        if self.version != VERSION {
            let why = format!("got {}; this program reads version {VERSION}", self.version);
            return Err(Problem::new("version", why));
        }
        for (name, shape) in &self.shapes {
            if name.is_empty() {
                return Err(Problem::new("shapes", "a shape has an empty name"));
            }
            let at = source::join("shapes", name);
            shape.validate(&at)?;
            if let PlainOr::Table(PlaceLike { like }) = &shape.place {
                self.stands_alone(like, &format!("{at}.place.like"))?;
            }
        }
        self.grid.validate()?;
        features::validate(&self.features, &self.shapes)?;
        anchors::validate(&self.anchors, &self.shapes)?;
        if !self.morph.name.is_empty() {
            return Err(Problem::new("morph.name", "only hybrids have a name; remove it"));
        }
        self.morph.validate("morph", self)?;
        for (i, hybrid) in self.hybrids.iter().enumerate() {
            let at = format!("hybrids[{i}]");
            if hybrid.name.trim().is_empty() {
                return Err(Problem::new(at, "missing key `name`"));
            }
            if self.hybrids[..i].iter().any(|h| h.name == hybrid.name) {
                let why = format!("`{}` is the name of another hybrid already", hybrid.name);
                return Err(Problem::new(format!("{at}.name"), why));
            }
            hybrid.validate(&at, self)?;
        }
        self.output.validate()
    }
}

impl Recipe {
    /// Whether there is a shape of that name whose place depends on no other.
    fn stands_alone(&self, name: &str, at: &str) -> Result<(), Problem> {
        let Some(shape) = self.shapes.get(name) else {
            let hint = did_you_mean(name, self.shapes.keys().map(String::as_str));
            return Err(Problem::new(at, format!("no shape is called `{name}`{hint}")));
        };
        match shape.place {
            PlainOr::Plain(_) => Ok(()),
            PlainOr::Table(_) => {
                let why = format!("`{name}` stands like another shape itself; name that one");
                Err(Problem::new(at, why))
            }
        }
    }
}

/// Reads a solid file (`kind = "solid"`); `file` names it in errors and tells TOML from JSON.
///
/// # Errors
/// Bad grammar, unknown keys, parts that are no shape: with file, line and key.
pub fn parse_solid(text: &str, file: &Path) -> Result<Solid, RecipeError> {
    let (solid, source): (Solid, _) = Source::read(text, file)?;
    if solid.kind.is_none() {
        let why = "missing key `kind`; a solid file begins with kind = \"solid\"";
        return Err(source.locate(Problem::new("", why)));
    }
    solid.validate("").map_err(|p| source.locate(p))?;
    Ok(solid)
}

/// A word of the recipe read alone, as on a command line: `graft`, `y`, `cm`.
///
/// # Errors
/// An unknown word, with the nearest known one.
pub fn word<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    T::deserialize(StrDeserializer::<WordError>::new(text))
        .map_err(|e| source::explain(&e.to_string()))
}

/// JSON Schema of the recipe.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Recipe).to_value()
}

#[cfg(test)]
mod tests;
