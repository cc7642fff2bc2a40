//! The super-toroid.

use super::{positive, power::Waves};
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, DVec3, dvec3};
use std::f64::consts::TAU;

/// A super-toroid; lengths in mm.
///
/// ```text
/// x = rx (gamma + alpha cos^n2(v)) cos^n1(u),  y = ry (...) sin^n1(u),  z = rz alpha sin^n2(v)
/// u and v in [0, 2pi], all powers signed: sgn(x) |x|^n
/// ```
///
/// The paper (Gonzalez Castro and Ugail 2007, section IV.B) closes its bracket before the cosine and
/// gives a beta where its text has gamma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuperToroid {
    /// Scales in x, y and z.
    pub scale: DVec3,
    /// Radius of the tube.
    pub alpha: f64,
    /// Radius of the ring, at least that of the tube or it meets itself.
    pub gamma: f64,
    /// Exponent along the ring: 1 round, 0 square, 2 a diamond.
    pub n1: f64,
    /// Exponent round the tube.
    pub n2: f64,
}

impl Default for SuperToroid {
    /// The paper's.
    fn default() -> Self {
        Self { scale: DVec3::ONE, alpha: 1.0, gamma: 2.0, n1: 0.6, n2: 0.7 }
    }
}

impl SuperToroid {
    /// Checks the numbers: finite and over 0.
    ///
    /// # Errors
    /// Names the first number at fault.
    pub fn check(&self) -> Result<(), SurfaceError> {
        let Self { scale, alpha, gamma, n1, n2 } = *self;
        positive(&[("rx", scale.x), ("ry", scale.y), ("rz", scale.z)])?;
        positive(&[("alpha", alpha), ("gamma", gamma), ("n1", n1), ("n2", n2)])
    }
}

impl Surface for SuperToroid {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, TAU], v: [0.0, TAU], wraps: [true, true] }
    }

    /// Where an exponent below 1 makes a derivative infinite it is large instead.
    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let (ring, tube) = (Waves::new(uv.x, self.n1), Waves::new(uv.y, self.n2));
        let far = self.gamma + self.alpha * tube.cos;
        let slope = self.alpha * tube.cos_slope;
        Jet {
            s: self.scale * dvec3(far * ring.cos, far * ring.sin, self.alpha * tube.sin),
            su: self.scale * dvec3(far * ring.cos_slope, far * ring.sin_slope, 0.0),
            sv: self.scale * dvec3(slope * ring.cos, slope * ring.sin, self.alpha * tube.sin_slope),
        }
    }
}
