use super::shape::Bent;
use super::{Element, Shape};
use crate::num::lanes::{Boxes, Interval8, LANES, Vec8};
use crate::num::{Aabb, Interval};
use fearless_simd::{Simd, f64x8, prelude::*};
use glam::{DMat3, DVec3};

/// An element made ready for many distance queries: what [`Element::distance_rounded`] works out
/// anew each time is worked out once.
#[derive(Clone, Debug)]
pub struct Gauge {
    shape: Shape,
    centre: DVec3,
    into: DMat3,
    half: DVec3,
    bent: Option<Bent>,
    round: f64,
    bounds: Aabb,
}

impl Gauge {
    /// Ready, with the element's edges rounded by `round` mm and its size unchanged.
    pub fn new(element: &Element, round: f64) -> Self {
        Self {
            shape: element.shape.clone(),
            centre: element.centre,
            into: DMat3::from_quat(element.rotation).transpose(),
            half: element.half,
            bent: element.bent(),
            round,
            bounds: element.bounds(),
        }
    }

    /// Signed distance, as [`Element::distance_rounded`] gives it.
    pub fn distance(&self, p: DVec3) -> f64 {
        let v = self.into * (p - self.centre);
        self.shape.deformed_distance(self.half, self.bent.as_ref(), self.round, v)
    }

    /// [`Gauge::distance`] of eight points, to the bit.
    #[inline(always)]
    pub(crate) fn distances<S: Simd>(&self, s: S, p: Vec8<S>) -> f64x8<S> {
        let v = p.less(Vec8::splat(s, self.centre)).turned(&self.into);
        if self.bent.is_none()
            && self.round <= 0.0
            && let Some(d) = self.shape.plain_distances(s, self.half, v)
        {
            return d;
        }
        let mut d = [0.0; LANES];
        for (d, v) in d.iter_mut().zip(v.lanes()) {
            *d = self.shape.deformed_distance(self.half, self.bent.as_ref(), self.round, v);
        }
        f64x8::simd_from(s, d)
    }

    /// An enclosure of the distance over a box.
    pub fn bound(&self, b: &Aabb) -> Interval {
        let d = self.distance(b.centre());
        Interval::ball(d, b.radius()).widen(1e-12 * (d.abs() + b.radius()))
    }

    /// [`Gauge::bound`] of eight boxes.
    #[inline(always)]
    pub(crate) fn ranges<S: Simd>(&self, s: S, b: &Boxes<S>) -> Interval8<S> {
        let d = self.distances(s, b.centre);
        let reach = b.radius + (d.abs() + b.radius) * 1e-12;
        Interval8 { lo: d - reach, hi: d + reach }
    }

    /// A box round the element.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }
}
