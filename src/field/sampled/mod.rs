//! The sampled form of a field: bricks of samples, fine near the surface and coarser away from it,
//! so that a look-up costs the same whatever made the field.
//!
//! A leaf holds 9³ samples (its 8³ cells with their far faces) at a step of `2^level` fine steps. A
//! leaf of side S stands only where |f| > S / 2, so away from the surface the step is at most
//! a quarter of the distance. Between samples the value is trilinear; where leaves of two levels
//! meet, the finer one takes the coarser one's values on the common face, so the whole is
//! continuous.
//!
//! Leaves through which the surface may go are made at once, the rest when a value of theirs is asked
//! for: a hybrid asks for less than half of them. What the field promises over a leaf that is not
//! made bounds it, so bounds never depend on what was asked for before; and a leaf's samples are the
//! same whenever they are made, and by whichever thread.
//!
//! **Error.** For a signed distance (1-Lipschitz) a look-up differs from the field by at most
//! (√3/2) step of its leaf, on the fine level (√3/2) of the fine step; near a smooth surface of
//! radius of curvature R it is about step²/(4R).

mod build;
mod leaf;
mod octree;
mod range;

use super::{Field, Shared};
use crate::num::{Aabb, Interval};
use glam::{DVec3, IVec3};
use octree::Grid;
use range::Ranges;
use std::sync::OnceLock;

/// Cells along a side of a leaf.
const CELLS: i32 = 8;
/// Samples along a side of a leaf.
const SIDE: usize = 9;
/// Samples of a leaf.
const LEAF: usize = SIDE * SIDE * SIDE;

/// A block of samples.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    /// Low corner, in fine cells from the origin.
    corner: IVec3,
    /// The step is `2^level` fine steps.
    level: u32,
}

/// The samples of a leaf, x fastest.
type Samples = Box<[f32; LEAF]>;

/// A field turned into samples.
pub struct Sampled {
    /// What leaves are made of; gone when all are made.
    field: Option<Shared>,
    grid: Grid,
    inverse: f64,
    /// The sampled box.
    bounds: Aabb,
    /// Leaf-sized blocks of the fine level, x fastest: the leaf that holds each.
    table: Vec<u32>,
    table_size: IVec3,
    leaves: Vec<Leaf>,
    /// Of each leaf, once they are made.
    samples: Vec<OnceLock<Samples>>,
    ranges: Ranges,
    support: Aabb,
    volume: f64,
}

impl Sampled {
    /// Fine step, mm.
    pub fn step(&self) -> f64 {
        self.grid.step
    }

    /// Bytes that the leaves take which are made, and which are not.
    pub fn bytes(&self) -> (usize, usize) {
        let made = self.samples.iter().filter(|s| s.get().is_some()).count();
        (made * size_of::<[f32; LEAF]>(), (self.leaves.len() - made) * size_of::<[f32; LEAF]>())
    }

    /// Volume of the inside, mm³, counted from the samples (each cell by the share of its trilinear
    /// values below zero, to first order).
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The leaf at a position in fine cells, clamped into the table.
    fn leaf_at(&self, cell: IVec3) -> usize {
        let c = (cell.max(IVec3::ZERO) / CELLS).min(self.table_size - 1);
        let i = (c.z * self.table_size.y + c.y) * self.table_size.x + c.x;
        self.table[i as usize] as usize
    }

    /// Trilinear value inside the sampled box; `u` in fine steps from the origin.
    fn interpolate(&self, u: DVec3) -> f64 {
        let leaf = self.leaf_at(u.as_ivec3());
        self.interpolate_in(leaf, u)
    }

    fn interpolate_in(&self, leaf: usize, u: DVec3) -> f64 {
        let Leaf { corner, level } = self.leaves[leaf];
        let local = (u - corner.as_dvec3()) * (1.0 / f64::from(1u32 << level));
        // towards zero is down here, and no call
        let cell = local.as_ivec3().clamp(IVec3::ZERO, IVec3::splat(CELLS - 1));
        let f = local - cell.as_dvec3();
        let (i, j, k) = (cell.x as usize, cell.y as usize, cell.z as usize);
        let at = i + SIDE * (j + SIDE * k);
        let s = &self.samples(leaf)[at..at + SIDE * SIDE + SIDE + 2];
        let row = |o: usize| {
            let (a, b) = (f64::from(s[o]), f64::from(s[o + 1]));
            a + (b - a) * f.x
        };
        let (y0, y1) = (row(0), row(SIDE));
        let (y2, y3) = (row(SIDE * SIDE), row(SIDE * SIDE + SIDE));
        let (z0, z1) = (y0 + (y1 - y0) * f.y, y2 + (y3 - y2) * f.y);
        z0 + (z1 - z0) * f.z
    }
}

impl Field for Sampled {
    fn value(&self, p: DVec3) -> f64 {
        // outside the sampled box: the value at its side plus the way there, which keeps a
        // distance 1-Lipschitz
        let inside = self.bounds.clamp(p);
        self.interpolate((inside - self.grid.origin) * self.inverse) + (p - inside).length()
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let c = b.centre();
        let inside = Aabb::new(self.bounds.clamp(b.min), self.bounds.clamp(b.max));
        let (range, slope) = self.range(&inside);
        let away = b.corners().iter().map(|&p| self.bounds.distance(p)).fold(0.0, f64::max);
        let by_samples = Interval::new(range.lo, range.hi + away).widen(1e-9 * self.grid.step);
        if slope == f64::INFINITY {
            // a value may not be made only for a bound
            return by_samples;
        }
        // the trilinear form of a leaf changes by at most `slope` a mm, the way outside by 1
        let steep = if away > 0.0 { slope + 1.0 } else { slope };
        let by_slope = Interval::ball(self.value(c), steep * b.radius());
        by_samples.meet(by_slope.widen(1e-9 * self.grid.step))
    }

    fn support(&self) -> Aabb {
        self.support
    }
}

#[cfg(test)]
mod tests;
