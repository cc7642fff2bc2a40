//! The four functions of u that solve the equation for one Fourier mode, scaled so that none can
//! overflow between the nodes.

use glam::DVec3;

/// Solutions of (D^2 - s^2)^2 f = 0, s the rate, each 1 at its node:
///
/// ```text
/// e^{-s(u-u0)},  (u-u0)/(u1-u0) e^{-s(u-u1)},  (u3-u)/(u3-u2) e^{-s(u2-u)},  e^{-s(u3-u)}
/// ```
///
/// They span the same space as e^{su}, u e^{su}, e^{-su}, u e^{-su} (Gonzalez Castro and Ugail 2007,
/// eqs 4 and 5), which overflow at s = 710 and lose all digits long before; the matrix of these four
/// at the nodes tends to the identity as s grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    pub rate: f64,
    pub nodes: [f64; 4],
}

impl Basis {
    /// The derivative of order `order` of the four functions at `u`.
    pub fn derivative(&self, u: f64, order: i32) -> [f64; 4] {
        let (s, [u0, u1, u2, u3]) = (self.rate, self.nodes);
        let power = s.powi(order);
        let sign = if order % 2 == 0 { 1.0 } else { -1.0 };
        // (c + d u) e^{ku} differentiates to k^m (c + d u) e^{ku} + m k^{m-1} d e^{ku}
        let more = f64::from(order) * s.powi(order - 1);
        let (left, right) = ((u - u0) / (u1 - u0), (u3 - u) / (u3 - u2));
        let (left_slope, right_slope) = (1.0 / (u1 - u0), -1.0 / (u3 - u2));
        [
            sign * power * (-s * (u - u0)).exp(),
            sign * (power * left - more * left_slope) * (-s * (u - u1)).exp(),
            (power * right + more * right_slope) * (-s * (u2 - u)).exp(),
            power * (-s * (u3 - u)).exp(),
        ]
    }

    /// The functions and their first derivatives at `u`.
    pub fn jet(&self, u: f64) -> [[f64; 4]; 2] {
        let (s, [u0, u1, u2, u3]) = (self.rate, self.nodes);
        let (left, right) = ((u - u0) / (u1 - u0), (u3 - u) / (u3 - u2));
        let [e0, e1, e2, e3] = [u0 - u, u1 - u, u - u2, u - u3].map(|x| (s * x).exp());
        let slopes = [
            -s * e0,
            (1.0 / (u1 - u0) - s * left) * e1,
            (s * right - 1.0 / (u3 - u2)) * e2,
            s * e3,
        ];
        [[e0, left * e1, right * e2, e3], slopes]
    }

    /// Row i: the four functions at node i.
    fn matrix(&self) -> [[f64; 4]; 4] {
        self.nodes.map(|u| self.derivative(u, 0))
    }

    /// The inverse of the matrix at the nodes: factors of the four functions from values at the four
    /// nodes. Nothing when it overflows, as with nodes far from the ends and a great rate.
    pub fn inverse(&self) -> Option<[[f64; 4]; 4]> {
        invert(self.matrix())
    }

    /// The same functions of w, u = start + length w.
    pub fn restricted(&self, start: f64, length: f64) -> Self {
        Self { rate: self.rate * length, nodes: self.nodes.map(|u| (u - start) / length) }
    }

    /// Largest sum of the sizes of the four cardinal functions over u in [0, 1]: how much an error
    /// of the curves can grow between them.
    pub fn lebesgue(&self) -> f64 {
        let Some(inverse) = self.inverse() else { return f64::INFINITY };
        (0..=1000).fold(0.0, |most: f64, i| {
            let f = self.derivative(f64::from(i) / 1000.0, 0);
            let sum: f64 = (0..4).map(|k| row(&f, &inverse, k).abs()).sum();
            most.max(sum)
        })
    }
}

/// Entry k of the row vector times the matrix.
fn row(left: &[f64; 4], right: &[[f64; 4]; 4], k: usize) -> f64 {
    (0..4).map(|i| left[i] * right[i][k]).sum()
}

/// A matrix times four vectors.
pub(super) fn times(matrix: &[[f64; 4]; 4], vectors: &[DVec3; 4]) -> [DVec3; 4] {
    matrix.map(|row| (0..4).map(|k| vectors[k] * row[k]).sum())
}

/// Gauss-Jordan with the largest pivot of each column.
fn invert(mut a: [[f64; 4]; 4]) -> Option<[[f64; 4]; 4]> {
    let mut b = [[0.0; 4]; 4];
    (0..4).for_each(|i| b[i][i] = 1.0);
    for c in 0..4 {
        let pivot = (c..4).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))?;
        a.swap(c, pivot);
        b.swap(c, pivot);
        let scale = a[c][c];
        if scale == 0.0 {
            return None;
        }
        a[c] = a[c].map(|x| x / scale);
        b[c] = b[c].map(|x| x / scale);
        for i in (0..4).filter(|&i| i != c) {
            let factor = a[i][c];
            for k in 0..4 {
                a[i][k] -= factor * a[c][k];
                b[i][k] -= factor * b[c][k];
            }
        }
    }
    b.iter().flatten().all(|x| x.is_finite()).then_some(b)
}

/// The cubic through four values at four nodes: the factors of 1, u, u^2, u^3 (eq. 3), by Newton's
/// divided differences.
pub(super) fn cubic(nodes: &[f64; 4], values: &[DVec3; 4]) -> [DVec3; 4] {
    let mut d = *values;
    for order in 1..4 {
        for i in (order..4).rev() {
            d[i] = (d[i] - d[i - 1]) / (nodes[i] - nodes[i - order]);
        }
    }
    let mut p = [d[3], DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
    for i in (0..3).rev() {
        // p <- p (u - node) + d
        for k in (1..4).rev() {
            p[k] = p[k - 1] - p[k] * nodes[i];
        }
        p[0] = d[i] - p[0] * nodes[i];
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::pde::NODES;

    #[test]
    fn the_functions_solve_the_equation() {
        for rate in [0.2, 1.0, 7.0, 40.0] {
            let basis = Basis { rate, nodes: [0.0, 0.2, 0.7, 1.0] };
            for u in [0.0, 0.13, 0.5, 0.99] {
                let [f, f2, f4] = [0, 2, 4].map(|order| basis.derivative(u, order));
                let s2 = rate * rate;
                for k in 0..4 {
                    // (D^2 - s^2)^2 = D^4 - 2 s^2 D^2 + s^4
                    let size = f4[k].abs() + 2.0 * s2 * f2[k].abs() + s2 * s2 * f[k].abs();
                    let rest = f4[k] - 2.0 * s2 * f2[k] + s2 * s2 * f[k];
                    assert!(rest.abs() <= 1e-13 * size, "rate {rate} u {u} function {k}");
                }
                let [values, slopes] = basis.jet(u);
                for k in 0..4 {
                    assert!((values[k] - f[k]).abs() <= 1e-15 * f[k].abs());
                    let slope = basis.derivative(u, 1)[k];
                    assert!((slopes[k] - slope).abs() <= 1e-13 * (slope.abs() + rate * f[k].abs()));
                }
            }
        }
    }

    #[test]
    fn lebesgue_constants_grow_as_measured() {
        // METHODS, four positions at thirds: measured without this code
        let measured =
            [(1.0, 1.63), (3.0, 1.67), (5.0, 1.83), (8.0, 2.55), (10.0, 3.61), (15.0, 11.4)];
        for (rate, want) in
            measured.into_iter().chain([(20.0, 43.8), (30.0, 811.0), (40.0, 17036.0)])
        {
            let got = Basis { rate, nodes: NODES }.lebesgue();
            assert!((got / want - 1.0).abs() < 0.01, "rate {rate}: {got}, not {want}");
        }
    }

    #[test]
    fn great_rates_overflow_nothing() {
        let basis = Basis { rate: 700.0, nodes: NODES };
        let inverse = basis.inverse().unwrap();
        for i in 0..=100 {
            let f = basis.derivative(f64::from(i) / 100.0, 0);
            assert!((0..4).all(|k| row(&f, &inverse, k).is_finite()));
        }
        for (i, row) in inverse.iter().enumerate() {
            assert!((0..4).all(|k| (row[k] - f64::from(u8::from(i == k))).abs() < 1e-90));
        }
    }

    #[test]
    fn cubic_meets_its_nodes() {
        let nodes = [0.1, 0.35, 0.5, 0.9];
        let values = [1.0, -2.0, 5.0, 0.25].map(DVec3::splat);
        let p = cubic(&nodes, &values);
        for (u, want) in nodes.into_iter().zip(values) {
            let got = p[0] + (p[1] + (p[2] + p[3] * u) * u) * u;
            assert!((got - want).length() < 1e-13);
        }
    }
}
