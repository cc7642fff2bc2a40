//! The Klein bottle, one-sided.

use super::positive;
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, dvec3};
use std::f64::consts::{PI, TAU};

/// A Klein bottle; lengths in mm, upright along y. It has a kink at u = pi, where the two formulas
/// meet, and its ends u = 0 and u = 2 pi are one curve, v against pi - v.
///
/// ```text
/// r = width (1 - cos(u)/2), z = r sin v
/// u <  pi: x = alpha cos u (1 + sin u) + r cos u cos v,  y = beta sin u + r sin u cos v
/// u >= pi: x = alpha cos u (1 + sin u) - r cos v,        y = beta sin u
/// ```
///
/// (Gonzalez Castro and Ugail 2007, section IV.A, with r for its delta.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KleinBottle {
    /// Half width of the spine.
    pub alpha: f64,
    /// Half height of the spine.
    pub beta: f64,
    /// Mean radius of the tube.
    pub width: f64,
}

impl Default for KleinBottle {
    /// The paper's.
    fn default() -> Self {
        Self { alpha: 6.0, beta: 16.0, width: 4.0 }
    }
}

impl KleinBottle {
    /// Checks the numbers: finite and over 0.
    ///
    /// # Errors
    /// Names the first number at fault.
    pub fn check(&self) -> Result<(), SurfaceError> {
        positive(&[("alpha", self.alpha), ("beta", self.beta), ("width", self.width)])
    }
}

impl Surface for KleinBottle {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, TAU], v: [0.0, TAU], wraps: [false, true] }
    }

    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let Self { alpha, beta, width } = *self;
        let (su, cu) = uv.x.sin_cos();
        let (sv, cv) = uv.y.sin_cos();
        let (r, r_slope) = (width * (1.0 - cu / 2.0), width * su / 2.0);
        let (spine, spine_slope) = (alpha * cu * (1.0 + su), alpha * (cu * cu - su * su - su));
        // The direction in which cos v leads, and how it turns with u
        let ([dx, dy], [tx, ty]) =
            if uv.x < PI { ([cu, su], [-su, cu]) } else { ([-1.0, 0.0], [0.0, 0.0]) };
        Jet {
            s: dvec3(spine + r * dx * cv, beta * su + r * dy * cv, r * sv),
            su: dvec3(
                spine_slope + (r_slope * dx + r * tx) * cv,
                beta * cu + (r_slope * dy + r * ty) * cv,
                r_slope * sv,
            ),
            sv: dvec3(-r * dx * sv, -r * dy * sv, r * cv),
        }
    }
}
