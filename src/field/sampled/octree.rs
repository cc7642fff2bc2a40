//! The octree of leaves, and what the field promises over each.

use super::{CELLS, Leaf};
use crate::field::Field;
use crate::job::{self, Cancelled, Job};
use crate::num::{Aabb, Interval};
use glam::{DVec3, IVec3};
use rayon::prelude::*;

/// A leaf stands where |f| exceeds this share of its side. Smaller: coarse leaves reach the
/// surface's neighbourhood and averages of two fields show their facets; larger: the fine level
/// takes several times the memory (1.0 doubles the leaves of a chair).
const STAND_OFF: f64 = 0.5;
/// Leaves whose bounds are asked for together.
const RUN: usize = 64;

/// Where samples lie.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    /// mm.
    pub origin: DVec3,
    /// Of the fine level, mm.
    pub step: f64,
}

impl Grid {
    pub fn point(&self, cell: IVec3) -> DVec3 {
        self.origin + cell.as_dvec3() * self.step
    }

    /// The octree's leaves in a fixed order.
    pub fn leaves(
        &self,
        field: &dyn Field,
        roots: IVec3,
        top: u32,
        job: &dyn Job,
    ) -> Result<Vec<Leaf>, Cancelled> {
        let mut open: Vec<Leaf> = Vec::new();
        for z in 0..roots.z {
            for y in 0..roots.y {
                for x in 0..roots.x {
                    open.push(Leaf { corner: IVec3::new(x, y, z) * (CELLS << top), level: top });
                }
            }
        }
        let mut done = Vec::new();
        for level in (0..=top).rev() {
            job::check(job)?;
            let split = |some: &[Leaf]| match level {
                0 => vec![false; some.len()],
                _ => self.must_split(field, some),
            };
            let split: Vec<bool> = open.par_chunks(8).flat_map_iter(split).collect();
            let mut next = Vec::new();
            for (leaf, split) in open.into_iter().zip(split) {
                if !split {
                    done.push(leaf);
                    continue;
                }
                let half = CELLS << (level - 1);
                for o in 0..8 {
                    let shift = IVec3::new(o & 1, o >> 1 & 1, o >> 2 & 1) * half;
                    next.push(Leaf { corner: leaf.corner + shift, level: level - 1 });
                }
            }
            open = next;
        }
        Ok(done)
    }

    /// Which leaves, neighbours mostly, are too near to the surface.
    fn must_split(&self, field: &dyn Field, leaves: &[Leaf]) -> Vec<bool> {
        let near = |(l, f): (&Leaf, Interval)| {
            let keep = STAND_OFF * self.step * f64::from(CELLS << l.level);
            f.lo < keep && f.hi > -keep
        };
        leaves.iter().zip(self.promised(field, leaves)).map(near).collect()
    }

    /// What the field promises over each leaf.
    pub fn promises(
        &self,
        field: &dyn Field,
        leaves: &[Leaf],
        job: &dyn Job,
    ) -> Result<Vec<Interval>, Cancelled> {
        let promised = |leaves: &[Leaf]| {
            job::check(job)?;
            Ok(self.promised(field, leaves))
        };
        let all = leaves.par_chunks(RUN).map(promised).collect::<Result<Vec<_>, Cancelled>>()?;
        Ok(all.concat())
    }

    fn promised(&self, field: &dyn Field, leaves: &[Leaf]) -> Vec<Interval> {
        let boxes: Vec<Aabb> = leaves.iter().map(|l| self.region(l)).collect();
        let mut out = vec![Interval::ALL; boxes.len()];
        field.bounds(&boxes, &mut out);
        out
    }

    fn region(&self, leaf: &Leaf) -> Aabb {
        let side = CELLS << leaf.level;
        Aabb::new(self.point(leaf.corner), self.point(leaf.corner + side))
    }
}

/// Leaf-sized blocks of the fine level, x fastest: the leaf that holds each.
pub(super) fn fill_table(leaves: &[Leaf], size: IVec3) -> Vec<u32> {
    let mut table = vec![0u32; (size.x * size.y * size.z) as usize];
    for (n, leaf) in leaves.iter().enumerate() {
        let (low, wide) = (leaf.corner / CELLS, 1 << leaf.level);
        for z in low.z..low.z + wide {
            for y in low.y..low.y + wide {
                let row = ((z * size.y + y) * size.x + low.x) as usize;
                table[row..row + wide as usize].fill(n as u32);
            }
        }
    }
    table
}
