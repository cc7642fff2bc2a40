//! The signed distance to the surface of what is solid.

use super::buried::{Surface, Trust};
use super::inside::Inside;
use super::signs::{Signs, signed};
use crate::bvh::{Bvh, Nearest, Winding};
use crate::num::{Aabb, Interval};
use glam::DVec3;
use std::sync::Arc;

/// Points, or boxes, that are looked at together.
pub(super) const OCTET: usize = Winding::LANES;

/// The surface of a solid, and where it is inside.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub(super) surface: Arc<Bvh>,
    /// For each surface triangle, when its sides tell.
    trust: Vec<Trust>,
    /// What is not in `surface` although the sign may change there.
    pub(super) ghosts: Bvh,
    /// Culled, but perhaps within `blur` of a kept one.
    culled: Bvh,
    pub(super) inside: Inside,
    /// Nearer than this a point is on the surface, mm.
    pub(super) touch: f64,
    /// How far the faces that were taken for surface may be from where the sign changes, mm.
    pub(super) blur: f64,
}

impl Solid {
    /// `all` is the tree over all faces, which serves where they are the surface as they are.
    pub(super) fn new(surface: Surface, mut inside: Inside, blur: f64, all: Arc<Bvh>) -> Self {
        let touch = 1e-12 * inside.bounds().size().length();
        let Surface { whole, triangles, trust, ghosts, culled, .. } = surface;
        let rest = || rayon::join(|| Bvh::new(&ghosts), || Bvh::new(&culled));
        let all = whole.then_some(all);
        if all.is_none() {
            inside.forget_distances();
        }
        let own = || all.unwrap_or_else(|| Arc::new(Bvh::new(&triangles)));
        let (surface, (ghosts, culled)) = rayon::join(own, rest);
        Self { surface, trust, ghosts, culled, inside, touch, blur }
    }

    /// Memory that it takes, bytes.
    pub(super) fn bytes(&self) -> usize {
        let trees = [&*self.surface, &self.ghosts, &self.culled].map(Bvh::bytes);
        trees.iter().sum::<usize>()
            + self.inside.bytes(&self.surface)
            + size_of_val(&self.trust[..])
    }

    /// The box outside which nothing is inside.
    pub(super) fn support(&self) -> Aabb {
        *self.inside.bounds()
    }

    /// In which of up to eight balls the sign changes nowhere but at the surface (and at the box), a
    /// bit for each.
    pub(super) fn which_sharp(&self, balls: &[(DVec3, f64)]) -> u8 {
        let clear = |&(centre, radius): &(DVec3, f64)| {
            self.ghosts.nearest_within(centre, radius + self.blur).is_none()
        };
        let clear = balls.iter().map(clear).enumerate();
        let clear = clear.fold(0u8, |bits, (i, yes)| bits | u8::from(yes) << i);
        if clear == 0 { 0 } else { clear & self.inside.which_sharp(balls) }
    }

    /// Whether the nearest face alone tells that `p` is inside.
    pub(super) fn by_face(&self, near: &Nearest) -> Option<bool> {
        if near.distance <= self.touch {
            return Some(false);
        }
        let Trust::Within(margin) = self.trust(near) else {
            return None;
        };
        let hidden = || margin > 0.0 && self.culled.nearest_within(near.point, self.blur).is_some();
        (near.inside > margin && !hidden()).then_some(near.height < 0.0)
    }

    pub(super) fn trust(&self, near: &Nearest) -> Trust {
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
        Signs::new(self).find(at, &self.surface.nearest_all(at), out);
    }

    pub(super) fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        for (boxes, out) in boxes.chunks(OCTET).zip(out.chunks_mut(OCTET)) {
            self.bounds_of_eight(boxes, out);
        }
    }

    fn bounds_of_eight(&self, boxes: &[Aabb], out: &mut [Interval]) {
        let middles: Vec<DVec3> = boxes.iter().map(Aabb::centre).collect();
        let hits = self.surface.nearest_all(&middles);
        let near = middles.iter().zip(&hits).map(|(&p, hit)| self.surface.nearest_of(p, hit));
        let near: Vec<Option<Nearest>> = near.collect();
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
