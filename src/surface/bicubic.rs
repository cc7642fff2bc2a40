//! A C1 surface through a grid of nodes, for states that a solver leaves on a grid.

use super::{Domain, Jet, Surface};
use glam::{DVec2, DVec3};

/// Piecewise bicubic interpolation over [0, 1]² (a tensor product of Catmull-Rom splines): through
/// every node, C1 across cells, exact for polynomials of degree two in u and in v. The derivative
/// at a node is the central difference of its neighbours, on the boundary of the ghosts beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bicubic {
    size: [usize; 2],
    /// u-rows of v, with one ring of ghosts.
    nodes: Vec<DVec3>,
}

impl Bicubic {
    /// A surface through `size` nodes with a ring of ghosts: u-rows of v, `(size[0] + 2) *
    /// (size[1] + 2)` points. The ghosts set the tangents across the edges. Those beyond the ends
    /// of an edge are replaced so that every edge curve depends on its own nodes alone.
    ///
    /// `None` with fewer than three nodes along a side or another number of points.
    #[must_use]
    pub fn new(size: [usize; 2], nodes: Vec<DVec3>) -> Option<Self> {
        let [u, v] = size;
        let count = u.checked_add(2)?.checked_mul(v.checked_add(2)?)?;
        if u < 3 || v < 3 || nodes.len() != count {
            return None;
        }
        let mut surface = Self { size, nodes };
        surface.extend_edges();
        Some(surface)
    }

    /// Extrapolates the edges by parabolas, first along them, then in the corners of the ring.
    fn extend_edges(&mut self) {
        let [last_u, last_v] = self.size.map(|n| n + 1);
        let row = self.size[1] + 2;
        let id = |i: usize, j: usize| i * row + j;
        // From the ring's corner: 0 or `last`, and the three nodes after it.
        let away = |k: usize, last: usize| [0, 1, 2, 3].map(|d| if k == 0 { d } else { last - d });
        let parabola = |a: DVec3, b: DVec3, c: DVec3| 3.0 * (a - b) + c;
        for i in [0, last_u] {
            for j in [0, last_v] {
                let ([a, b, c, d], [e, f, g, h]) = (away(i, last_u), away(j, last_v));
                let x = |i: usize, j: usize| self.nodes[id(i, j)];
                let along_u = parabola(x(b, f), x(c, f), x(d, f));
                let along_v = parabola(x(b, f), x(b, g), x(b, h));
                // The ring's corner sets the twist: the mean of both rings' extrapolations.
                let corner = parabola(along_v, x(c, e), x(d, e));
                let other = parabola(along_u, x(a, g), x(a, h));
                self.nodes[id(a, f)] = along_u;
                self.nodes[id(b, e)] = along_v;
                self.nodes[id(a, e)] = 0.5 * (corner + other);
            }
        }
    }

    /// Weights of the four nodes around a parameter and of its derivative, and the first node.
    fn weights(&self, axis: usize, s: f64) -> (usize, [f64; 4], [f64; 4]) {
        let cells = self.size[axis] - 1;
        let x = (if s.is_nan() { 0.0 } else { s.clamp(0.0, 1.0) }) * cells as f64;
        let cell = (x as usize).min(cells - 1);
        let f = x - cell as f64;
        let w = [
            0.5 * f * (f * (2.0 - f) - 1.0),
            0.5 * (f * f * (3.0 * f - 5.0) + 2.0),
            0.5 * f * (f * (4.0 - 3.0 * f) + 1.0),
            0.5 * f * f * (f - 1.0),
        ];
        let d = [
            0.5 * (f * (4.0 - 3.0 * f) - 1.0),
            0.5 * f * (9.0 * f - 10.0),
            0.5 * (f * (8.0 - 9.0 * f) + 1.0),
            0.5 * f * (3.0 * f - 2.0),
        ];
        (cell, w, d.map(|d| d * cells as f64))
    }
}

impl Surface for Bicubic {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, 1.0], v: [0.0, 1.0], wraps: [false; 2] }
    }

    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let (i, wu, du) = self.weights(0, uv.x);
        let (j, wv, dv) = self.weights(1, uv.y);
        let mut jet = Jet { s: DVec3::ZERO, su: DVec3::ZERO, sv: DVec3::ZERO };
        for (a, row) in self.nodes.chunks_exact(self.size[1] + 2).skip(i).take(4).enumerate() {
            let (mut s, mut sv) = (DVec3::ZERO, DVec3::ZERO);
            for ((x, w), d) in row.iter().skip(j).zip(wv).zip(dv) {
                s += *x * w;
                sv += *x * d;
            }
            jet.s += s * wu[a];
            jet.su += s * du[a];
            jet.sv += sv * wu[a];
        }
        jet
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{dvec2, dvec3};

    fn ghosted(size: [usize; 2], f: impl Fn(f64, f64) -> DVec3) -> Option<Bicubic> {
        let at = |k: usize, n: usize| (k as f64 - 1.0) / (n - 1) as f64;
        let nodes = (0..size[0] + 2)
            .flat_map(|i| (0..size[1] + 2).map(move |j| (i, j)))
            .map(|(i, j)| f(at(i, size[0]), at(j, size[1])))
            .collect();
        Bicubic::new(size, nodes)
    }

    #[test]
    fn biquadratics_are_exact() {
        let f = |u: f64, v: f64| dvec3(u, 2.0 - v + u * v, (u * u - u) * (3.0 * v * v + v));
        let Some(s) = ghosted([5, 8], f) else { panic!("enough nodes") };
        for k in 0..60 {
            let (u, v) = ((k as f64 * 0.137).fract(), (k as f64 * 0.311).fract());
            let j = s.jet(0, dvec2(u, v));
            let (w, wv) = (3.0 * v * v + v, 6.0 * v + 1.0);
            assert!((j.s - f(u, v)).length() < 1e-13);
            assert!((j.su - dvec3(1.0, v, (2.0 * u - 1.0) * w)).length() < 1e-12);
            assert!((j.sv - dvec3(0.0, u - 1.0, (u * u - u) * wv)).length() < 1e-12);
        }
        // The corners too, where ghosts are extrapolated.
        assert!((s.point(0, dvec2(1.0, 1.0)) - f(1.0, 1.0)).length() < 1e-13);
    }

    #[test]
    fn cells_join_smoothly_and_jets_are_derivatives() {
        let f = |u: f64, v: f64| dvec3((7.0 * u).sin(), (5.0 * v * u).cos(), (3.0 * u - v).exp());
        let Some(s) = ghosted([6, 7], f) else { panic!("enough nodes") };
        let h = 1e-6;
        for k in 0..40 {
            let uv = dvec2(
                0.1 + 0.8 * (k as f64 * 0.137).fract(),
                0.2 + 0.6 * (k as f64 * 0.711).fract(),
            );
            let j = s.jet(0, uv);
            let by = |d: DVec2| (s.point(0, uv + d) - s.point(0, uv - d)) / (2.0 * h);
            assert!((j.su - by(dvec2(h, 0.0))).length() < 1e-7);
            assert!((j.sv - by(dvec2(0.0, h))).length() < 1e-7);
        }
        for k in 1..5 {
            let (left, right) = (0.2 * k as f64 - 1e-12, 0.2 * k as f64 + 1e-12);
            let (a, b) = (s.jet(0, dvec2(left, 0.37)), s.jet(0, dvec2(right, 0.37)));
            assert!((a.s - b.s).length() < 1e-9 && (a.su - b.su).length() < 1e-8);
            assert!((a.sv - b.sv).length() < 1e-8);
        }
    }

    #[test]
    fn wrong_counts_are_refused() {
        assert_eq!(Bicubic::new([4, 4], vec![DVec3::ZERO; 35]), None);
        assert_eq!(Bicubic::new([2, 4], vec![DVec3::ZERO; 24]), None);
        assert_eq!(Bicubic::new([usize::MAX, 4], vec![]), None);
    }
}
