//! Rays: where a line from inside first leaves the solid.

use super::{Bvh, Node};
use crate::num::Aabb;
use glam::DVec3;

/// Where a ray leaves through a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Index of the triangle among those the tree was built from.
    pub face: u32,
    /// Distance from the start, mm.
    pub distance: f64,
    /// The triangle's unit normal.
    pub normal: DVec3,
}

impl Bvh {
    /// The nearest triangle between `least` and `most` mm away that the ray from `from` along the
    /// unit vector `along` meets from behind. A ray that runs exactly through a side may find
    /// either triangle.
    pub fn first_exit(&self, from: DVec3, along: DVec3, [least, most]: [f64; 2]) -> Option<Exit> {
        let (inverse, mut best) = (along.recip(), most);
        let mut found = None;
        let mut open = Vec::with_capacity(64);
        open.extend((!self.nodes.is_empty()).then_some(0u32));
        while let Some(index) = open.pop() {
            let Node { bounds, first, count } = &self.nodes[index as usize];
            if !meets(bounds, from, inverse, best) {
                continue;
            }
            if *count == 0 {
                // the child on the near side is looked at first
                let [a, b] = [*first, first + 1];
                let gap = |i: u32| (self.nodes[i as usize].bounds.centre() - from).dot(along);
                open.extend(if gap(a) <= gap(b) { [b, a] } else { [a, b] });
                continue;
            }
            for slot in *first..first + count {
                let corners = &self.corners[slot as usize];
                if let Some((distance, normal)) = leaves(corners, from, along)
                    && distance > least
                    && distance < best
                {
                    best = distance;
                    found = Some(Exit { face: self.faces[slot as usize], distance, normal });
                }
            }
        }
        found
    }
}

/// Whether a ray enters a box before `best`.
fn meets(b: &Aabb, from: DVec3, inverse: DVec3, best: f64) -> bool {
    let (mut enter, mut leave) = (0.0f64, best);
    for axis in 0..3 {
        if inverse[axis].is_infinite() {
            // beside the slab that it runs along, or in it all the way
            if from[axis] < b.min[axis] || from[axis] > b.max[axis] {
                return false;
            }
            continue;
        }
        let a = (b.min[axis] - from[axis]) * inverse[axis];
        let b = (b.max[axis] - from[axis]) * inverse[axis];
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    // as much as the products may be rounded
    enter * (1.0 - 1e-12) <= leave
}

/// Distance to a triangle met from behind, sides included, and its normal (Möller and Trumbore
/// 1997).
fn leaves(&[a, b, c]: &[DVec3; 3], from: DVec3, along: DVec3) -> Option<(f64, DVec3)> {
    let (ab, ac) = (b - a, c - a);
    let area = ab.cross(ac);
    let facing = along.dot(area);
    if facing <= 0.0 {
        return None;
    }
    let rest = (a - from).cross(along);
    let (u, v) = (rest.dot(ac), -rest.dot(ab));
    let slack = 1e-12 * area.length();
    if u < -slack || v < -slack || u + v > facing + slack {
        return None;
    }
    Some(((a - from).dot(area) / facing, area.normalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares of side 2 at z = 0 and z = 3, seen from above and below.
    fn plate() -> Bvh {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let square = |z: f64| {
            let [a, b, c, d] = [at(0., 0., z), at(2., 0., z), at(2., 2., z), at(0., 2., z)];
            [[a, b, c], [a, c, d]]
        };
        let mut all: Vec<[DVec3; 3]> = square(3.0).to_vec();
        all.extend(square(0.0).map(|[a, b, c]| [a, c, b]));
        Bvh::new(&all)
    }

    #[test]
    fn the_first_way_out() {
        let b = plate();
        for (from, along, want) in [
            (DVec3::new(0.5, 0.7, 0.0), DVec3::Z, Some(3.0)),
            (DVec3::new(0.5, 0.7, 3.0), DVec3::NEG_Z, Some(3.0)),
            // on the diagonal, and on the rim
            (DVec3::new(1.0, 1.0, 1.0), DVec3::Z, Some(2.0)),
            (DVec3::new(0.0, 1.0, 1.0), DVec3::Z, Some(2.0)),
            (DVec3::new(2.5, 1.0, 1.0), DVec3::Z, None),
            // from outside one comes in first, and goes out on the other side
            (DVec3::new(1.0, 0.5, -1.0), DVec3::Z, Some(4.0)),
            (DVec3::new(1.0, 0.5, 3.0), DVec3::Z, None),
            (DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.0, 0.6, 0.8), None),
            (DVec3::new(0.1, 0.2, 2.2), DVec3::new(0.0, 0.6, 0.8), Some(1.0)),
        ] {
            let found = b.first_exit(from, along, [1e-9, f64::INFINITY]).map(|e| e.distance);
            match (found, want) {
                (Some(d), Some(w)) => assert!((d - w).abs() < 1e-12, "{from} {along}: {d}"),
                (found, want) => assert_eq!(found, want, "{from} {along}"),
            }
        }
        assert!(Bvh::new(&[]).first_exit(DVec3::ZERO, DVec3::Z, [0.0, 1.0]).is_none());
    }
}
