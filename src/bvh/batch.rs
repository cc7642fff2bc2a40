//! Many nearest distances at once. Points come in runs that lie close together: 64 points share
//! one walk of the tree, eight share a short list of triangles, and the kernel measures eight
//! points against a triangle at a time.

use super::Bvh;
use super::triangle::{LANES, Points};
use super::wide::Open;
use crate::num::Aabb;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::DVec3;

/// Points that share a walk of the tree.
const RUN: usize = 64;
/// More candidates than this for a run cost more than a walk per eight points.
const RUN_CAP: usize = 768;
/// More candidates than this for eight points cost more than a walk per point.
const OCTET_CAP: usize = 512;

/// Squared distance and slot of the nearest triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Squared distance, mm²; infinite when there are no triangles.
    pub distance2: f64,
    /// The triangle's slot, for [`Bvh::nearest_of`]; `u32::MAX` for none.
    slot: u32,
}

/// Lists kept from run to run.
struct Scratch {
    open: Open,
    run: Vec<u32>,
    octet: Vec<u32>,
    /// Squared distances of the run's candidates to the centres of its eight octets.
    centres: Vec<[f64; LANES]>,
    /// The triangle that was nearest to the last point searched for.
    last: u32,
}

impl Bvh {
    /// The nearest triangle for each point: exactly the distance [`Bvh::nearest`] gives. Any order
    /// of points is right; runs of 64 that fill a small cube are fast.
    pub fn nearest_all(&self, at: &[DVec3]) -> Vec<Hit> {
        let mut out = vec![Hit { distance2: f64::INFINITY, slot: u32::MAX }; at.len()];
        if self.is_empty() {
            return out;
        }
        dispatch!(Level::new(), s => self.runs(s, at, &mut out));
        out
    }

    /// What [`Bvh::nearest`] tells, for a hit of [`Bvh::nearest_all`].
    pub fn nearest_of(&self, p: DVec3, hit: &Hit) -> Option<super::Nearest> {
        (hit.slot != u32::MAX).then(|| self.describe(p, hit.distance2, hit.slot))
    }

    /// The triangle of a hit, as [`super::Nearest::face`] names it.
    pub fn face_of(&self, hit: &Hit) -> Option<u32> {
        self.faces.get(hit.slot as usize).copied()
    }

    #[inline(always)]
    fn runs<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit]) {
        let mut lists = Scratch {
            open: Open::with_capacity(64),
            run: Vec::with_capacity(RUN_CAP + LANES),
            octet: Vec::with_capacity(RUN_CAP + LANES),
            centres: Vec::with_capacity(RUN_CAP + LANES),
            last: u32::MAX,
        };
        for (at, out) in at.chunks(RUN).zip(out.chunks_mut(RUN)) {
            self.run(s, at, out, &mut lists);
        }
    }

    #[inline(always)]
    fn run<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit], lists: &mut Scratch) {
        if at.len() <= LANES || !self.gather_for(s, at, RUN_CAP, lists) {
            for (at, out) in at.chunks(LANES).zip(out.chunks_mut(LANES)) {
                self.alone(s, at, out, lists);
            }
            return;
        }
        let octets = at.len().div_ceil(LANES);
        let mut boxes = [Aabb::EMPTY; LANES];
        for (b, at) in boxes.iter_mut().zip(at.chunks(LANES)) {
            *b = Aabb::of(at.iter().copied());
        }
        let mut middles = [DVec3::ZERO; LANES];
        for (middle, b) in middles.iter_mut().zip(&boxes) {
            *middle = b.centre();
        }
        let centres = Points::of(s, &middles[..octets]);
        let mut nearest = f64x8::splat(s, f64::INFINITY);
        lists.centres.clear();
        for &i in &lists.run {
            let d2 = centres.distances2(&self.tris[i as usize]);
            nearest = nearest.min(d2);
            lists.centres.push(d2.into());
        }
        for (k, (at, out)) in at.chunks(LANES).zip(out.chunks_mut(LANES)).enumerate() {
            // whatever is nearest to some point of the box is this near to its centre
            let reach = nearest[k].sqrt() + 2.0 * boxes[k].radius() + 4.0 * self.slack(middles[k]);
            let reach2 = reach * reach;
            lists.octet.clear();
            for (&i, d2) in lists.run.iter().zip(&lists.centres) {
                if d2[k] <= reach2 {
                    lists.octet.push(i);
                }
            }
            self.measure(s, at, out, &lists.octet);
        }
    }

    /// Eight points that share no candidates with others.
    #[inline(always)]
    fn alone<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit], lists: &mut Scratch) {
        if at.len() > 1 && self.gather_for(s, at, OCTET_CAP, lists) {
            self.measure(s, at, out, &lists.run);
            return;
        }
        for (&p, out) in at.iter().zip(out) {
            let (distance2, slot) = self.closest_after(s, p, lists);
            *out = Hit { distance2, slot };
        }
    }

    /// The nearest triangle, no farther than the one found before.
    #[inline(always)]
    fn closest_after<S: Simd>(&self, s: S, p: DVec3, lists: &mut Scratch) -> (f64, u32) {
        let known = self.tris.get(lists.last as usize).map(|t| t.distance2(p.x, p.y, p.z));
        // a point that is no number has no distance
        let reach2 = known.map_or(f64::INFINITY, |d2| d2.min(f64::INFINITY));
        let found = self.wide.closest(s, p, (reach2, u32::MAX), self.slack(p), &mut lists.open);
        if found.1 != u32::MAX {
            lists.last = found.1;
        }
        found
    }

    /// Fills `lists.run` with every triangle that can be nearest to one of the points; `false` if
    /// they are more than `cap`.
    #[inline(always)]
    fn gather_for<S: Simd>(&self, s: S, at: &[DVec3], cap: usize, lists: &mut Scratch) -> bool {
        if !at.iter().all(|p| p.is_finite()) {
            return false;
        }
        let b = Aabb::of(at.iter().copied());
        let middle = b.centre();
        let distance = self.closest_after(s, middle, lists).0.sqrt();
        let reach = distance + b.radius() + 4.0 * self.slack(middle);
        self.wide.gather(s, &b, reach, cap, &mut lists.open, &mut lists.run)
    }

    /// The nearest of some candidates for up to eight points.
    #[inline(always)]
    fn measure<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit], candidates: &[u32]) {
        let octet = Points::of(s, at);
        let mut best = f64x8::splat(s, f64::INFINITY);
        let mut slot = f64x8::splat(s, f64::NAN);
        for &i in candidates {
            let d2 = octet.distances2(&self.tris[i as usize]);
            let nearer = d2.simd_lt(best);
            slot = nearer.select(f64x8::splat(s, f64::from(i)), slot);
            best = nearer.select(d2, best);
        }
        for (k, out) in out.iter_mut().enumerate() {
            let slot = if slot[k].is_nan() { u32::MAX } else { slot[k] as u32 };
            *out = Hit { distance2: best[k], slot };
        }
    }
}
