//! `pde` and `pde-morph` (Gonzalez Castro and Ugail 2007).

use super::Kind;
use crate::recipe::PlainOr;
use crate::recipe::primitive::one;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A surface of PDE patches: `patches`, or a named `shape` cut into some.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pde {
    /// `pde`.
    #[schemars(extend("const" = "pde"))]
    pub kind: Kind,
    /// Fourier modes N of the curves that are used as they are.
    #[serde(default = "five")]
    pub modes: usize,
    /// The equation's parameter, at least 1: how fast detail dies away from the curves.
    #[serde(default = "one")]
    pub a: f64,
    /// Whether the remainder takes up what the modes leave of the curves.
    #[serde(default = "yes")]
    pub remainder: bool,
    /// Size of one unit of the shape or of the curves, mm.
    #[serde(default = "one")]
    pub scale: f64,
    /// The patches, one after the other.
    #[serde(default)]
    pub patches: Vec<Patch>,
    /// A named shape instead of patches.
    #[serde(default)]
    pub shape: Option<Shape>,
    /// Numbers of the named shape that differ from its own, by name.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// Patches that the named shape is cut into.
    #[serde(default)]
    pub divisions: Option<usize>,
    /// Points of each curve of the named shape.
    #[serde(default)]
    pub points: Option<usize>,
}

fn five() -> usize {
    5
}

fn yes() -> bool {
    true
}

/// A shape with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// A Klein bottle: alpha, beta, width.
    KleinBottle,
    /// A sea shell: alpha, beta, delta, turns.
    SeaShell,
    /// A super-ellipsoid: alpha, beta, gamma, n1, n2.
    SuperEllipsoid,
    /// A super-toroid: rx, ry, rz, alpha, gamma, n1, n2.
    SuperToroid,
    /// A dolphin of five patches, without parameters.
    Dolphin,
}

impl Shape {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::KleinBottle => "klein-bottle",
            Self::SeaShell => "sea-shell",
            Self::SuperEllipsoid => "super-ellipsoid",
            Self::SuperToroid => "super-toroid",
            Self::Dolphin => "dolphin",
        }
    }
}

/// The four curves of a patch.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Where the curves sit, increasing in [0, 1]; by default 0, 1/3, 2/3, 1.
    #[serde(default)]
    pub u: Option<[f64; 4]>,
    /// The curves: points at equal steps of v, or Fourier terms.
    pub curves: [Curve; 4],
}

/// A closed curve over v: points `[x, y, z]` at equal steps of v in [0, 2 pi), or its terms.
pub type Curve = PlainOr<Vec<[f64; 3]>, Terms>;

/// A curve as a Fourier sum; only a mean is a pole.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Its mean.
    pub mean: [f64; 3],
    /// Factors of cos(nv) for n = 1, 2, ...
    #[serde(default)]
    pub cos: Vec<[f64; 3]>,
    /// Factors of sin(nv) for n = 1, 2, ...
    #[serde(default)]
    pub sin: Vec<[f64; 3]>,
}

/// A morph of two PDE surfaces.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PdeMorph {
    /// `pde-morph`.
    #[schemars(extend("const" = "pde-morph"))]
    pub kind: Kind,
    /// The source, a file of kind `pde`.
    pub from: PathBuf,
    /// The target, a file of kind `pde`.
    pub to: PathBuf,
    /// What is blended.
    #[serde(default)]
    pub method: PdeMethod,
    /// How far t = 1 leads: 1 is the target, more goes past it.
    #[serde(default = "one")]
    pub gamma: f64,
    /// The blend has gone gamma t^power at t.
    #[serde(default = "one")]
    pub power: f64,
    /// The same for each of the four curves of every patch (`boundary`, `combined`): gamma, or
    /// `{ gamma, power }`.
    #[serde(default)]
    pub curves: Option<[PlainOr<f64, Epsilon>; 4]>,
    /// The same for the radial part (`spine`), apart from the spine.
    #[serde(default)]
    pub radial: Option<PlainOr<f64, Epsilon>>,
}

/// Which of the four morphs of paper 000.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PdeMethod {
    /// The curves, solved again (III.A).
    #[default]
    Boundary,
    /// The number of modes (III.B).
    Modes,
    /// Both (III.C).
    Combined,
    /// Spine and radial part of the solved surfaces (III.D).
    Spine,
}

/// How far a blend has gone at t: gamma t^power.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Epsilon {
    /// Where t = 1 leads.
    #[serde(default = "one")]
    pub gamma: f64,
    /// 1 is steady; more starts slowly.
    #[serde(default = "one")]
    pub power: f64,
}
