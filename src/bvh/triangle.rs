//! Distance from a point to a triangle, in the triangle's own plane frame.
//!
//! The frame's x runs along the longest side AB, so that the arithmetic stays sound on slivers:
//! a misjudged side changes the result by round-off only. Every distance in this crate goes
//! through [`Tri::distance2`], one point or eight at a time, so all queries agree exactly.

use crate::num::Aabb;
use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};
use glam::DVec3;

/// Points measured at once by the batch kernel.
pub(super) const LANES: usize = 8;

/// A triangle A(0, 0), B(ab, 0), C(cx, cy) with cy >= 0 in the frame (u, v, n) at A: the numbers
/// of A, u, v and n, then ab, then unit direction and length of the sides from B and A to C.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tri([f64; NUMBERS]);

/// Numbers of a triangle.
const NUMBERS: usize = 19;

/// Cosine below which two unit vectors count as square to each other.
const SQUARE: f64 = 1e-9;

/// Where a point lies relative to a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    /// Signed height over the plane, positive on the side the normal points to.
    pub height: f64,
    /// Distance of the foot from the nearest side line, negative where it lies outside.
    pub inside: f64,
    /// The nearest point of the triangle.
    pub point: DVec3,
}

/// Unit direction and length of a plane vector; a zero vector counts as direction x.
fn direction(x: f64, y: f64) -> [f64; 3] {
    let length = x.hypot(y);
    if length > 0.0 { [x / length, y / length, length] } else { [1.0, 0.0, 0.0] }
}

/// `clamp` that vectorises: no NaN handling.
#[inline(always)]
fn clip(x: f64, hi: f64) -> f64 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < hi { x } else { hi }
}

#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Tri {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        let side = |i: usize| (corners[(i + 1) % 3] - corners[i]).length_squared();
        let first = (0..3).fold(0, |best, i| if side(i) > side(best) { i } else { best });
        let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
        let u = (b - a).try_normalize().unwrap_or(DVec3::X);
        // the part of AC across AB keeps v and n square to u even on a sliver
        let across = (c - a) - u * (c - a).dot(u);
        let v = (across - u * across.dot(u)).try_normalize();
        // of a triangle that is a segment there is only round-off left, which may run along AB
        let v = v.filter(|v| v.dot(u).abs() < SQUARE);
        let v = v.unwrap_or_else(|| u.any_orthonormal_vector());
        let ab = (b - a).dot(u);
        let (cx, cy) = ((c - a).dot(u), (c - a).dot(v));
        let n = u.cross(v);
        let ([bx, by, bl], [cx, cy, cl]) = (direction(cx - ab, cy), direction(cx, cy));
        Self([
            a.x, a.y, a.z, u.x, u.y, u.z, v.x, v.y, v.z, n.x, n.y, n.z, ab, bx, by, bl, cx, cy, cl,
        ])
    }

    /// Squared distance.
    #[inline(always)]
    pub(super) fn distance2(&self, px: f64, py: f64, pz: f64) -> f64 {
        let [ax, ay, az, ux, uy, uz, vx, vy, vz, nx, ny, nz, ab, bx, by, bl, cx, cy, cl] = self.0;
        let (rx, ry, rz) = (px - ax, py - ay, pz - az);
        let x = rx * ux + ry * uy + rz * uz;
        let y = rx * vx + ry * vy + rz * vz;
        let z = rx * nx + ry * ny + rz * nz;
        let q = x - ab;
        let (along_b, perp_b) = (q * bx + y * by, y * bx - q * by);
        let (along_c, perp_c) = (x * cx + y * cy, x * cy - y * cx);
        let over_a = x - clip(x, ab);
        let over_b = along_b - clip(along_b, bl);
        let over_c = along_c - clip(along_c, cl);
        let sides = least(
            over_a * over_a + y * y,
            least(over_b * over_b + perp_b * perp_b, over_c * over_c + perp_c * perp_c),
        );
        let inside = least(y, least(perp_b, perp_c));
        z * z + if inside > 0.0 { 0.0 } else { sides }
    }

    /// Height, foot and nearest point for `p`.
    pub(super) fn local(&self, p: DVec3) -> Local {
        let [ax, ay, az, ux, uy, uz, vx, vy, vz, nx, ny, nz, ab, bx, by, bl, cx, cy, cl] = self.0;
        let [a, u, v, n] =
            [[ax, ay, az], [ux, uy, uz], [vx, vy, vz], [nx, ny, nz]].map(DVec3::from);
        let r = p - a;
        let (x, y, z) = (r.dot(u), r.dot(v), r.dot(n));
        let q = x - ab;
        let inside = y.min(y * bx - q * by).min(x * cy - y * cx);
        let foot = if inside > 0.0 {
            [x, y]
        } else {
            let (b, c) = (clip(q * bx + y * by, bl), clip(x * cx + y * cy, cl));
            let sides = [[clip(x, ab), 0.0], [ab + b * bx, b * by], [c * cx, c * cy]];
            let far = |s: [f64; 2]| (s[0] - x).powi(2) + (s[1] - y).powi(2);
            sides.into_iter().fold(sides[0], |m, s| if far(s) < far(m) { s } else { m })
        };
        Local { height: z, inside, point: a + u * foot[0] + v * foot[1] }
    }
}

/// Eight triangles, number by number.
#[derive(Clone, Debug)]
pub(super) struct Lanes([[f64; LANES]; NUMBERS]);

/// A point in every lane, or eight points.
#[derive(Clone, Copy)]
pub(super) struct Points<S: Simd> {
    pub(super) x: f64x8<S>,
    pub(super) y: f64x8<S>,
    pub(super) z: f64x8<S>,
}

#[inline(always)]
fn clip_lanes<S: Simd>(x: f64x8<S>, hi: f64x8<S>) -> f64x8<S> {
    x.max(f64x8::splat(x.token(), 0.0)).min(hi)
}

/// A point against a triangle in its frame: over each side line how far beyond the side's ends, and
/// how far off to the left; the height; and where the foot is in the triangle.
struct Local8<S: Simd> {
    over: [f64x8<S>; 3],
    off: [f64x8<S>; 3],
    z: f64x8<S>,
    inside: mask64x8<S>,
}

/// `t` tells the lanes of a number of the triangle. What is not inlined here would lose the wide
/// registers: no closures.
#[inline(always)]
fn local<S: Simd>(p: &Points<S>, t: &impl Numbers<S>) -> Local8<S> {
    let (rx, ry, rz) = (p.x - t.at(0), p.y - t.at(1), p.z - t.at(2));
    let x = rx * t.at(3) + ry * t.at(4) + rz * t.at(5);
    let y = rx * t.at(6) + ry * t.at(7) + rz * t.at(8);
    let z = rx * t.at(9) + ry * t.at(10) + rz * t.at(11);
    let ab = t.at(12);
    let (bx, by, bl) = (t.at(13), t.at(14), t.at(15));
    let (cx, cy, cl) = (t.at(16), t.at(17), t.at(18));
    let q = x - ab;
    let (along_b, perp_b) = (q * bx + y * by, y * bx - q * by);
    let (along_c, perp_c) = (x * cx + y * cy, x * cy - y * cx);
    let over_a = x - clip_lanes(x, ab);
    let over_b = along_b - clip_lanes(along_b, bl);
    let over_c = along_c - clip_lanes(along_c, cl);
    let inside = y.min(perp_b.min(perp_c)).simd_gt(f64x8::splat(x.token(), 0.0));
    Local8 { over: [over_a, over_b, over_c], off: [y, perp_b, perp_c], z, inside }
}

impl<S: Simd> Local8<S> {
    /// Squared distances from the sides.
    #[inline(always)]
    fn sides(&self) -> [f64x8<S>; 3] {
        let ([a, b, c], [y, p, q]) = (self.over, self.off);
        [a * a + y * y, b * b + p * p, c * c + q * q]
    }
}

/// Eight distances at once, [`Tri::distance2`] to the letter.
#[inline(always)]
fn distances2<S: Simd>(p: &Points<S>, t: impl Numbers<S>) -> f64x8<S> {
    let local = local(p, &t);
    let [a, b, c] = local.sides();
    let sides = a.min(b.min(c));
    local.z * local.z + local.inside.select(f64x8::splat(sides.token(), 0.0), sides)
}

/// The way from the nearest point of a triangle, mm: squared length, and along x, y, z. Its length
/// is that of [`distances2`] but for round-off.
#[derive(Clone, Copy)]
pub(super) struct Way<S: Simd> {
    pub(super) length2: f64x8<S>,
    pub(super) along: [f64x8<S>; 3],
}

/// The ways to eight points at once.
#[inline(always)]
fn ways<S: Simd>(p: &Points<S>, t: impl Numbers<S>) -> Way<S> {
    let local = local(p, &t);
    let ([over_a, over_b, over_c], [y, perp_b, perp_c]) = (local.over, local.off);
    let [a, b, c] = local.sides();
    let (bx, by, cx, cy) = (t.at(13), t.at(14), t.at(16), t.at(17));
    let by_c = c.simd_lt(b);
    let side = by_c.select(c, b);
    let x = by_c.select(over_c * cx + perp_c * cy, over_b * bx - perp_b * by);
    let v = by_c.select(over_c * cy - perp_c * cx, over_b * by + perp_b * bx);
    let by_a = a.simd_lt(side);
    let zero = f64x8::splat(side.token(), 0.0);
    let side = local.inside.select(zero, by_a.select(a, side));
    let x = local.inside.select(zero, by_a.select(over_a, x));
    let y = local.inside.select(zero, by_a.select(y, v));
    let z = local.z;
    let along_x = x * t.at(3) + y * t.at(6) + z * t.at(9);
    let along_y = x * t.at(4) + y * t.at(7) + z * t.at(10);
    let along_z = x * t.at(5) + y * t.at(8) + z * t.at(11);
    Way { length2: z * z + side, along: [along_x, along_y, along_z] }
}

/// Where [`distances2`] reads a triangle's numbers from.
trait Numbers<S: Simd> {
    fn at(&self, n: usize) -> f64x8<S>;
}

/// One triangle, the same in all lanes.
struct One<'a, S: Simd>(S, &'a [f64; NUMBERS]);

impl<S: Simd> Numbers<S> for One<'_, S> {
    #[inline(always)]
    fn at(&self, n: usize) -> f64x8<S> {
        f64x8::splat(self.0, self.1[n])
    }
}

/// Eight triangles.
struct Many<'a, S: Simd>(S, &'a [[f64; LANES]; NUMBERS]);

impl<S: Simd> Numbers<S> for Many<'_, S> {
    #[inline(always)]
    fn at(&self, n: usize) -> f64x8<S> {
        f64x8::simd_from(self.0, self.1[n])
    }
}

/// One of eight triangles, the same in all lanes.
struct OneOf<'a, S: Simd>(S, &'a [[f64; LANES]; NUMBERS], usize);

impl<S: Simd> Numbers<S> for OneOf<'_, S> {
    #[inline(always)]
    fn at(&self, n: usize) -> f64x8<S> {
        f64x8::splat(self.0, self.1[n][self.2])
    }
}

impl Lanes {
    /// Up to eight triangles, at least one; the last one fills the lanes left over.
    pub(super) fn of(tris: &[Tri]) -> Self {
        let of = |n: usize, lane: usize| tris[lane.min(tris.len() - 1)].0[n];
        Self(std::array::from_fn(|n| std::array::from_fn(|lane| of(n, lane))))
    }

    /// The ways to a point (the same in all lanes).
    #[inline(always)]
    pub(super) fn ways<S: Simd>(&self, s: S, p: &Points<S>) -> Way<S> {
        ways(p, Many(s, &self.0))
    }

    /// Squared distances of a point (the same in all lanes).
    #[inline(always)]
    pub(super) fn distances2<S: Simd>(&self, s: S, p: &Points<S>) -> f64x8<S> {
        distances2(p, Many(s, &self.0))
    }
}

impl<S: Simd> Points<S> {
    /// One point.
    #[inline(always)]
    pub(super) fn one(s: S, p: DVec3) -> Self {
        Self { x: f64x8::splat(s, p.x), y: f64x8::splat(s, p.y), z: f64x8::splat(s, p.z) }
    }

    /// The first points of `at`; what is missing repeats the last one.
    #[inline(always)]
    pub(super) fn of(s: S, at: &[DVec3]) -> Self {
        let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            if let Some(p) = at.get(i).or(at.last()) {
                (x[i], y[i], z[i]) = (p.x, p.y, p.z);
            }
        }
        let lanes = |x| f64x8::simd_from(s, x);
        Self { x: lanes(x), y: lanes(y), z: lanes(z) }
    }

    /// Distances from a box, 0 inside.
    #[inline(always)]
    pub(super) fn distances(&self, b: &Aabb) -> f64x8<S> {
        let s = self.x.token();
        let x = self.x - self.x.max(f64x8::splat(s, b.min.x)).min(f64x8::splat(s, b.max.x));
        let y = self.y - self.y.max(f64x8::splat(s, b.min.y)).min(f64x8::splat(s, b.max.y));
        let z = self.z - self.z.max(f64x8::splat(s, b.min.z)).min(f64x8::splat(s, b.max.z));
        (x * x + y * y + z * z).sqrt()
    }

    /// The ways from a triangle.
    #[inline(always)]
    pub(super) fn ways(&self, tri: &Tri) -> Way<S> {
        ways(self, One(self.x.token(), &tri.0))
    }

    /// Squared distances to one of eight triangles.
    #[inline(always)]
    pub(super) fn distances2_of(&self, tris: &Lanes, lane: usize) -> f64x8<S> {
        distances2(self, OneOf(self.x.token(), &tris.0, lane % LANES))
    }

    /// Squared distances to a triangle.
    #[inline(always)]
    pub(super) fn distances2(&self, tri: &Tri) -> f64x8<S> {
        distances2(self, One(self.x.token(), &tri.0))
    }
}

#[cfg(test)]
mod tests {
    use super::Tri;
    use glam::{DVec3, dvec3};

    fn distance(corners: [DVec3; 3], p: DVec3) -> f64 {
        Tri::new(corners).distance2(p.x, p.y, p.z).sqrt()
    }

    #[test]
    fn each_region_of_a_right_triangle() {
        let t = [DVec3::ZERO, dvec3(4.0, 0.0, 0.0), dvec3(0.0, 3.0, 0.0)];
        for (p, d) in [
            (dvec3(1.0, 1.0, 2.0), 2.0),
            (dvec3(1.0, 1.0, -2.0), 2.0),
            (dvec3(2.0, -3.0, 0.0), 3.0),
            (dvec3(-3.0, -4.0, 0.0), 5.0),
            (dvec3(7.0, -4.0, 0.0), 5.0),
            (dvec3(-3.0, 7.0, 0.0), 5.0),
            (dvec3(2.0 + 3.0, 1.5 + 4.0, 0.0), 5.0),
        ] {
            for turn in 0..3 {
                let corners = [0, 1, 2].map(|i| t[(i + turn) % 3]);
                assert!((distance(corners, p) - d).abs() < 1e-14, "{p}: {d}");
                let flipped = [corners[0], corners[2], corners[1]];
                assert!((distance(flipped, p) - d).abs() < 1e-14, "{p}: {d}");
                let near = Tri::new(corners).local(p).point;
                assert!((near.distance(p) - d).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_triangle_without_area_is_a_segment_or_a_point() {
        let (a, b) = (dvec3(1.0, 0.0, 0.0), dvec3(5.0, 0.0, 0.0));
        for corners in [[a, b, b], [a, a, b], [a, b, dvec3(3.0, 0.0, 0.0)], [b, a, a]] {
            assert!((distance(corners, dvec3(8.0, 4.0, 0.0)) - 5.0).abs() < 1e-14);
            assert!((distance(corners, dvec3(9.0, 0.0, 0.0)) - 4.0).abs() < 1e-14);
            assert!((distance(corners, dvec3(2.0, 0.0, 1.0)) - 1.0).abs() < 1e-14);
        }
        assert!((distance([a, a, a], dvec3(1.0, 3.0, 4.0)) - 5.0).abs() < 1e-14);
    }

    #[test]
    fn a_segment_in_any_direction_is_no_wider_than_a_line() {
        let at = |k: u32| {
            let x = f64::from(k) * 0.754_877_666;
            dvec3(x.fract(), (x * 1.3247).fract(), (x * 1.7549).fract()) * 50.0 - 25.0
        };
        // most of all in those that run nearly along an axis: there round-off runs along it too
        let flat = [1.0, 1e-2, 1e-4, 1e-8].map(|x: f64| dvec3(1.0, x, x * x));
        for (k, flat) in (0..2000).flat_map(|k| flat.map(|flat| (k, flat))) {
            let (a, b, p) = (at(k), at(k) + (at(k + 7) - at(k)) * flat * 0.3, at(3 * k + 1));
            let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let far = p.distance(a.lerp(b, along));
            for corners in [[a, b, b], [b, a, a], [a, b, a], [a, b, a.lerp(b, 0.37)]] {
                assert!((distance(corners, p) - far).abs() < 1e-9 * far, "{corners:?} {p}");
            }
        }
    }

    #[test]
    fn a_sliver_is_as_near_as_its_longest_side() {
        let t = [DVec3::ZERO, dvec3(100.0, 0.0, 0.0), dvec3(40.0, 1e-13, 1e-13)];
        for (p, d) in [(dvec3(50.0, 3.0, 4.0), 5.0), (dvec3(103.0, 4.0, 0.0), 5.0)] {
            assert!((distance(t, p) - d).abs() < 1e-12);
        }
    }
}
