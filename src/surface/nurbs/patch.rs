//! Rational B-spline surfaces.

use super::super::{Domain, Jet, Surface};
use super::SurfaceError;
use super::knots::Knots;
use super::net::Net;
use glam::DVec2;

/// A tensor-product rational B-spline surface of any degrees: one patch.
#[derive(Clone, Debug, PartialEq)]
pub struct RationalSurface {
    pub(super) net: Net,
    domain: Domain,
}

impl RationalSurface {
    /// From a net of [x, y, z, weight], a row along u for each step along v, and
    /// `points + degree + 1` knots each way. Knots that are not clamped are clamped to their domain;
    /// the surface stays the same.
    ///
    /// # Errors
    /// Rows of different lengths, a wrong number of knots, knots that fall or repeat too often,
    /// weights that are not positive.
    pub fn new(
        degree: [usize; 2],
        knots_u: Vec<f64>,
        knots_v: Vec<f64>,
        net: &[Vec<[f64; 4]>],
    ) -> Result<Self, SurfaceError> {
        Ok(Self::of(Net::new(degree, knots_u, Some(knots_v), net)?))
    }

    pub(super) fn of(net: Net) -> Self {
        let domain = net.domain();
        Self { net, domain }
    }

    /// The (clamped) knots along u and v.
    pub fn knots(&self) -> &[Knots; 2] {
        &self.net.along
    }

    /// The control points [x, y, z, weight], row by row.
    pub fn net(&self) -> Vec<Vec<[f64; 4]>> {
        self.net.rows()
    }

    /// The same surface with more knots along u and v.
    ///
    /// # Errors
    /// Knots outside the domain, or repeated more often than the degree allows.
    pub fn refined(&self, more_u: &[f64], more_v: &[f64]) -> Result<Self, SurfaceError> {
        let net = self.net.refined(0, more_u, "knots_u")?.refined(1, more_v, "knots_v")?;
        Ok(Self::of(net))
    }

    /// The same surface at higher degrees, with the least knots: each distinct one once more a
    /// degree.
    ///
    /// # Errors
    /// A degree below the present one or above [`MAX_DEGREE`](super::MAX_DEGREE).
    pub fn elevated(&self, degree: [usize; 2]) -> Result<Self, SurfaceError> {
        Ok(Self::of(self.net.elevated(0, degree[0])?.elevated(1, degree[1])?))
    }
}

impl Surface for RationalSurface {
    fn domain(&self, _: usize) -> Domain {
        self.domain
    }

    fn jet(&self, _: usize, uv: DVec2) -> Jet {
        self.net.jet(&self.net.locate(uv))
    }
}
