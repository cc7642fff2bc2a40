//! Vectors of three numbers, eight at a time. The arithmetic is `glam`'s, operation by operation.

use super::triangle::Points;
use fearless_simd::{Simd, f64x8, prelude::*};
use glam::DVec3;

/// Eight vectors.
#[derive(Clone, Copy)]
pub(super) struct Vec8<S: Simd> {
    pub(super) x: f64x8<S>,
    pub(super) y: f64x8<S>,
    pub(super) z: f64x8<S>,
}

impl<S: Simd> Vec8<S> {
    /// The points, the last one repeated.
    #[inline(always)]
    pub(super) fn of(s: S, at: &[DVec3]) -> Self {
        let Points { x, y, z } = Points::of(s, at);
        Self { x, y, z }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub(super) fn splat(s: S, p: DVec3) -> Self {
        let lane = |v| f64x8::splat(s, v);
        Self { x: lane(p.x), y: lane(p.y), z: lane(p.z) }
    }

    /// These less others.
    #[inline(always)]
    pub(super) fn less(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }

    /// A point less each of these.
    #[inline(always)]
    pub(super) fn to(self, p: DVec3) -> Self {
        let s = self.x.token();
        let lane = |v| f64x8::splat(s, v);
        Self { x: lane(p.x) - self.x, y: lane(p.y) - self.y, z: lane(p.z) - self.z }
    }

    #[inline(always)]
    pub(super) fn dot(self, o: Self) -> f64x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// With the same vector in all lanes.
    #[inline(always)]
    pub(super) fn along(self, o: DVec3) -> f64x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub(super) fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - o.y * self.z,
            y: self.z * o.x - o.z * self.x,
            z: self.x * o.y - o.x * self.y,
        }
    }
}
