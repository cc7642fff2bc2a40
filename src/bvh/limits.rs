//! What can be nearest to some point of a small box, told from the middle of the box alone.
//!
//! Let T* be the triangle nearest to the middle c, at distance D* with unit vector g* from its foot
//! to c, and K any convex thing at distance D with unit vector g. Distance from K is convex, so at
//! c + d it is at least D + g.d; distance from T* is at most that from its foot,
//! |D* g* + d| <= D* + g*.d + |d|²/2D*. Hence K can be nearest somewhere in the box of half size h
//! and radius r only if
//!
//! > D - D* <= sum_a h_a |g*_a - g_a| + r²/2D*,
//!
//! which leaves few where the surface is far and smooth. Near the surface the last term is large;
//! there distances tell: D <= r + the greatest distance of a point of the box.

use super::triangle::{LANES, Way};
use fearless_simd::{Simd, f64x8, prelude::*};
use glam::DVec3;

/// Distances from T* in radii of the box below which the second order says nothing.
const NEAR: f64 = 0.25;
/// More than a product of any two lengths.
const FAR: f64 = 1e100;

/// The nearest thing to the middle of a box.
#[derive(Clone, Copy)]
pub(super) struct Star {
    /// Squared distance, mm².
    pub length2: f64,
    /// The way from its foot to the middle, mm.
    pub along: [f64; 3],
}

impl Star {
    pub(super) const NONE: Self = Self { length2: f64::INFINITY, along: [0.0; 3] };

    /// The nearest of eight, and its lane, if it is nearer than what is known.
    #[inline(always)]
    pub(super) fn take<S: Simd>(&mut self, way: &Way<S>) -> Option<usize> {
        let length2: [f64; LANES] = way.length2.into();
        let mut best = None;
        for (lane, length2) in length2.into_iter().enumerate() {
            if length2 < self.length2 {
                self.length2 = length2;
                best = Some(lane);
            }
        }
        if let Some(lane) = best {
            self.along = way.along.map(|a| a[lane]);
        }
        best
    }
}

/// A box of points.
#[derive(Clone, Copy)]
pub(super) struct Small {
    /// Half its size, and half its diagonal, mm.
    pub half: DVec3,
    pub radius: f64,
    /// Round-off of a distance there, mm.
    pub slack: f64,
}

/// What is known of a box whose points are at most `edge` from the surface.
#[derive(Clone, Copy)]
pub(super) struct Limit {
    /// Squared distance from the box beyond which nothing is nearest to a point of it.
    pub edge2: f64,
    /// The same from its middle.
    reach2: f64,
    /// D* with what the second order and round-off add.
    most: f64,
    /// g*.
    towards: [f64; 3],
    half: DVec3,
}

impl Limit {
    /// That of no points.
    pub(super) const NOTHING: Self = Self {
        edge2: f64::NEG_INFINITY,
        reach2: f64::NEG_INFINITY,
        most: FAR,
        towards: [0.0; 3],
        half: DVec3::ZERO,
    };

    #[inline(always)]
    pub(super) fn new(of: &Small, star: &Star, edge: f64) -> Self {
        let Small { half, radius, slack } = *of;
        let edge = edge + slack;
        let reach = edge + radius + 2.0 * slack;
        let far = star.length2.sqrt();
        // a foot that is off by sqrt(2 D slack) turns g by sqrt(2 slack / D)
        let turn = 1e-6 + 8.0 * (slack / far).sqrt();
        let more = radius * (0.5 * radius / far + turn) + 8.0 * slack;
        let useful = far > NEAR * radius && far < 1e-10 * FAR;
        Self {
            // an empty lane is infinitely far, and is not looked at even so
            edge2: (edge * edge).min(f64::MAX),
            reach2: (reach * reach).min(f64::MAX),
            most: if useful { far + more } else { FAR },
            towards: if useful { star.along.map(|w| w / far) } else { [0.0; 3] },
            half,
        }
    }
}

/// Limits in lanes: of one box in all of them, or of eight.
pub(super) struct Limits<S: Simd> {
    reach2: f64x8<S>,
    most: f64x8<S>,
    towards: [f64x8<S>; 3],
    half: [f64x8<S>; 3],
}

impl<S: Simd> Limits<S> {
    #[inline(always)]
    pub(super) fn one(s: S, limit: &Limit) -> Self {
        let all = |v| f64x8::splat(s, v);
        let Limit { reach2, most, towards: t, half: h, .. } = *limit;
        Self {
            reach2: all(reach2),
            most: all(most),
            towards: [all(t[0]), all(t[1]), all(t[2])],
            half: [all(h.x), all(h.y), all(h.z)],
        }
    }

    #[inline(always)]
    pub(super) fn each(s: S, limits: &[Limit; LANES]) -> Self {
        let (mut reach2, mut most) = ([0.0; LANES], [0.0; LANES]);
        let (mut towards, mut half) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, limit) in limits.iter().enumerate() {
            (reach2[lane], most[lane]) = (limit.reach2, limit.most);
            for a in 0..3 {
                (towards[a][lane], half[a][lane]) = (limit.towards[a], limit.half[a]);
            }
        }
        let lanes = |v| f64x8::simd_from(s, v);
        let three = |[x, y, z]: [[f64; LANES]; 3]| [lanes(x), lanes(y), lanes(z)];
        Self {
            reach2: lanes(reach2),
            most: lanes(most),
            towards: three(towards),
            half: three(half),
        }
    }

    /// In which lanes the thing can be nearest to one of the points, by the way from it to the middle.
    /// Multiplied by D, which may be zero.
    #[inline(always)]
    pub(super) fn can_win(&self, way: &Way<S>) -> u64 {
        let d = way.length2.sqrt();
        let [x, y, z] = way.along;
        let turn = (d * self.towards[0] - x).abs() * self.half[0]
            + (d * self.towards[1] - y).abs() * self.half[1]
            + (d * self.towards[2] - z).abs() * self.half[2];
        let near = way.length2.simd_le(self.reach2).to_bitmask();
        near & (way.length2 - d * self.most).simd_le(turn).to_bitmask()
    }
}
