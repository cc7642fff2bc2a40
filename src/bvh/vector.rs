//! Vectors of three numbers, eight at a time. The arithmetic is `glam`'s, operation by operation.

use super::triangle::Points;
use fearless_simd::{Simd, SimdMask, f64x8, prelude::*};
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

    #[inline(always)]
    pub(super) fn times(self, k: f64x8<S>) -> Self {
        Self { x: self.x * k, y: self.y * k, z: self.z * k }
    }

    /// Of unit length, or zero where it cannot be.
    #[inline(always)]
    pub(super) fn unit(self) -> Self {
        let s = self.x.token();
        let (zero, one) = (f64x8::splat(s, 0.0), f64x8::splat(s, 1.0));
        let rate = one / self.dot(self).sqrt();
        let fine = rate.simd_gt(zero) & rate.simd_lt(f64x8::splat(s, f64::INFINITY));
        let scaled = self.times(rate);
        let or_zero = |v: f64x8<S>| fine.select(v, zero);
        Self { x: or_zero(scaled.x), y: or_zero(scaled.y), z: or_zero(scaled.z) }
    }

    /// Least and greatest height of some points along this axis.
    #[inline(always)]
    pub(super) fn shadow(self, points: &[Self; 3]) -> [f64x8<S>; 2] {
        let [a, b, c] = points;
        let (a, b, c) = (a.dot(self), b.dot(self), c.dot(self));
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// In which lanes shadows on this axis are more than `slack` from each other, which is not negative,
    /// a bit for each; in none where the axis has no direction but round-off.
    #[inline(always)]
    pub(super) fn parts(self, [a, b]: [f64x8<S>; 2], [c, d]: [f64x8<S>; 2], slack: f64) -> u8 {
        let lane = |v| f64x8::splat(self.x.token(), v);
        let gap = (a - d).max(c - b);
        if !gap.simd_gt(lane(0.0)).any_true() {
            return 0;
        }
        let length = self.dot(self).sqrt();
        let told = length.simd_gt(lane(1e-9)) & (gap / length).simd_gt(lane(slack));
        told.to_bitmask() as u8
    }
}
