use super::axis;
use super::pairs::middle;
use super::triangle::LANES;
use crate::num::lanes::Vec8;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::DVec3;

/// Distance from a point to one triangle, mm; to a segment or point where it has no area.
pub fn gap(corners: [DVec3; 3], p: DVec3) -> f64 {
    super::triangle::Tri::new(corners).distance2(p.x, p.y, p.z).sqrt()
}

/// A flat convex polygon (a triangle, or a segment of two points) and its unit normal, zero without area.
#[derive(Clone, Copy)]
pub struct Flat<'a>(pub &'a [DVec3], pub DVec3);

impl<'a> Flat<'a> {
    /// With the normal that its corners have.
    pub fn of(corners: &'a [DVec3]) -> Self {
        Self(corners, normal(corners))
    }
}

/// Whether two polygons are separated by more than `slack` mm, which is not negative. Errs on the side
/// of `false`: what touches or overlaps is never called apart.
///
/// Separating axes: the line from middle to middle, which parts most of what is apart; both normals,
/// the sides' normals within each plane, and all products of a side of one with a side of the other.
pub fn apart(Flat(a, na): Flat, Flat(b, nb): Flat, slack: f64) -> bool {
    let parts = |axis: DVec3| parts(a, b, axis, slack);
    let middle = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
    if parts(middle(b) - middle(a)) || parts(na) || parts(nb) {
        return true;
    }
    sides(b).any(|t| parts(t.cross(nb)))
        || sides(a).any(|s| parts(s.cross(na)) || sides(b).any(|t| parts(s.cross(t))))
}

/// Unit normal of a flat polygon (Newell), zero without area.
fn normal(p: &[DVec3]) -> DVec3 {
    let Some(&o) = p.first() else {
        return DVec3::ZERO;
    };
    (1..p.len())
        .map(|i| (p[i] - o).cross(p[(i + 1) % p.len()] - o))
        .sum::<DVec3>()
        .normalize_or_zero()
}

/// A polygon, to be told [`apart`] from triangles eight at a time, with the same answers.
pub struct Outline<'a> {
    corners: &'a [DVec3],
    normal: DVec3,
    middle: DVec3,
    sides: Vec<DVec3>,
    slack: f64,
}

impl<'a> Outline<'a> {
    /// Triangles that [`Outline::near`] takes at once.
    pub const MOST: usize = LANES;

    /// Of at least one point.
    pub fn new(corners: &'a [DVec3], slack: f64) -> Self {
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        Self { corners, normal: normal(corners), middle, sides: sides(corners).collect(), slack }
    }

    /// Which of up to eight triangles are not apart from it, a bit for each.
    pub fn near(&self, triangles: &[(&[DVec3; 3], DVec3)]) -> u8 {
        if triangles.is_empty() {
            return 0;
        }
        let of = |i: usize| {
            let at: [DVec3; LANES] = std::array::from_fn(|lane| match triangles.get(lane) {
                Some((t, n)) => {
                    if i < 3 {
                        t[i]
                    } else {
                        *n
                    }
                }
                None => DVec3::ZERO,
            });
            at
        };
        let lanes = [0, 1, 2, 3].map(of);
        let all = u8::MAX >> (LANES - triangles.len().min(LANES));
        dispatch!(Level::new(), s => self.near_of(s, &lanes, all))
    }

    /// The same of those whose bit is set in `near`, from their corners and normals.
    #[inline(always)]
    fn near_of<S: Simd>(&self, s: S, [a, b, c, n]: &[[DVec3; LANES]; 4], mut near: u8) -> u8 {
        let triangles = [Vec8::of(s, a), Vec8::of(s, b), Vec8::of(s, c)];
        near &= !self.parted(&triangles, middle(&triangles).less(Vec8::splat(s, self.middle)));
        if near == 0 {
            return 0;
        }
        let (own, normals) = (Vec8::splat(s, self.normal), Vec8::of(s, n));
        near &= !self.parted(&triangles, own);
        near &= !self.parted(&triangles, normals);
        let [a, b, c] = triangles;
        let sides = [b.less(a).unit(), c.less(b).unit(), a.less(c).unit()];
        for side in sides {
            near &= !self.parted(&triangles, side.cross(normals));
        }
        for &side in &self.sides {
            if near == 0 {
                return 0;
            }
            let side = Vec8::splat(s, side);
            near &= !self.parted(&triangles, side.cross(own));
            for other in sides {
                near &= !self.parted(&triangles, side.cross(other));
            }
        }
        near
    }

    #[inline(always)]
    fn parted<S: Simd>(&self, triangles: &[Vec8<S>; 3], axis: Vec8<S>) -> u8 {
        let s = axis.x.token();
        let mut lo = f64x8::splat(s, f64::INFINITY);
        let mut hi = f64x8::splat(s, f64::NEG_INFINITY);
        for &p in self.corners {
            let height = Vec8::splat(s, p).dot(axis);
            lo = lo.min(height);
            hi = hi.max(height);
        }
        axis::parts(axis, [lo, hi], axis::shadow(axis, triangles), self.slack)
    }
}

fn sides(p: &[DVec3]) -> impl Iterator<Item = DVec3> {
    (0..p.len()).map(move |i| (p[(i + 1) % p.len()] - p[i]).normalize_or_zero())
}

/// Whether the shadows on an axis are more than `slack` from each other; no if the axis says nothing.
#[inline(always)]
fn parts(a: &[DVec3], b: &[DVec3], axis: DVec3, slack: f64) -> bool {
    let shadow = |p: &[DVec3]| {
        p.iter()
            .map(|p| p.dot(axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)))
    };
    let ((alo, ahi), (blo, bhi)) = (shadow(a), shadow(b));
    let gap = (alo - bhi).max(blo - ahi);
    if gap <= 0.0 {
        return false;
    }
    // most are far enough beyond doubt, and need no root
    let length2 = axis.length_squared();
    if length2 > 1e-16 && gap * gap > slack * slack * length2 * (1.0 + 1e-9) {
        return true;
    }
    // sides nearly parallel give a direction of round-off only
    let length = length2.sqrt();
    length > 1e-9 && gap / length > slack
}

#[cfg(test)]
mod tests {
    use super::{Flat, Outline};
    use glam::{DVec3, dvec3};

    fn apart(a: &[DVec3], b: &[DVec3], slack: f64) -> bool {
        super::apart(Flat::of(a), Flat::of(b), slack)
    }

    #[test]
    fn crossing_touching_and_separate_triangles() {
        let flat = [dvec3(0.0, 0.0, 0.0), dvec3(4.0, 0.0, 0.0), dvec3(0.0, 4.0, 0.0)];
        let through = [dvec3(1.0, 1.0, -1.0), dvec3(1.0, 1.0, 1.0), dvec3(9.0, 9.0, 0.0)];
        let standing = [dvec3(1.0, 1.0, 0.0), dvec3(2.0, 1.0, 0.0), dvec3(1.0, 1.0, 3.0)];
        let above = standing.map(|p| p + dvec3(0.0, 0.0, 0.01));
        let beside = flat.map(|p| p + dvec3(3.0, 3.0, 0.0));
        let overlapping = flat.map(|p| p + dvec3(1.0, 1.0, 0.0));
        assert!(!apart(&flat, &through, 0.0));
        assert!(!apart(&flat, &standing, 1e-9));
        assert!(apart(&flat, &above, 0.005));
        assert!(!apart(&flat, &above, 0.02));
        assert!(apart(&flat, &beside, 0.1));
        assert!(!apart(&flat, &overlapping, 1e-9));
        assert!(!apart(&flat, &[dvec3(1.0, 1.0, -1.0), dvec3(1.0, 1.0, 1.0)], 0.0));
        assert!(apart(&flat, &[dvec3(3.0, 3.0, -1.0), dvec3(3.0, 3.0, 1.0)], 0.1));
    }

    /// Triangles in all positions to each other: far, near, touching, crossing, thin and without area.
    fn some(n: u32) -> impl Iterator<Item = [DVec3; 3]> {
        let at = |k: u32| {
            let x = f64::from(k) * 0.754_877_666;
            dvec3(x.fract(), (x * 1.3247).fract(), (x * 1.7549).fract())
        };
        (0..n).map(move |i| {
            let (o, size) = (at(i) * 3.0, [2.0, 0.5, 1e-3][i as usize % 3]);
            let [a, b, c] = [1, 2, 3].map(|k| o + (at(7 * i + k) - 0.5) * size);
            match i % 11 {
                0 => [a, b, b],
                1 => [a, a, a],
                2 => [a, b, c].map(|p| dvec3(p.x, p.y, 1.0)),
                3 => [a, b, c].map(DVec3::round),
                _ => [a, b, c],
            }
        })
    }

    #[test]
    fn eight_at_a_time_are_told_apart_as_one_is() {
        let triangles: Vec<_> = some(400).collect();
        let (mut near, mut far) = (0, 0);
        for (i, [a, b, c]) in some(60).enumerate() {
            let slack = [0.0, 1e-6, 0.02, 0.3][i % 4];
            let four = [a, b, c, a + (c - b) * 0.7];
            let outline = &four[..3 + i % 2];
            for run in triangles.chunks(8) {
                let flat: Vec<_> = run.iter().map(|t| (t, Flat::of(t).1)).collect();
                let bits = Outline::new(outline, slack).near(&flat);
                for (lane, t) in run.iter().enumerate() {
                    let touches = !apart(outline, t, slack);
                    assert_eq!(bits >> lane & 1 == 1, touches, "{outline:?} {t:?}");
                    assert_eq!(touches, !apart(t, outline, slack));
                    if touches { near += 1 } else { far += 1 }
                }
                assert_eq!(u32::from(bits) >> run.len(), 0);
            }
        }
        assert!(near > 500 && far > 500, "{near} {far}");
    }
}
