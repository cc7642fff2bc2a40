use super::{Bvh, Node};
use crate::num::Aabb;
use glam::DVec3;

/// The point of a triangle set nearest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of the triangle among those the tree was built from.
    pub face: u32,
    /// The nearest point, mm.
    pub point: DVec3,
    /// Its distance, mm.
    pub distance: f64,
    /// Height of the query over the triangle's plane, positive in front (mm).
    pub height: f64,
    /// How far the query's foot lies within the triangle's sides; negative where it lies outside
    /// them and the nearest point is on a side or corner (mm).
    pub inside: f64,
}

/// Squared distance from a point to a box.
#[inline(always)]
fn distance2(b: &Aabb, p: DVec3) -> f64 {
    (b.min - p).max(p - b.max).max(DVec3::ZERO).length_squared()
}

/// Squared distance between two boxes.
fn gap2(a: &Aabb, b: &Aabb) -> f64 {
    (a.min - b.max).max(b.min - a.max).max(DVec3::ZERO).length_squared()
}

impl Bvh {
    /// The nearest point; `None` for an empty set or a point that is not finite.
    pub fn nearest(&self, p: DVec3) -> Option<Nearest> {
        self.nearest_within(p, f64::INFINITY)
    }

    /// The nearest point no farther than `reach` mm.
    pub fn nearest_within(&self, p: DVec3, reach: f64) -> Option<Nearest> {
        let (d2, slot) = self.closest(p, reach * reach, &mut Vec::with_capacity(64));
        (slot != u32::MAX).then(|| self.describe(p, d2, slot))
    }

    /// Distance to the nearest point, infinite for an empty set.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.closest(p, f64::INFINITY, &mut Vec::with_capacity(64)).0.sqrt()
    }

    pub(super) fn describe(&self, p: DVec3, d2: f64, slot: u32) -> Nearest {
        let local = self.tris[slot as usize].local(p);
        Nearest {
            face: self.faces[slot as usize],
            point: local.point,
            distance: d2.sqrt(),
            height: local.height,
            inside: local.inside,
        }
    }

    /// Least squared distance up to `reach2`, and its slot (`u32::MAX` for none). The result is
    /// the minimum over all triangles exactly: pruning leaves room for round-off.
    pub(super) fn closest(&self, p: DVec3, reach2: f64, stack: &mut Vec<(f64, u32)>) -> (f64, u32) {
        let slack = self.slack(p);
        let limit = |d2: f64| (d2.sqrt() + slack).powi(2);
        let (mut best, mut slot) = (reach2, u32::MAX);
        let mut edge = limit(best);
        let mut next = (!self.nodes.is_empty()).then_some(0u32);
        stack.clear();
        while let Some(index) = next {
            let Node { first, count, .. } = self.nodes[index as usize];
            if count > 0 {
                for i in first..first + count {
                    let d2 = self.tris[i as usize].distance2(p.x, p.y, p.z);
                    if d2 < best || (d2 == best && slot == u32::MAX) {
                        (best, slot) = (d2, i);
                        edge = limit(best);
                    }
                }
                next = None;
            } else {
                let a = distance2(&self.nodes[first as usize].bounds, p);
                let b = distance2(&self.nodes[first as usize + 1].bounds, p);
                let (near, far) = if a <= b {
                    ((a, first), (b, first + 1))
                } else {
                    ((b, first + 1), (a, first))
                };
                if far.0 <= edge {
                    stack.push(far);
                }
                next = (near.0 <= edge).then_some(near.1);
            }
            while next.is_none()
                && let Some((d2, index)) = stack.pop()
            {
                next = (d2 <= edge).then_some(index);
            }
        }
        (best, slot)
    }

    /// Slots of the leaves within `reach` of a box; `false` as soon as they are more than `cap`.
    pub(super) fn gather(
        &self,
        b: &Aabb,
        reach: f64,
        cap: usize,
        stack: &mut Vec<(f64, u32)>,
        out: &mut Vec<u32>,
    ) -> bool {
        out.clear();
        stack.clear();
        let reach2 = reach * reach;
        if !self.nodes.is_empty() {
            stack.push((0.0, 0));
        }
        while let Some((_, index)) = stack.pop() {
            let node = &self.nodes[index as usize];
            if gap2(&node.bounds, b) > reach2 {
                continue;
            }
            if node.count > 0 {
                out.extend(node.first..node.first + node.count);
                if out.len() > cap {
                    return false;
                }
            } else {
                stack.extend([(0.0, node.first + 1), (0.0, node.first)]);
            }
        }
        true
    }

    /// Indices of the triangles whose boxes come within `reach` mm of a box.
    pub fn overlapping(&self, b: &Aabb, reach: f64) -> Vec<u32> {
        let mut found = vec![];
        self.gather(b, reach, usize::MAX, &mut vec![], &mut found);
        let near = |&s: &u32| gap2(&Aabb::of(self.corners[s as usize]), b) <= reach * reach;
        found.retain(near);
        for slot in &mut found {
            *slot = self.faces[*slot as usize];
        }
        found
    }
}
