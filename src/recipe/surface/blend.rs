//! `blend` (You, Ugail and Zhang 2012).

use super::{Formula, Kind};
use crate::recipe::primitive::one;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A C1 blend between two moving surfaces.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Blend {
    /// `blend`.
    #[schemars(extend("const" = "blend"))]
    pub kind: Kind,
    /// Factor of the fourth derivative by u.
    pub beta: f64,
    /// Factor of the mixed derivative.
    pub gamma: f64,
    /// Factor of the fourth derivative by v.
    pub lambda: f64,
    /// Density: factor of the second derivative by t.
    pub rho: f64,
    /// Damping: factor of the first derivative by t.
    pub eta: f64,
    /// Number of corrections K.
    #[serde(default = "seven")]
    pub terms: usize,
    /// Kind of corrections: `bubble`, or the paper's `sine`.
    #[serde(default)]
    pub basis: Basis,
    /// Points over u and v at which the residual is made small.
    #[serde(default = "points")]
    pub collocation: [usize; 2],
    /// First and last v.
    #[serde(default = "round")]
    pub v: [f64; 2],
    /// What the blend meets at u = 0.
    #[serde(rename = "at-0")]
    pub at_0: Side,
    /// What the blend meets at u = 1.
    #[serde(rename = "at-1")]
    pub at_1: Side,
    /// Whether the two surfaces it meets are drawn too: patches 0 and 2, the blend is patch 1.
    #[serde(default)]
    pub beside: bool,
    /// Whether the closed form is taken instead of the series; not every blend has one.
    #[serde(default)]
    pub exact: bool,
    /// Size of one unit, mm.
    #[serde(default = "one")]
    pub scale: f64,
}

fn seven() -> usize {
    7
}

fn points() -> [usize; 2] {
    [21, 21]
}

fn round() -> [f64; 2] {
    [0.0, TAU]
}

/// The corrections of a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// u^2 (1 - u)^2 times polynomials.
    #[default]
    Bubble,
    /// The paper's sines, corrected.
    Sine,
}

/// One end of a blend: `position` and `tangent` over v and t, or a `surface` over u, v and t, which
/// runs `from` one u to the `cut`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Side {
    /// Position x, y, z.
    #[serde(default)]
    pub position: Option<[Formula; 3]>,
    /// Derivative by u of x, y, z.
    #[serde(default)]
    pub tangent: Option<[Formula; 3]>,
    /// The surface that the blend leaves, x, y, z.
    #[serde(default)]
    pub surface: Option<[Formula; 3]>,
    /// The u where that surface begins.
    #[serde(default)]
    pub from: Option<f64>,
    /// The u where the blend takes over.
    #[serde(default)]
    pub cut: Option<f64>,
}
