//! Inside or outside, by winding numbers.

use crate::bvh::{Rim, Winding};
use crate::num::Aabb;
use glam::DVec3;

/// What the tree's winding number is off by at most where it is not refined, with room.
const TREE_ERROR: f64 = 0.05;

/// Where a mesh is solid. Closed shells count first: with w1 their winding number, rounded, and
/// w2 that of the open shells, a point is inside where w1 >= 1 or w1 + w2 >= 1/2, and never
/// outside the box round all faces. So an open sheet cannot hollow a closed solid, and what a
/// sheet seems to enclose ends at the box.
#[derive(Clone, Debug)]
pub(super) struct Inside {
    closed: Winding,
    open: Winding,
    rim: Rim,
    bounds: Aabb,
}

impl Inside {
    /// From the faces of closed and of open shells and the rims of the latter.
    pub(super) fn new(
        closed: &[[DVec3; 3]],
        open: &[[DVec3; 3]],
        rim: &[([DVec3; 2], u32)],
    ) -> Self {
        let (closed, open) = (Winding::new(closed), Winding::new(open));
        let bounds = closed.bounds().hull(open.bounds());
        Self { closed, open, rim: Rim::new(rim), bounds }
    }

    /// The box round all faces; everything outside it is outside.
    pub(super) fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Whether all shells are closed, so that only faces part inside from outside.
    pub(super) fn is_closed(&self) -> bool {
        self.open.is_empty()
    }

    /// Whether `p` is inside.
    pub(super) fn at(&self, p: DVec3) -> bool {
        self.bounds.contains(p) && self.raw(p)
    }

    /// Whether `p` is inside by winding numbers alone.
    pub(super) fn raw(&self, p: DVec3) -> bool {
        let closed = self.closed_number(p);
        if closed >= 1.0 || self.open.is_empty() {
            return closed >= 1.0;
        }
        let level = 0.5 - closed;
        self.open.number(p, level) >= level
    }

    fn closed_number(&self, p: DVec3) -> f64 {
        if self.closed.bounds().contains(p) { self.closed.number(p, 0.5).round() } else { 0.0 }
    }

    /// The winding number of the open shells, roughly.
    pub(super) fn open_number(&self, p: DVec3) -> f64 {
        self.open.rough(p)
    }

    /// Whether in that ball only faces part inside from outside (before the cut at the box): the
    /// winding number's smooth part, which the rims make, stays off one half.
    pub(super) fn sharp(&self, centre: DVec3, radius: f64) -> bool {
        if self.open.is_empty() {
            return true;
        }
        let most = 0.5 - TREE_ERROR;
        let change = self.rim.variation(centre, radius, most / radius) * radius;
        if change >= most {
            return false;
        }
        let part = (self.open_number(centre) - 0.5).rem_euclid(1.0);
        change + TREE_ERROR < part.min(1.0 - part)
    }
}
