//! Eight numbers or points at once, operation by operation as one alone: each lane holds the bits
//! that its own point would give. What is not inlined would lose the wide registers: no closures
//! over lanes.

use fearless_simd::{Simd, f64x8, prelude::*};
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
