//! Polygons to triangles, in their best-fit plane, by cutting off ears.
//!
//! A simple polygon whose triangles all turn the same way is tiled by them exactly: no overlap and
//! no gap. So only the turn of each piece has to be watched, with exact predicates.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Convex: a fan.
    Convex,
    /// With corners that point inwards, or flat ones.
    Concave,
    /// It crosses itself, is flat to a line, or is too large: triangles that may overlap.
    Tangled,
}

/// Concave polygons with more corners become fans, which is wrong but quick: cutting ears looks at
/// every corner for every ear. 4096 corners take 0.04 s as a comb and 0.4 s as a spiral; 100 000 in
/// a spiral would take minutes. Real furniture has under a hundred.
pub(crate) const MOST_CORNERS: usize = 4096;

/// Appends the triangles of `ring` (point indices in order) to `out`, turning as the ring turns.
/// Corners that stand where the one before does are left out; under three corners give nothing.
pub(crate) fn triangulate(ring: &[u32], points: &[DVec3], out: &mut Vec<[u32; 3]>) -> Cut {
    let at = |v: u32| points[v as usize];
    let mut ring = ring.to_vec();
    ring.dedup_by(|b, a| at(*a) == at(*b));
    while ring.len() > 1 && at(ring[0]) == at(ring[ring.len() - 1]) {
        ring.pop();
    }
    if ring.len() < 3 {
        return Cut::Tangled;
    }
    let flat = flatten(&ring.iter().map(|&v| at(v)).collect::<Vec<_>>());
    let mut emit = |a: usize, b: usize, c: usize| out.push([ring[a], ring[b], ring[c]]);
    let fan = is_fan(&flat);
    if fan || flat.len() > MOST_CORNERS {
        (1..flat.len() - 1).for_each(|i| emit(0, i, i + 1));
        return if fan { Cut::Convex } else { Cut::Tangled };
    }
    cut_ears(&flat, emit)
}

/// The ring in its best-fit plane (normal by Newell's sum), so that it turns counter-clockwise.
fn flatten(ring: &[DVec3]) -> Vec<DVec2> {
    let o = ring[0];
    let sum = (1..ring.len() - 1)
        .map(|i| (ring[i] - o).cross(ring[i + 1] - o))
        .fold(DVec3::ZERO, |a, b| a + b);
    let n = sum.try_normalize().unwrap_or(DVec3::Z);
    let u = n.any_orthonormal_vector();
    let v = n.cross(u);
    ring.iter().map(|&p| DVec2::new((p - o).dot(u), (p - o).dot(v))).collect()
}

/// Twice the signed area of a, b, c; its sign is exact.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether every corner turns left and so does the fan from the first; the latter tells a pentagram
/// from a pentagon.
fn is_fan(p: &[DVec2]) -> bool {
    let n = p.len();
    (0..n).all(|i| turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) > 0.0)
        && (1..n - 1).all(|i| turn(p[0], p[i], p[i + 1]) > 0.0)
}

/// How picky the choice of the next ear is; it only ever falls.
#[derive(Clone, Copy, PartialEq)]
enum Care {
    /// Nothing inside the ear or on its rim.
    Clear,
    /// Nothing strictly inside it: holes joined by a bridge may touch.
    Touching,
    /// Any corner that turns left.
    Left,
    /// Any corner.
    Any,
}

struct Ring<'a> {
    p: &'a [DVec2],
    next: Vec<usize>,
    prev: Vec<usize>,
}

fn cut_ears(p: &[DVec2], mut emit: impl FnMut(usize, usize, usize)) -> Cut {
    let n = p.len();
    let mut ring = Ring {
        p,
        next: (1..n).chain([0]).collect(),
        prev: [n - 1].into_iter().chain(0..n - 1).collect(),
    };
    let (mut care, mut i, mut left, mut passed) = (Care::Clear, 0, n, 0);
    while left > 3 {
        if ring.is_ear(i, care) {
            let (a, c) = (ring.prev[i], ring.next[i]);
            emit(a, i, c);
            (ring.next[a], ring.prev[c]) = (c, a);
            // Skipping a corner gives plumper triangles than cutting all ears from one.
            (i, left, passed) = (ring.next[c], left - 1, 0);
        } else {
            (i, passed) = (ring.next[i], passed + 1);
            if passed == left {
                (care, passed) = (care.lower(), 0);
            }
        }
    }
    let (a, c) = (ring.prev[i], ring.next[i]);
    emit(a, i, c);
    let last = turn(p[a], p[i], p[c]);
    if matches!(care, Care::Clear | Care::Touching) && last >= 0.0 {
        Cut::Concave
    } else {
        Cut::Tangled
    }
}

impl Care {
    fn lower(self) -> Self {
        match self {
            Care::Clear => Care::Touching,
            Care::Touching => Care::Left,
            Care::Left | Care::Any => Care::Any,
        }
    }
}

impl Ring<'_> {
    fn is_ear(&self, i: usize, care: Care) -> bool {
        let (a, b, c) = (self.p[self.prev[i]], self.p[i], self.p[self.next[i]]);
        if care == Care::Any {
            return true;
        }
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        if care == Care::Left {
            return true;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let mut q = self.next[self.next[i]];
        while q != self.prev[i] {
            let here = self.p[q];
            let near = low.cmple(here).all() && here.cmple(high).all();
            if near && self.blocks(q, [a, b, c], care) {
                return false;
            }
            q = self.next[q];
        }
        true
    }

    /// Whether corner `q` keeps the ear a, b, c from being cut.
    fn blocks(&self, q: usize, [a, b, c]: [DVec2; 3], care: Care) -> bool {
        let here = self.p[q];
        if here == a || here == c {
            return false; // what starts here and runs inside shows by its other end
        }
        if here == b {
            // A bridge to a hole ends at the tip: only a side that runs into the ear blocks it.
            let enters = |s: DVec2| turn(a, b, s) > 0.0 && turn(b, c, s) > 0.0;
            return enters(self.p[self.next[q]]) || enters(self.p[self.prev[q]]);
        }
        let t = turn(a, b, here).min(turn(b, c, here)).min(turn(c, a, here));
        if care == Care::Clear { t >= 0.0 } else { t > 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn cut(ring: &[DVec3]) -> (Cut, Vec<[u32; 3]>) {
        let mut out = vec![];
        let kind = triangulate(&(0..ring.len() as u32).collect::<Vec<_>>(), ring, &mut out);
        (kind, out)
    }

    fn areas(ring: &[DVec3], faces: &[[u32; 3]]) -> Vec<DVec3> {
        let at = |v: u32| ring[v as usize];
        faces.iter().map(|f| (at(f[1]) - at(f[0])).cross(at(f[2]) - at(f[0])) * 0.5).collect()
    }

    /// As given, clockwise, started at each corner, and on tilted planes: n - 2 triangles that turn
    /// as the ring does and whose areas sum to `area`.
    fn tiles(shape: &[[f64; 2]], area: f64) {
        for tilt in [DQuat::IDENTITY, DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 2.0, 1.1)] {
            for start in 0..shape.len() {
                let mut ring: Vec<DVec3> =
                    shape.iter().map(|p| tilt * DVec3::new(p[0] + 7.0, p[1] - 3.0, 5.0)).collect();
                ring.rotate_left(start);
                for sign in [1.0, -1.0] {
                    let (_, faces) = cut(&ring);
                    assert_eq!(faces.len(), ring.len() - 2);
                    let normal = tilt * DVec3::Z * sign;
                    let parts = areas(&ring, &faces);
                    let total: f64 = parts.iter().map(|a| a.length()).sum();
                    assert!((total - area).abs() < 1e-12 * area.max(1.0), "{total} for {area}");
                    assert!(parts.iter().all(|a| a.dot(normal) >= -1e-12), "a piece is turned");
                    ring.reverse();
                }
            }
        }
    }

    const L: [[f64; 2]; 6] = [[0., 0.], [4., 0.], [4., 1.], [1., 1.], [1., 3.], [0., 3.]];

    #[test]
    fn an_l_keeps_its_area() {
        tiles(&L, 6.0);
        let ring = L.map(|p| DVec3::new(p[0], p[1], 0.0));
        assert_eq!(cut(&ring).0, Cut::Concave);
    }

    #[test]
    fn a_star_keeps_its_area() {
        // Ten corners on radii 2 and 1, 36 degrees apart: ten triangles of sin(36°) · 2 · 1 / 2.
        let star: Vec<[f64; 2]> = (0..10)
            .map(|i| {
                let (r, a) = (2.0 - f64::from(i % 2), f64::from(i) * 36f64.to_radians());
                [r * a.cos(), r * a.sin()]
            })
            .collect();
        tiles(&star, 10.0 * 36f64.to_radians().sin());
    }

    #[test]
    fn a_comb_and_a_hole_on_a_bridge_keep_their_area() {
        let mut comb = vec![[0., 0.], [9., 0.]];
        for i in (0..9).rev() {
            comb.push([f64::from(i) + 1.0, if i % 2 == 0 { 5.0 } else { 1.0 }]);
            comb.push([f64::from(i), if i % 2 == 0 { 5.0 } else { 1.0 }]);
        }
        comb.dedup();
        tiles(&comb, 5.0 * 5.0 + 4.0);
        // A square of 4 with a square hole of 2, cut open along a bridge from (0,0) to (1,1).
        let keyhole = [
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ];
        // Started at either end of the bridge the ring would close on itself: dedup keeps it.
        tiles(&keyhole, 12.0);
    }

    #[test]
    fn flat_corners_make_no_empty_triangle() {
        // A square with a corner in the middle of each side.
        let ring = [[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]];
        tiles(&ring, 4.0);
        let ring = ring.map(|p| DVec3::new(p[0], p[1], 0.0));
        let (_, faces) = cut(&ring);
        assert!(areas(&ring, &faces).iter().all(|a| a.z > 0.1));
    }

    #[test]
    fn convex_is_a_fan_and_a_pentagram_is_tangled() {
        let at = |deg: f64| DVec3::new(deg.to_radians().cos(), deg.to_radians().sin(), 0.0);
        let pentagon = [0., 72., 144., 216., 288.].map(at);
        assert_eq!(cut(&pentagon), (Cut::Convex, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]));
        let pentagram = [0., 144., 288., 72., 216.].map(at);
        let (kind, faces) = cut(&pentagram);
        assert_eq!((kind, faces.len()), (Cut::Tangled, 3));
    }

    #[test]
    fn what_is_no_polygon_gives_nothing_or_something_finite() {
        let p = DVec3::new(1.0, 2.0, 3.0);
        assert!(cut(&[]).1.is_empty());
        assert!(cut(&[p, p, p, p]).1.is_empty());
        assert_eq!(cut(&[p, p, DVec3::X, DVec3::Y, DVec3::Y, p]).1.len(), 1);
        // All on one line: triangles without area, but every corner is kept.
        let line: Vec<DVec3> = (0..5).map(|i| DVec3::X * f64::from(i)).collect();
        assert_eq!(cut(&line).1.len(), 3);
        let huge: Vec<DVec3> = (0..MOST_CORNERS as u32 + 2)
            .map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0))
            .collect();
        assert_eq!(cut(&huge).1.len(), huge.len() - 2);
    }
}
