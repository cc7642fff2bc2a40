//! The sea shell: a tube that thins while it winds up.

use super::positive;
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// A sea shell; lengths in mm. Open at its wide end, u = 0; a pole at u = 2 pi.
///
/// ```text
/// r = alpha (1 - u/2pi),  x = (r (1 + cos v) + delta) cos(turns u),  y = (...) sin(turns u),
/// z = beta u/2pi + r sin v,  u and v in [0, 2pi]
/// ```
///
/// The paper (Gonzalez Castro and Ugail 2007, section IV.A) prints another offset and factor in y, a
/// cosine for its sine, and half the range of u: its picture is this one, known from Nordstrand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeaShell {
    /// Radius of the tube at its mouth.
    pub alpha: f64,
    /// Height of the axis.
    pub beta: f64,
    /// Radius of the hole along the axis.
    pub delta: f64,
    /// Whorls.
    pub turns: f64,
}

impl Default for SeaShell {
    /// The paper's.
    fn default() -> Self {
        Self { alpha: 0.2, beta: 1.0, delta: 0.1, turns: 2.0 }
    }
}

impl SeaShell {
    /// Checks the numbers: all finite; `alpha` and `turns` over 0, the others at least 0.
    ///
    /// # Errors
    /// Names the first number at fault.
    pub fn check(&self) -> Result<(), SurfaceError> {
        positive(&[("alpha", self.alpha), ("turns", self.turns)])?;
        for (name, x) in [("beta", self.beta), ("delta", self.delta)] {
            if !(x.is_finite() && x >= 0.0) {
                return Err(SurfaceError::new(name, format!("{x}; a finite number, at least 0")));
            }
        }
        Ok(())
    }
}

impl Surface for SeaShell {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, TAU], v: [0.0, TAU], wraps: [false, true] }
    }

    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let Self { alpha, beta, delta, turns } = *self;
        let (r, r_slope) = (alpha * (1.0 - uv.x / TAU), -alpha / TAU);
        let (st, ct) = (turns * uv.x).sin_cos();
        let (sv, cv) = uv.y.sin_cos();
        let (far, far_slope) = (r * (1.0 + cv) + delta, r_slope * (1.0 + cv));
        Jet {
            s: dvec3(far * ct, far * st, beta * uv.x / TAU + r * sv),
            su: DVec3::new(
                far_slope * ct - turns * far * st,
                far_slope * st + turns * far * ct,
                beta / TAU + r_slope * sv,
            ),
            sv: dvec3(-r * sv * ct, -r * sv * st, r * cv),
        }
    }
}
