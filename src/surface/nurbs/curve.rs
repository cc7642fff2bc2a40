//! Curves: the trait, rational B-spline curves, and their polylines.

use super::knots::Knots;
use super::net::Net;
use super::{SurfaceError, wrong};
use glam::{DVec3, DVec4};

/// A point of a curve and its derivatives by the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurveJet {
    /// Position, mm.
    pub c: DVec3,
    /// First derivative.
    pub d1: DVec3,
    /// Second derivative.
    pub d2: DVec3,
}

/// A parametric curve of smooth pieces that join end to end.
pub trait Curve: Send + Sync {
    /// Where the pieces begin and end: at least two parameters, growing.
    fn breaks(&self) -> &[f64];
    /// Whether the end is the beginning again.
    fn closed(&self) -> bool;
    /// Position and derivatives at `u` of the piece from `breaks[piece]` to `breaks[piece + 1]`: at a
    /// break the derivatives of either side can be had.
    fn jet(&self, piece: usize, u: f64) -> CurveJet;

    /// First and last parameter.
    fn domain(&self) -> [f64; 2] {
        let breaks = self.breaks();
        [breaks[0], breaks[breaks.len() - 1]]
    }
    /// Position and derivatives at `u`, held within the domain; at a break those to the right.
    fn at(&self, u: f64) -> CurveJet {
        let breaks = self.breaks();
        let piece = breaks[1..breaks.len() - 1].partition_point(|&b| b <= u);
        let [a, b] = self.domain();
        self.jet(piece, u.max(a).min(b))
    }
    /// Position at `u`.
    fn point(&self, u: f64) -> DVec3 {
        self.at(u).c
    }
}

/// A rational B-spline curve of any degree.
#[derive(Clone, Debug, PartialEq)]
pub struct RationalCurve {
    pub(super) net: Net,
    breaks: Vec<f64>,
}

impl RationalCurve {
    /// From control points [x, y, z, weight] and `points + degree + 1` knots. Knots that are not
    /// clamped (periodic ones, say) are clamped to their domain; the curve stays the same.
    ///
    /// # Errors
    /// Wrong number of knots, knots that fall or repeat too often, weights that are not positive.
    pub fn new(degree: usize, knots: Vec<f64>, points: &[[f64; 4]]) -> Result<Self, SurfaceError> {
        Ok(Self::of(Net::new([degree, 0], knots, None, &[points.to_vec()])?))
    }

    pub(super) fn of(net: Net) -> Self {
        let breaks = net.along[0].breaks();
        Self { net, breaks }
    }

    /// The (clamped) knots.
    pub fn knots(&self) -> &Knots {
        &self.net.along[0]
    }

    /// The control points [x, y, z, weight].
    pub fn points(&self) -> Vec<[f64; 4]> {
        self.net.rows().concat()
    }

    /// The same curve with more knots.
    ///
    /// # Errors
    /// Knots outside the domain, or repeated more often than the degree allows.
    pub fn refined(&self, more: &[f64]) -> Result<Self, SurfaceError> {
        Ok(Self::of(self.net.refined(0, more, "knots_u")?))
    }

    /// The same curve at a higher degree, with the least knots: each distinct one once more a degree.
    ///
    /// # Errors
    /// A degree below the present one or above [`MAX_DEGREE`](super::MAX_DEGREE).
    pub fn elevated(&self, degree: usize) -> Result<Self, SurfaceError> {
        Ok(Self::of(self.net.elevated(0, degree)?))
    }
}

impl Curve for RationalCurve {
    fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    fn closed(&self) -> bool {
        self.net.wraps(0)
    }

    fn jet(&self, piece: usize, u: f64) -> CurveJet {
        let knots = &self.net.along[0];
        let basis = knots.basis::<3>(knots.span(self.breaks[piece]), u);
        quotient(basis.rows.map(|row| self.net.sum(basis.first, &row)))
    }
}

/// The point c = A / w and its derivatives: c' = (A' - w' c) / w, c'' = (A'' - 2 w' c' - w'' c) / w.
pub(super) fn quotient([a, a1, a2]: [DVec4; 3]) -> CurveJet {
    let c = a.truncate() / a.w;
    let d1 = (a1.truncate() - a1.w * c) / a.w;
    let d2 = (a2.truncate() - 2.0 * a1.w * d1 - a2.w * c) / a.w;
    CurveJet { c, d1, d2 }
}

/// A piece of a curve gets this many chords at most.
const MOST_CHORDS: usize = 4096;

/// A polyline gets this many points at most, however many pieces the curve has.
const MOST_POINTS: usize = 1 << 20;

/// Points along a curve whose chords stay within `tolerance` (mm) of it; the ends of its pieces are
/// among them, so that corners stay sharp. A closed curve does not repeat its first point.
///
/// # Errors
/// A tolerance that is not positive, or so small that it asks for too many points.
pub fn polyline(curve: &dyn Curve, tolerance: f64) -> Result<Vec<DVec3>, SurfaceError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return wrong(
            "tolerance",
            format!("tolerance is {tolerance}; expected a positive number of mm"),
        );
    }
    let breaks = curve.breaks();
    let mut points = vec![];
    for (piece, ends) in breaks.windows(2).enumerate() {
        let n = chords(curve, piece, [ends[0], ends[1]], tolerance)?;
        if points.len() + n > MOST_POINTS {
            let why = format!("{tolerance} mm asks for more than {MOST_POINTS} points");
            return wrong("tolerance", why);
        }
        let at = |i: usize| ends[0] + (ends[1] - ends[0]) * (i as f64 / n as f64);
        points.extend((0..n).map(|i| curve.jet(piece, at(i)).c));
    }
    if !curve.closed() {
        let last = breaks.len() - 2;
        points.push(curve.jet(last, breaks[last + 1]).c);
    }
    Ok(points)
}

/// Chords of equal parameter steps that a piece needs. A chord of step h is off by at most
/// h^2 max|c''| / 8; the bound starts the search, the distance measured inside each chord ends it.
fn chords(
    curve: &dyn Curve,
    piece: usize,
    [a, b]: [f64; 2],
    tolerance: f64,
) -> Result<usize, SurfaceError> {
    let at = |s: f64| curve.jet(piece, a + (b - a) * s);
    let bend = (0..=16).map(|i| at(f64::from(i) / 16.0).d2.length()).fold(0.0, f64::max);
    let guess = ((b - a) * (bend / (8.0 * tolerance)).sqrt()).ceil();
    let mut n = if guess.is_finite() { (guess as usize).max(1) } else { MOST_CHORDS + 1 };
    while n <= MOST_CHORDS {
        let fits = (0..n).all(|i| {
            let end = |k: f64| at((i as f64 + k) / n as f64).c;
            let (p, q) = (end(0.0), end(1.0));
            [0.25, 0.5, 0.75].iter().all(|&k| off(end(k), p, q) <= tolerance)
        });
        if fits {
            return Ok(n);
        }
        n *= 2;
    }
    wrong(
        "tolerance",
        format!("{tolerance} mm asks for more than {MOST_CHORDS} chords from u = {a} to {b}"),
    )
}

/// Distance of a point from a segment.
fn off(x: DVec3, p: DVec3, q: DVec3) -> f64 {
    let d = q - p;
    let s = ((x - p).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    x.distance(p + d * s)
}
