//! The winding number by a tree of dipoles: Barill, Dickson, Schmidt, Levin and Jacobson 2018,
//! "Fast winding numbers for soups and clouds", with the expansion carried to the third order.

mod dipole;
mod lanes;

use super::Bvh;
use super::triangle::LANES;
use crate::num::Aabb;
use dipole::{Dipole, dipoles};
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use std::sync::Arc;

/// A box of triangles is seen as one dipole from farther than this many of its radii: at first, where
/// only the side of a level matters, and where the number does.
const COARSE: f64 = 1.25;
const ROUGH: f64 = 2.0;
/// How near the level in question the tree's answer is not trusted, and the wider opening used
/// then: in the end the sum over all triangles decides. Third order is off by up to .003 on a ball at 2
/// radii, and on fifteen chairs by up to .09 at 1.25 and .013 at 2.
const REFINE: [(f64, f64); 4] = [(0.3, ROUGH), (0.02, 6.0), (3e-4, 20.0), (2e-6, f64::INFINITY)];

/// The generalised winding number of oriented triangles: 1 inside one closed shell whose faces are
/// counter-clockwise seen from outside, 0 outside; sums over shells, fractions near open rims.
///
/// Up to eight points are asked for together; what a point gets does not depend on the others.
#[derive(Clone, Debug)]
pub struct Winding {
    bvh: Arc<Bvh>,
    dipoles: Vec<Dipole>,
}

impl Winding {
    /// Points that [`Winding::numbers`] and [`Winding::roughly`] take at once.
    pub const LANES: usize = LANES;

    /// The tree over oriented triangles with finite coordinates.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let bvh = Arc::new(Bvh::bare(triangles));
        let dipoles = dipoles(&bvh);
        Self { bvh, dipoles }
    }

    /// The same, and the tree for other queries.
    pub fn with_tree(triangles: &[[DVec3; 3]]) -> (Self, Arc<Bvh>) {
        let mut bvh = Bvh::bare(triangles);
        let (dipoles, lanes) = rayon::join(|| dipoles(&bvh), || bvh.lanes());
        (bvh.tris, bvh.wide) = lanes;
        let bvh = Arc::new(bvh);
        (Self { bvh: bvh.clone(), dipoles }, bvh)
    }

    /// Lets go of what only distances need, where nobody else has the tree.
    pub fn forget_distances(&mut self) {
        if let Some(bvh) = Arc::get_mut(&mut self.bvh) {
            (bvh.tris, bvh.wide) = Default::default();
        }
    }

    /// Whether there are no triangles, so that the winding number is 0 everywhere.
    pub fn is_empty(&self) -> bool {
        self.bvh.is_empty()
    }

    /// Memory that it takes, bytes; beside a tree that another may have too.
    pub fn bytes(&self, other: &Arc<Bvh>) -> usize {
        let own = if Arc::ptr_eq(&self.bvh, other) { 0 } else { self.bvh.bytes() };
        own + size_of_val(&self.dipoles[..])
    }

    /// The box round the triangles.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// The winding number at `q`, on the right side of `level`.
    pub fn number(&self, q: DVec3, level: f64) -> f64 {
        self.numbers(&[q], [level; LANES])[0]
    }

    /// The winding numbers at up to eight points, each on the right side of its level: the tree's
    /// answer, recomputed the more exactly the nearer it comes to that level; far from it off by a
    /// tenth at worst. Lanes without a point are 0.
    pub fn numbers(&self, at: &[DVec3], levels: [f64; LANES]) -> [f64; LANES] {
        self.numbers_of(at, all(at), levels)
    }

    /// The same of the points whose bit is set in `of`; the others are 0.
    pub fn numbers_of(&self, at: &[DVec3], of: u8, levels: [f64; LANES]) -> [f64; LANES] {
        self.both_of(at, of, levels)[1]
    }

    /// What [`Winding::coarsely_of`] and [`Winding::numbers_of`] answer, for no more than the latter.
    pub fn both_of(&self, at: &[DVec3], of: u8, levels: [f64; LANES]) -> [[f64; LANES]; 2] {
        let stack = &mut Vec::with_capacity(64);
        let mut open = of & all(at);
        let near = |w: &[f64; LANES], open: u8, reach: f64| {
            let doubtful = |i: &usize| open >> i & 1 == 1 && (w[*i] - levels[*i]).abs() < reach;
            (0..LANES).filter(doubtful).fold(0u8, |bits, i| bits | 1 << i)
        };
        let coarse = self.coarsely_of(at, open);
        let mut w = coarse;
        for (reach, beta) in REFINE {
            open = near(&w, open, reach);
            if open == 0 {
                break;
            }
            self.tree(at, beta, open, stack, &mut w);
        }
        [coarse, w]
    }

    /// The winding numbers of those of up to eight points whose bit is set in `of`, off by a tenth at
    /// worst; the others are 0.
    pub fn coarsely_of(&self, at: &[DVec3], of: u8) -> [f64; LANES] {
        let mut w = [0.0; LANES];
        self.tree(at, COARSE, of & all(at), &mut Vec::with_capacity(64), &mut w);
        w
    }

    /// The winding numbers at up to eight points as the tree has them at once, off by some
    /// hundredths at worst. Lanes without a point are 0.
    pub fn roughly(&self, at: &[DVec3]) -> [f64; LANES] {
        self.roughly_of(at, u8::MAX)
    }

    /// The same of the points whose bit is set in `of`; the others are 0.
    pub fn roughly_of(&self, at: &[DVec3], of: u8) -> [f64; LANES] {
        let mut w = [0.0; LANES];
        self.tree(at, ROUGH, of & all(at), &mut Vec::with_capacity(64), &mut w);
        w
    }

    /// The winding number as the sum over all triangles.
    pub fn exact(&self, q: DVec3) -> f64 {
        let mut w = [0.0; LANES];
        self.tree(&[q], f64::INFINITY, 1, &mut Vec::with_capacity(64), &mut w);
        w[0]
    }

    /// Answers for the points whose bit is set in `open`, with boxes opened within `beta` radii.
    fn tree(
        &self,
        at: &[DVec3],
        beta: f64,
        open: u8,
        stack: &mut Vec<(u32, u8)>,
        out: &mut [f64; LANES],
    ) {
        dispatch!(Level::new(), s => self.walk(s, at, beta, open, stack, out));
    }
}

/// A bit for each point.
fn all(at: &[DVec3]) -> u8 {
    u8::MAX.checked_shr((LANES - at.len().min(LANES)) as u32).unwrap_or(0)
}
