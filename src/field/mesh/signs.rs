//! The signs of many points: most are told by a point nearby or by the nearest face, and the winding
//! number is asked for those that are left, eight at a time.

use super::buried::Trust;
use super::solid::{OCTET, Solid};
use crate::bvh::{Hit, Nearest};
use crate::num::Aabb;
use glam::DVec3;
use std::ops::Range;

/// Points that are looked at together.
const RUN: usize = OCTET * OCTET;
/// Runs whose signs are found together.
const RUNS: usize = OCTET;
/// Points that are looked through for some more to ask for.
const AHEAD: usize = 256;

/// A point whose sign is known.
#[derive(Clone, Copy)]
struct Known {
    at: DVec3,
    distance: f64,
    inside: bool,
}

/// A face and the side of it on which a point lies.
type Side = (u32, bool);

/// A point whose sign neither its nearest face nor the point before it tells.
struct Open {
    /// Which point.
    point: usize,
    /// Which region it lies in.
    region: usize,
    /// Points of a region on the same side have the same sign.
    side: Option<Side>,
    /// By winding number, once that was asked for.
    answer: Option<bool>,
}

/// Finds the signs of points that come in runs of neighbours.
pub(super) struct Signs<'a> {
    solid: &'a Solid,
    /// With closed shells the way from one region to the next holds no surprise either.
    reach: bool,
    /// The last point that became known.
    last: Option<Known>,
    known: Vec<Known>,
    /// Balls in which only faces part inside from outside: which of `known` lie in each.
    regions: Vec<Range<usize>>,
    open: Vec<Open>,
}

/// The ball round some points in which their feet are looked for: twice as wide as their box.
fn ball(at: &[DVec3]) -> (DVec3, f64) {
    let run = Aabb::of(at.iter().copied());
    (run.centre(), 2.0 * run.radius())
}

fn balls(at: &[DVec3], each: usize) -> Vec<(DVec3, f64)> {
    at.chunks(each).map(ball).collect()
}

impl<'a> Signs<'a> {
    pub(super) fn new(solid: &'a Solid) -> Self {
        let reach = solid.inside.is_closed() && solid.ghosts.is_empty();
        let (known, regions, open) = (vec![], vec![], vec![]);
        Self { solid, reach, last: None, known, regions, open }
    }

    /// The signed distances of any number of points, from the nearest triangle of each.
    pub(super) fn find(&mut self, at: &[DVec3], hits: &[Hit], out: &mut [f64]) {
        let eight = RUNS * RUN;
        let hits = hits.chunks(eight);
        for ((at, hits), out) in at.chunks(eight).zip(hits).zip(out.chunks_mut(eight)) {
            self.find_eight(at, hits, out);
        }
    }

    fn find_eight(&mut self, at: &[DVec3], hits: &[Hit], out: &mut [f64]) {
        self.known.clear();
        self.regions.clear();
        self.open.clear();
        for (f, hit) in out.iter_mut().zip(hits) {
            *f = hit.distance2.sqrt();
        }
        let balls = balls(at, RUN);
        let sharp = self.solid.which_sharp(&balls);
        for (i, &ball) in balls.iter().enumerate() {
            let run = i * RUN..((i + 1) * RUN).min(at.len());
            if sharp >> i & 1 == 1 {
                self.region(run, ball, at, hits, out);
            } else {
                self.octets(run, at, hits, out);
            }
        }
        self.settle(at, out);
    }

    /// A run whose ball is not sharp: the same by octets, and by winding number where those are not
    /// sharp either.
    fn octets(&mut self, run: Range<usize>, at: &[DVec3], hits: &[Hit], out: &mut [f64]) {
        let solid = self.solid;
        let balls = balls(&at[run.clone()], OCTET);
        let sharp = if balls.len() > 1 { solid.which_sharp(&balls) } else { 0 };
        for (i, &ball) in balls.iter().enumerate() {
            let first = run.start + i * OCTET;
            let octet = first..(first + OCTET).min(run.end);
            if sharp >> i & 1 == 1 {
                self.region(octet, ball, at, hits, out);
                continue;
            }
            let inside = solid.inside.which(&at[octet.clone()]);
            for (i, f) in out[octet].iter_mut().enumerate() {
                *f = signed(*f, *f > solid.touch && inside >> i & 1 == 1);
            }
        }
    }

    /// Signs of points in a ball in which only faces part inside from outside, by the point before or
    /// the nearest face.
    fn region(
        &mut self,
        points: Range<usize>,
        (centre, radius): (DVec3, f64),
        at: &[DVec3],
        hits: &[Hit],
        out: &mut [f64],
    ) {
        let first = self.known.len();
        // only where the way to it lies in a ball that is known to be sharp
        self.last = self.last.filter(|k| self.reach || k.at.distance(centre) <= radius);
        for start in points.clone().step_by(OCTET) {
            let octet = start..(start + OCTET).min(points.end);
            // most points lie in the free ball of one before
            let last =
                self.last.filter(|k| self.all_reached(k, &at[octet.clone()], &out[octet.clone()]));
            let Some(Known { inside, .. }) = last else {
                self.one_by_one(octet, (centre, radius), at, hits, out);
                continue;
            };
            let end = octet.end - 1;
            self.learn(Known { at: at[end], distance: out[end], inside });
            out[octet].iter_mut().for_each(|f| *f = signed(*f, inside));
        }
        self.regions.push(first..self.known.len());
    }

    fn learn(&mut self, known: Known) {
        self.known.push(known);
        self.last = Some(known);
    }

    /// Whether points are in the box and reached from a known one.
    fn all_reached(&self, known: &Known, at: &[DVec3], distances: &[f64]) -> bool {
        let reached = |(&p, &distance): (&DVec3, &f64)| {
            self.solid.inside.bounds().contains(p) & self.solid.reaches(known, p, distance)
        };
        // all of them: that is faster than to stop at the first
        at.iter().zip(distances).map(reached).fold(true, |all, yes| all & yes)
    }

    fn one_by_one(
        &mut self,
        points: Range<usize>,
        (centre, radius): (DVec3, f64),
        at: &[DVec3],
        hits: &[Hit],
        out: &mut [f64],
    ) {
        let (solid, region) = (self.solid, self.regions.len());
        for i in points {
            let (p, distance) = (at[i], out[i]);
            if !solid.inside.bounds().contains(p) {
                continue;
            }
            let before = self.last.filter(|k| solid.reaches(k, p, distance)).map(|k| k.inside);
            let mut side = None;
            let inside = before.or_else(|| {
                // the way to the foot must lie in the ball that is known to be sharp
                let near = solid.surface.nearest_of(p, &hits[i]).filter(|near| {
                    solid.inside.is_closed() || near.point.distance(centre) <= radius
                })?;
                side = solid.side(&near);
                solid.by_face(&near)
            });
            match inside {
                Some(inside) => {
                    out[i] = signed(distance, inside);
                    self.learn(Known { at: p, distance, inside });
                }
                None => self.open.push(Open { point: i, region, side, answer: None }),
            }
        }
    }

    /// Signs of the points that are open: that of one on the same side of the same face, or of one from
    /// which the way is shorter than the distance of either to the surface; else by winding number.
    fn settle(&mut self, at: &[DVec3], out: &mut [f64]) {
        let mut region = usize::MAX;
        let mut sides: Vec<(Side, bool)> = vec![];
        let mut fresh: Vec<Known> = vec![];
        for n in 0..self.open.len() {
            let Open { point, region: own, side, .. } = self.open[n];
            if own != region {
                region = own;
                sides.clear();
                fresh.clear();
            }
            let (p, distance) = (at[point], out[point]);
            let told = self.told(n, at, out, &sides, &fresh);
            let inside = told.or(self.open[n].answer).unwrap_or_else(|| {
                self.ask(n, at, out, &sides, &fresh);
                self.open[n].answer.unwrap_or(false)
            });
            out[point] = signed(distance, inside);
            fresh.push(Known { at: p, distance, inside });
            let new = side.filter(|side| !sides.iter().any(|s| s.0 == *side));
            sides.extend(new.map(|side| (side, inside)));
        }
    }

    /// What is known of an open point by its side or another point of its region; `sides` and `fresh`
    /// are what was found in that region since.
    fn told(
        &self,
        n: usize,
        at: &[DVec3],
        out: &[f64],
        sides: &[(Side, bool)],
        fresh: &[Known],
    ) -> Option<bool> {
        let Open { point, region, side, .. } = self.open[n];
        let (p, distance) = (at[point], out[point]);
        let same = sides.iter().find(|s| Some(s.0) == side).map(|s| s.1);
        let known = fresh.iter().rev().chain(self.known[self.regions[region].clone()].iter().rev());
        let reached = || {
            let mut known = known;
            known.find(|k| self.solid.reaches(k, p, distance)).map(|k| k.inside)
        };
        same.or_else(reached)
    }

    /// Asks for the winding number of an open point, and of some of the next ones that nothing else
    /// tells so far.
    fn ask(
        &mut self,
        n: usize,
        at: &[DVec3],
        out: &[f64],
        sides: &[(Side, bool)],
        fresh: &[Known],
    ) {
        let mut asked = vec![n];
        let region = self.open[n].region;
        for j in (n + 1..self.open.len()).take(AHEAD) {
            if asked.len() == OCTET {
                break;
            }
            let here = &self.open[j];
            let alike = |&k: &usize| {
                let other = &self.open[k];
                (other.region, other.side) == (here.region, here.side)
            };
            let (sides, fresh) =
                if here.region == region { (sides, fresh) } else { (&[][..], &[][..]) };
            let open = here.answer.is_none() && !asked.iter().any(alike);
            if open && self.told(j, at, out, sides, fresh).is_none() {
                asked.push(j);
            }
        }
        let points: Vec<DVec3> = asked.iter().map(|&j| at[self.open[j].point]).collect();
        let inside = self.solid.inside.which_raw(&points, u8::MAX);
        for (i, j) in asked.into_iter().enumerate() {
            let open = &mut self.open[j];
            open.answer = Some(out[open.point] > self.solid.touch && inside >> i & 1 == 1);
        }
    }
}

impl Solid {
    /// Whether the way from a known point to one at that distance from the surface cannot meet it.
    fn reaches(&self, known: &Known, p: DVec3, distance: f64) -> bool {
        let free = known.distance.max(distance) - self.blur - self.touch;
        free > 0.0 && known.at.distance_squared(p) < free * free
    }

    /// The face and the side of it on which a point lies, if all points there that are near each
    /// other have the same sign.
    fn side(&self, near: &Nearest) -> Option<Side> {
        let local = self.trust(near) == Trust::Local && near.distance > self.touch;
        (local && near.inside > 0.0).then_some((near.face, near.height < 0.0))
    }
}

/// A distance with its sign.
pub(super) fn signed(distance: f64, inside: bool) -> f64 {
    if inside { -distance } else { distance }
}
