use super::Bvh;
use super::wide::Open;
use crate::num::Aabb;
use fearless_simd::{Level, dispatch};
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
        let (d2, slot) = self.closest(p, reach * reach);
        (slot != u32::MAX).then(|| self.describe(p, d2, slot))
    }

    /// Distance to the nearest point, infinite for an empty set.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.closest(p, f64::INFINITY).0.sqrt()
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
    /// the minimum over all triangles exactly.
    fn closest(&self, p: DVec3, reach2: f64) -> (f64, u32) {
        let (known, slack) = ((reach2, u32::MAX), self.slack(p));
        let open = &mut Open::with_capacity(64);
        dispatch!(Level::new(), s => self.wide.closest(s, p, known, slack, open))
    }

    /// Indices of the triangles whose boxes come within `reach` mm of a box.
    pub fn overlapping(&self, b: &Aabb, reach: f64) -> Vec<u32> {
        let mut found = self.gather(b, reach, &mut Open::with_capacity(64));
        let near = |&s: &u32| gap2(&Aabb::of(self.corners[s as usize]), b) <= reach * reach;
        found.retain(near);
        for slot in &mut found {
            *slot = self.faces[*slot as usize];
        }
        found
    }

    /// Slots of the packs within `reach` of a box.
    pub(super) fn gather(&self, b: &Aabb, reach: f64, open: &mut Open) -> Vec<u32> {
        let mut found = vec![];
        dispatch!(Level::new(), s => {
            self.wide.gather(s, b, reach, open, &mut found)
        });
        found
    }
}
