//! Eight numbers or points at once, operation by operation as one alone: each lane holds the bits
//! that its own point would give. What is not inlined would lose the wide registers: no closures
//! over lanes.

use super::{Aabb, Interval};
use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};
use glam::{DAffine3, DMat3, DVec3};

/// How many at once.
pub(crate) const LANES: usize = 8;

/// Eight numbers at rest.
pub(crate) type Lane = [f64; LANES];

/// Eight points or vectors.
#[derive(Clone, Copy)]
pub(crate) struct Vec8<S: Simd> {
    pub x: f64x8<S>,
    pub y: f64x8<S>,
    pub z: f64x8<S>,
}

impl<S: Simd> Vec8<S> {
    /// The first points of `at`; what is missing repeats the last one.
    #[inline(always)]
    pub fn of(s: S, at: &[DVec3]) -> Self {
        let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            if let Some(p) = at.get(i).or(at.last()) {
                (x[i], y[i], z[i]) = (p.x, p.y, p.z);
            }
        }
        Self { x: f64x8::simd_from(s, x), y: f64x8::simd_from(s, y), z: f64x8::simd_from(s, z) }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(s: S, p: DVec3) -> Self {
        Self { x: f64x8::splat(s, p.x), y: f64x8::splat(s, p.y), z: f64x8::splat(s, p.z) }
    }

    /// All of them.
    #[inline(always)]
    pub fn lanes(&self) -> [DVec3; LANES] {
        let (x, y, z): (Lane, Lane, Lane) = (self.x.into(), self.y.into(), self.z.into());
        std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]))
    }

    /// These where the mask holds, others elsewhere.
    #[inline(always)]
    pub fn or(self, o: Self, mask: mask64x8<S>) -> Self {
        Self {
            x: mask.select(self.x, o.x),
            y: mask.select(self.y, o.y),
            z: mask.select(self.z, o.z),
        }
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
    pub fn times(self, k: f64x8<S>) -> Self {
        Self { x: self.x * k, y: self.y * k, z: self.z * k }
    }

    /// A point less each of these.
    #[inline(always)]
    pub fn to(self, p: DVec3) -> Self {
        Self::splat(self.x.token(), p).less(self)
    }

    #[inline(always)]
    pub fn dot(self, o: Self) -> f64x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// With the same vector in all lanes.
    #[inline(always)]
    pub fn along(self, o: DVec3) -> f64x8<S> {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - o.y * self.z,
            y: self.z * o.x - o.z * self.x,
            z: self.x * o.y - o.x * self.y,
        }
    }

    /// Of unit length, or zero where it cannot be.
    #[inline(always)]
    pub fn unit(self) -> Self {
        let s = self.x.token();
        let (zero, one) = (f64x8::splat(s, 0.0), f64x8::splat(s, 1.0));
        let rate = one / self.dot(self).sqrt();
        let fine = rate.simd_gt(zero) & rate.simd_lt(f64x8::splat(s, f64::INFINITY));
        self.times(rate).or(Self::splat(s, DVec3::ZERO), fine)
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// The greatest coordinate.
    #[inline(always)]
    pub fn greatest(self) -> f64x8<S> {
        self.x.max(self.y).max(self.z)
    }

    /// `m * self`.
    #[inline(always)]
    pub fn turned(self, m: &DMat3) -> Self {
        let DMat3 { x_axis: a, y_axis: b, z_axis: c } = *m;
        Self {
            x: self.x * a.x + self.y * b.x + self.z * c.x,
            y: self.x * a.y + self.y * b.y + self.z * c.y,
            z: self.x * a.z + self.y * b.z + self.z * c.z,
        }
    }

    /// Where an affine map takes them.
    #[inline(always)]
    pub fn mapped(self, m: &DAffine3) -> Self {
        let v = self.turned(&m.matrix3);
        Self { x: v.x + m.translation.x, y: v.y + m.translation.y, z: v.z + m.translation.z }
    }
}

/// Eight intervals.
#[derive(Clone, Copy)]
pub(crate) struct Interval8<S: Simd> {
    pub lo: f64x8<S>,
    pub hi: f64x8<S>,
}

impl<S: Simd> Interval8<S> {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn point(s: S, x: f64) -> Self {
        Self { lo: f64x8::splat(s, x), hi: f64x8::splat(s, x) }
    }

    /// All of them.
    #[inline(always)]
    pub fn lanes(self) -> [Interval; LANES] {
        let (lo, hi): (Lane, Lane) = (self.lo.into(), self.hi.into());
        std::array::from_fn(|i| Interval::new(lo[i], hi[i]))
    }
}

/// Up to eight boxes; what is missing repeats the last one.
#[derive(Clone, Copy)]
pub(crate) struct Boxes<S: Simd> {
    pub centre: Vec8<S>,
    pub half: Vec8<S>,
    /// Half the diagonal.
    pub radius: f64x8<S>,
}

impl<S: Simd> Boxes<S> {
    #[inline(always)]
    pub fn of(s: S, boxes: &[Aabb]) -> Self {
        let (mut centre, mut half) = ([DVec3::ZERO; LANES], [DVec3::ZERO; LANES]);
        let mut radius = [0.0; LANES];
        for i in 0..LANES {
            if let Some(b) = boxes.get(i).or(boxes.last()) {
                (centre[i], half[i], radius[i]) = (b.centre(), b.size() * 0.5, b.radius());
            }
        }
        let radius = f64x8::simd_from(s, radius);
        Self { centre: Vec8::of(s, &centre), half: Vec8::of(s, &half), radius }
    }
}
