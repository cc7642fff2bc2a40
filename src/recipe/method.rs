//! `[morph]` and `[[hybrids]]`: which method, between what, with which weights.

use super::features::FeatureMorph;
use super::primitive::{finite, is_default, positive};
use super::source::join;
use super::time::Times;
use super::value::{Auto, PlainOr};
use super::{Problem, Recipe, SurfaceMethod, did_you_mean};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Rows of weights: by feature (or `default`), then by shape.
pub type Weights = BTreeMap<String, BTreeMap<String, f64>>;

/// How shapes become one; a hybrid overrides what it names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MorphEntry {
    /// The hybrid's name; `{name}` stands for it in file names. Only in `[[hybrids]]`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub name: String,
    /// Which method; by default `auto`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<MethodEntry>,
    /// The two shapes of a pair: t = 0 and t = 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between: Option<[String; 2]>,
    /// The shapes of a group.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub among: Option<Vec<String>>,
    /// What hybrids of the method `auto` are to look like; by default `average`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub style: Option<StyleEntry>,
    /// What the features' weights blend; by default `maps`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<BlendEntry>,
    /// The morphing function inside graft and group; by default `grow`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner: Option<InnerEntry>,
    /// Offset of the features that name none of their own, mm; paper 001, eq. 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// How distances to the features become weights; by default `smooth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weighting: Option<PlainOr<WeightingKind, WeightingEntry>>,
    /// Frames of the result: `average`, `dominant` or the name of a shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<String>,
    /// Morph times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t: Option<Times>,
    /// Weights of the shapes, a row a feature, and a row `default`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub weights: Weights,
    /// Weights of the frames, as `weights`; by default the mean of the features' weights.
    #[serde(default, skip_serializing_if = "is_default")]
    pub deform_weights: Weights,
    /// How single features change, by their names: over what the features say themselves.
    #[serde(default, skip_serializing_if = "is_default")]
    pub parts: BTreeMap<String, FeatureMorph>,
    /// Parameters of space-time blending.
    #[serde(rename = "space-time", default, skip_serializing_if = "Option::is_none")]
    pub space_time: Option<SpaceTimeEntry>,
    /// Parameters of optimal transport.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transport: Option<TransportEntry>,
}

/// Methods of metamorphosis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MethodEntry {
    /// The weighted mean of the fields.
    Linear,
    /// Bounded blending in space-time.
    SpaceTime,
    /// Features with inverse-square weights (Lerios 1995).
    FeatureVolume,
    /// Features of two shapes (paper 001, eq. 1).
    Graft,
    /// Features of any number of shapes (paper 001, eq. 8).
    Group,
    /// The source's surface moves into the target's (Breen and Whitaker 2001); two shapes that
    /// overlap.
    LevelSet,
    /// The shapes' matter is moved over the shortest way (Solomon et al. 2015).
    Transport,
    /// The shapes are pulled onto common anchors, those of features or `[[anchors]]`, and averaged
    /// (Cohen-Or et al. 1998).
    Warp,
    /// Graft or group with parameters chosen by a search; features are suggested where the recipe has
    /// none, and where no parts are found it is space-time. One shape alone as it is.
    #[default]
    Auto,
    /// Two surface files of kind pde: their curves are blended and the equation solved again.
    PdeBoundary,
    /// Two surface files of kind pde: the modes of one fade out, those of the other in.
    PdeModes,
    /// Two surface files of kind pde: the curves at the ends are blended, modes elsewhere.
    PdeCombined,
    /// Two surface files of kind pde: the spines are blended, then what stands on them.
    PdeSpine,
    /// Two surface files of kind nurbs: the mean of the points.
    NurbsLinear,
    /// Two surface files of kind nurbs: the mean of the points by their masses.
    NurbsWeighted,
}

impl MethodEntry {
    /// The morph of two surface files that this method is, if it is one.
    pub fn surface(self) -> Option<SurfaceMethod> {
        Some(match self {
            Self::PdeBoundary => SurfaceMethod::PdeBoundary,
            Self::PdeModes => SurfaceMethod::PdeModes,
            Self::PdeCombined => SurfaceMethod::PdeCombined,
            Self::PdeSpine => SurfaceMethod::PdeSpine,
            Self::NurbsLinear => SurfaceMethod::NurbsLinear,
            Self::NurbsWeighted => SurfaceMethod::NurbsWeighted,
            _ => return None,
        })
    }
}

/// What hybrids of the method `auto` are to look like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StyleEntry {
    /// An in-between everywhere.
    #[default]
    Average,
    /// Whole parts of one shape or the other; of a pair they change places one after another.
    Swap,
    /// The lesser shapes grow out of the dominant one.
    Grow,
    /// The lesser shapes shrink towards the dominant one.
    Erode,
}

/// What the features' weights blend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BlendEntry {
    /// The positions: one blended look-up a shape.
    Maps,
    /// The morphed fields, as paper 001 prints it.
    Fields,
}

/// Morphing functions inside graft and group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum InnerEntry {
    /// The weighted mean of the fields.
    Linear,
    /// Bounded blending in space-time.
    SpaceTime,
    /// The lesser shapes grow out of the dominant one.
    Grow,
    /// The lesser shapes shrink towards the dominant one.
    Erode,
    /// Linear where the shapes overlap, grow where not.
    Auto,
    /// The weighted mean of the fields, raised so that the mean volume is kept.
    Mean,
    /// As grow, with the members thinned so that the mean volume is kept.
    Merge,
    /// As merge, with nothing thinned: the shapes one upon the other.
    Union,
}

/// How distances to features become weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WeightingKind {
    /// Positive and once differentiable everywhere.
    Smooth,
    /// Paper 001, eq. 5.
    Transfinite,
    /// Paper 001, eq. 4.
    InverseSquare,
}

/// A weighting with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightingEntry {
    /// Which.
    #[serde(default = "smooth")]
    pub kind: WeightingKind,
    /// Width of the transition, mm; by default 3% of the height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f64>,
    /// Power of the distance, for `smooth`; by default 2, or 4 for `blend = "fields"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<f64>,
}

fn smooth() -> WeightingKind {
    WeightingKind::Smooth
}

/// Parameters of space-time blending; what is not given is chosen from the shapes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpaceTimeEntry {
    /// Height of the blend, mm.
    #[serde(default, skip_serializing_if = "is_default")]
    pub a0: Auto<f64>,
    /// Reach of the blend from each shape, mm: one number, or one a shape.
    #[serde(default, skip_serializing_if = "is_default")]
    pub a: Auto<OneOrMany>,
    /// Reach in time; by default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub a3: Option<f64>,
    /// Which form; by default `l`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<FormEntry>,
}

/// Parameters of optimal transport.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TransportEntry {
    /// Samples along the longest side of its own lattice, 16 to 256; by default 96.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<u32>,
}

impl TransportEntry {
    /// Samples unless told.
    pub const SAMPLES: u32 = 96;
}

/// One number for all shapes, or one a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number or a list of numbers")]
pub enum OneOrMany {
    /// For all shapes.
    One(f64),
    /// In the order of the shapes.
    Many(Vec<f64>),
}

/// Forms of the space-time blend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FormEntry {
    /// The weighted mean plus the pairs' bounded blends.
    L,
    /// The union of the lowered shapes plus the pairs' bounded blends.
    S,
    /// Two half-cylinders in space-time; two shapes only.
    HalfCylinders,
}

impl MorphEntry {
    /// This entry where it says something, else `base`; rows of weights one by one.
    pub fn over(&self, base: &Self) -> Self {
        let rows = |mine: &Weights, theirs: &Weights| {
            let mut all = theirs.clone();
            all.extend(mine.iter().map(|(k, v)| (k.clone(), v.clone())));
            all
        };
        // naming the shapes of a hybrid replaces both ways of naming them
        let named = self.between.is_some() || self.among.is_some();
        let of = if named { self } else { base };
        Self {
            name: self.name.clone(),
            method: self.method.or(base.method),
            between: of.between.clone(),
            among: of.among.clone(),
            style: self.style.or(base.style),
            blend: self.blend.or(base.blend),
            inner: self.inner.or(base.inner),
            offset: self.offset.or(base.offset),
            weighting: self.weighting.clone().or_else(|| base.weighting.clone()),
            frames: self.frames.clone().or_else(|| base.frames.clone()),
            t: self.t.clone().or_else(|| base.t.clone()),
            weights: rows(&self.weights, &base.weights),
            deform_weights: rows(&self.deform_weights, &base.deform_weights),
            parts: over_parts(&self.parts, &base.parts),
            space_time: self.space_time.clone().or_else(|| base.space_time.clone()),
            transport: self.transport.clone().or_else(|| base.transport.clone()),
        }
    }

    /// What is wrong beyond the grammar; `at` is the key of this entry.
    pub(super) fn validate(&self, at: &str, recipe: &Recipe) -> Result<(), Problem> {
        if self.between.is_some() && self.among.is_some() {
            return Err(Problem::new(at, "both `between` and `among`; give one of them"));
        }
        let between = self.between.iter().flatten().map(|n| ("between", n));
        let among = self.among.iter().flatten().map(|n| ("among", n));
        for (key, name) in between.chain(among) {
            known_shape(name, &format!("{at}.{key}"), recipe)?;
        }
        if let Some(name) = self.frames.as_ref().filter(|f| *f != "average" && *f != "dominant") {
            let names = ["average", "dominant"].into_iter();
            let names = names.chain(recipe.shapes.keys().map(String::as_str));
            if !recipe.shapes.contains_key(name) {
                let hint = did_you_mean(name, names);
                let why = format!("got `{name}`; expected average, dominant or a shape{hint}");
                return Err(Problem::new(format!("{at}.frames"), why));
            }
        }
        if let Some(PlainOr::Table(w)) = &self.weighting {
            w.epsilon.map_or(Ok(()), |e| positive(e, &format!("{at}.weighting.epsilon")))?;
            w.power.map_or(Ok(()), |p| positive(p, &format!("{at}.weighting.power")))?;
        }
        rows(&self.weights, &format!("{at}.weights"), recipe)?;
        rows(&self.deform_weights, &format!("{at}.deform_weights"), recipe)?;
        for (feature, part) in &self.parts {
            let at = join(&format!("{at}.parts"), feature);
            known_feature(feature, &[], &at, recipe)?;
            finite(&[part.offset.unwrap_or(0.0)], &format!("{at}.offset"))?;
        }
        if let Some(samples) = self.transport.as_ref().and_then(|t| t.samples)
            && !(16..=256).contains(&samples)
        {
            let why = format!("got {samples}; expected 16 to 256");
            return Err(Problem::new(format!("{at}.transport.samples"), why));
        }
        self.space_time.as_ref().map_or(Ok(()), |s| s.validate(&format!("{at}.space-time")))
    }
}

impl SpaceTimeEntry {
    fn validate(&self, at: &str) -> Result<(), Problem> {
        if let Some(&a0) = self.a0.value() {
            finite(&[a0], &format!("{at}.a0"))?;
        }
        match self.a.value() {
            Some(OneOrMany::One(a)) => positive(*a, &format!("{at}.a"))?,
            Some(OneOrMany::Many(a)) => {
                a.iter().try_for_each(|&a| positive(a, &format!("{at}.a")))?;
            }
            None => {}
        }
        self.a3.map_or(Ok(()), |a| positive(a, &format!("{at}.a3")))
    }
}

fn known_shape(name: &str, at: &str, recipe: &Recipe) -> Result<(), Problem> {
    if recipe.shapes.contains_key(name) {
        return Ok(());
    }
    let hint = did_you_mean(name, recipe.shapes.keys().map(String::as_str));
    Err(Problem::new(at, format!("no shape is called `{name}`{hint}")))
}

fn known_feature(name: &str, also: &[&str], at: &str, recipe: &Recipe) -> Result<(), Problem> {
    let names = || recipe.features.iter().map(|f| f.name.as_str()).chain(also.iter().copied());
    if names().any(|n| n == name) {
        return Ok(());
    }
    let hint = did_you_mean(name, names());
    Err(Problem::new(at, format!("no feature is called `{name}`{hint}")))
}

/// The parts of both; what `mine` says of a part, key by key, goes first.
fn over_parts(
    mine: &BTreeMap<String, FeatureMorph>,
    base: &BTreeMap<String, FeatureMorph>,
) -> BTreeMap<String, FeatureMorph> {
    let mut all = base.clone();
    for (name, part) in mine {
        let merged = all.get(name).map_or_else(|| part.clone(), |b| part.over(b));
        all.insert(name.clone(), merged);
    }
    all
}

fn rows(rows: &Weights, at: &str, recipe: &Recipe) -> Result<(), Problem> {
    for (feature, row) in rows {
        let at = join(at, feature);
        known_feature(feature, &["default"], &at, recipe)?;
        for (shape, &w) in row {
            let at = join(&at, shape);
            known_shape(shape, &at, recipe)?;
            finite(&[w], &at)?;
            if w < 0.0 {
                return Err(Problem::new(at, format!("got {w}; a weight is not negative")));
            }
        }
        if row.values().sum::<f64>() <= 0.0 {
            return Err(Problem::new(at, "the weights sum to zero; give one of them more"));
        }
    }
    Ok(())
}
