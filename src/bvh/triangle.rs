//! Distance from a point to a triangle, in the triangle's own plane frame.
//!
//! The frame's x runs along the longest side AB, so that the arithmetic stays sound on slivers:
//! a misjudged side changes the result by round-off only. Every distance in this crate goes
//! through [`Tri::distance2`], one point or eight at a time, so all queries agree exactly.

use glam::DVec3;

/// Points measured at once by the batch kernel.
pub(super) const LANES: usize = 8;

/// A triangle A(0, 0), B(ab, 0), C(cx, cy) with cy >= 0 in the frame (u, v, n) at A.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tri {
    a: DVec3,
    u: DVec3,
    v: DVec3,
    n: DVec3,
    ab: f64,
    /// Unit direction and length of the side from B to C.
    bc: [f64; 3],
    /// Unit direction and length of the side from A to C.
    ac: [f64; 3],
}

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
        let v = across - u * across.dot(u);
        let v = v.try_normalize().unwrap_or_else(|| u.any_orthonormal_vector());
        let ab = (b - a).dot(u);
        let (cx, cy) = ((c - a).dot(u), (c - a).dot(v));
        Self { a, u, v, n: u.cross(v), ab, bc: direction(cx - ab, cy), ac: direction(cx, cy) }
    }

    /// Squared distance.
    #[inline(always)]
    pub(super) fn distance2(&self, px: f64, py: f64, pz: f64) -> f64 {
        let (rx, ry, rz) = (px - self.a.x, py - self.a.y, pz - self.a.z);
        let x = rx * self.u.x + ry * self.u.y + rz * self.u.z;
        let y = rx * self.v.x + ry * self.v.y + rz * self.v.z;
        let z = rx * self.n.x + ry * self.n.y + rz * self.n.z;
        let [bx, by, bl] = self.bc;
        let [cx, cy, cl] = self.ac;
        let q = x - self.ab;
        let (along_b, perp_b) = (q * bx + y * by, y * bx - q * by);
        let (along_c, perp_c) = (x * cx + y * cy, x * cy - y * cx);
        let over_a = x - clip(x, self.ab);
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
        let r = p - self.a;
        let (x, y, z) = (r.dot(self.u), r.dot(self.v), r.dot(self.n));
        let [bx, by, bl] = self.bc;
        let [cx, cy, cl] = self.ac;
        let q = x - self.ab;
        let inside = y.min(y * bx - q * by).min(x * cy - y * cx);
        let foot = if inside > 0.0 {
            [x, y]
        } else {
            let (b, c) = (clip(q * bx + y * by, bl), clip(x * cx + y * cy, cl));
            let sides = [[clip(x, self.ab), 0.0], [self.ab + b * bx, b * by], [c * cx, c * cy]];
            let far = |s: [f64; 2]| (s[0] - x).powi(2) + (s[1] - y).powi(2);
            sides.into_iter().fold(sides[0], |m, s| if far(s) < far(m) { s } else { m })
        };
        Local { height: z, inside, point: self.a + self.u * foot[0] + self.v * foot[1] }
    }
}

/// Eight points, coordinate by coordinate.
#[derive(Clone, Copy)]
pub(super) struct Octet {
    pub x: [f64; LANES],
    pub y: [f64; LANES],
    pub z: [f64; LANES],
}

impl Octet {
    /// The first points of `at`; what is missing repeats the last one.
    pub(super) fn of(at: &[DVec3]) -> Self {
        let pick = |i: usize| at.get(i).or(at.last()).copied().unwrap_or(DVec3::ZERO);
        let p: [DVec3; LANES] = std::array::from_fn(pick);
        Self { x: p.map(|p| p.x), y: p.map(|p| p.y), z: p.map(|p| p.z) }
    }

    /// Squared distances to a triangle.
    #[inline]
    pub(super) fn distances2(&self, tri: &Tri) -> [f64; LANES] {
        let mut d = [0.0; LANES];
        for (i, d) in d.iter_mut().enumerate() {
            *d = tri.distance2(self.x[i], self.y[i], self.z[i]);
        }
        d
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
    fn a_sliver_is_as_near_as_its_longest_side() {
        let t = [DVec3::ZERO, dvec3(100.0, 0.0, 0.0), dvec3(40.0, 1e-13, 1e-13)];
        for (p, d) in [(dvec3(50.0, 3.0, 4.0), 5.0), (dvec3(103.0, 4.0, 0.0), 5.0)] {
            assert!((distance(t, p) - d).abs() < 1e-12);
        }
    }
}
