//! Knot vectors and the B-spline basis.

use super::{SurfaceError, wrong};

/// The highest degree. Far beyond what design uses; it keeps the basis on the stack.
pub const MAX_DEGREE: usize = 24;

/// Knots of different targets that are closer than this share of the domain are the same knot;
/// knots of one vector have to be equal or further apart.
pub const SAME_KNOT: f64 = 1e-9;

/// The lengths of domain (and their reciprocals) that derivatives still survive.
const LONGEST: f64 = 1e12;

/// A checked knot vector of a degree: `count + degree + 1` knots that never fall.
///
/// The domain runs from knot `degree` to knot `count`. It is *clamped* when the ends are repeated
/// `degree + 1` times.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    pub(super) degree: usize,
    pub(super) values: Vec<f64>,
}

/// The `degree + 1` basis functions that live on a span: row 0 their values, row k their k-th
/// derivatives.
pub(super) struct Basis<const K: usize> {
    /// Index of the control point of the first function.
    pub first: usize,
    pub rows: [[f64; MAX_DEGREE + 1]; K],
}

impl Knots {
    /// Checks knots for `points` control points.
    ///
    /// # Errors
    /// At `key`: the degree, the number of knots, a knot that is not finite, falls or is repeated
    /// too often, a domain without length.
    pub fn new(
        degree: usize,
        values: Vec<f64>,
        points: usize,
        key: &str,
    ) -> Result<Self, SurfaceError> {
        if degree == 0 || degree > MAX_DEGREE {
            return wrong("degree", format!("degree is {degree}; expected 1 to {MAX_DEGREE}"));
        }
        let fits = values.len() == points.saturating_add(degree + 1);
        if points < degree + 1 {
            let why = format!("degree {degree} needs {} points or more; got {points}", degree + 1);
            return wrong("net", why);
        }
        if !fits {
            let (have, need) = (values.len(), points + degree + 1);
            let why = format!(
                "knot vector has {have} knots; degree {degree} with {points} points needs {need}"
            );
            return wrong(key, why);
        }
        let knots = Self { degree, values };
        knots.check(key)?;
        Ok(knots)
    }

    fn check(&self, key: &str) -> Result<(), SurfaceError> {
        if let Some(i) = self.values.iter().position(|t| !t.is_finite()) {
            return wrong(format!("{key}[{i}]"), format!("knot is {}", self.values[i]));
        }
        if let Some(i) = self.values.windows(2).position(|w| w[0] > w[1]) {
            let (a, b) = (self.values[i], self.values[i + 1]);
            return wrong(
                format!("{key}[{}]", i + 1),
                format!("knot {b} after {a}; knots never fall"),
            );
        }
        let [a, b] = self.domain();
        if !(1.0 / LONGEST..=LONGEST).contains(&(b - a)) {
            let why = format!("knots run from {a} to {b}; expected a length of 1e-12 to 1e12");
            return wrong(key, why);
        }
        if let Some(w) = self.values.windows(2).find(|w| {
            let gap = w[1] - w[0];
            gap > 0.0 && gap <= SAME_KNOT * (b - a)
        }) {
            let why = format!(
                "knots {} and {} differ by less than 1e-9 of the domain; make them equal",
                w[0], w[1]
            );
            return wrong(key, why);
        }
        self.check_repeats(key)
    }

    fn check_repeats(&self, key: &str) -> Result<(), SurfaceError> {
        let [a, b] = self.domain();
        for (t, times) in self.distinct() {
            let most = if t > a && t < b { self.degree } else { self.degree + 1 };
            if times > most {
                let why = format!(
                    "knot {t} is repeated {times} times; degree {} allows {most}",
                    self.degree
                );
                return wrong(key, why);
            }
        }
        Ok(())
    }

    /// Degree 0, one control point: what a curve has along v.
    pub(super) fn none() -> Self {
        Self { degree: 0, values: vec![0.0, 1.0] }
    }

    /// Knots with their multiplicities, clamped by construction.
    pub(super) fn of(degree: usize, distinct: &[(f64, usize)]) -> Self {
        let values = distinct.iter().flat_map(|&(t, n)| std::iter::repeat_n(t, n)).collect();
        Self { degree, values }
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of control points.
    pub fn count(&self) -> usize {
        self.values.len() - self.degree - 1
    }

    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.values[self.degree], self.values[self.count()]]
    }

    /// Distinct knots and how often each is repeated.
    pub fn distinct(&self) -> Vec<(f64, usize)> {
        self.values.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
    }

    /// The distinct knots of the domain: the ends of its polynomial pieces.
    pub fn breaks(&self) -> Vec<f64> {
        let mut inside = self.values[self.degree..=self.count()].to_vec();
        inside.dedup();
        inside
    }

    /// Where each control point acts most: the mean of its `degree` inner knots (Greville abscissa).
    pub fn centres(&self) -> Vec<f64> {
        let p = self.degree.max(1);
        let mean = |i: usize| self.values[i + 1..=i + p].iter().sum::<f64>() / p as f64;
        let [a, b] = self.domain();
        (0..self.count()).map(|i| mean(i).clamp(a, b)).collect()
    }

    pub(super) fn is_clamped(&self) -> bool {
        let (n, p) = (self.values.len(), self.degree);
        self.values[0] == self.values[p] && self.values[n - 1] == self.values[n - 1 - p]
    }

    /// The same domain with its ends repeated `degree + 1` times.
    pub(super) fn clamped(&self) -> Self {
        let [a, b] = self.domain();
        let mut distinct = self.distinct();
        distinct.retain(|&(t, _)| t >= a && t <= b);
        for d in &mut distinct {
            if d.0 == a || d.0 == b {
                d.1 = self.degree + 1;
            }
        }
        Self::of(self.degree, &distinct)
    }

    /// The knots of the same curves at one degree more: every distinct knot once more, no others.
    pub(super) fn raised(&self) -> Self {
        let distinct: Vec<_> = self.distinct().into_iter().map(|(t, n)| (t, n + 1)).collect();
        Self::of(self.degree + 1, &distinct)
    }

    /// The span `k` with `knot[k] <= u < knot[k + 1]` within the domain; the last one at its end.
    pub(super) fn span(&self, u: f64) -> usize {
        let [first, last] = [self.degree, self.count()];
        let above = self.values[first..last].partition_point(|&t| t <= u);
        let mut k = first + above.max(1) - 1;
        while k > first && self.values[k] == self.values[k + 1] {
            k -= 1;
        }
        k
    }

    /// Basis functions and K - 1 derivatives at `u` on span `k` (Cox and de Boor's recurrence).
    pub(super) fn basis<const K: usize>(&self, k: usize, u: f64) -> Basis<K> {
        let p = self.degree;
        let mut rows = [[0.0; MAX_DEGREE + 1]; K];
        // `rows[o]` holds derivatives of order o of degree d; each step raises d by one.
        rows[0][0] = 1.0;
        for d in 1..=p {
            // Orders are taken down, so that order o still sees order o - 1 of degree d - 1; only
            // what ends in degree p is worked out.
            for o in (1..K).rev().filter(|&o| d + K > p + o) {
                let (lower, upper) = rows.split_at_mut(o);
                let mut carry = 0.0;
                for (r, (&f, out)) in lower[o - 1][..d].iter().zip(&mut upper[0]).enumerate() {
                    let i = k + 1 + r - d;
                    let w = d as f64 * f / (self.values[i + d] - self.values[i]);
                    *out = carry - w;
                    carry = w;
                }
                upper[0][d] = carry;
            }
            let mut carry = 0.0;
            for (r, f) in rows[0][..d].iter_mut().enumerate() {
                let i = k + 1 + r - d;
                let [left, right] = [self.values[i], self.values[i + d]];
                let w = *f / (right - left);
                *f = carry + (right - u) * w;
                carry = (u - left) * w;
            }
            rows[0][d] = carry;
        }
        Basis { first: k - p, rows }
    }
}
