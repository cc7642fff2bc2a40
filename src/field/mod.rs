//! Fields: everything that has a value at a point and an honest bound over a box.
//!
//! The sign is told once: **f < 0 inside, f > 0 outside, f = 0 on the surface**; a signed
//! distance field measures in millimetres.

pub mod csg;
pub mod dense;
pub mod mesh;
pub mod sample;
pub mod sampled;
pub mod skin;
pub mod solid;
pub mod walls;

use crate::num::{Aabb, Interval};
use glam::DVec3;
use std::sync::Arc;

/// A scalar field over space, negative inside the shape.
pub trait Field: Send + Sync {
    /// The value at `p`; never NaN for finite `p`.
    fn value(&self, p: DVec3) -> f64;

    /// An enclosure of every value on the box. A promise, never a guess: sparse evaluation skips
    /// what the bound says is empty. What has no good enclosure answers [`Interval::ALL`].
    fn bound(&self, b: &Aabb) -> Interval;

    /// Enclosures over many boxes; `out` is as long as `boxes`. Must give exactly what
    /// [`Field::bound`] gives, box by box.
    fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        for (bound, b) in out.iter_mut().zip(boxes) {
            *bound = self.bound(b);
        }
    }

    /// A box outside which f > 0.
    fn support(&self) -> Aabb;

    /// Memory that is held for it, bytes, roughly; little unless it is made of many triangles.
    fn bytes(&self) -> usize {
        0
    }

    /// Values at many points: one virtual call a brick instead of one a point. `out` is as long as
    /// `at`. Must give exactly what [`Field::value`] gives, point by point. Callers order the
    /// points so that contiguous runs lie close together.
    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        for (f, &p) in out.iter_mut().zip(at) {
            *f = self.value(p);
        }
    }
}

/// A field that several owners read.
pub type Shared = Arc<dyn Field>;
