//! Inside or outside, by winding numbers.

use crate::bvh::{Bvh, Rim, Winding};
use crate::num::Aabb;
use glam::DVec3;
use std::sync::Arc;

/// What the tree's rough winding number is off by at most, with room, and how far the coarse one is from
/// that.
const ROUGH_ERROR: f64 = 0.05;
const COARSE_ERROR: f64 = 0.15;

/// Where a mesh is solid. Closed shells count first: with w1 their winding number, rounded, and
/// w2 that of the open shells, a point is inside where w1 >= 1 or w1 + w2 >= 1/2, and never
/// outside the box round all faces. So an open sheet cannot hollow a closed solid, and what a
/// sheet seems to enclose ends at the box.
#[derive(Clone, Debug)]
pub(super) struct Inside {
    closed: Winding,
    open: Winding,
    rim: Rim,
    bounds: Aabb,
}

impl Inside {
    /// From the faces of closed and of open shells and the rims of the latter.
    pub(super) fn new(
        closed: &[[DVec3; 3]],
        open: &[[DVec3; 3]],
        rim: &[([DVec3; 2], u32)],
    ) -> Self {
        let (closed, open) = rayon::join(|| Winding::new(closed), || Winding::new(open));
        Self::of(closed, open, rim)
    }

    /// From all faces, which are either those of closed shells or those of open ones, with the tree over
    /// them.
    pub(super) fn over(
        all: &[[DVec3; 3]],
        rim: &[([DVec3; 2], u32)],
        closed: bool,
    ) -> (Self, Arc<Bvh>) {
        let ((all, tree), none) = (Winding::with_tree(all), Winding::new(&[]));
        let inside = if closed { Self::of(all, none, rim) } else { Self::of(none, all, rim) };
        (inside, tree)
    }

    fn of(closed: Winding, open: Winding, rim: &[([DVec3; 2], u32)]) -> Self {
        let bounds = closed.bounds().hull(open.bounds());
        Self { closed, open, rim: Rim::new(rim), bounds }
    }

    /// Memory that it takes, bytes; beside the tree of the surface.
    pub(super) fn bytes(&self, surface: &Arc<Bvh>) -> usize {
        self.closed.bytes(surface) + self.open.bytes(surface) + self.rim.bytes()
    }

    /// Lets go of what only distances need, where nobody else has the trees.
    pub(super) fn forget_distances(&mut self) {
        self.closed.forget_distances();
        self.open.forget_distances();
    }

    /// The box round all faces; everything outside it is outside.
    pub(super) fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Whether all shells are closed, so that only faces part inside from outside.
    pub(super) fn is_closed(&self) -> bool {
        self.open.is_empty()
    }

    /// Whether `p` is inside.
    pub(super) fn at(&self, p: DVec3) -> bool {
        self.bounds.contains(p) && self.raw(p)
    }

    /// Which of up to eight points are inside, a bit for each.
    pub(super) fn which(&self, at: &[DVec3]) -> u8 {
        let there = which(at, |_, p| self.bounds.contains(p));
        self.which_raw(at, there)
    }

    /// Whether `p` is inside by winding numbers alone.
    pub(super) fn raw(&self, p: DVec3) -> bool {
        self.which_raw(&[p], 1) != 0
    }

    /// Which of up to eight points, of those whose bit is set in `of`, are inside by winding numbers
    /// alone. Each gets the answer that it gets alone.
    pub(super) fn which_raw(&self, at: &[DVec3], of: u8) -> u8 {
        self.which_and_seen(at, of).0
    }

    /// The same, and what of the open shells' winding numbers came up on the way.
    fn which_and_seen(&self, at: &[DVec3], of: u8) -> (u8, Seen) {
        let bounds = self.closed.bounds();
        let near = of & which(at, |_, p| bounds.contains(p));
        let mut closed = [0.0; Winding::LANES];
        if near != 0 {
            let numbers = self.closed.numbers_of(at, near, [0.5; Winding::LANES]);
            closed = numbers.map(f64::round);
        }
        let solid = of & which(at, |i, _| closed[i] >= 1.0);
        let rest = of & !solid;
        if rest == 0 || self.open.is_empty() {
            return (solid, Seen::default());
        }
        let levels = closed.map(|closed| 0.5 - closed);
        let [numbers, open] = self.open.both_of(at, rest, levels);
        (solid | rest & which(at, |i, _| open[i] >= levels[i]), Seen { of: rest, numbers })
    }

    /// Which of up to eight points are inside, a bit for each; and for which of those that have a radius
    /// the ball round them is sharp, see [`Inside::which_sharp`].
    pub(super) fn which_and_sharp(&self, at: &[DVec3], radii: &[Option<f64>]) -> (u8, u8) {
        let there = which(at, |_, p| self.bounds.contains(p));
        let (inside, seen) = self.which_and_seen(at, there);
        (inside, self.sharp_of(at, radii, seen))
    }

    /// The winding numbers of the open shells at up to eight points, roughly.
    pub(super) fn open_numbers(&self, at: &[DVec3]) -> [f64; Winding::LANES] {
        self.open.roughly(at)
    }

    /// For which of up to eight balls only faces part inside from outside in them (before the cut at the
    /// box), a bit for each: the winding number's smooth part, which the rims make, stays off one half.
    pub(super) fn which_sharp(&self, balls: &[(DVec3, f64)]) -> u8 {
        let centres: Vec<DVec3> = balls.iter().map(|b| b.0).collect();
        let radii: Vec<_> = balls.iter().map(|b| Some(b.1)).collect();
        self.sharp_of(&centres, &radii, Seen::default())
    }

    /// The same of those points that have a radius.
    fn sharp_of(&self, at: &[DVec3], radii: &[Option<f64>], seen: Seen) -> u8 {
        let asked = which(at, |i, _| radii[i].is_some());
        if self.open.is_empty() {
            return asked;
        }
        let most = 0.5 - ROUGH_ERROR;
        let radius = |i: usize| radii.get(i).copied().flatten().unwrap_or(0.0);
        let balls: Vec<(DVec3, f64)> = (0..).map(radius).zip(at).map(|(r, &p)| (p, r)).collect();
        let allowed = std::array::from_fn(|i| most / radius(i));
        let rates = self.rim.variations(&balls, asked, allowed);
        let changes: [f64; Winding::LANES] = std::array::from_fn(|i| rates[i] * radius(i));
        let open = asked & which(at, |i, _| changes[i] < most);
        let rest = open & !seen.of;
        let more = if rest == 0 { seen.numbers } else { self.open.coarsely_of(at, rest) };
        // how far it stays off one half, with a number that is `room` better than it needs to be
        let off = |i: usize, number: f64, room: f64| {
            let part = (number - 0.5).rem_euclid(1.0);
            changes[i] + ROUGH_ERROR + room < part.min(1.0 - part)
        };
        let coarse = |i: usize| if seen.of >> i & 1 == 1 { seen.numbers[i] } else { more[i] };
        let sharp = open & which(at, |i, _| off(i, coarse(i), COARSE_ERROR));
        let doubt = open & !sharp & which(at, |i, _| off(i, coarse(i), -COARSE_ERROR));
        if doubt == 0 {
            return sharp;
        }
        let rough = self.open.roughly_of(at, doubt);
        sharp | doubt & which(at, |i, _| off(i, rough[i], 0.0))
    }
}

/// Winding numbers of the open shells at some of eight points, coarsely.
#[derive(Default)]
struct Seen {
    /// A bit for each point whose number is known.
    of: u8,
    numbers: [f64; Winding::LANES],
}

/// The bits of the points for which something holds.
fn which(at: &[DVec3], holds: impl Fn(usize, DVec3) -> bool) -> u8 {
    let bits = at.iter().enumerate().filter(|&(i, &p)| holds(i, p));
    bits.fold(0, |bits, (i, _)| bits | 1 << i)
}
