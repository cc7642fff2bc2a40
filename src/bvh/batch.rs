//! Many nearest distances at once. Points come in runs that lie close together: 64 points share
//! one walk of the tree, eight share a short list of triangles, and the kernel measures eight
//! points against a triangle at a time.

use super::Bvh;
use super::triangle::{LANES, Octet};
use crate::num::Aabb;
use glam::DVec3;

/// Points that share a walk of the tree.
const RUN: usize = 64;
/// More candidates than this for a run cost more than a walk per eight points.
const RUN_CAP: usize = 512;
/// More candidates than this for eight points cost more than a walk per point.
const OCTET_CAP: usize = 192;

/// Squared distance and slot of the nearest triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Squared distance, mm²; infinite when there are no triangles.
    pub distance2: f64,
    /// The triangle's slot, for [`Bvh::nearest_of`]; `u32::MAX` for none.
    slot: u32,
}

/// Lists kept from run to run.
#[derive(Default)]
struct Scratch {
    stack: Vec<(f64, u32)>,
    run: Vec<u32>,
    octet: Vec<u32>,
    /// Squared distances of the run's candidates to the centres of its eight octets.
    centres: Vec<[f64; LANES]>,
    /// The triangle that was nearest to the last point searched for.
    last: Option<u32>,
}

impl Bvh {
    /// The nearest triangle for each point: exactly the distance [`Bvh::nearest`] gives. Any order
    /// of points is right; runs of 64 that fill a small cube are fast.
    pub fn nearest_all(&self, at: &[DVec3]) -> Vec<Hit> {
        let mut out = vec![Hit { distance2: f64::INFINITY, slot: u32::MAX }; at.len()];
        if self.is_empty() {
            return out;
        }
        let mut scratch = Scratch::default();
        for (at, out) in at.chunks(RUN).zip(out.chunks_mut(RUN)) {
            self.run(at, out, &mut scratch);
        }
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

    fn run(&self, at: &[DVec3], out: &mut [Hit], s: &mut Scratch) {
        if at.len() <= LANES || !self.gather_for(at, RUN_CAP, s) {
            for (at, out) in at.chunks(LANES).zip(out.chunks_mut(LANES)) {
                self.alone(at, out, s);
            }
            return;
        }
        let boxes: Vec<Aabb> = at.chunks(LANES).map(|p| Aabb::of(p.iter().copied())).collect();
        let middles: Vec<DVec3> = boxes.iter().map(Aabb::centre).collect();
        let octet = Octet::of(&middles);
        s.centres.clear();
        s.centres.extend(s.run.iter().map(|&i| octet.distances2(&self.tris[i as usize])));
        for (k, (at, out)) in at.chunks(LANES).zip(out.chunks_mut(LANES)).enumerate() {
            let nearest = s.centres.iter().fold(f64::INFINITY, |m, d| m.min(d[k])).sqrt();
            // whatever is nearest to some point of the box is this near to its centre
            let reach = nearest + 2.0 * boxes[k].radius() + 4.0 * self.slack(middles[k]);
            let reach2 = reach * reach;
            s.octet.clear();
            let near = s.run.iter().zip(&s.centres).filter(|(_, d)| d[k] <= reach2);
            s.octet.extend(near.map(|(&i, _)| i));
            self.measure(at, out, &s.octet);
        }
    }

    /// Eight points that share no candidates with others.
    fn alone(&self, at: &[DVec3], out: &mut [Hit], s: &mut Scratch) {
        if at.len() > 1 && self.gather_for(at, OCTET_CAP, s) {
            self.measure(at, out, &s.run);
            return;
        }
        for (&p, out) in at.iter().zip(out) {
            let (distance2, slot) = self.closest_after(p, s);
            *out = Hit { distance2, slot };
        }
    }

    /// [`Bvh::closest`], no farther than the triangle found before.
    fn closest_after(&self, p: DVec3, s: &mut Scratch) -> (f64, u32) {
        let known = s.last.map(|slot| self.tris[slot as usize].distance2(p.x, p.y, p.z));
        // a point that is no number has no distance
        let reach2 = known.map_or(f64::INFINITY, |d2| d2.min(f64::INFINITY));
        let found = self.closest(p, reach2, &mut s.stack);
        s.last = (found.1 != u32::MAX).then_some(found.1).or(s.last);
        found
    }

    /// Fills `s.run` with every triangle that can be nearest to one of the points; `false` if
    /// they are more than `cap`.
    fn gather_for(&self, at: &[DVec3], cap: usize, s: &mut Scratch) -> bool {
        if !at.iter().all(|p| p.is_finite()) {
            return false;
        }
        let b = Aabb::of(at.iter().copied());
        let middle = b.centre();
        let distance = self.closest_after(middle, s).0.sqrt();
        let reach = distance + b.radius() + 4.0 * self.slack(middle);
        self.gather(&b, reach, cap, &mut s.stack, &mut s.run)
    }

    /// The nearest of some candidates for up to eight points.
    fn measure(&self, at: &[DVec3], out: &mut [Hit], candidates: &[u32]) {
        let octet = Octet::of(at);
        let mut best = [f64::INFINITY; LANES];
        let mut slot = [f64::NAN; LANES];
        for &i in candidates {
            let d2 = octet.distances2(&self.tris[i as usize]);
            let id = f64::from(i);
            for k in 0..LANES {
                slot[k] = if d2[k] < best[k] { id } else { slot[k] };
                best[k] = if d2[k] < best[k] { d2[k] } else { best[k] };
            }
        }
        for ((out, d2), slot) in out.iter_mut().zip(best).zip(slot) {
            let slot = if slot.is_nan() { u32::MAX } else { slot as u32 };
            *out = Hit { distance2: d2, slot };
        }
    }
}
