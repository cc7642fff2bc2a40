//! C1 blends between two moving surfaces (You, Ugail and Zhang 2012; METHODS A-002).
//!
//! A blend S(u, v, t) meets two *primary surfaces* at u = 0 and u = 1 in position and u derivative,
//! and between them nearly solves (their eq. 3, without force)
//!
//! ```text
//! beta S_uuuu + gamma S_uuvv + lambda S_vvvv + rho S_tt + eta S_t = 0
//! ```
//!
//! The boundary data are multiplied out into sums over functions F_j(v, t), and
//! S = sum_j G_j(u) F_j(v, t), where G_j is a cubic that carries the ends plus K corrections that
//! leave them alone. The corrections minimise the squared residual at points of (u, v, t).
//!
//! Where this leaves the paper, and why:
//! - The sines: eq. 9 and 10 leave out the slope of sin(k pi u) at u = 0, so the printed blend does not
//!   meet its tangents there. [`Basis::Sine`] has the missing cubic.
//! - The default [`Basis::Bubble`] costs the same and converges geometrically.
//! - Eq. 15 has a bracket slip. The right-hand side here is the operator applied to the cubics.
//! - Eq. 7 asks each term of the sum to vanish alone. That is right only where derivatives of F_j are
//!   multiples of F_j; for t or v^2 they are other functions. Functions that meet in each other's
//!   derivatives are solved together, over t as well, so that G_j depends on u only.

mod exact;
mod examples;
mod functions;
mod primary;
mod profile;
mod solve;
mod surface;
#[cfg(test)]
mod tests;

pub use exact::Exact;
pub use examples::{cone, cylinders, frustum};
pub use primary::{Beside, Primary};
pub use profile::Basis;
pub use surface::BlendSurface;

use super::{Motion, Surface, SurfaceError};
use crate::num::Expr;
use primary::Extent;
use std::sync::Arc;
use surface::Separated;

/// The five numbers that shape a blend: the factors of the terms of its equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handles {
    /// Of S_uuuu.
    pub beta: f64,
    /// Of S_uuvv.
    pub gamma: f64,
    /// Of S_vvvv.
    pub lambda: f64,
    /// Density, of S_tt.
    pub rho: f64,
    /// Damping, of S_t.
    pub eta: f64,
}

/// All that makes a blend, as a surface file holds it.
#[derive(Clone, Debug)]
pub struct BlendSpec {
    /// beta, gamma, lambda, rho, eta.
    pub handles: Handles,
    /// Number of corrections K (paper: terms of the sine series), at most 40.
    pub terms: usize,
    /// Kind of corrections.
    pub basis: Basis,
    /// Points L over u and M over v at which the residual is taken, ends included, 2 to 400 each.
    pub collocation: [usize; 2],
    /// First and last v.
    pub v: [f64; 2],
    /// What the blend meets at u = 0 and u = 1.
    pub at: [Side; 2],
}

/// What a blend meets at one end.
#[derive(Clone, Debug)]
pub struct Side {
    /// Position over v and t, mm.
    pub(super) position: [Expr; 3],
    /// Derivative by u over v and t, mm.
    pub(super) tangent: [Expr; 3],
    extent: Extent,
}

impl Side {
    /// From position and tangent, expressions in v and t. The primary surface drawn beside the blend
    /// goes on straight along the tangent for a quarter of its length.
    ///
    /// # Errors
    /// `position[i]` or `tangent[i]` (the caller knows which end), and what is wrong with the expression.
    pub fn new(position: [&str; 3], tangent: [&str; 3]) -> Result<Self, SurfaceError> {
        let position = read("position", position, &["v", "t"])?;
        let tangent = read("tangent", tangent, &["v", "t"])?;
        Ok(Self { position, tangent, extent: Extent::Straight { reach: 0.25 } })
    }

    /// From a primary surface, expressions in u, v and t, that runs from u = `from` to the cut at
    /// u = `cut`, where the blend takes over (paper 002, eq. 1).
    ///
    /// # Errors
    /// `surface[i]`, and what is wrong with the expression.
    pub fn cut(surface: [&str; 3], from: f64, cut: f64) -> Result<Self, SurfaceError> {
        let surface = read("surface", surface, &["u", "v", "t"])?;
        let mut sides = [const { Vec::new() }; 2];
        for (i, s) in surface.iter().enumerate() {
            let at = |e: &dyn std::fmt::Display| {
                SurfaceError::new(format!("surface[{i}]"), e.to_string())
            };
            let slope = s.derivative(0).map_err(|e| at(&e))?;
            for (side, e) in sides.iter_mut().zip([s, &slope]) {
                side.push(e.with(0, cut).over(&["v", "t"]).ok_or_else(|| at(&"depends on u"))?);
            }
        }
        let [position, tangent] = sides.map(<[Expr; 3]>::try_from);
        match (position, tangent) {
            (Ok(position), Ok(tangent)) => {
                Ok(Self { position, tangent, extent: Extent::Cut { surface, from, cut } })
            }
            _ => Err(SurfaceError::new("surface", "needs three components")),
        }
    }
}

/// Three expressions, their errors named by key and place.
fn read(key: &str, texts: [&str; 3], variables: &[&str]) -> Result<[Expr; 3], SurfaceError> {
    let one = |i: usize| {
        Expr::parse(texts[i], variables)
            .map_err(|e| SurfaceError::new(format!("{key}[{i}]"), e.to_string()))
    };
    Ok([one(0)?, one(1)?, one(2)?])
}

/// A blend, solved for all times.
#[derive(Clone, Debug)]
pub struct Blend {
    spec: BlendSpec,
    sum: Separated,
}

impl Blend {
    /// Finds the functions of the boundary data and solves for the corrections, once for all t.
    ///
    /// # Errors
    /// `terms`, `collocation` or `v` out of range or too few points for the terms; an expression of
    /// `at-0` or `at-1` without a value; `beta` and the other handles where they make the equation
    /// nearly singular.
    pub fn new(spec: BlendSpec) -> Result<Self, SurfaceError> {
        solve::check(&spec)?;
        primary::check_values(&spec)?;
        let sum = solve::solve(&spec)?;
        Ok(Self { spec, sum })
    }

    /// What it was made of.
    pub fn spec(&self) -> &BlendSpec {
        &self.spec
    }

    /// The functions F_j(v, t) of the boundary data, as text.
    pub fn functions(&self) -> Vec<String> {
        self.sum.functions.iter().map(|f| f.f.to_string()).collect()
    }

    /// The solution without approximation, where there is one: every derivative of a function a
    /// multiple of that function, and no repeated roots (paper 002, eqs 20 to 28).
    ///
    /// # Errors
    /// `beta`, the function, and why there is no closed form for it.
    pub fn exact(&self) -> Result<Exact, SurfaceError> {
        exact::exact(&self.spec, &self.sum)
    }

    /// The surface at a time, with its own type.
    ///
    /// # Errors
    /// As [`Motion::at`]: an expression without a value at that time.
    pub fn surface(&self, t: f64) -> Result<BlendSurface, SurfaceError> {
        self.sum.at(t, &self.spec)
    }

    /// The primary surface met at u = 0 (`end` 0) or u = 1 (any other).
    ///
    /// # Errors
    /// `surface`, where its derivative is too long.
    pub fn primary(&self, end: usize) -> Result<Primary, SurfaceError> {
        Primary::new(&self.spec, end.min(1))
    }

    /// The blend between its two primary surfaces: three patches, the blend in the middle.
    ///
    /// # Errors
    /// As [`Blend::primary`].
    pub fn beside(&self) -> Result<Beside, SurfaceError> {
        Ok(Beside { blend: self.clone(), primary: [self.primary(0)?, self.primary(1)?] })
    }
}

impl Motion for Blend {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(Arc::new(self.surface(t)?))
    }
}
