//! A solved patch: the spine and the terms round it, in closed form.

use super::{
    basis::{Basis, cubic, times},
    curve::Fourier,
};
use crate::surface::Jet;
use glam::{DVec2, DVec3};

/// One Fourier mode: `cos` and `sin` hold the factors of the four functions of `basis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Term {
    pub n: usize,
    /// Whether it belongs to the remainder.
    pub rest: bool,
    pub basis: Basis,
    pub cos: [DVec3; 4],
    pub sin: [DVec3; 4],
}

impl Term {
    /// Whether both have the same four functions.
    fn alike(&self, other: &Self) -> bool {
        let (a, b) = (&self.basis, &other.basis);
        // spelt out: compared as arrays, they took a tenth of the time of a point
        a.rate == b.rate && (0..4).all(|i| a.nodes[i] == b.nodes[i])
    }

    /// Factors of cos(nv) and sin(nv) at `u`, from the functions of the basis there.
    fn amplitude(&self, f: &[f64; 4]) -> [DVec3; 2] {
        let sum = |c: &[DVec3; 4]| c[0] * f[0] + c[1] * f[1] + c[2] * f[2] + c[3] * f[3];
        [sum(&self.cos), sum(&self.sin)]
    }
}

/// One mode of the boundary: the factors of cos(nv) and sin(nv) in each of the four curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mode {
    pub n: usize,
    /// The rate of the functions of u is the patch's `a` times this: n for the modes, N + 1 for
    /// those in the remainder.
    pub level: usize,
    /// Whether it belongs to the remainder.
    pub rest: bool,
    pub cos: [DVec3; 4],
    pub sin: [DVec3; 4],
}

/// The closed form of one patch, u in [0, 1], v in [0, 2 pi).
///
/// X = A0 + sum over n of A_n cos(nv) + B_n sin(nv) + R. The remainder R has the one rate w = a(N+1):
/// r1 e^{wu} + r2 e^{-wu} + r3 u e^{wu} + r4 u e^{-wu}, with the r functions of v (Gonzalez Castro and
/// Ugail 2007, eq. 7 prints them as functions of u, which could not take up the boundary's error
/// along v). They take up the Fourier terms past N, so R is a sum of such terms too, all at rate w;
/// it does not solve the equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// A0 = a00 + a01 u + a02 u^2 + a03 u^3.
    pub(super) spine: [DVec3; 4],
    pub(super) terms: Vec<Term>,
}

impl Solution {
    /// The solution through the mean points and modes of four curves. Nothing if it overflows.
    pub(super) fn solve(
        nodes: &[f64; 4],
        a: f64,
        means: &[DVec3; 4],
        modes: &[Mode],
    ) -> Option<Self> {
        let mut terms = Vec::with_capacity(modes.len());
        let mut last: Option<(usize, Basis, [[f64; 4]; 4])> = None;
        for mode in modes {
            let (basis, inverse) = match last {
                Some((level, basis, inverse)) if level == mode.level => (basis, inverse),
                _ => {
                    let basis = Basis { rate: a * mode.level as f64, nodes: *nodes };
                    (basis, basis.inverse()?)
                }
            };
            last = Some((mode.level, basis, inverse));
            let [cos, sin] = [&mode.cos, &mode.sin].map(|c| times(&inverse, c));
            terms.push(Term { n: mode.n, rest: mode.rest, basis, cos, sin });
        }
        Some(Self { spine: cubic(nodes, means), terms })
    }

    /// The spine, A0, at `u`: the centre line of the patch.
    pub fn spine(&self, u: f64) -> DVec3 {
        let [a, b, c, d] = self.spine;
        a + (b + (c + d * u) * u) * u
    }

    /// Position and first derivatives, from the closed form.
    pub fn jet(&self, uv: DVec2) -> Jet {
        let [_, b, c, d] = self.spine;
        let mut jet = Jet {
            s: self.spine(uv.x),
            su: b + (c * 2.0 + d * (3.0 * uv.x)) * uv.x,
            sv: DVec3::ZERO,
        };
        let mut wave = Wave::new(uv.y);
        for chunk in self.terms.chunk_by(Term::alike) {
            let [values, slopes] = chunk[0].basis.jet(uv.x);
            for term in chunk {
                let n = term.n as f64;
                let (sin, cos) = wave.at(term.n);
                let [a, b] = term.amplitude(&values);
                let [au, bu] = term.amplitude(&slopes);
                jet.s += a * cos + b * sin;
                jet.su += au * cos + bu * sin;
                jet.sv += (b * cos - a * sin) * n;
            }
        }
        jet
    }

    /// Position only.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        let mut at = self.spine(uv.x);
        let mut wave = Wave::new(uv.y);
        for chunk in self.terms.chunk_by(Term::alike) {
            let values = chunk[0].basis.derivative(uv.x, 0);
            for term in chunk {
                let (sin, cos) = wave.at(term.n);
                let [a, b] = term.amplitude(&values);
                at += a * cos + b * sin;
            }
        }
        at
    }

    /// The curve of constant `u`.
    pub(super) fn curve(&self, u: f64) -> Fourier {
        let most = self.terms.iter().map(|t| t.n).max().unwrap_or(0);
        let mut terms = vec![[DVec3::ZERO; 2]; most];
        for term in &self.terms {
            let [a, b] = term.amplitude(&term.basis.derivative(u, 0));
            if let Some(sum) = terms.get_mut(term.n.wrapping_sub(1)) {
                sum[0] += a;
                sum[1] += b;
            }
        }
        Fourier { mean: self.spine(u), terms }
    }

    /// The part u in [start, end] as a patch of its own, the very same points.
    pub(super) fn part(&self, start: f64, end: f64) -> Self {
        let length = end - start;
        let [_, b, c, d] = self.spine;
        let spine = [
            self.spine(start),
            (b + (c * 2.0 + d * (3.0 * start)) * start) * length,
            (c + d * (3.0 * start)) * length.powi(2),
            d * length.powi(3),
        ];
        let terms = self
            .terms
            .iter()
            .map(|t| Term { basis: t.basis.restricted(start, length), ..*t })
            .collect();
        Self { spine, terms }
    }

    /// The solution with every term times `weight`; terms of weight 0 are dropped.
    pub(super) fn weighted(&self, weight: impl Fn(&Term) -> f64) -> Self {
        let mut out = Self { spine: self.spine, terms: Vec::with_capacity(self.terms.len()) };
        for term in &self.terms {
            let w = weight(term);
            if w != 0.0 {
                let [cos, sin] = [&term.cos, &term.sin].map(|c| c.map(|x| x * w));
                out.terms.push(Term { cos, sin, ..*term });
            }
        }
        out
    }

    /// (1 - spine) of this and `spine` of the other for A0, the same with `radial` for the rest.
    pub(super) fn blend(&self, other: &Self, spine: f64, radial: f64) -> Self {
        let mut out = self.weighted(|_| 1.0 - radial);
        for k in 0..4 {
            out.spine[k] = self.spine[k] * (1.0 - spine) + other.spine[k] * spine;
        }
        for term in &other.weighted(|_| radial).terms {
            match out.terms.iter_mut().find(|t| t.n == term.n && t.basis == term.basis) {
                Some(twin) => {
                    for k in 0..4 {
                        twin.cos[k] += term.cos[k];
                        twin.sin[k] += term.sin[k];
                    }
                }
                None => out.terms.push(*term),
            }
        }
        out
    }
}

/// Sine and cosine of n v for n that mostly rise by the same step, by one or, where a shape is its own
/// image, by two or more: one turn further each time, which is four products and, over a thousand terms,
/// good to 1e-13.
struct Wave {
    v: f64,
    n: usize,
    last: (f64, f64),
    /// The step, and sine and cosine of it times v.
    step: usize,
    turn: (f64, f64),
}

impl Wave {
    fn new(v: f64) -> Self {
        Self { v, n: 0, last: (0.0, 1.0), step: 1, turn: v.sin_cos() }
    }

    fn at(&mut self, n: usize) -> (f64, f64) {
        let of = |n: usize| (n as f64 * self.v).sin_cos();
        let ((s, c), (s1, c1)) = (self.last, self.turn);
        match n.checked_sub(self.n) {
            Some(0) => {}
            Some(by) if by == self.step => self.last = (s * c1 + c * s1, c * c1 - s * s1),
            Some(by) => (self.last, self.turn, self.step) = (of(n), of(by), by),
            None => self.last = of(n),
        }
        self.n = n;
        self.last
    }
}

/// Cosines and sines of n v for a row of v, made once for many patches.
pub(super) struct Waves {
    count: usize,
    /// For n = 1, 2, ...: the cosines, then the sines.
    table: Vec<f64>,
}

impl Waves {
    /// For n up to `most`.
    pub fn new(vs: &[f64], most: usize) -> Self {
        let mut table = Vec::with_capacity(2 * most * vs.len());
        for n in 1..=most {
            let angles = || vs.iter().map(|v| v * n as f64);
            table.extend(angles().map(f64::cos));
            table.extend(angles().map(f64::sin));
        }
        Self { count: vs.len(), table }
    }

    fn of(&self, n: usize) -> (&[f64], &[f64]) {
        let start = 2 * (n - 1) * self.count;
        self.table[start..start + 2 * self.count].split_at(self.count)
    }
}

impl Solution {
    /// The largest n of its terms.
    pub(super) fn modes(&self) -> usize {
        self.terms.iter().map(|t| t.n).max().unwrap_or(0)
    }

    /// Positions at all (u, v), u slowest: the exponentials are taken once a row, the waves never.
    pub(super) fn rows(&self, us: &[f64], waves: &Waves, out: &mut [DVec3]) {
        let mut row = vec![0.0; 3 * waves.count];
        for (&u, points) in us.iter().zip(out.chunks_mut(waves.count.max(1))) {
            let (x, yz) = row.split_at_mut(waves.count);
            let (y, z) = yz.split_at_mut(waves.count);
            let centre = self.spine(u);
            x.fill(centre.x);
            y.fill(centre.y);
            z.fill(centre.z);
            for chunk in self.terms.chunk_by(Term::alike) {
                let values = chunk[0].basis.derivative(u, 0);
                for term in chunk {
                    let [a, b] = term.amplitude(&values);
                    let (cos, sin) = waves.of(term.n);
                    add(x, [a.x, b.x], cos, sin);
                    add(y, [a.y, b.y], cos, sin);
                    add(z, [a.z, b.z], cos, sin);
                }
            }
            for (((p, x), y), z) in points.iter_mut().zip(&*x).zip(&*y).zip(&*z) {
                *p = DVec3::new(*x, *y, *z);
            }
        }
    }
}

/// One coordinate of a mode over a row.
fn add(row: &mut [f64], [a, b]: [f64; 2], cos: &[f64], sin: &[f64]) {
    for ((x, c), s) in row.iter_mut().zip(cos).zip(sin) {
        *x += a * c + b * s;
    }
}

#[cfg(test)]
mod tests {
    use super::Wave;

    /// Whatever the steps, the waves are those of n v.
    #[test]
    fn waves_turn_on_by_any_step() {
        let orders: [Vec<usize>; 6] = [
            (1..=500).collect(),
            (1..=500).step_by(2).collect(),
            (4..=1000).step_by(4).collect(),
            vec![1, 2, 4, 5, 7, 8, 10, 11],
            vec![3, 3, 6, 6, 9],
            vec![5, 2, 4, 1, 2, 3, 40],
        ];
        for v in [0.0, 0.3, 1.9, 3.2, 6.2] {
            for order in &orders {
                let mut wave = Wave::new(v);
                for &n in order {
                    let (sin, cos) = wave.at(n);
                    let (s, c) = (n as f64 * v).sin_cos();
                    assert!((sin - s).abs() < 1e-12 && (cos - c).abs() < 1e-12, "{n} of {order:?}");
                }
            }
        }
    }
}
