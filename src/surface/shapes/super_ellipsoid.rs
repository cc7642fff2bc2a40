//! The super-ellipsoid.

use super::{positive, power::Waves};
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, dvec3};
use std::f64::consts::{PI, TAU};

/// A super-ellipsoid; lengths in mm. Poles at the ends of u, which runs down from the top.
///
/// ```text
/// x = alpha sin^n1(u) cos^n2(v),  y = beta sin^n1(u) sin^n2(v),  z = gamma cos^n1(u)
/// u in [0, pi], v in [0, 2pi], all powers signed: sgn(x) |x|^n
/// ```
///
/// The paper (Gonzalez Castro and Ugail 2007, section IV.B) prints a sine in z, which would make a
/// disc of it, and has u and v the other way round; here v is the one that closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuperEllipsoid {
    /// Half size in x.
    pub alpha: f64,
    /// Half size in y.
    pub beta: f64,
    /// Half size in z.
    pub gamma: f64,
    /// Exponent from pole to pole: 1 round, 0 a box, 2 straight, more hollow.
    pub n1: f64,
    /// Exponent round the axis.
    pub n2: f64,
}

impl Default for SuperEllipsoid {
    /// The paper's.
    fn default() -> Self {
        Self { alpha: 1.0, beta: 2.0, gamma: 2.0, n1: 0.8, n2: 1.7 }
    }
}

impl SuperEllipsoid {
    /// Checks the numbers: finite and over 0.
    ///
    /// # Errors
    /// Names the first number at fault.
    pub fn check(&self) -> Result<(), SurfaceError> {
        let Self { alpha, beta, gamma, n1, n2 } = *self;
        let named = [("alpha", alpha), ("beta", beta), ("gamma", gamma), ("n1", n1), ("n2", n2)];
        positive(&named)
    }
}

impl Surface for SuperEllipsoid {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, PI], v: [0.0, TAU], wraps: [false, true] }
    }

    /// Where an exponent below 1 makes a derivative infinite it is large instead.
    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let (a, b) = (Waves::new(uv.x, self.n1), Waves::new(uv.y, self.n2));
        let size = dvec3(self.alpha, self.beta, self.gamma);
        Jet {
            s: size * dvec3(a.sin * b.cos, a.sin * b.sin, a.cos),
            su: size * dvec3(a.sin_slope * b.cos, a.sin_slope * b.sin, a.cos_slope),
            sv: size * dvec3(a.sin * b.cos_slope, a.sin * b.sin_slope, 0.0),
        }
    }
}
