//! A net of poles over two knot vectors: what curves and surfaces are made of.

use super::super::{Domain, Jet};
use super::knots::{Basis, Knots, MAX_DEGREE};
use super::poles::poles_on;
use super::{SurfaceError, wrong};
use glam::{DVec2, DVec4};

/// Coordinates, and masses with their reciprocals, up to here: products of two and their
/// derivatives stay finite.
const LARGEST: f64 = 1e50;

/// Poles row by row; a row runs along axis 0 (u).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Net {
    pub along: [Knots; 2],
    pub poles: Vec<DVec4>,
}

/// Whether a mass can be used: positive, and neither so large nor so small that products overflow.
pub(super) fn is_mass(w: f64) -> bool {
    (1.0 / LARGEST..=LARGEST).contains(&w)
}

/// The place of an entry of a table in messages; curves have no rows.
pub(super) fn place(key: &str, row: usize, column: usize) -> String {
    format!("{key}[{row}][{column}]")
}

impl Net {
    /// Checks rows of [x, y, z, weight] and brings them on clamped knots. No `knots_v` is a curve.
    pub fn new(
        degree: [usize; 2],
        knots_u: Vec<f64>,
        knots_v: Option<Vec<f64>>,
        rows: &[Vec<[f64; 4]>],
    ) -> Result<Self, SurfaceError> {
        let width = rows.first().map_or(0, Vec::len);
        if width == 0 {
            return wrong("net", "the net has no control points");
        }
        if let Some(j) = rows.iter().position(|r| r.len() != width) {
            let why = format!("row has {} control points; the first has {width}", rows[j].len());
            return wrong(format!("net[{j}]"), why);
        }
        let mut poles = Vec::with_capacity(rows.len() * width);
        for (j, row) in rows.iter().enumerate() {
            for (i, &point) in row.iter().enumerate() {
                poles.push(pole(point, j, i)?);
            }
        }
        let u = Knots::new(degree[0], knots_u, width, "knots_u")?;
        let v = match knots_v {
            Some(knots) => Knots::new(degree[1], knots, rows.len(), "knots_v")?,
            None if rows.len() == 1 => Knots::none(),
            None => {
                return wrong(
                    "knots_v",
                    format!("missing; a net of {} rows needs them", rows.len()),
                );
            }
        };
        let net = Self { along: [u, v], poles };
        Ok([0, 1].into_iter().fold(net, |net, axis| {
            let knots = &net.along[axis];
            if knots.is_clamped() {
                return net;
            }
            let clamped = knots.clamped();
            net.on(axis, clamped)
        }))
    }

    pub fn width(&self) -> usize {
        self.along[0].count()
    }

    pub fn is_curve(&self) -> bool {
        self.along[1].degree == 0
    }

    /// The control points with their weights, row by row.
    pub fn rows(&self) -> Vec<Vec<[f64; 4]>> {
        let point = |p: &DVec4| (p.truncate() / p.w).extend(p.w).to_array();
        self.poles.chunks(self.width()).map(|row| row.iter().map(point).collect()).collect()
    }

    /// The masses, row by row in one list.
    pub fn masses(&self) -> Vec<f64> {
        self.poles.iter().map(|p| p.w).collect()
    }

    /// The same shape on other knots along an axis; see [`poles_on`].
    pub fn on(&self, axis: usize, knots: Knots) -> Self {
        let (width, old) = (self.width(), &self.along[axis]);
        let poles = if axis == 0 {
            self.poles.chunks(width).flat_map(|row| poles_on(old, row, &knots)).collect()
        } else {
            let column = |i: usize| self.poles.iter().skip(i).step_by(width).copied();
            let columns: Vec<Vec<DVec4>> =
                (0..width).map(|i| poles_on(old, &column(i).collect::<Vec<_>>(), &knots)).collect();
            (0..knots.count()).flat_map(|j| columns.iter().map(move |c| c[j])).collect()
        };
        let mut along = self.along.clone();
        along[axis] = knots;
        Self { along, poles }
    }

    /// The same shape, one degree up along an axis.
    pub fn raised(&self, axis: usize) -> Self {
        self.on(axis, self.along[axis].raised())
    }

    /// The same shape at a higher degree along an axis.
    pub fn elevated(&self, axis: usize, degree: usize) -> Result<Self, SurfaceError> {
        let own = self.along[axis].degree;
        if degree < own || degree > MAX_DEGREE {
            let why = format!("degree {degree} asked for; expected {own} to {MAX_DEGREE}");
            return wrong("degree", why);
        }
        Ok((own..degree).fold(self.clone(), |net, _| net.raised(axis)))
    }

    /// The same shape with more knots along an axis, which may repeat existing ones.
    pub fn refined(&self, axis: usize, more: &[f64], key: &str) -> Result<Self, SurfaceError> {
        let old = &self.along[axis];
        let [a, b] = old.domain();
        if let Some(i) = more.iter().position(|&t| !(t > a && t < b)) {
            let why = format!("knot {} is not inside the domain, {a} to {b}", more[i]);
            return wrong(format!("{key}[{i}]"), why);
        }
        let mut values = [&old.values, more].concat();
        values.sort_by(f64::total_cmp);
        let points = old.count() + more.len();
        Ok(self.on(axis, Knots::new(old.degree, values, points, key)?))
    }

    /// Whether the last line of poles along an axis is the first again, to 1e-9 of their size.
    pub fn wraps(&self, axis: usize) -> bool {
        if self.along[axis].degree == 0 {
            return false;
        }
        let size = self.poles.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        let same = |a: DVec4, b: DVec4| (a - b).abs().max_element() <= 1e-9 * size;
        ends(self.width(), self.poles.len(), axis).all(|(a, b)| same(self.poles[a], self.poles[b]))
    }

    /// The parameters, and where the surface closes up.
    pub fn domain(&self) -> Domain {
        let [u, v] = [0, 1].map(|axis| self.along[axis].domain());
        Domain { u, v, wraps: [0, 1].map(|axis| self.wraps(axis)) }
    }

    /// Position and derivatives.
    pub fn jet(&self, spot: &Spot) -> Jet {
        let mut sums = [DVec4::ZERO; 3];
        spot.each(self.width(), |pole, f| {
            let p = self.poles[pole];
            (0..3).for_each(|k| sums[k] += p * f[k]);
        });
        quotient(sums)
    }

    /// The sum of the poles of a curve, from `first` on, times a row of basis functions.
    pub fn sum(&self, first: usize, row: &[f64]) -> DVec4 {
        let poles = self.poles[first..].iter().zip(&row[..=self.along[0].degree]);
        poles.fold(DVec4::ZERO, |s, (&p, &f)| s + p * f)
    }

    /// The basis functions that live at a point, which is held within the domain.
    pub fn locate(&self, uv: DVec2) -> Spot {
        let [u, v] = [0, 1].map(|axis| {
            let knots = &self.along[axis];
            let [a, b] = knots.domain();
            let t = uv[axis].max(a).min(b);
            knots.basis::<2>(knots.span(t), t)
        });
        Spot { along: [u, v], degree: [self.along[0].degree, self.along[1].degree] }
    }
}

/// The point s = A / w and its derivatives, s_u = (A_u - w_u s) / w.
pub(super) fn quotient([a, au, av]: [DVec4; 3]) -> Jet {
    let s = a.truncate() / a.w;
    Jet { s, su: (au.truncate() - au.w * s) / a.w, sv: (av.truncate() - av.w * s) / a.w }
}

/// The tensor-product basis functions at a point.
pub(super) struct Spot {
    along: [Basis<2>; 2],
    degree: [usize; 2],
}

impl Spot {
    /// Hands out each control of a net of this width with its basis function N and N_u, N_v.
    pub fn each(&self, width: usize, mut to: impl FnMut(usize, [f64; 3])) {
        let [u, v] = &self.along;
        let [p, q] = self.degree;
        for (j, (&g, &dg)) in v.rows[0][..=q].iter().zip(&v.rows[1]).enumerate() {
            let start = (v.first + j) * width + u.first;
            for (i, (&f, &df)) in u.rows[0][..=p].iter().zip(&u.rows[1]).enumerate() {
                to(start + i, [f * g, df * g, f * dg]);
            }
        }
    }
}

/// Pairs of entries on the first and the last line along an axis.
pub(super) fn ends(
    width: usize,
    count: usize,
    axis: usize,
) -> impl Iterator<Item = (usize, usize)> {
    let (lines, step, across) =
        if axis == 0 { (count / width, width, width - 1) } else { (width, 1, count - width) };
    (0..lines).map(move |n| (n * step, n * step + across))
}

fn pole(point: [f64; 4], row: usize, column: usize) -> Result<DVec4, SurfaceError> {
    let [x, y, z, w] = point;
    if let Some(c) = [x, y, z].into_iter().find(|c| c.is_nan() || c.abs() > LARGEST) {
        return wrong(place("net", row, column), format!("coordinate is {c}"));
    }
    if !is_mass(w) {
        let why = format!("weight is {w}; weights are masses, expected a positive number");
        return wrong(place("net", row, column), why);
    }
    Ok(DVec4::new(x * w, y * w, z * w, w))
}
