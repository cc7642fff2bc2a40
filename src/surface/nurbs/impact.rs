//! The area of impact: controls round a centre that follow it (the paper's section 4.4).

use super::knots::Knots;
use super::net::Net;
use super::{SurfaceError, wrong};
use crate::weight::Ease;

/// How much of the change at the centre a control takes, by its distance in radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Falloff {
    /// 1 - 3 d^2 + 2 d^3: flat at the centre and at the rim.
    #[default]
    Smooth,
    /// 1 - d.
    Linear,
    /// 1 - u(d) for a function of the user's.
    Custom(Ease),
}

impl Falloff {
    /// The share at `d` radii: 1 at the centre, 0 from the rim on (for a custom one: what it says).
    pub fn at(&self, d: f64) -> f64 {
        let d = d.clamp(0.0, 1.0);
        match self {
            Self::Smooth => 1.0 - d * d * (3.0 - 2.0 * d),
            Self::Linear => 1.0 - d,
            Self::Custom(ease) => 1.0 - ease.at(d),
        }
    }
}

/// An ellipse in the (u, v) plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// Its centre (u, v); curves take no notice of v.
    pub centre: [f64; 2],
    /// Its half axes along u and v, above 0.
    pub radius: [f64; 2],
    /// What the controls within it take.
    pub falloff: Falloff,
}

impl Impact {
    /// Moves each number towards `to` by the falloff at its control (its Greville abscissae);
    /// round the back where the net closes up.
    pub(super) fn pull(
        &self,
        mut list: Vec<f64>,
        net: &Net,
        to: f64,
    ) -> Result<Vec<f64>, SurfaceError> {
        if let Some(axis) = self.radius.iter().position(|r| r.is_nan() || *r <= 0.0) {
            let why = format!("radius is {}; expected a positive number", self.radius[axis]);
            return wrong(format!("radius[{axis}]"), why);
        }
        let across = [0, 1].map(|axis| self.across(axis, &net.along[axis], net.wraps(axis)));
        for (k, r) in list.iter_mut().enumerate() {
            let (i, j) = (k % net.width(), k / net.width());
            let d = across[0][i].hypot(across[1][j]);
            if d < 1.0 {
                let f = self.falloff.at(d);
                *r = *r * (1.0 - f) + to * f;
            }
        }
        Ok(list)
    }

    /// Distance of each control from the centre along an axis, in radii.
    fn across(&self, axis: usize, knots: &Knots, wraps: bool) -> Vec<f64> {
        if knots.degree() == 0 {
            return vec![0.0];
        }
        let [a, b] = knots.domain();
        let distance = |t: f64| {
            let d = (t - self.centre[axis]).abs();
            if wraps { d.min((b - a - d).abs()) } else { d }
        };
        knots.centres().into_iter().map(|t| distance(t) / self.radius[axis]).collect()
    }
}
