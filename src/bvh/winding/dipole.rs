//! Moments of oriented triangles, summed up the tree.

use crate::bvh::{Bvh, Node};
use crate::num::Aabb;
use glam::{DMat3, DVec3};

/// Moments of the area vectors about the centre of a node, ready for evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dipole {
    pub(super) centre: DVec3,
    pub(super) radius2: f64,
    /// Sum of area vectors.
    pub(super) first: DVec3,
    pub(super) trace: f64,
    /// Coefficients of xx, yy, zz, xy, xz, yz.
    pub(super) second: [f64; 6],
    /// Contraction that meets d / r^5.
    pub(super) third_line: DVec3,
    /// Coefficients of xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
    pub(super) third: [f64; 10],
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

/// Nodes of a part of the tree that one thread sums up.
const PART: usize = 4096;
/// Levels below which the tree is not divided any more.
const DEPTH: u32 = 64;

/// The dipole of every node.
pub(super) fn dipoles(bvh: &Bvh) -> Vec<Dipole> {
    let Some(root) = bvh.nodes.first() else {
        return vec![];
    };
    let mut all = vec![Dipole::default(); bvh.nodes.len()];
    let (own, below) = all.split_at_mut(1);
    own[0] = node(bvh, root, below, DEPTH).dipole(&root.bounds);
    all
}

/// The moments of a node; `below` gets the dipoles of all under it.
fn node(bvh: &Bvh, node: &Node, below: &mut [Dipole], depth: u32) -> Moments {
    let first = node.first as usize;
    if node.count > 0 {
        return of_triangles(&bvh.corners[first..first + node.count as usize], &node.bounds);
    }
    let [a, b] = pair(bvh, first, below, depth);
    of_children(&a, &b, &node.bounds)
}

/// The moments of the two nodes from `at`. The tree is laid out so that what is under the first one
/// follows them, then what is under the second.
fn pair(bvh: &Bvh, at: usize, out: &mut [Dipole], depth: u32) -> [Moments; 2] {
    if out.len() < PART || depth == 0 {
        return one_by_one(bvh, at, out);
    }
    let (a, b) = (&bvh.nodes[at], &bvh.nodes[at + 1]);
    let (own, below) = out.split_at_mut(2);
    let second = if b.count > 0 { below.len() } else { b.first as usize - (at + 2) };
    let (under_a, under_b) = below.split_at_mut(second);
    let (m, n) =
        rayon::join(|| node(bvh, a, under_a, depth - 1), || node(bvh, b, under_b, depth - 1));
    own[0] = m.dipole(&a.bounds);
    own[1] = n.dipole(&b.bounds);
    [m, n]
}

/// The same from the last pair up to the first, without as much room as there are nodes.
fn one_by_one(bvh: &Bvh, at: usize, out: &mut [Dipole]) -> [Moments; 2] {
    let mut open: Vec<[Moments; 2]> = vec![];
    for (i, own) in out.chunks_exact_mut(2).enumerate().rev() {
        // what is under the first node has come last
        let both = [0, 1].map(|k| {
            let node = &bvh.nodes[at + 2 * i + k];
            let first = node.first as usize;
            if node.count > 0 {
                return of_triangles(
                    &bvh.corners[first..first + node.count as usize],
                    &node.bounds,
                );
            }
            let none = Moments::at(DVec3::ZERO);
            let [a, b] = open.pop().unwrap_or([none; 2]);
            of_children(&a, &b, &node.bounds)
        });
        for k in 0..2 {
            own[k] = both[k].dipole(&bvh.nodes[at + 2 * i + k].bounds);
        }
        open.push(both);
    }
    open.pop().unwrap_or([Moments::at(DVec3::ZERO); 2])
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
    use super::*;

    /// The dipoles from the last node up to the first.
    fn plain(bvh: &Bvh) -> Vec<Dipole> {
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

    #[test]
    fn parts_of_the_tree_sum_up_as_the_whole_does() {
        let at = |k: u32| {
            let x = f64::from(k) * 0.754_877_666;
            DVec3::new(x.fract(), (x * 1.3247).fract(), (x * 1.7549).fract()) * 50.0
        };
        let triangle = |i: u32| [at(i), at(i) + at(i + 1) * 0.02, at(i) + at(i + 2) * 0.02];
        for n in [0, 1, 9, 300, 30_000] {
            let bvh = Bvh::bare(&(0..n).map(triangle).collect::<Vec<_>>());
            assert!(n < 30_000 || bvh.nodes.len() > 2 * PART);
            let same = format!("{:?}", dipoles(&bvh)) == format!("{:?}", plain(&bvh));
            assert!(same, "{n}");
        }
    }
}
