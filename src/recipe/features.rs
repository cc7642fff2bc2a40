//! Entries of `[[features]]`: elements on the shapes that correspond to each other.

use super::method::InnerEntry;
use super::primitive::{self, is_default};
use super::shapes::ShapeEntry;
use super::source::join;
use super::time::TimeFn;
use super::{
    BoxShape, CapsuleShape, CylinderShape, EllipsoidShape, Primitive, PrismShape, Problem,
    did_you_mean,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// A feature, such as a leg: one element on every shape that takes part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeatureEntry {
    /// Its name; weights are given by it.
    pub name: String,
    /// Turn of the high end of every element against the low end, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twist_deg: Option<f64>,
    /// Size of every element at the high end over that at the low end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taper: Option<f64>,
    /// Bend of every element's axis, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend_deg: Option<f64>,
    /// The element on each shape, by the shape's name.
    pub on: BTreeMap<String, ElementEntry>,
    /// How it changes with t.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub morph: Option<FeatureMorph>,
}

/// How a feature changes with t.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeatureMorph {
    /// Morph time: how much of each shape; `"t"` by default. For two shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t: Option<TimeFn>,
    /// Deformation time: how much of each frame; `"t"` by default. For two shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deform: Option<TimeFn>,
    /// Thickens the feature (thins it when negative), mm; paper 001, eq. 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// Morphing function of this feature: linear, grow, auto, mean or merge; by default the morph's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner: Option<InnerEntry>,
}

impl FeatureMorph {
    /// This where it says something, else `base`.
    pub fn over(&self, base: &Self) -> Self {
        Self {
            t: self.t.clone().or_else(|| base.t.clone()),
            deform: self.deform.clone().or_else(|| base.deform.clone()),
            offset: self.offset.or(base.offset),
            inner: self.inner.or(base.inner),
        }
    }
}

/// An element: exactly one shape, perhaps twisted, tapered or bent along its axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElementEntry {
    /// A box.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub box_shape: Option<BoxShape>,
    /// A flat-ended rod.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderShape>,
    /// A ball-ended rod.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capsule: Option<CapsuleShape>,
    /// A scaled ball.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipsoid: Option<EllipsoidShape>,
    /// A convex prism.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prism: Option<PrismShape>,
    /// A closed mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshShape>,
    /// Turn of the high end against the low end, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twist_deg: Option<f64>,
    /// Size at the high end over size at the low end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taper: Option<f64>,
    /// Bend of the axis, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend_deg: Option<f64>,
}

/// A closed mesh as an element; its own box is its frame. Millimetres, z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshShape {
    /// The mesh, relative to the recipe.
    pub file: PathBuf,
    /// Where the middle of its box goes, mm; by default it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<[f64; 3]>,
    /// Side lengths its box is scaled to, mm; by default it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f64; 3]>,
    /// Degrees about x, then y, then z.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rotate_deg: [f64; 3],
}

/// The shape of an element, borrowed from its entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementShape<'a> {
    /// A primitive.
    Primitive(Primitive<'a>),
    /// `mesh`
    Mesh(&'a MeshShape),
}

impl ElementEntry {
    /// The one shape; `at` is the key of this element.
    ///
    /// # Errors
    /// None or several shapes.
    pub fn shape(&self, at: &str) -> Result<ElementShape<'_>, Problem> {
        let primitive = primitive::only(
            [
                self.box_shape.as_ref().map(Primitive::Box),
                self.cylinder.as_ref().map(Primitive::Cylinder),
                self.capsule.as_ref().map(Primitive::Capsule),
                self.ellipsoid.as_ref().map(Primitive::Ellipsoid),
                self.prism.as_ref().map(Primitive::Prism),
            ],
            at,
        );
        match (&self.mesh, primitive) {
            (None, p) => {
                p?.map(ElementShape::Primitive).ok_or_else(|| Problem::new(at, primitive::NO_SHAPE))
            }
            (Some(m), Ok(None)) => Ok(ElementShape::Mesh(m)),
            (Some(_), _) => Err(Problem::new(at, "`mesh` beside another shape; give one shape")),
        }
    }

    fn validate(&self, at: &str) -> Result<(), Problem> {
        match self.shape(at)? {
            ElementShape::Primitive(p) => {
                let at = format!("{at}.{}", p.key());
                p.validate(&at)?;
                if p.round() != 0.0 {
                    let why = "features have no rounded edges; remove it";
                    return Err(Problem::new(format!("{at}.round"), why));
                }
            }
            ElementShape::Mesh(m) => {
                primitive::finite(&m.center.unwrap_or_default(), &format!("{at}.mesh.center"))?;
                primitive::finite(&m.rotate_deg, &format!("{at}.mesh.rotate_deg"))?;
                let size = m.size.unwrap_or([1.0; 3]);
                size.iter()
                    .try_for_each(|&s| primitive::positive(s, &format!("{at}.mesh.size")))?;
            }
        }
        let (twist, taper) = (self.twist_deg.unwrap_or(0.0), self.taper.unwrap_or(1.0));
        primitive::deform(twist, taper, self.bend_deg.unwrap_or(0.0), at)
    }
}

/// What is wrong with the features beyond the grammar.
pub(super) fn validate(
    features: &[FeatureEntry],
    shapes: &BTreeMap<String, ShapeEntry>,
) -> Result<(), Problem> {
    let mut names = BTreeSet::new();
    for (i, f) in features.iter().enumerate() {
        let at = format!("features[{i}]");
        if f.name.trim().is_empty() || f.name == "default" {
            let why = format!("a feature cannot be called `{}`", f.name);
            return Err(Problem::new(format!("{at}.name"), why));
        }
        if !names.insert(&f.name) {
            let why = format!("`{}` is the name of another feature already", f.name);
            return Err(Problem::new(format!("{at}.name"), why));
        }
        f.validate(&at, shapes)?;
    }
    Ok(())
}

impl FeatureEntry {
    fn validate(&self, at: &str, shapes: &BTreeMap<String, ShapeEntry>) -> Result<(), Problem> {
        let (twist, taper) = (self.twist_deg.unwrap_or(0.0), self.taper.unwrap_or(1.0));
        primitive::deform(twist, taper, self.bend_deg.unwrap_or(0.0), at)?;
        if self.on.is_empty() {
            let why = format!("feature `{}` stands on no shape", self.name);
            return Err(Problem::new(format!("{at}.on"), why));
        }
        for (shape, element) in &self.on {
            let at = join(&format!("{at}.on"), shape);
            if !shapes.contains_key(shape) {
                let hint = did_you_mean(shape, shapes.keys().map(String::as_str));
                return Err(Problem::new(at, format!("no shape is called `{shape}`{hint}")));
            }
            element.validate(&at)?;
        }
        let offset = self.morph.as_ref().and_then(|m| m.offset).unwrap_or(0.0);
        primitive::finite(&[offset], &format!("{at}.morph.offset"))
    }
}
