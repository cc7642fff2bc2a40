//! The weighted average of compatible nets with masses of its own.
//!
//! D_i = l_i m_i / sum l_j m_j and M = sum D_i P_i. Unless the masses are the targets' own weights,
//! M is no B-spline of the same degree, so it is worked out point by point, with its derivatives.

use super::super::{Domain, Jet, Surface};
use super::curve::{self, Curve, CurveJet};
use super::net::{self, Net, Spot, ends};
use glam::{DVec2, DVec3, DVec4};
use std::sync::Arc;

/// The masses of each target, in the order of its poles.
pub(super) type Masses = Arc<Vec<Vec<f64>>>;

/// A frame of a morph.
pub(super) struct Blended {
    nets: Arc<Vec<Net>>,
    /// The weight l_i of each target; they sum to one, and some are zero.
    shares: Vec<f64>,
    /// None: one everywhere.
    masses: Option<Masses>,
    domain: Domain,
    breaks: Vec<f64>,
}

impl Blended {
    pub fn new(nets: Arc<Vec<Net>>, shares: Vec<f64>, masses: Option<Masses>) -> Self {
        let mut domain = nets[0].domain();
        for axis in [0, 1] {
            domain.wraps[axis] = nets.iter().all(|n| n.wraps(axis))
                && masses.iter().flat_map(|m| m.iter()).all(|m| joins(m, nets[0].width(), axis));
        }
        let breaks = nets[0].along[0].breaks();
        Self { nets, shares, masses, domain, breaks }
    }

    /// Number, net and weight of the targets that take part.
    fn targets(&self) -> impl Iterator<Item = (usize, &Net, f64)> {
        let weighted = self.nets.iter().zip(&self.shares).enumerate();
        weighted.filter(|(_, (_, l))| **l > 0.0).map(|(i, (net, &l))| (i, net, l))
    }

    /// l m, l m_u, l m_v of a target at a spot.
    fn mass(&self, target: usize, share: f64, spot: &Spot) -> [f64; 3] {
        let Some(masses) = &self.masses else {
            return [share, 0.0, 0.0];
        };
        let mut sums = [0.0; 3];
        spot.each(self.nets[target].width(), |pole, f| {
            let m = share * masses[target][pole];
            (0..3).for_each(|k| sums[k] += m * f[k]);
        });
        sums
    }

    /// The normalised distances D_i at a point: not negative, and their sum is one.
    pub fn distances(&self, uv: DVec2) -> Vec<f64> {
        let spot = self.nets[0].locate(uv);
        let mut out = vec![0.0; self.nets.len()];
        self.targets().for_each(|(i, _, l)| out[i] = self.mass(i, l, &spot)[0]);
        let sum: f64 = out.iter().sum();
        out.iter().map(|m| m / sum).collect()
    }
}

/// Whether the masses on the last line along an axis are those on the first, to 1e-9.
fn joins(masses: &[f64], width: usize, axis: usize) -> bool {
    ends(width, masses.len(), axis)
        .all(|(a, b)| (masses[a] - masses[b]).abs() <= 1e-9 * masses[a].max(masses[b]))
}

impl Surface for Blended {
    fn domain(&self, _: usize) -> Domain {
        self.domain
    }

    fn jet(&self, _: usize, uv: DVec2) -> Jet {
        let spot = self.nets[0].locate(uv);
        let mut sums = [DVec4::ZERO; 3];
        for (i, net, l) in self.targets() {
            let p = net.jet(&spot);
            let [m, mu, mv] = self.mass(i, l, &spot);
            sums[0] += (m * p.s).extend(m);
            sums[1] += (mu * p.s + m * p.su).extend(mu);
            sums[2] += (mv * p.s + m * p.sv).extend(mv);
        }
        net::quotient(sums)
    }
}

impl Curve for Blended {
    fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    fn closed(&self) -> bool {
        self.domain.wraps[0]
    }

    fn jet(&self, piece: usize, u: f64) -> CurveJet {
        let knots = &self.nets[0].along[0];
        let basis = knots.basis::<3>(knots.span(self.breaks[piece]), u);
        let mut sums = [DVec4::ZERO; 3];
        for (i, net, l) in self.targets() {
            let a = basis.rows.map(|row| net.sum(basis.first, &row));
            let p = curve::quotient(a);
            let m = match &self.masses {
                None => [l, 0.0, 0.0],
                Some(masses) => basis.rows.map(|row| {
                    let own = masses[i][basis.first..].iter().zip(&row[..=knots.degree]);
                    l * own.map(|(m, f)| m * f).sum::<f64>()
                }),
            };
            let d2: DVec3 = m[2] * p.c + 2.0 * m[1] * p.d1 + m[0] * p.d2;
            sums[0] += (m[0] * p.c).extend(m[0]);
            sums[1] += (m[1] * p.c + m[0] * p.d1).extend(m[1]);
            sums[2] += d2.extend(m[2]);
        }
        curve::quotient(sums)
    }
}
