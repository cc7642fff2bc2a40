//! The signed distance to the surface of what is solid.

use super::buried::{Surface, Trust};
use super::inside::Inside;
use crate::bvh::{Bvh, Hit, Nearest, Winding};
use crate::num::{Aabb, Interval};
use glam::DVec3;
use std::sync::Arc;

/// Points whose signs are found together.
const RUN: usize = OCTET * OCTET;
/// And where they are not the same all over.
const OCTET: usize = Winding::LANES;

/// The surface of a solid, and where it is inside.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    surface: Arc<Bvh>,
    /// For each surface triangle, when its sides tell.
    trust: Vec<Trust>,
    /// What is not in `surface` although the sign may change there.
    ghosts: Bvh,
    /// Culled, but perhaps within `blur` of a kept one.
    culled: Bvh,
    inside: Inside,
    /// Nearer than this a point is on the surface, mm.
    touch: f64,
    /// How far the faces that were taken for surface may be from where the sign changes, mm.
    blur: f64,
}

/// A point whose sign is known.
#[derive(Clone, Copy)]
struct Known {
    at: DVec3,
    distance: f64,
    inside: bool,
}

/// The ball round some points in which their feet are looked for: twice as wide as their box.
fn ball(at: &[DVec3]) -> (DVec3, f64) {
    let run = Aabb::of(at.iter().copied());
    (run.centre(), 2.0 * run.radius())
}

fn signed(distance: f64, inside: bool) -> f64 {
    if inside { -distance } else { distance }
}

impl Solid {
    /// `all` is the tree over all faces, which serves where they are the surface as they are.
    pub(super) fn new(surface: Surface, inside: Inside, blur: f64, all: Arc<Bvh>) -> Self {
        let touch = 1e-12 * inside.bounds().size().length();
        let Surface { whole, triangles, trust, ghosts, culled, .. } = surface;
        let rest = || rayon::join(|| Bvh::new(&ghosts), || Bvh::new(&culled));
        let own = || if whole { all } else { Arc::new(Bvh::new(&triangles)) };
        let (surface, (ghosts, culled)) = rayon::join(own, rest);
        Self { surface, trust, ghosts, culled, inside, touch, blur }
    }

    /// The box outside which nothing is inside.
    pub(super) fn support(&self) -> Aabb {
        *self.inside.bounds()
    }

    /// In which of up to eight balls the sign changes nowhere but at the surface (and at the box), a
    /// bit for each.
    fn which_sharp(&self, balls: &[(DVec3, f64)]) -> u8 {
        let clear = |&(centre, radius): &(DVec3, f64)| {
            self.ghosts.nearest_within(centre, radius + self.blur).is_none()
        };
        let clear = balls.iter().map(clear).enumerate();
        let clear = clear.fold(0u8, |bits, (i, yes)| bits | u8::from(yes) << i);
        if clear == 0 { 0 } else { clear & self.inside.which_sharp(balls) }
    }

    /// Whether the nearest face alone tells that `p` is inside.
    fn by_face(&self, near: &Nearest) -> Option<bool> {
        if near.distance <= self.touch {
            return Some(false);
        }
        let Trust::Within(margin) = self.trust(near) else {
            return None;
        };
        let hidden = || margin > 0.0 && self.culled.nearest_within(near.point, self.blur).is_some();
        (near.inside > margin && !hidden()).then_some(near.height < 0.0)
    }

    fn trust(&self, near: &Nearest) -> Trust {
        self.trust.get(near.face as usize).copied().unwrap_or(Trust::Never)
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        let Some(near) = self.surface.nearest(p) else {
            return f64::INFINITY;
        };
        let inside = self.inside.bounds().contains(p) && self.raw(p, &near);
        signed(near.distance, inside)
    }

    /// Inside by winding number, or by the nearest face where that is known to agree.
    fn raw(&self, p: DVec3, near: &Nearest) -> bool {
        if near.distance <= self.touch {
            return false;
        }
        let face = if self.inside.is_closed() { self.by_face(near) } else { None };
        face.unwrap_or_else(|| self.inside.raw(p))
    }

    pub(super) fn values(&self, at: &[DVec3], out: &mut [f64]) {
        let hits = self.surface.nearest_all(at);
        // with closed shells the way from one run to the next holds no surprise either
        let reach = self.inside.is_closed() && self.ghosts.is_empty();
        let mut known = Vec::with_capacity(RUN + 1);
        let eight = RUN * OCTET;
        for ((at, hits), out) in at.chunks(eight).zip(hits.chunks(eight)).zip(out.chunks_mut(eight))
        {
            let balls: Vec<_> = at.chunks(RUN).map(ball).collect();
            let sharp = self.which_sharp(&balls);
            let runs = at.chunks(RUN).zip(hits.chunks(RUN)).zip(out.chunks_mut(RUN));
            for (i, ((at, hits), out)) in runs.enumerate() {
                let last = known.pop().filter(|_| reach);
                known.clear();
                known.extend(last);
                if sharp >> i & 1 == 1 {
                    self.spread(at, hits, balls[i], &mut known, out);
                } else {
                    self.octets(at, hits, &mut known, out);
                }
            }
        }
    }

    /// Values of a run whose sign is not sharp: by octets, together where those are.
    fn octets(&self, at: &[DVec3], hits: &[Hit], known: &mut Vec<Known>, out: &mut [f64]) {
        let balls: Vec<_> = at.chunks(OCTET).map(ball).collect();
        let sharp = if balls.len() > 1 { self.which_sharp(&balls) } else { 0 };
        let octets = at.chunks(OCTET).zip(hits.chunks(OCTET)).zip(out.chunks_mut(OCTET));
        for (i, ((at, hits), out)) in octets.enumerate() {
            known.clear();
            if sharp >> i & 1 == 1 {
                self.spread(at, hits, balls[i], known, out);
                continue;
            }
            let inside = self.inside.which(at);
            for (i, (hit, f)) in hits.iter().zip(out).enumerate() {
                let distance = hit.distance2.sqrt();
                *f = signed(distance, distance > self.touch && inside >> i & 1 == 1);
            }
        }
    }

    /// Signs of a run in a ball in which only faces part inside from outside: by the nearest face; else
    /// from a point already known, where the way from it is shorter than the distance of either
    /// to the surface; else by winding number.
    fn spread(
        &self,
        at: &[DVec3],
        hits: &[Hit],
        (centre, radius): (DVec3, f64),
        known: &mut Vec<Known>,
        out: &mut [f64],
    ) {
        let mut open = vec![];
        for (i, ((&p, hit), f)) in at.iter().zip(hits).zip(out.iter_mut()).enumerate() {
            let distance = hit.distance2.sqrt();
            *f = distance;
            if !self.inside.bounds().contains(p) {
                continue;
            }
            // most points lie in the free ball of the one before
            if let Some(inside) =
                known.last().filter(|k| self.reaches(k, p, distance)).map(|k| k.inside)
            {
                *f = signed(distance, inside);
                known.push(Known { at: p, distance, inside });
                continue;
            }
            // the way to the foot must lie in the ball that is known to be sharp
            let near = self
                .surface
                .nearest_of(p, hit)
                .filter(|near| self.inside.is_closed() || near.point.distance(centre) <= radius);
            match near.and_then(|near| self.by_face(&near)) {
                Some(inside) => {
                    *f = signed(distance, inside);
                    known.push(Known { at: p, distance, inside });
                }
                None => open.push((i, near.and_then(|near| self.side(&near)))),
            }
        }
        let mut sides: Vec<((u32, bool), bool)> = vec![];
        // by winding number: one that must be asked for brings the next ones with it
        let (mut first, mut asked, mut answers) = (0, 0, 0u8);
        for (n, &(i, side)) in open.iter().enumerate() {
            let (p, distance) = (at[i], out[i]);
            let same = || sides.iter().find(|s| Some(s.0) == side).map(|s| s.1);
            let reached =
                || known.iter().rev().find(|k| self.reaches(k, p, distance)).map(|k| k.inside);
            let inside = same().or_else(reached).unwrap_or_else(|| {
                if n >= asked {
                    let next: Vec<DVec3> = open[n..].iter().take(OCTET).map(|o| at[o.0]).collect();
                    (asked, answers) = (n + next.len(), self.inside.which_raw(&next, u8::MAX));
                    first = n;
                }
                distance > self.touch && answers >> (n - first) & 1 == 1
            });
            out[i] = signed(distance, inside);
            known.push(Known { at: p, distance, inside });
            sides.extend(side.map(|side| (side, inside)));
        }
    }

    /// Whether the way from a known point to one at that distance from the surface cannot meet it.
    fn reaches(&self, known: &Known, p: DVec3, distance: f64) -> bool {
        known.at.distance(p) < known.distance.max(distance) - self.blur - self.touch
    }

    /// The face and the side of it on which a point lies, if all points there that are near each
    /// other have the same sign.
    fn side(&self, near: &Nearest) -> Option<(u32, bool)> {
        let local = self.trust(near) == Trust::Local && near.distance > self.touch;
        (local && near.inside > 0.0).then_some((near.face, near.height < 0.0))
    }

    pub(super) fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        for (boxes, out) in boxes.chunks(OCTET).zip(out.chunks_mut(OCTET)) {
            self.bounds_of_eight(boxes, out);
        }
    }

    fn bounds_of_eight(&self, boxes: &[Aabb], out: &mut [Interval]) {
        let near: Vec<_> = boxes.iter().map(|b| self.surface.nearest(b.centre())).collect();
        // boxes whose sign has to be known: for those of closed shells all, else where it is sharp
        let whole = self.inside.is_closed();
        let mut asked = vec![];
        for (i, (b, near)) in boxes.iter().zip(&near).enumerate() {
            let Some(near) = near else {
                continue;
            };
            let there = !self.inside.bounds().meet(*b).is_empty();
            let free = whole || near.distance > b.radius() + self.blur;
            if there && free {
                asked.push((i, b.centre(), b.radius()));
            }
        }
        if !whole {
            let balls: Vec<_> = asked.iter().map(|a| (a.1, a.2)).collect();
            let mut sharp = self.which_sharp(&balls);
            asked.retain(|_| (sharp & 1 == 1, sharp >>= 1).0);
        }
        let centres: Vec<DVec3> = asked.iter().map(|a| a.1).collect();
        let sides = self.sides(&centres, asked.iter().map(|a| near[a.0].as_ref()));
        for (i, (b, out)) in boxes.iter().zip(out).enumerate() {
            let (centre, radius) = (b.centre(), b.radius());
            *out = Interval::ALL;
            let Some(near) = near[i].filter(|_| radius.is_finite()) else {
                continue;
            };
            let d = near.distance;
            let round_off = self.touch + 1e-12 * centre.abs().max_element();
            let inside = asked.iter().position(|a| a.0 == i).map(|n| sides >> n & 1 == 1);
            let range = match inside {
                _ if self.inside.bounds().meet(*b).is_empty() => {
                    Interval::new((d - radius).max(0.0), d + radius)
                }
                Some(inside) if whole => Interval::ball(signed(d, inside), radius + self.blur),
                Some(inside) if !inside || self.holds(b) => {
                    Interval::ball(signed(d, inside), radius)
                }
                _ => Interval::ball(0.0, d + radius),
            };
            *out = range.widen(round_off);
        }
    }

    /// Which of up to eight points are inside, a bit for each.
    fn sides<'a>(&self, at: &[DVec3], near: impl Iterator<Item = Option<&'a Nearest>>) -> u8 {
        let (mut sides, mut rest) = (0, 0);
        for (i, (&p, near)) in at.iter().zip(near).enumerate() {
            let there = self.inside.bounds().contains(p);
            let face = near.filter(|_| self.inside.is_closed()).and_then(|n| self.by_face(n));
            match face {
                _ if !there => {}
                Some(inside) => sides |= u8::from(inside) << i,
                None => rest |= 1 << i,
            }
        }
        if rest == 0 { sides } else { sides | self.inside.which_raw(at, rest) }
    }

    fn holds(&self, b: &Aabb) -> bool {
        self.inside.bounds().contains(b.min) && self.inside.bounds().contains(b.max)
    }
}
