//! Whether two triangles meet where they should not: exact, by the orientation predicates of
//! Shewchuk 1997. A triangle is closed, so touching counts as meeting.

use glam::{DVec2, DVec3, Vec3Swizzles as _};
use robust::{Coord, Coord3D};

/// A face with an area, ready to be tested against others.
#[derive(Clone, Copy)]
pub(super) struct Triangle {
    /// Positions.
    pub at: [DVec3; 3],
    /// Names: two corners of one name are one vertex.
    pub names: [u32; 3],
    /// The axis along which it can be flattened and keep an area.
    axis: u8,
}

impl Triangle {
    /// `None` when its corners lie on one line: it has no plane, and is reported elsewhere.
    pub fn new(at: [DVec3; 3], names: [u32; 3]) -> Option<Self> {
        let normal = (at[1] - at[0]).cross(at[2] - at[0]).abs().to_array();
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| normal[j as usize].total_cmp(&normal[i as usize]));
        let keeps_area = |&axis: &u8| turn(at.map(|p| flat(p, axis))) != 0;
        axes.into_iter().find(keeps_area).map(|axis| Self { at, names, axis })
    }

    /// Turned so that corner `k` comes first.
    fn turned_to(&self, k: usize) -> [DVec3; 3] {
        [0, 1, 2].map(|i| self.at[(k + i) % 3])
    }

    /// Whether all three points lie strictly on one side of its plane.
    fn has_beside(&self, points: &[DVec3; 3]) -> bool {
        let [p, q, r] = points.map(|p| side(self.at, p));
        p != 0 && p == q && q == r
    }

    /// Whether it holds any point of the segment pq.
    fn meets_segment(&self, p: DVec3, q: DVec3) -> bool {
        let (at_p, at_q) = (side(self.at, p), side(self.at, q));
        if at_p * at_q > 0 {
            return false;
        }
        if at_p == 0 && at_q == 0 {
            let corners = self.at.map(|c| flat(c, self.axis));
            return meets_segment_flat(corners, flat(p, self.axis), flat(q, self.axis));
        }
        let [a, b, c] = self.at;
        let round = [side([p, q, a], b), side([p, q, b], c), side([p, q, c], a)];
        round.iter().all(|&s| s >= 0) || round.iter().all(|&s| s <= 0)
    }
}

/// Whether two triangles have a point in common beyond the vertices and the edge they share.
pub(super) fn meet(a: &Triangle, b: &Triangle) -> bool {
    let mut shared = [(0, 0); 3];
    let mut count = 0;
    for (i, name) in a.names.iter().enumerate() {
        if let Some(j) = b.names.iter().position(|n| n == name) {
            shared[count] = (i, j);
            count += 1;
        }
    }
    match count {
        0 => strangers_meet(a, b),
        // All they share besides the vertex would end at the edge opposite it in a or in b.
        1 => {
            let [v, a1, a2] = a.turned_to(shared[0].0);
            let [_, b1, b2] = b.turned_to(shared[0].1);
            let normal = (a1 + a2) - (b1 + b2);
            !parted(&[a1, a2], &[b1, b2], v, normal)
                && (b.meets_segment(a1, a2) || a.meets_segment(b1, b2))
        }
        2 => folded(a, b, shared[0], shared[1]),
        _ => true,
    }
}

/// How much of a sum of products must be left to trust its sign: far above what rounding can do
/// to three products of differences, far below any angle that matters for speed.
const CERTAIN: f64 = 1e-12;

/// Squared share that must be left of a vector for its direction to be as good as [`CERTAIN`] takes it.
const SURE: f64 = 1e-6;

/// Whether a plane through `origin` certainly parts some points from others. Settles most pairs
/// without a predicate; what it leaves open is judged exactly.
fn parted(above: &[DVec3], below: &[DVec3], origin: DVec3, normal: DVec3) -> bool {
    let beyond = |p: DVec3, normal: DVec3| {
        let offset = p - origin;
        offset.dot(normal) > CERTAIN * offset.abs().dot(normal.abs())
    };
    above.iter().all(|&p| beyond(p, normal)) && below.iter().all(|&p| beyond(p, -normal))
}

fn strangers_meet(a: &Triangle, b: &Triangle) -> bool {
    let (from, to): (DVec3, DVec3) = (b.at.iter().sum(), a.at.iter().sum());
    if parted(&a.at, &b.at, (from + to) / 6.0, to - from) {
        return false;
    }
    if a.has_beside(&b.at) || b.has_beside(&a.at) {
        return false;
    }
    (0..3).any(|k| {
        let ([a0, a1, _], [b0, b1, _]) = (a.turned_to(k), b.turned_to(k));
        b.meets_segment(a0, a1) || a.meets_segment(b0, b1)
    })
}

/// Whether two triangles of one edge lie in one plane and on the same side of the edge.
fn folded(a: &Triangle, b: &Triangle, one: (usize, usize), two: (usize, usize)) -> bool {
    let (u, v) = (a.at[one.0], a.at[two.0]);
    let (p, q) = (a.at[3 - one.0 - two.0], b.at[3 - one.1 - two.1]);
    let (edge, across) = (v - u, p - q);
    let normal = across - edge * (across.dot(edge) / edge.length_squared());
    // a normal left over from what cancelled holds the edge in no plane
    let sure = normal.length_squared() > SURE * across.length_squared();
    if sure && parted(&[p], &[q], u, normal) {
        return false;
    }
    side(a.at, q) == 0 && {
        let [u, v, p, q] = [u, v, p, q].map(|x| flat(x, a.axis));
        turn([u, v, p]) == turn([u, v, q])
    }
}

fn meets_segment_flat(triangle: [DVec2; 3], p: DVec2, q: DVec2) -> bool {
    let [a, b, c] = triangle;
    let facing = turn(triangle);
    let holds = |x| [[a, b, x], [b, c, x], [c, a, x]].iter().all(|&t| turn(t) * facing >= 0);
    holds(p) || holds(q) || [(a, b), (b, c), (c, a)].iter().any(|&(s, e)| cross(s, e, p, q))
}

/// Whether segments ab and pq have a point in common, ends included.
fn cross(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let (p_side, q_side) = (turn([a, b, p]), turn([a, b, q]));
    let (a_side, b_side) = (turn([p, q, a]), turn([p, q, b]));
    if [p_side, q_side, a_side, b_side] == [0; 4] {
        let (low, high) = (a.min(b).max(p.min(q)), a.max(b).min(p.max(q)));
        return low.cmple(high).all();
    }
    p_side * q_side <= 0 && a_side * b_side <= 0
}

/// Seen along an axis, keeping the handedness.
fn flat(p: DVec3, axis: u8) -> DVec2 {
    match axis {
        0 => p.yz(),
        1 => p.zx(),
        _ => p.xy(),
    }
}

/// Sign of the side of a triangle's plane that a point lies on.
fn side(plane: [DVec3; 3], p: DVec3) -> i8 {
    let [a, b, c, d] =
        [plane[0], plane[1], plane[2], p].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    sign(robust::orient3d(a, b, c, d))
}

/// Sign of the turn at the middle of three points: +1 is counter-clockwise.
fn turn(points: [DVec2; 3]) -> i8 {
    let [a, b, c] = points.map(|p| Coord { x: p.x, y: p.y });
    sign(robust::orient2d(a, b, c))
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tri(at: [[i32; 3]; 3], names: [u32; 3]) -> Triangle {
        let at = at.map(|p| DVec3::from(p.map(f64::from)));
        Triangle::new(at, names).expect("the triangle has an area")
    }

    const FLOOR: [[i32; 3]; 3] = [[0, 0, 0], [10, 0, 0], [0, 10, 0]];
    const APART: [u32; 3] = [3, 4, 5];

    fn floor() -> Triangle {
        tri(FLOOR, [0, 1, 2])
    }

    #[test]
    fn strangers() {
        let cases = [
            ([[2, 2, -1], [2, 2, 5], [3, 4, 5]], true, "cuts through"),
            ([[2, 2, 0], [2, 2, 5], [3, 4, 5]], true, "stands on it"),
            ([[0, 0, 0], [-2, 2, 5], [3, 4, 5]], true, "stands on its corner"),
            ([[5, 5, 0], [9, 9, 5], [9, 9, 0]], true, "touches its edge"),
            ([[2, 2, 1], [2, 2, 5], [3, 4, 5]], false, "hovers"),
            ([[9, 9, -1], [9, 9, 5], [9, 12, 5]], false, "passes beside"),
            ([[1, 1, 0], [3, 1, 0], [1, 3, 0]], true, "lies inside, same plane"),
            ([[-9, -9, 0], [90, -9, 0], [-9, 90, 0]], true, "lies round it, same plane"),
            ([[-1, 4, 0], [12, 4, 0], [12, 5, 0]], true, "crosses it, same plane"),
            ([[10, 0, 0], [20, 0, 0], [10, 9, 0]], true, "touches a corner, same plane"),
            ([[6, 5, 0], [20, 0, 0], [10, 9, 0]], false, "beside it, same plane"),
        ];
        for (at, want, why) in cases {
            let t = tri(at, APART);
            assert_eq!(meet(&floor(), &t), want, "{why}");
            assert_eq!(meet(&t, &floor()), want, "{why}, the other way round");
        }
    }

    #[test]
    fn neighbours() {
        let cases = [
            ([[0, 0, 0], [0, -5, 2], [-5, 0, 2]], [0, 4, 5], false, "one vertex, apart"),
            ([[0, 0, 0], [4, 4, 2], [4, 4, -2]], [0, 4, 5], true, "one vertex, edge through"),
            ([[0, 0, 0], [40, 39, 1], [39, 40, -1]], [0, 4, 5], true, "one vertex, edge outside"),
            ([[0, 0, 0], [-5, 0, 0], [0, -5, 0]], [0, 4, 5], false, "one vertex, same plane"),
            ([[0, 0, 0], [5, 1, 0], [1, 5, 0]], [0, 4, 5], true, "one vertex, overlapping"),
            ([[0, 0, 0], [5, 0, 0], [5, -5, 0]], [0, 4, 5], true, "along part of an edge"),
            ([[0, 0, 0], [10, 0, 0], [0, 0, 3]], [0, 1, 5], false, "one edge, upright"),
            ([[10, 0, 0], [0, 0, 0], [5, -5, 0]], [1, 0, 5], false, "one edge, flat"),
            ([[10, 0, 0], [0, 0, 0], [5, 5, 0]], [1, 0, 5], true, "one edge, folded over"),
            (FLOOR, [0, 1, 2], true, "the same triangle twice"),
        ];
        for (at, names, want, why) in cases {
            let t = tri(at, names);
            assert_eq!(meet(&floor(), &t), want, "{why}");
            assert_eq!(meet(&t, &floor()), want, "{why}, the other way round");
        }
    }

    #[test]
    fn a_line_is_no_triangle() {
        let p = DVec3::new(0.1, 0.2, 0.3);
        assert!(Triangle::new([p, p * 2.0, p * 4.0], [0, 1, 2]).is_none());
        assert!(Triangle::new([p, p, p * 4.0], [0, 1, 2]).is_none());
    }

    /// A point of both triangles, looked for among all barycentric steps of a twelfth: a
    /// witness against a wrong "no".
    fn witness(a: &Triangle, b: &Triangle) -> bool {
        let inside = |t: &Triangle, p: DVec3| {
            let corners = t.at.map(|c| flat(c, t.axis));
            let p2 = flat(p, t.axis);
            side(t.at, p) == 0 && meets_segment_flat(corners, p2, p2)
        };
        (0..=12).any(|i| {
            (0..=12 - i).any(|j| {
                let w = [i, j, 12 - i - j].map(f64::from);
                inside(b, (w[0] * a.at[0] + w[1] * a.at[1] + w[2] * a.at[2]) / 12.0)
            })
        })
    }

    proptest! {
        #[test]
        fn order_does_not_matter(c in prop::array::uniform6(prop::array::uniform3(-3_i32..4))) {
            // Multiples of 12, so that the witness points are whole and its arithmetic exact.
            let at = c.map(|p| DVec3::from(p.map(|x| f64::from(x * 12))));
            let a = Triangle::new([at[0], at[1], at[2]], [0, 1, 2]);
            let b = Triangle::new([at[3], at[4], at[5]], APART);
            if let (Some(a), Some(b)) = (a, b) {
                let found = meet(&a, &b);
                prop_assert_eq!(found, meet(&b, &a));
                let turned = Triangle::new([b.at[2], b.at[1], b.at[0]], APART).unwrap();
                prop_assert_eq!(found, meet(&a, &turned));
                prop_assert!(found || !witness(&a, &b));
            }
        }
    }

    /// Two triangles of one edge whose third corners are equally far from it: what parts them is what
    /// rounding left.
    #[test]
    fn meeting_is_mutual() {
        let tenths = |at: [[i32; 3]; 3], names| {
            let at = at.map(|p| DVec3::from(p.map(f64::from)) * 0.1);
            Triangle::new(at, names).expect("the triangle has an area")
        };
        for (a, b) in [
            ([[3, 4, 1], [3, 2, 1], [5, 2, 2]], [[3, 2, 1], [5, 5, 2], [3, 4, 1]]),
            ([[4, 0, 2], [4, 3, 4], [4, 0, 1]], [[4, 3, 4], [4, 3, 3], [4, 0, 2]]),
            ([[2, 1, 0], [0, 2, 0], [3, 4, 4]], [[0, 2, 0], [5, 3, 4], [2, 1, 0]]),
        ] {
            let (a, b) = (tenths(a, [0, 1, 2]), tenths(b, [1, 5, 0]));
            assert!(meet(&a, &b) && meet(&b, &a));
        }
    }
}
