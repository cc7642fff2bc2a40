//! Which triangles may be in contact.

use super::Bvh;
#[cfg(doc)]
use super::apart;
use super::axis::{parts, shadow};
use super::triangle::LANES;
use super::wide::Open;
use crate::num::Aabb;
use crate::num::lanes::Vec8;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::DVec3;
use std::ops::Range;

/// Up to eight triangles that are neighbours in the tree; the last one fills the lanes left over.
struct Run<'a> {
    faces: &'a [u32],
    corners: [[DVec3; LANES]; 3],
    lo: [DVec3; LANES],
    hi: [DVec3; LANES],
    /// The faces as numbers, those left over higher than all.
    order: [f64; LANES],
    /// The box round all.
    whole: Aabb,
}

impl<'a> Run<'a> {
    /// Of at least one triangle.
    fn of(corners: &[[DVec3; 3]], faces: &'a [u32]) -> Self {
        let at = |lane: usize| &corners[lane.min(corners.len() - 1)];
        let boxes: [Aabb; LANES] = std::array::from_fn(|lane| Aabb::of(*at(lane)));
        Self {
            faces,
            corners: std::array::from_fn(|i| std::array::from_fn(|lane| at(lane)[i])),
            lo: boxes.map(|b| b.min),
            hi: boxes.map(|b| b.max),
            order: std::array::from_fn(|lane| faces.get(lane).map_or(f64::MAX, |&f| f.into())),
            whole: boxes.iter().fold(Aabb::EMPTY, |whole, b| whole.hull(*b)),
        }
    }

    /// Adds the pairs of these triangles with those in `slots` of higher index.
    #[inline(always)]
    fn pairs<S: Simd>(
        &self,
        s: S,
        bvh: &Bvh,
        slots: &[u32],
        reach: f64,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        let (zero, reach2) = (f64x8::splat(s, 0.0), f64x8::splat(s, reach * reach));
        let (lo, hi) = (Vec8::of(s, &self.lo), Vec8::of(s, &self.hi));
        let [a, b, c] = &self.corners;
        let own = [Vec8::of(s, a), Vec8::of(s, b), Vec8::of(s, c)];
        let middles = middle(&own);
        let order = f64x8::simd_from(s, self.order);
        let least = self.faces.iter().min().copied().unwrap_or(u32::MAX);
        for &slot in slots {
            let face = bvh.faces[slot as usize];
            if face <= least {
                continue;
            }
            let corners = &bvh.corners[slot as usize];
            let b = Aabb::of(*corners);
            let (below, above) = (lo.less(Vec8::splat(s, b.max)), hi.to(b.min));
            let x = below.x.max(above.x).max(zero);
            let y = below.y.max(above.y).max(zero);
            let z = below.z.max(above.z).max(zero);
            let lower = order.simd_lt(f64x8::splat(s, face.into()));
            let mut near = (lower & (x * x + y * y + z * z).simd_le(reach2)).to_bitmask();
            if near == 0 {
                continue;
            }
            let [a, b, c] = corners;
            let other = [Vec8::splat(s, *a), Vec8::splat(s, *b), Vec8::splat(s, *c)];
            let axis = middle(&other).less(middles);
            near &= !u64::from(parts(axis, shadow(axis, &own), shadow(axis, &other), reach));
            while near != 0 {
                let lane = near.trailing_zeros() as usize;
                near &= near - 1;
                pairs.push([self.faces[lane], face]);
            }
        }
    }
}

#[inline(always)]
pub(super) fn middle<S: Simd>([a, b, c]: &[Vec8<S>; 3]) -> Vec8<S> {
    let three = f64x8::splat(a.x.token(), 3.0);
    Vec8 {
        x: (a.x + b.x + c.x) / three,
        y: (a.y + b.y + c.y) / three,
        z: (a.z + b.z + c.z) / three,
    }
}

impl Bvh {
    /// Pairs of triangles whose boxes come within `reach` mm of each other and that the line from
    /// middle to middle does not tell [`apart`], the lower index first: those of the triangles in a
    /// range of slots with the ones of higher index.
    pub fn close_pairs(&self, slots: Range<usize>, reach: f64) -> Vec<[u32; 2]> {
        let open = &mut Open::with_capacity(64);
        let mut pairs = vec![];
        // neighbours in the tree share a walk
        let (corners, faces) = (&self.corners[slots.clone()], &self.faces[slots]);
        for (corners, faces) in corners.chunks(LANES).zip(faces.chunks(LANES)) {
            let run = Run::of(corners, faces);
            let found = self.gather(&run.whole, reach, open);
            dispatch!(Level::new(), s => run.pairs(s, self, &found, reach, &mut pairs));
        }
        pairs
    }
}
