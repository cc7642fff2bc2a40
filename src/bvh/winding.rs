//! The winding number by a tree of dipoles: Barill, Dickson, Schmidt, Levin and Jacobson 2018,
//! "Fast winding numbers for soups and clouds", with the expansion carried to the third order.

use super::{Bvh, Node};
use crate::num::Aabb;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A box of triangles is seen as one dipole from farther than this many of its radii.
const BETA: f64 = 2.0;
/// How near the level in question the tree's answer is not trusted, and the wider opening used
/// then. Third order at 2 radii is off by up to .003 on a ball and falls with the fourth power.
const REFINE: [(f64, f64); 2] = [(0.02, 6.0), (3e-4, 20.0)];
/// Nearer than this to the level only the sum over all triangles decides.
const EXACT: f64 = 2e-6;

/// The generalised winding number of oriented triangles: 1 inside one closed shell whose faces are
/// counter-clockwise seen from outside, 0 outside; sums over shells, fractions near open rims.
#[derive(Clone, Debug)]
pub struct Winding {
    bvh: Bvh,
    pub(super) dipoles: Vec<Dipole>,
}

/// Moments of the area vectors about the centre of a node, ready for evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dipole {
    pub(super) centre: DVec3,
    radius2: f64,
    /// Sum of area vectors.
    first: DVec3,
    trace: f64,
    /// Coefficients of xx, yy, zz, xy, xz, yz.
    second: [f64; 6],
    /// Contraction that meets d / r^5.
    third_line: DVec3,
    /// Coefficients of xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
    third: [f64; 10],
}

/// Moments while they are summed up the tree. With e = x - centre and n the normal:
/// `first` = ∫ n, `second[i]` = ∫ n_i e, `third[i]` = ∫ n_i e eᵀ.
#[derive(Clone, Copy, Debug)]
struct Moments {
    area: f64,
    centre: DVec3,
    radius: f64,
    first: DVec3,
    second: [DVec3; 3],
    third: [DMat3; 3],
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Moments {
    fn at(centre: DVec3) -> Self {
        let (zero, none) = (DVec3::ZERO, DMat3::ZERO);
        let (second, third) = ([zero; 3], [none; 3]);
        Self { area: 0.0, centre, radius: 0.0, first: zero, second, third }
    }

    fn add_triangle(&mut self, corners: &[DVec3; 3]) {
        let e = corners.map(|p| p - self.centre);
        let n = (e[1] - e[0]).cross(e[2] - e[0]) * 0.5;
        let c = (e[0] + e[1] + e[2]) / 3.0;
        // mean of e eᵀ over the triangle
        let mean = e.iter().fold(outer(c, c) * 9.0, |m, &v| m + outer(v, v)) * (1.0 / 12.0);
        self.area += n.length();
        self.radius = e.iter().fold(self.radius, |r, v| r.max(v.length()));
        self.first += n;
        for i in 0..3 {
            self.second[i] += c * n[i];
            self.third[i] += mean * n[i];
        }
    }

    fn add(&mut self, o: &Moments) {
        let h = o.centre - self.centre;
        self.area += o.area;
        self.radius = self.radius.max(h.length() + o.radius);
        self.first += o.first;
        for i in 0..3 {
            let (n, m) = (o.first[i], o.second[i]);
            self.second[i] += m + h * n;
            self.third[i] += o.third[i] + outer(m, h) + outer(h, m) + outer(h, h) * n;
        }
    }

    fn dipole(&self, bounds: &Aabb) -> Dipole {
        let far = (self.centre - bounds.min).max(bounds.max - self.centre).length();
        let m = &self.second;
        let t = |i: usize, j: usize, k: usize| self.third[i].col(j)[k];
        let line = |k: usize| (0..3).map(|i| 2.0 * t(i, i, k) + t(k, i, i)).sum();
        // coefficient of x_a x_a x_b: the three places the odd index can take
        let two = |a: usize, b: usize| 2.0 * t(a, a, b) + t(b, a, a);
        Dipole {
            centre: self.centre,
            radius2: self.radius.min(far).powi(2),
            first: self.first,
            trace: m[0].x + m[1].y + m[2].z,
            second: [m[0].x, m[1].y, m[2].z, m[0].y + m[1].x, m[0].z + m[2].x, m[1].z + m[2].y],
            third_line: DVec3::new(line(0), line(1), line(2)),
            third: [
                t(0, 0, 0),
                t(1, 1, 1),
                t(2, 2, 2),
                two(0, 1),
                two(0, 2),
                two(1, 0),
                two(1, 2),
                two(2, 0),
                two(2, 1),
                2.0 * (t(0, 1, 2) + t(1, 0, 2) + t(2, 0, 1)),
            ],
        }
    }
}

impl Dipole {
    /// 4 pi times the winding number seen from d = centre - q, |d|² = r2.
    pub(super) fn solid_angle(&self, d: DVec3, r2: f64) -> f64 {
        let (i2, DVec3 { x, y, z }) = (1.0 / r2, d);
        let i3 = i2 * i2.sqrt();
        let [xx, yy, zz, xy, xz, yz] = self.second;
        let square = xx * x * x + yy * y * y + zz * z * z + xy * x * y + xz * x * z + yz * y * z;
        let t = &self.third;
        let cube = x * x * (t[0] * x + t[3] * y + t[4] * z)
            + y * y * (t[1] * y + t[5] * x + t[6] * z)
            + z * z * (t[2] * z + t[7] * x + t[8] * y)
            + t[9] * x * y * z;
        let lines = 3.0 * square + 1.5 * self.third_line.dot(d);
        i3 * (self.first.dot(d) + self.trace - i2 * (lines - 7.5 * i2 * cube))
    }
}

/// The half of a triangle's signed solid angle seen from the origin, as the direction of a complex
/// number (van Oosterom and Strackee 1983): real part, imaginary part.
fn half_angle([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let across = a.dot(b.cross(c));
    (la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, across)
}

/// Angles in (-pi, pi] summed as a product of complex numbers: one arc tangent for all, and the
/// full turns counted by the side of the real axis on which each factor lies.
struct Angles {
    re: f64,
    im: f64,
    turns: f64,
}

impl Angles {
    const NONE: Self = Self { re: 1.0, im: 0.0, turns: 0.0 };

    fn add(&mut self, (re, im): (f64, f64)) {
        let (x, y) = (self.re * re - self.im * im, self.re * im + self.im * re);
        let size = x.abs().max(y.abs());
        // a point on a corner sees nothing of that triangle
        if size <= 0.0 || size.is_nan() {
            return;
        }
        // far from where the next product could overflow or vanish nothing needs to be scaled
        let size = if (1e-100..1e100).contains(&size) { 1.0 } else { size };
        if self.im >= 0.0 && im >= 0.0 && y < 0.0 {
            self.turns += 1.0;
        } else if self.im < 0.0 && im < 0.0 && (y > 0.0 || (y == 0.0 && x < 0.0)) {
            self.turns -= 1.0;
        }
        (self.re, self.im) = if size == 1.0 { (x, y) } else { (x / size, y / size) };
    }

    fn total(&self) -> f64 {
        self.im.atan2(self.re) + 2.0 * PI * self.turns
    }
}

impl Winding {
    /// The tree over oriented triangles with finite coordinates.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let bvh = Bvh::bare(triangles);
        let dipoles = dipoles(&bvh);
        Self { bvh, dipoles }
    }

    /// Whether there are no triangles, so that the winding number is 0 everywhere.
    pub fn is_empty(&self) -> bool {
        self.bvh.is_empty()
    }

    /// The box round the triangles.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// The winding number at `q`, on the right side of `level`: the tree's answer, recomputed the
    /// more exactly the nearer it comes to that level.
    pub fn number(&self, q: DVec3, level: f64) -> f64 {
        let stack = &mut Vec::with_capacity(64);
        let mut w = self.tree(q, BETA, stack);
        for (near, beta) in REFINE {
            if (w - level).abs() >= near {
                return w;
            }
            w = self.tree(q, beta, stack);
        }
        if (w - level).abs() < EXACT { self.exact(q) } else { w }
    }

    /// The winding number as the tree has it at once, off by some hundredths at worst.
    pub fn rough(&self, q: DVec3) -> f64 {
        self.tree(q, BETA, &mut Vec::with_capacity(64))
    }

    /// The winding number as the sum over all triangles.
    pub fn exact(&self, q: DVec3) -> f64 {
        let mut angles = Angles::NONE;
        self.sum(0, self.bvh.len() as u32, q, &mut angles);
        2.0 * angles.total() / (4.0 * PI)
    }

    fn sum(&self, first: u32, count: u32, q: DVec3, angles: &mut Angles) {
        let slots = first as usize..(first + count) as usize;
        for &[a, b, c] in &self.bvh.corners[slots] {
            angles.add(half_angle([a - q, b - q, c - q]));
        }
    }

    fn tree(&self, q: DVec3, beta: f64, stack: &mut Vec<u32>) -> f64 {
        let beta2 = beta * beta;
        let (mut total, mut angles) = (0.0, Angles::NONE);
        stack.clear();
        if !self.bvh.is_empty() {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let dipole = &self.dipoles[index as usize];
            let d = dipole.centre - q;
            let r2 = d.length_squared();
            if r2 > beta2 * dipole.radius2 {
                total += dipole.solid_angle(d, r2);
                continue;
            }
            let Node { first, count, .. } = self.bvh.nodes[index as usize];
            if count > 0 {
                self.sum(first, count, q, &mut angles);
            } else {
                stack.extend([first + 1, first]);
            }
        }
        (total + 2.0 * angles.total()) / (4.0 * PI)
    }
}

fn dipoles(bvh: &Bvh) -> Vec<Dipole> {
    let mut moments = vec![Moments::at(DVec3::ZERO); bvh.nodes.len()];
    for (i, node) in bvh.nodes.iter().enumerate().rev() {
        let first = node.first as usize;
        moments[i] = if node.count > 0 {
            of_triangles(&bvh.corners[first..first + node.count as usize], &node.bounds)
        } else {
            of_children(&moments[first], &moments[first + 1], &node.bounds)
        };
    }
    bvh.nodes.iter().zip(&moments).map(|(n, m)| m.dipole(&n.bounds)).collect()
}

fn of_triangles(triangles: &[[DVec3; 3]], bounds: &Aabb) -> Moments {
    let (mut centre, mut area) = (DVec3::ZERO, 0.0);
    for &[a, b, c] in triangles {
        let part = (b - a).cross(c - a).length();
        centre += (a + b + c) * (part / 3.0);
        area += part;
    }
    let mut m = Moments::at(if area > 0.0 { centre / area } else { bounds.centre() });
    triangles.iter().for_each(|t| m.add_triangle(t));
    m
}

fn of_children(a: &Moments, b: &Moments, bounds: &Aabb) -> Moments {
    let area = a.area + b.area;
    let centre = (a.centre * a.area + b.centre * b.area) / area;
    let mut m = Moments::at(if area > 0.0 { centre } else { bounds.centre() });
    m.add(a);
    m.add(b);
    m
}

#[cfg(test)]
mod tests {
    use super::{Angles, half_angle};
    use glam::dvec3;

    #[test]
    fn angles_add_up_over_full_turns() {
        for step in [0.3f64, -0.3, 2.9, -2.9, 1.7] {
            let mut sum = Angles::NONE;
            for n in 1..200 {
                sum.add((step.cos() * 1e3, step.sin() * 1e3));
                assert!((sum.total() - step * f64::from(n)).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let (re, im) =
            half_angle([dvec3(2.0, 0.0, 0.0), dvec3(0.0, 3.0, 0.0), dvec3(0.0, 0.0, 1.0)]);
        assert!((im.atan2(re) - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    }
}
