//! Warped distance-field interpolation (Cohen-Or, Levin and Solomovici 1998): every shape is pulled
//! onto common anchors, and the distances are averaged there.
//!
//! Anchor a stands at p_ja on shape j and at q_a = Σ w_j p_ja in the result. The warp of shape j
//! leads back, W_j(q_a) = p_ja: an affine map plus Σ c_a |x - q_a|, the radial basis that bends
//! least in space. The field is Σ λ_j f_j(W_j(x)). A shape with all the weight has W = identity, so
//! the ends are the inputs exactly.
//!
//! **Bounds.** Over a box round c of radius r, `W(x) = W(c) + J (x - c) + e` with
//! `|e| <= Σ |c_a| δ_a r` and δ_a = 2 r / (2 D_a - r) where c lies D_a > r from q_a, else 2: the
//! change of the direction to the anchor. The shape's own bound over that image holds.

use super::Morph;
use super::plan::{Anchor, Course, Feature, MorphError, Part};
use crate::field::{Field, Shared};
use crate::job::{Cancelled, Job};
use crate::num::lsq::{Dense, solve};
use crate::num::{Aabb, Interval};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Where the anchors of an element stand, in its normal coordinates: its middle and the middles of
/// its six sides. Corners would tie down what overlapping elements disagree about.
const ON_ELEMENT: [DVec3; 7] =
    [DVec3::ZERO, DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
/// Anchors closer than this share of their extent are one: the first of them counts.
const SAME: f64 = 1e-4;
/// Anchors at most: the system is solved densely, which takes a tenth of a second for so many, and
/// every look-up passes all of them.
const MOST: usize = 300;

pub(super) struct Warp {
    shapes: Vec<Part>,
    course: Course,
    anchors: Vec<(Vec<DVec3>, Course)>,
}

impl Warp {
    pub fn new(
        shapes: Vec<Part>,
        course: Course,
        features: &[Feature],
        own: Vec<Anchor>,
    ) -> Result<Self, MorphError> {
        let mut anchors = Vec::new();
        for f in features {
            for q in ON_ELEMENT {
                let at = f.elements.iter().map(|e| e.to_world(q)).collect();
                anchors.push((at, f.deform.clone()));
            }
        }
        for a in own {
            if a.at.len() != shapes.len() {
                let (anchor, got) = (a.name, a.at.len());
                return Err(MorphError::Anchors { anchor, got, shapes: shapes.len() });
            }
            anchors.push((a.at, course.clone()));
        }
        if anchors.is_empty() || anchors.len() > MOST {
            return Err(MorphError::Range {
                what: "the number of anchors".to_owned(),
                expected: "1 to 300; give [[features]] or [[anchors]]",
                got: anchors.len() as f64,
            });
        }
        Ok(Self { shapes, course, anchors })
    }
}

impl Morph for Warp {
    fn at(&self, t: f64, _job: &dyn Job) -> Result<Shared, Cancelled> {
        let weights = self.course.at(t);
        let to: Vec<DVec3> = self
            .anchors
            .iter()
            .map(|(at, course)| at.iter().zip(course.at(t)).map(|(p, w)| *p * w).sum())
            .collect();
        let kept = distinct(&to);
        let to: Vec<DVec3> = kept.iter().map(|&a| to[a]).collect();
        let pulled = self.shapes.iter().zip(weights).enumerate().filter(|(_, (_, w))| *w > 0.0);
        let parts = pulled
            .map(|(j, (shape, weight))| {
                let from = kept.iter().map(|&a| self.anchors[a].0[j]).collect::<Vec<_>>();
                Pulled { field: shape.field.clone(), weight, map: Map::new(&to, &from) }
            })
            .collect();
        Ok(Arc::new(Mean { parts }))
    }

    fn domain(&self) -> Aabb {
        self.shapes.iter().fold(Aabb::EMPTY, |b, s| b.hull(s.field.support()))
    }
}

/// Indices of points that do not fall on an earlier one.
fn distinct(at: &[DVec3]) -> Vec<usize> {
    let least = SAME * Aabb::of(at.iter().copied()).size().length();
    let mut kept: Vec<usize> = Vec::new();
    for (i, p) in at.iter().enumerate() {
        if kept.iter().all(|&k| at[k].distance(*p) > least) || kept.is_empty() {
            kept.push(i);
        }
    }
    kept
}

/// x -> x + shift + linear (x - middle) + Σ c_a |x - q_a|.
struct Map {
    middle: DVec3,
    shift: DVec3,
    linear: DMat3,
    /// Anchors and their coefficients.
    anchors: Vec<(DVec3, DVec3)>,
    /// Σ |c_a| a component.
    total: DVec3,
}

impl Map {
    /// The map with W(to_a) = from_a. Where the anchors span less than space, the smallest one.
    fn new(to: &[DVec3], from: &[DVec3]) -> Self {
        let extent = Aabb::of(to.iter().copied());
        let (middle, n) = (extent.centre(), to.len());
        // coordinates near one, so that no column drowns another
        let scale = extent.size().max_element().max(1e-9);
        let at: Vec<DVec3> = to.iter().map(|q| (*q - middle) / scale).collect();
        let affine = |a: usize, c: usize| if c == 0 { 1.0 } else { at[a][c - 1] };
        let matrix = Dense::from_fn(n + 4, n + 4, |i, j| match (i < n, j < n) {
            (true, true) => at[i].distance(at[j]),
            (true, false) => affine(i, j - n),
            (false, true) => affine(j, i - n),
            (false, false) => 0.0,
        });
        let right =
            Dense::from_fn(n + 4, 3, |i, c| if i < n { from[i][c] - to[i][c] } else { 0.0 });
        let x = solve(matrix, right).x;
        let row = |i: usize| DVec3::new(x.at(i, 0), x.at(i, 1), x.at(i, 2));
        let anchors: Vec<_> = (0..n).map(|a| (to[a], row(a) / scale)).collect();
        Self {
            middle,
            shift: row(n),
            linear: DMat3::from_cols(row(n + 1), row(n + 2), row(n + 3)) * (1.0 / scale),
            total: anchors.iter().map(|(_, c)| c.abs()).sum(),
            anchors,
        }
    }

    fn pull(&self, p: DVec3) -> DVec3 {
        let bent: DVec3 = self.anchors.iter().map(|(q, c)| *c * p.distance(*q)).sum();
        p + (self.shift + self.linear * (p - self.middle) + bent)
    }

    /// A box that holds the images of all points of `b`.
    fn image(&self, b: &Aabb) -> Aabb {
        let (c, r) = (b.centre(), b.radius());
        let mut jacobian = DMat3::IDENTITY + self.linear;
        let mut rest = DVec3::ZERO;
        for (q, w) in &self.anchors {
            let way = c - *q;
            let d = way.length();
            if d > 0.0 {
                let u = way / d;
                jacobian += DMat3::from_cols(*w * u.x, *w * u.y, *w * u.z);
            }
            let turn = if d > r { (2.0 * r / (2.0 * d - r)).min(2.0) } else { 2.0 };
            rest += w.abs() * turn;
        }
        let half = jacobian.abs() * (b.size() * 0.5) + rest * r;
        let slack = 1e-12 * (c.abs().max_element() + half.max_element() + self.size(c));
        Aabb::around(self.pull(c), half).grow(slack)
    }

    /// How large the terms of the map are at `p`, for round-off.
    fn size(&self, p: DVec3) -> f64 {
        let far = (p - self.middle).length() + 1.0;
        self.shift.length() + far * (1.0 + self.total.length() * self.anchors.len() as f64)
    }
}

/// A shape behind its warp.
struct Pulled {
    field: Shared,
    weight: f64,
    map: Map,
}

/// The weighted mean of warped shapes.
struct Mean {
    parts: Vec<Pulled>,
}

impl Field for Mean {
    fn value(&self, p: DVec3) -> f64 {
        let mut f = [0.0];
        self.values(&[p], &mut f);
        f[0]
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        out.fill(0.0);
        let mut y = vec![DVec3::ZERO; at.len()];
        let mut one = vec![0.0; at.len()];
        for part in &self.parts {
            for (y, &p) in y.iter_mut().zip(at) {
                *y = part.map.pull(p);
            }
            part.field.values(&y, &mut one);
            for (f, v) in out.iter_mut().zip(&one) {
                *f += part.weight * v;
            }
        }
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let mut sum = Interval::point(0.0);
        for part in &self.parts {
            sum = sum + part.field.bound(&part.map.image(b)).scale(part.weight);
        }
        sum.widen(1e-9 * (1.0 + b.radius()))
    }

    /// The maps may bring matter from anywhere, so nothing smaller can be promised.
    fn support(&self) -> Aabb {
        Aabb::ALL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_passes_its_anchors_and_is_affine_where_they_are() {
        let to = [[0, 0, 0], [9, 1, 0], [2, 8, 1], [1, 2, 7], [5, 5, 5], [8, 9, 9]]
            .map(|p| DVec3::from_array(p.map(f64::from)));
        let turn = DMat3::from_rotation_z(0.3);
        let affine = to.map(|p| turn * p * 1.5 + DVec3::new(3.0, -2.0, 1.0));
        let map = Map::new(&to, &affine);
        let p = DVec3::new(20.0, -3.0, 4.0);
        assert!(map.pull(p).distance(turn * p * 1.5 + DVec3::new(3.0, -2.0, 1.0)) < 1e-9);
        assert!(map.total.length() < 1e-10);
        let mut bent = affine;
        bent[4] += DVec3::new(2.0, 1.0, -1.0);
        let map = Map::new(&to, &bent);
        for (q, p) in to.iter().zip(bent) {
            assert!(map.pull(*q).distance(p) < 1e-9);
        }
    }

    #[test]
    fn anchors_in_a_plane_leave_the_way_across_alone() {
        let to = [[0, 0], [9, 1], [2, 8], [7, 7]]
            .map(|[x, y]| DVec3::new(f64::from(x), f64::from(y), 0.0));
        let from = to.map(|p| p + DVec3::new(5.0, 0.0, 0.0));
        let p = Map::new(&to, &from).pull(DVec3::new(3.0, 3.0, 40.0));
        assert!(p.distance(DVec3::new(8.0, 3.0, 40.0)) < 1e-9);
    }
}
