//! `dynamic` (You and Zhang 2007).

use super::{Formula, Kind};
use crate::recipe::PlainOr;
use crate::recipe::primitive::one;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A surface moved by forces. Without force or boundary it is the flat unit square.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dynamic {
    /// `dynamic`.
    #[schemars(extend("const" = "dynamic"))]
    pub kind: Kind,
    /// Nodes along u and v.
    #[serde(default = "grid")]
    pub grid: [usize; 2],
    /// Time step.
    pub dt: f64,
    /// Number of steps; the motion ends at `steps * dt`.
    pub steps: usize,
    /// How time is stepped.
    #[serde(default)]
    pub scheme: Scheme,
    /// Density.
    pub rho: f64,
    /// Damping.
    pub eta: f64,
    /// b, c, d for all components, or a list of three for x, y and z.
    pub control: PlainOr<[Control; 3], Control>,
    /// Force on x, y and z, in u, v and t.
    #[serde(default)]
    pub force: [Formula; 3],
    /// Curves and tangents at the edges.
    #[serde(default)]
    pub boundary: Boundary,
    /// The state at t = 0: `rest`, `steady`, or positions and velocities.
    #[serde(default)]
    pub start: Start,
    /// Size of one unit, mm.
    #[serde(default = "one")]
    pub scale: f64,
}

fn grid() -> [usize; 2] {
    [41, 41]
}

/// Shape control parameters.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Control {
    /// Of the fourth derivative by u.
    pub b: f64,
    /// Of the mixed derivative.
    pub c: f64,
    /// Of the fourth derivative by v.
    pub d: f64,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// Second order in dt, adds no damping.
    #[default]
    Trapezoidal,
    /// The paper's: first order, damps quick motions.
    Implicit,
}

/// What holds at the edges.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Boundary {
    /// `flat`, the unit square; or x, y, z of all four edges in u, v and t.
    #[serde(default = "flat")]
    pub curves: Option<PlainOr<Curves, Edges>>,
    /// Derivative across each edge; zero where left out.
    #[serde(default)]
    pub tangents: Edges,
    /// Of what the tangents are derivatives.
    #[serde(default)]
    pub tangents_of: TangentsOf,
}

fn flat() -> Option<PlainOr<Curves, Edges>> {
    Some(PlainOr::Plain(Curves::Flat))
}

/// Boundary curves with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Curves {
    /// The edges of the unit square.
    Flat,
}

/// x, y, z on the edges u = 0, u = 1, v = 0 and v = 1.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Edges {
    /// u = 0
    #[serde(default)]
    pub u0: Option<[Formula; 3]>,
    /// u = 1
    #[serde(default)]
    pub u1: Option<[Formula; 3]>,
    /// v = 0
    #[serde(default)]
    pub v0: Option<[Formula; 3]>,
    /// v = 1
    #[serde(default)]
    pub v1: Option<[Formula; 3]>,
}

/// Of what tangents are derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TangentsOf {
    /// The displacement from the patch between the curves.
    #[default]
    Displacement,
    /// The position.
    Position,
}

/// The state at t = 0.
pub type Start = PlainOr<StartWord, StartTable>;

impl Default for Start {
    fn default() -> Self {
        Self::Plain(StartWord::Rest)
    }
}

/// A start with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StartWord {
    /// The patch between the curves, at rest.
    Rest,
    /// In balance, at rest.
    Steady,
}

/// A start of one's own.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartTable {
    /// x, y, z in u and v.
    pub position: [Formula; 3],
    /// Their velocities in u and v.
    #[serde(default)]
    pub velocity: [Formula; 3],
}
