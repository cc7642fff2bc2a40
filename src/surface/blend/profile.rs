//! Functions of u that a blend is made of: the four cubics that carry the ends, and corrections that
//! vanish there with their derivatives.

use std::f64::consts::PI;

/// Corrections to the cubic; all are zero at u = 0 and u = 1, and so are their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Basis {
    /// u^2 (1 - u)^2 T_k(2u - 1), k = 0..K-1: converges geometrically.
    #[default]
    Bubble,
    /// sin(k pi u) with the cubic that ends it, k = 1..K: the paper's, corrected; converges slowly.
    Sine,
}

/// The cubics of paper 002 eq. 12, for position and tangent at 0, position and tangent at 1: value,
/// and first to fourth derivative.
pub fn cubics(u: f64) -> [[f64; 5]; 4] {
    [
        [1.0 - (3.0 - 2.0 * u) * u * u, 6.0 * u * (u - 1.0), 12.0 * u - 6.0, 12.0, 0.0],
        [u * (1.0 - u) * (1.0 - u), (1.0 - u) * (1.0 - 3.0 * u), 6.0 * u - 4.0, 6.0, 0.0],
        [(3.0 - 2.0 * u) * u * u, 6.0 * u * (1.0 - u), 6.0 - 12.0 * u, -12.0, 0.0],
        [(u - 1.0) * u * u, u * (3.0 * u - 2.0), 6.0 * u - 2.0, 6.0, 0.0],
    ]
}

impl Basis {
    /// Fewest collocation points in u for `terms` corrections.
    ///
    /// Sines need two more than terms: the last vanishes on L - 1 = K equal steps, and what is left of
    /// it is aliased. Bubbles are polynomials and need as many points as terms.
    pub fn least_points(self, terms: usize) -> usize {
        match self {
            Self::Bubble => terms,
            Self::Sine if terms == 0 => 0,
            Self::Sine => terms + 2,
        }
    }

    /// Value and first four derivatives of the first `terms` corrections at `u`, in turn.
    pub fn jets(self, u: f64, terms: usize, mut give: impl FnMut(usize, [f64; 5])) {
        match self {
            Self::Sine => (0..terms).for_each(|k| give(k, sine(u, k + 1))),
            Self::Bubble => {
                let ends = ends(u);
                let mut t = Chebyshev::new(2.0 * u - 1.0);
                for k in 0..terms {
                    give(k, product(ends, t.next()));
                }
            }
        }
    }

    /// Values and derivatives of the first corrections, as many as there is room for.
    pub fn slopes(self, u: f64, values: &mut [f64], slopes: &mut [f64]) {
        let each = values.iter_mut().zip(slopes);
        match self {
            Self::Sine => {
                let (s, c) = (PI * u).sin_cos();
                let (mut sin, mut cos) = (s, c);
                for (k, (z, dz)) in (1..).zip(each) {
                    let (w, odd) = (PI * f64::from(k), k % 2 == 1);
                    let (q, r) = if odd { (1.0, 0.0) } else { (3.0, 2.0) };
                    *z = sin - w * u * (1.0 - u * (q - r * u));
                    *dz = w * (cos - 1.0 + u * (2.0 * q - 3.0 * r * u));
                    (sin, cos) = (sin * c + cos * s, cos * c - sin * s);
                }
            }
            Self::Bubble => {
                let [e, de, ..] = ends(u);
                let x = 2.0 * u - 1.0;
                // T_k and its derivative by u, from T_0 and T_-1 = T_1
                let (mut t, mut dt, mut before, mut dbefore) = (1.0, 0.0, x, 2.0);
                for (z, dz) in each {
                    (*z, *dz) = (e * t, de * t + e * dt);
                    let next = 2.0 * x * t - before;
                    let dnext = 4.0 * t + 2.0 * x * dt - dbefore;
                    (before, dbefore, t, dt) = (t, dt, next, dnext);
                }
            }
        }
    }
}

/// u^2 (1 - u)^2 and its derivatives.
fn ends(u: f64) -> [f64; 5] {
    let rest = 1.0 - u;
    [
        u * u * rest * rest,
        2.0 * u * rest * (1.0 - 2.0 * u),
        2.0 - 12.0 * u * rest,
        24.0 * u - 12.0,
        24.0,
    ]
}

/// sin(k pi u) - k pi u + k pi (2 + s) u^2 - k pi (1 + s) u^3 with s = (-1)^k, and its derivatives.
fn sine(u: f64, k: usize) -> [f64; 5] {
    let w = PI * k as f64;
    let (q, r) = if k % 2 == 1 { (1.0, 0.0) } else { (3.0, 2.0) };
    let (sin, cos) = (w * u).sin_cos();
    [
        sin - w * u * (1.0 - u * (q - r * u)),
        w * (cos - 1.0 + u * (2.0 * q - 3.0 * r * u)),
        w * (2.0 * q - 6.0 * r * u - w * sin),
        -w * (6.0 * r + w * w * cos),
        w.powi(4) * sin,
    ]
}

/// T_0, T_1, ... at x with their first four derivatives by u = (x + 1) / 2.
struct Chebyshev {
    x: f64,
    this: [f64; 5],
    before: [f64; 5],
}

impl Chebyshev {
    fn new(x: f64) -> Self {
        // T_-1 = T_1
        Self { x, this: [1.0, 0.0, 0.0, 0.0, 0.0], before: [x, 1.0, 0.0, 0.0, 0.0] }
    }

    fn next(&mut self) -> [f64; 5] {
        let now = self.this;
        for m in 0..5 {
            let lower = if m == 0 { 0.0 } else { 2.0 * m as f64 * now[m - 1] };
            self.this[m] = 2.0 * self.x * now[m] + lower - self.before[m];
        }
        self.before = now;
        [now[0], 2.0 * now[1], 4.0 * now[2], 8.0 * now[3], 16.0 * now[4]]
    }
}

/// Derivatives of a product, by Leibniz.
fn product(a: [f64; 5], b: [f64; 5]) -> [f64; 5] {
    [
        a[0] * b[0],
        a[1] * b[0] + a[0] * b[1],
        a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2],
        a[3] * b[0] + 3.0 * (a[2] * b[1] + a[1] * b[2]) + a[0] * b[3],
        a[4] * b[0] + 4.0 * (a[3] * b[1] + a[1] * b[3]) + 6.0 * a[2] * b[2] + a[0] * b[4],
    ]
}

#[cfg(test)]
mod tests {
    use super::{Basis, cubics};

    #[test]
    fn cubics_carry_the_ends() {
        let (a, b) = (cubics(0.0), cubics(1.0));
        for (i, (a, b)) in a.iter().zip(&b).enumerate() {
            let one = |place: usize| f64::from(u8::from(place == i));
            assert_eq!([a[0], a[1], b[0], b[1]], [one(0), one(1), one(2), one(3)]);
        }
    }

    #[test]
    fn corrections_vanish_at_the_ends() {
        for basis in [Basis::Bubble, Basis::Sine] {
            for u in [0.0, 1.0] {
                basis.jets(u, 12, |k, z| {
                    assert!(z[0].abs() < 1e-13 && z[1].abs() < 1e-12, "{basis:?} {k} {z:?}");
                });
            }
        }
    }

    #[test]
    fn each_derivative_is_that_of_the_one_before() {
        let h = 1e-5;
        for basis in [Basis::Bubble, Basis::Sine] {
            for u in [0.07, 0.5, 0.83] {
                let at = |u: f64| {
                    let mut all = vec![[0.0; 5]; 10];
                    basis.jets(u, 10, |k, z| all[k] = z);
                    all.extend(cubics(u));
                    all
                };
                let (here, ahead, behind) = (at(u), at(u + h), at(u - h));
                for k in 0..14 {
                    for m in 0..4 {
                        let rough = (ahead[k][m] - behind[k][m]) / (2.0 * h);
                        let size = here[k].iter().fold(1.0, |s: f64, x| s.max(x.abs()));
                        // error h^2 / 6 of a derivative two orders up, at most (10 pi)^2 times this
                        assert!((rough - here[k][m + 1]).abs() < 1e-6 * size, "{k} {m}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_short_way_gives_the_same() {
        for basis in [Basis::Bubble, Basis::Sine] {
            for u in [0.0, 0.3, 0.99, 1.0] {
                let (mut z, mut dz) = ([0.0; 15], [0.0; 15]);
                basis.slopes(u, &mut z, &mut dz);
                basis.jets(u, 15, |k, jet| {
                    assert!((z[k] - jet[0]).abs() < 1e-13 && (dz[k] - jet[1]).abs() < 1e-11);
                });
            }
        }
    }
}
