//! Parametric surfaces and curves: a position and its derivatives for every (u, v), perhaps for every
//! time t.
//!
//! A *patch* is one map from a rectangle of (u, v) to space; a surface is one patch or many. A
//! *motion* gives a surface for every t in [0, 1]. Lengths are millimetres, angles radians.

pub mod bicubic;
pub mod blend;
pub mod dynamic;
pub mod nurbs;
pub mod pde;
pub mod shapes;
pub mod tessellate;

use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The rectangle of parameters of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// First and last u.
    pub u: [f64; 2],
    /// First and last v.
    pub v: [f64; 2],
    /// Whether the last u (v) is the first one again, so that the patch closes up.
    pub wraps: [bool; 2],
}

/// A point of a patch and its first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Position, mm.
    pub s: DVec3,
    /// Derivative by u.
    pub su: DVec3,
    /// Derivative by v.
    pub sv: DVec3,
}

/// A parametric surface of one or more patches.
pub trait Surface: Send + Sync {
    /// Number of patches, at least 1.
    fn patches(&self) -> usize {
        1
    }
    /// The parameters of a patch.
    fn domain(&self, patch: usize) -> Domain;
    /// Position and first derivatives, analytic.
    fn jet(&self, patch: usize, uv: DVec2) -> Jet;
    /// Position only.
    fn point(&self, patch: usize, uv: DVec2) -> DVec3 {
        self.jet(patch, uv).s
    }
}

/// A surface that depends on time.
pub trait Motion: Send + Sync {
    /// The surface at `t` in [0, 1].
    ///
    /// # Errors
    /// What the equation behind it says: an ill-posed system, a time out of reach.
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError>;
}

/// What can go wrong with a surface; each kind has its own messages.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {why}")]
pub struct SurfaceError {
    /// The parameter at fault, as the surface file names it, such as `knots_u`.
    pub at: String,
    /// What was wrong, got and expected.
    pub why: String,
}

impl SurfaceError {
    /// A parameter and what is wrong with it.
    pub fn new(at: impl Into<String>, why: impl Into<String>) -> Self {
        Self { at: at.into(), why: why.into() }
    }
}
