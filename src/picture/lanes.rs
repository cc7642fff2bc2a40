//! Vectors of three numbers, eight at a time. The arithmetic is `glam`'s, operation by operation.

use fearless_simd::{Simd, f32x8, prelude::*};
use glam::Vec3;

/// Numbers worked on at once.
pub(super) const LANES: usize = 8;

/// Eight numbers in memory.
pub(super) type Eight = [f32; LANES];

/// Eight vectors in memory, by coordinate.
pub(super) type Eight3 = [Eight; 3];

/// Puts a vector in a lane.
#[inline(always)]
pub(super) fn put(to: &mut Eight3, lane: usize, v: Vec3) {
    (to[0][lane], to[1][lane], to[2][lane]) = (v.x, v.y, v.z);
}

/// The vector in a lane.
#[inline(always)]
pub(super) fn take(from: &Eight3, lane: usize) -> Vec3 {
    Vec3::new(from[0][lane], from[1][lane], from[2][lane])
}

/// Eight vectors.
#[derive(Clone, Copy)]
pub(super) struct Vec8<S: Simd> {
    pub x: f32x8<S>,
    pub y: f32x8<S>,
    pub z: f32x8<S>,
}

impl<S: Simd> Vec8<S> {
    #[inline(always)]
    pub fn load(s: S, [x, y, z]: &Eight3) -> Self {
        let lanes = |v: &Eight| f32x8::simd_from(s, *v);
        Self { x: lanes(x), y: lanes(y), z: lanes(z) }
    }

    #[inline(always)]
    pub fn store(self) -> Eight3 {
        [self.x.into(), self.y.into(), self.z.into()]
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(s: S, v: Vec3) -> Self {
        let lane = |v| f32x8::splat(s, v);
        Self { x: lane(v.x), y: lane(v.y), z: lane(v.z) }
    }

    #[inline(always)]
    pub fn plus(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }

    #[inline(always)]
    pub fn less(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }

    #[inline(always)]
    pub fn times(self, k: f32x8<S>) -> Self {
        Self { x: self.x * k, y: self.y * k, z: self.z * k }
    }

    #[inline(always)]
    pub fn over(self, k: f32x8<S>) -> Self {
        Self { x: self.x / k, y: self.y / k, z: self.z / k }
    }

    #[inline(always)]
    pub fn dot(self, o: Self) -> f32x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Of unit length, or another vector where it cannot be.
    #[inline(always)]
    pub fn unit_or(self, other: Self) -> Self {
        let s = self.x.token();
        let (zero, one) = (f32x8::splat(s, 0.0), f32x8::splat(s, 1.0));
        let rate = one / self.dot(self).sqrt();
        let fine = rate.simd_gt(zero) & rate.simd_lt(f32x8::splat(s, f32::INFINITY));
        let scaled = self.times(rate);
        Self {
            x: fine.select(scaled.x, other.x),
            y: fine.select(scaled.y, other.y),
            z: fine.select(scaled.z, other.z),
        }
    }
}
