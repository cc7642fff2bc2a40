//! What a method needs to be told; the scene fills it in, [`super::build`] checks it.

use super::{level_set, transport};
use crate::element::Element;
use crate::field::Shared;
use crate::job::Cancelled;
use crate::num::Aabb;
use crate::weight::{Ease, Weighting};

/// A shape that takes part in a morph.
#[derive(Clone)]
pub struct Part {
    /// Name, as in the recipe.
    pub name: String,
    /// Signed distance, mm; looked up many times, so usually a sampled form.
    pub field: Shared,
}

/// A feature: one element on every shape, all aligned to each other.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Name, as in the recipe.
    pub name: String,
    /// One element a shape, in the order of the shapes.
    pub elements: Vec<Element>,
    /// Shape weights and frame weights of this feature.
    pub morph: Course,
    /// Weights of the frames; apart from the shapes' (paper 001, section 3.2).
    pub deform: Course,
    /// Offset d of paper 001, eq. 6, mm; positive thickens. Of a pair it is reached half way, see
    /// [`Feature::offset_at`].
    pub offset: f64,
    /// Morphing function of this feature; by default the plan's. See [`Inner::by_feature`].
    pub inner: Option<Inner>,
}

impl Feature {
    /// The offset o_i(t), mm: of a pair `4 u (1 - u)` of the whole, so that the ends are the inputs;
    /// with fixed weights always the whole.
    pub fn offset_at(&self, t: f64) -> f64 {
        match &self.morph {
            Course::Pair(ease) => {
                let u = ease.at(t);
                self.offset * 4.0 * u * (1.0 - u)
            }
            Course::Fixed(_) => self.offset,
        }
    }
}

/// A place where a shape touches the floor, and its hybrids should.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Its middle, on the floor.
    pub at: glam::DVec3,
    /// Radius in the plan that holds all of it, mm.
    pub reach: f64,
}

/// How the weights of the shapes depend on time.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// Two shapes: weights (1 - u(t), u(t)).
    Pair(Ease),
    /// Any number of shapes: the same positive weights at every time, not yet normalised.
    Fixed(Vec<f64>),
}

impl Course {
    /// Weights at `t`, one a shape, summing to one.
    pub fn at(&self, t: f64) -> Vec<f64> {
        match self {
            Self::Pair(ease) => {
                let u = ease.at(t);
                vec![1.0 - u, u]
            }
            Self::Fixed(w) => {
                let sum: f64 = w.iter().sum();
                w.iter().map(|x| x / sum).collect()
            }
        }
    }
}

/// What the features' weights blend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// The positions: one blended look-up a shape.
    Maps,
    /// The morphed fields: paper 001, eqs 1 and 8 to the letter.
    Fields,
}

/// The morphing function f_m inside the features, or of the whole shapes where there are none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inner {
    /// The weighted mean of the fields (paper 001, eq. 2).
    Linear,
    /// Bounded blending in space-time (METHODS B).
    SpaceTime,
    /// The lesser shapes grow out of the dominant one.
    Grow,
    /// The lesser shapes shrink towards the dominant one.
    Erode,
    /// Feature by feature: linear with an offset where the shapes overlap, grow where not.
    Auto,
    /// The weighted mean of the fields, raised in each feature so that the mean volume is kept.
    Mean,
    /// As grow, with the members thinned in each feature so that the mean volume is kept.
    Merge,
    /// As merge, with nothing thinned.
    Union,
}

impl Inner {
    /// Whether one feature may have this function while others have another such one.
    pub fn by_feature(self) -> bool {
        !matches!(self, Self::SpaceTime | Self::Erode)
    }
}

/// Which frames the features of the result have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// The weighted mean of the shapes' frames.
    Average,
    /// The frames of one shape, by its index.
    Of(usize),
}

/// Base of the space-time blend of k shapes (METHODS B).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The weighted mean plus the pairs' bounded blends.
    L,
    /// The union of the lowered shapes plus the pairs' bounded blends.
    S,
    /// Two half-cylinders in space-time joined by a bounded blend (Pasko et al. 2004); pairs only.
    HalfCylinders,
}

/// Parameters of space-time blending; `None` is chosen from the shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceTime {
    /// Which form.
    pub form: Form,
    /// Height of the blend, mm; by default the one that keeps the weighted mean volume.
    pub a0: Option<f64>,
    /// Reach of the blend from each shape, mm; by default the largest one-sided Hausdorff distance.
    pub a: Option<Vec<f64>>,
    /// Reach in time.
    pub a3: f64,
}

impl Default for SpaceTime {
    fn default() -> Self {
        Self { form: Form::L, a0: None, a: None, a3: 1.0 }
    }
}

/// A point of every shape that belongs together, beside those of the features.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Name, as in the recipe.
    pub name: String,
    /// Where it stands on each shape, in the order of the shapes, mm.
    pub at: Vec<glam::DVec3>,
}

/// How the shapes become one. Each scheme takes of a [`Plan`] what it needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Scheme {
    /// Blending by features, or of whole shapes where there are none: what `blend`, `inner` and the
    /// weightings say (paper 001).
    #[default]
    Blend,
    /// The source's surface moves into the target's (Breen and Whitaker 2001). Two shapes.
    LevelSet {
        /// Cells of the lattice it moves on, mm; larger where there would be too many.
        step: f64,
    },
    /// The shapes' matter is moved over the shortest way (Solomon et al. 2015).
    Transport {
        /// Samples along the longest side of the lattice it is moved on.
        samples: u32,
    },
    /// The shapes are pulled onto common anchors and averaged (Cohen-Or et al. 1998). The features
    /// give anchors too.
    Warp {
        /// Further anchors.
        anchors: Vec<Anchor>,
    },
}

impl Scheme {
    /// Memory (bytes) that the scheme needs beside the shapes, over a domain.
    pub fn bytes(&self, domain: &Aabb, shapes: usize) -> f64 {
        match self {
            Self::Blend | Self::Warp { .. } => 0.0,
            Self::LevelSet { step } => level_set::count(domain, *step) * level_set::BYTES,
            Self::Transport { samples } => transport::bytes(domain, *samples, shapes),
        }
    }
}

/// Everything a morph is made from.
#[derive(Clone)]
pub struct Plan {
    /// How the shapes become one.
    pub scheme: Scheme,
    /// The shapes, two or more.
    pub shapes: Vec<Part>,
    /// Features; empty for a morph of whole shapes.
    pub features: Vec<Feature>,
    /// Weights of whole shapes, for a morph without features.
    pub course: Course,
    /// What the weights blend.
    pub blend: Blend,
    /// Morphing function.
    pub inner: Inner,
    /// How feature distances become weights.
    pub weighting: Weighting,
    /// Weighting of the shape weights in the maps blend; sharper than that of the positions.
    pub sharp: Weighting,
    /// Frames of the result.
    pub frames: Frames,
    /// Parameters of [`Inner::SpaceTime`].
    pub space_time: SpaceTime,
    /// Side of the cells that results are sampled with, mm: nothing is made thinner than they can hold.
    /// Nought leaves that open.
    pub cell: f64,
    /// Where each shape touches the floor; may be empty.
    pub feet: Vec<Vec<Foot>>,
}

impl Plan {
    /// A morph of whole shapes, without features: a pair by time, more shapes in equal shares.
    pub fn whole(shapes: Vec<Part>, inner: Inner) -> Self {
        let course = match shapes.len() {
            2 => Course::Pair(Ease::Power(1.0)),
            k => Course::Fixed(vec![1.0; k]),
        };
        Self {
            scheme: Scheme::Blend,
            shapes,
            features: Vec::new(),
            course,
            blend: Blend::Maps,
            inner,
            weighting: Weighting::Transfinite,
            sharp: Weighting::Transfinite,
            frames: Frames::Average,
            space_time: SpaceTime::default(),
            cell: 0.0,
            feet: Vec::new(),
        }
    }
}

/// What keeps a plan from being carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MorphError {
    /// Fewer than two shapes.
    #[error("a morph needs two shapes or more, got {0}")]
    Shapes(usize),
    /// An element is missing or there is one too many.
    #[error("feature `{feature}` has {got} elements for {shapes} shapes")]
    Unpaired {
        /// Its name.
        feature: String,
        /// Elements given.
        got: usize,
        /// Shapes of the morph.
        shapes: usize,
    },
    /// Weights that cannot be normalised.
    #[error("{at}: weights must be {shapes} numbers, none negative, not all zero")]
    Weights {
        /// Feature name, or `default`.
        at: String,
        /// Shapes of the morph.
        shapes: usize,
    },
    /// A function of a feature that cannot stand beside others.
    #[error(
        "feature `{0}`: space-time and erode are for the whole morph; a feature of its own takes \
         linear, grow, auto, mean, merge or union, in a morph of one of these"
    )]
    Inner(String),
    /// An anchor is missing or there is one too many.
    #[error("anchor `{anchor}` has {got} points for {shapes} shapes")]
    Anchors {
        /// Its name.
        anchor: String,
        /// Points given.
        got: usize,
        /// Shapes of the morph.
        shapes: usize,
    },
    /// A method that takes two shapes only.
    #[error("method `{method}` takes two shapes, got {got}; use another method")]
    TwoShapes {
        /// Which.
        method: &'static str,
        /// Shapes given.
        got: usize,
    },
    /// Nothing lies in both shapes.
    #[error(
        "the shapes do not overlap: no point lies inside both `{a}` and `{b}`, and a level set grows \
         only out of what both have; place them over each other, or use another method"
    )]
    Apart {
        /// The source.
        a: String,
        /// The target.
        b: String,
    },
    /// A shape without any inside.
    #[error(
        "`{0}` has no volume to move: no inside was found; give it a thickness, or use another method"
    )]
    Hollow(String),
    /// Shapes that no lattice can hold.
    #[error("the shapes have no finite size")]
    Unbounded,
    /// A form that takes two shapes only.
    #[error("space-time form `half-cylinders` takes two shapes, got {0}; use `l` or `s`")]
    PairOnly(usize),
    /// A shape that moves, and has no field at this time.
    #[error("shape `{shape}` at t = {t}: {why}")]
    Shape {
        /// Its name.
        shape: String,
        /// The time.
        t: f64,
        /// What the surface says.
        why: String,
    },
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A number out of its range.
    #[error("{what} must be {expected}, got {got}")]
    Range {
        /// Which number.
        what: String,
        /// What is allowed.
        expected: &'static str,
        /// What was given.
        got: f64,
    },
}
