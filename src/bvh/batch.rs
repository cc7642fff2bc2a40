//! Many nearest distances at once. Points come in runs that lie close together: 64 points share one
//! walk of the tree, eight share a short list of triangles, and the kernel measures eight points
//! against a triangle at a time. Where a run meets too many triangles, each eight points walk alone.

use super::Bvh;
use super::limits::{Limit, Limits, Small, Star};
use super::triangle::{LANES, Points, Tri, Way};
use super::wide::{Known, Open, Pack, Seek};
use crate::num::Aabb;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::DVec3;

/// Points that share a walk of the tree.
const RUN: usize = LANES * LANES;
/// More triangles than this for a run cost more than a walk per eight points.
const RUN_CAP: usize = 256;
/// More triangles than this for eight points cost more than a walk per point.
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
struct Scratch<S: Simd> {
    open: Open,
    /// What can be nearest to a point of the run.
    run: Vec<u32>,
    /// The ways from these to the middles of the eight octets.
    ways: Vec<Way<S>>,
    /// What can be nearest to a point of each octet.
    octets: [Vec<u32>; LANES],
    /// The triangle that was nearest to the last point searched for.
    last: u32,
}

/// The nearest triangle so far, in each lane.
struct Nearest<S: Simd> {
    d2: f64x8<S>,
    /// As a number; NaN for none.
    slot: f64x8<S>,
}

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    fn none(s: S) -> Self {
        Self { d2: f64x8::splat(s, f64::INFINITY), slot: f64x8::splat(s, f64::NAN) }
    }

    /// Takes a triangle where it is nearer than those before.
    #[inline(always)]
    fn take(&mut self, slot: u32, d2: f64x8<S>) {
        let nearer = d2.simd_lt(self.d2);
        self.slot = nearer.select(f64x8::splat(d2.token(), f64::from(slot)), self.slot);
        self.d2 = nearer.select(d2, self.d2);
    }

    /// Squared distance, and slot (`u32::MAX` for none).
    #[inline(always)]
    fn lane(&self, lane: usize) -> (f64, u32) {
        let slot = self.slot[lane];
        (self.d2[lane], if slot.is_nan() { u32::MAX } else { slot as u32 })
    }
}

/// The root of the greatest of eight squares.
#[inline(always)]
fn greatest<S: Simd>(d2: f64x8<S>) -> f64 {
    let d2: [f64; LANES] = d2.into();
    d2.into_iter().fold(0.0, f64::max).sqrt()
}

/// Looks for everything that can be nearest to a point of a box.
struct Run<'a, S: Simd> {
    s: S,
    of: Small,
    corners: Points<S>,
    star: Star,
    /// No point of the box is farther from the surface.
    edge: f64,
    known: Known<S>,
    found: &'a mut Vec<u32>,
}

impl<'a, S: Simd> Run<'a, S> {
    #[inline(always)]
    fn new(s: S, bounds: Aabb, of: Small, start: Option<&Tri>, found: &'a mut Vec<u32>) -> Self {
        found.clear();
        let middle = Points::one(s, bounds.centre());
        let corners = Points::of(s, &bounds.corners());
        let (mut star, mut edge) = (Star::NONE, f64::INFINITY);
        if let Some(tri) = start {
            star.take(&middle.ways(tri));
            edge = greatest(corners.distances2(tri));
        }
        let limit = Limit::new(&of, &star, edge);
        let known = Known::new(s, middle, bounds, &limit);
        Self { s, of, corners, star, edge, known, found }
    }
}

impl<S: Simd> Seek<S> for Run<'_, S> {
    #[inline(always)]
    fn known(&self) -> &Known<S> {
        &self.known
    }

    #[inline(always)]
    fn take(&mut self, pack: &Pack, way: &Way<S>, mut bits: u64) -> bool {
        if let Some(lane) = self.star.take(way) {
            // a distance from a triangle is greatest at a corner
            let corners = self.corners.distances2_of(&pack.lanes, lane);
            self.edge = self.edge.min(greatest(corners));
            self.known.narrow(self.s, &Limit::new(&self.of, &self.star, self.edge));
            bits &= self.known.limits.can_win(way);
        }
        while bits != 0 {
            self.found.push(pack.first + bits.trailing_zeros());
            bits &= bits - 1;
        }
        self.found.len() <= RUN_CAP
    }
}

/// Looks for the nearest triangles of eight points.
struct Octet<S: Simd> {
    s: S,
    of: Small,
    points: Points<S>,
    star: Star,
    near: Nearest<S>,
    known: Known<S>,
    looked: usize,
}

impl<S: Simd> Octet<S> {
    #[inline(always)]
    fn new(s: S, at: &[DVec3], bounds: Aabb, of: Small, start: Option<(u32, &Tri)>) -> Self {
        let (middle, points) = (Points::one(s, bounds.centre()), Points::of(s, at));
        let (mut star, mut near) = (Star::NONE, Nearest::none(s));
        if let Some((slot, tri)) = start {
            star.take(&middle.ways(tri));
            near.take(slot, points.distances2(tri));
        }
        let limit = Limit::new(&of, &star, greatest(near.d2));
        let known = Known::new(s, middle, bounds, &limit);
        Self { s, of, points, star, near, known, looked: 0 }
    }
}

impl<S: Simd> Seek<S> for Octet<S> {
    #[inline(always)]
    fn known(&self) -> &Known<S> {
        &self.known
    }

    #[inline(always)]
    fn take(&mut self, pack: &Pack, way: &Way<S>, mut bits: u64) -> bool {
        self.looked += bits.count_ones() as usize;
        while bits != 0 {
            let lane = bits.trailing_zeros();
            bits &= bits - 1;
            let d2 = self.points.distances2_of(&pack.lanes, lane as usize);
            self.near.take(pack.first + lane, d2);
        }
        self.star.take(way);
        let limit = Limit::new(&self.of, &self.star, greatest(self.near.d2));
        self.known.narrow(self.s, &limit);
        self.looked <= OCTET_CAP
    }
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
            ways: Vec::with_capacity(RUN_CAP + LANES),
            octets: std::array::from_fn(|_| Vec::with_capacity(RUN_CAP + LANES)),
            last: u32::MAX,
        };
        for (at, out) in at.chunks(RUN).zip(out.chunks_mut(RUN)) {
            if at.len() > LANES && self.gather_for(s, at, &mut lists) {
                self.run(s, at, out, &mut lists);
                continue;
            }
            for (at, out) in at.chunks(LANES).zip(out.chunks_mut(LANES)) {
                self.alone(s, at, out, &mut lists);
            }
        }
    }

    #[inline(always)]
    fn small(&self, b: &Aabb) -> Small {
        let slack = self.slack(b.min).max(self.slack(b.max));
        Small { half: b.size() * 0.5, radius: b.radius(), slack }
    }

    /// Fills `lists.run` with every triangle that can be nearest to one of the points; `false` if
    /// they are too many.
    #[inline(always)]
    fn gather_for<S: Simd>(&self, s: S, at: &[DVec3], lists: &mut Scratch<S>) -> bool {
        if !at.iter().all(|p| p.is_finite()) {
            return false;
        }
        let bounds = Aabb::of(at.iter().copied());
        let start = self.tris.get(lists.last as usize);
        let mut run = Run::new(s, bounds, self.small(&bounds), start, &mut lists.run);
        self.wide.seek(s, &mut run, &mut lists.open)
    }

    /// A run of points by the candidates in `lists.run`.
    #[inline(always)]
    fn run<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit], lists: &mut Scratch<S>) {
        let mut boxes = [Aabb::EMPTY; LANES];
        for (b, at) in boxes.iter_mut().zip(at.chunks(LANES)) {
            *b = Aabb::of(at.iter().copied());
        }
        let mut middles = [DVec3::ZERO; LANES];
        for (middle, b) in middles.iter_mut().zip(&boxes) {
            *middle = b.centre();
        }
        let middles = Points::of(s, &middles[..at.len().div_ceil(LANES)]);
        let mut nearest = Nearest::none(s);
        lists.ways.clear();
        for (n, &i) in (0u32..).zip(&lists.run) {
            let way = middles.ways(&self.tris[i as usize]);
            nearest.take(n, way.length2);
            lists.ways.push(way);
        }
        let mut limits = [Limit::NOTHING; LANES];
        for (k, at) in at.chunks(LANES).enumerate() {
            let (length2, n) = nearest.lane(k);
            let Some((way, &i)) = lists.ways.get(n as usize).zip(lists.run.get(n as usize)) else {
                continue;
            };
            let star = Star { length2, along: way.along.map(|a| a[k]) };
            let edge = greatest(Points::of(s, at).distances2(&self.tris[i as usize]));
            limits[k] = Limit::new(&self.small(&boxes[k]), &star, edge);
            lists.last = i;
        }
        let limits = Limits::each(s, &limits);
        lists.octets.iter_mut().for_each(Vec::clear);
        for (&i, way) in lists.run.iter().zip(&lists.ways) {
            let mut bits = limits.can_win(way);
            while bits != 0 {
                lists.octets[bits.trailing_zeros() as usize].push(i);
                bits &= bits - 1;
            }
        }
        let octets = at.chunks(LANES).zip(out.chunks_mut(LANES));
        for ((at, out), candidates) in octets.zip(&lists.octets) {
            let points = Points::of(s, at);
            let mut near = Nearest::none(s);
            for &i in candidates {
                near.take(i, points.distances2(&self.tris[i as usize]));
            }
            for (lane, out) in out.iter_mut().enumerate() {
                let (distance2, slot) = near.lane(lane);
                *out = Hit { distance2, slot };
            }
        }
    }

    /// Up to eight points that share no candidates with others.
    #[inline(always)]
    fn alone<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [Hit], lists: &mut Scratch<S>) {
        let mut known = [(f64::INFINITY, u32::MAX); LANES];
        let mut all = false;
        if at.iter().all(|p| p.is_finite()) {
            let bounds = Aabb::of(at.iter().copied());
            let start = self.tris.get(lists.last as usize).map(|tri| (lists.last, tri));
            let mut octet = Octet::new(s, at, bounds, self.small(&bounds), start);
            all = self.wide.seek(s, &mut octet, &mut lists.open);
            known = std::array::from_fn(|lane| octet.near.lane(lane));
        }
        for ((&p, known), out) in at.iter().zip(known).zip(out) {
            let mut found = known;
            if !all {
                found = self.wide.closest(s, p, known, self.slack(p), &mut lists.open);
            }
            let (distance2, slot) = found;
            *out = Hit { distance2, slot };
            if slot != u32::MAX {
                lists.last = slot;
            }
        }
    }
}
