//! From a field to leaves: the octree, the samples, the common faces.

use super::range::Ranges;
use super::{CELLS, LEAF, Leaf, SIDE, Sampled};
use crate::field::Field;
use crate::job::{self, Cancelled, Job};
use crate::num::Aabb;
use glam::{DVec3, IVec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A leaf stands where |f| exceeds this share of its side. Smaller: coarse leaves reach the
/// surface's neighbourhood and averages of two fields show their facets; larger: the fine level
/// takes several times the memory (1.0 doubles the leaves of a chair).
const STAND_OFF: f64 = 0.5;
/// Levels at most: the coarsest leaf is 8 * 2^5 fine steps wide.
const LEVELS: u32 = 5;
/// Cells kept free round the support, so that the surface never lies on the side of the box.
const MARGIN: f64 = 4.0;

impl Sampled {
    /// Samples `field` over its support at a fine step in mm.
    ///
    /// # Errors
    /// [`Cancelled`] when the job is.
    pub fn new(field: &dyn Field, step: f64, job: &dyn Job) -> Result<Self, Cancelled> {
        let support = field.support();
        let domain = support.grow(MARGIN * step);
        // round up to whole coarsest leaves that are not much wider than the shape
        let fine = (domain.size() / step).ceil().max(DVec3::ONE);
        let mut top = 0;
        while top < LEVELS && f64::from(CELLS << (top + 1)) <= fine.max_element() * 0.5 {
            top += 1;
        }
        let root = CELLS << top;
        let roots = (fine / f64::from(root)).ceil().as_ivec3().max(IVec3::ONE);
        let cells = roots * root;
        let origin = domain.centre() - cells.as_dvec3() * (step * 0.5);
        let grid = Grid { origin, step };
        let leaves = grid.leaves(field, roots, top, job)?;
        let table_size = cells / CELLS;
        let table = fill_table(&leaves, table_size);
        let mut s = Self {
            origin,
            step,
            inverse: 1.0 / step,
            bounds: Aabb::new(origin, origin + cells.as_dvec3() * step),
            table,
            table_size,
            leaves,
            data: Vec::new(),
            ranges: Ranges::default(),
            support,
            volume: 0.0,
        };
        s.data = grid.cores(field, &s.leaves, job)?;
        s.fill_far_faces(&grid, field, job)?;
        s.join_levels(top);
        s.ranges = Ranges::new(&s);
        s.volume = s.count_volume();
        Ok(s)
    }

    /// Fills the samples of the far faces: from the neighbour that has them in its core, else from
    /// the field.
    fn fill_far_faces(
        &mut self,
        grid: &Grid,
        field: &dyn Field,
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let far = &near_order()[CORE..];
        for first in (0..self.leaves.len()).step_by(AT_ONCE) {
            let some = first..(first + AT_ONCE).min(self.leaves.len());
            let fill = |leaf| self.far_faces(leaf, far, grid, field, job);
            let faces: Vec<Vec<(usize, f32)>> =
                some.into_par_iter().map(fill).collect::<Result<_, Cancelled>>()?;
            for (leaf, faces) in (first..).zip(faces) {
                for (n, f) in faces {
                    self.data[leaf * LEAF + n] = f;
                }
            }
        }
        Ok(())
    }

    /// The samples of a leaf's far faces.
    fn far_faces(
        &self,
        leaf: usize,
        far: &[usize],
        grid: &Grid,
        field: &dyn Field,
        job: &dyn Job,
    ) -> Result<Vec<(usize, f32)>, Cancelled> {
        job::check(job)?;
        let Leaf { corner, level } = self.leaves[leaf];
        let (mut found, mut asked, mut at) = (Vec::with_capacity(far.len()), vec![], vec![]);
        for &n in far {
            let cell = corner + place(n) * (1 << level);
            let other = self.leaf_at(cell);
            let from = cell - self.leaves[other].corner;
            let outside = (cell.cmpge(self.table_size * CELLS)).any();
            if !outside && self.leaves[other].level == level {
                let o = from.map(|x| x >> level).as_usizevec3();
                found.push((n, self.data[other * LEAF + o.x + SIDE * (o.y + SIDE * o.z)]));
            } else {
                asked.push(n);
                at.push(grid.point(cell));
            }
        }
        let mut out = vec![0.0; at.len()];
        field.values(&at, &mut out);
        found.extend(asked.into_iter().zip(out).map(|(n, f)| (n, f as f32)));
        Ok(found)
    }

    /// Gives fine leaves the values of coarser neighbours on common faces, coarsest first.
    fn join_levels(&mut self, top: u32) {
        for level in (0..top).rev() {
            let todo: Vec<usize> =
                (0..self.leaves.len()).filter(|&l| self.leaves[l].level == level).collect();
            let fixes: Vec<Vec<(usize, f32)>> =
                todo.par_iter().map(|&leaf| self.coarser_on_faces(leaf)).collect();
            for (at, value) in fixes.into_iter().flatten() {
                self.data[at] = value;
            }
        }
    }

    /// Sample index and new value, for each sample on a face shared with a coarser leaf.
    fn coarser_on_faces(&self, leaf: usize) -> Vec<(usize, f32)> {
        let Leaf { corner, level } = self.leaves[leaf];
        let side = CELLS << level;
        let coarse_near = (-1..=1).any(|z| {
            (-1..=1).any(|y| {
                (-1..=1).any(|x| {
                    let probe = corner + side / 2 + IVec3::new(x, y, z) * side;
                    self.leaves[self.leaf_at(probe)].level > level
                })
            })
        });
        let mut out = Vec::new();
        if !coarse_near {
            return out;
        }
        for n in 0..LEAF {
            let ijk = place(n);
            let on_face = ijk.cmpeq(IVec3::ZERO) | ijk.cmpeq(IVec3::splat(CELLS));
            if !on_face.any() {
                continue;
            }
            let u = corner + ijk * (1 << level);
            let coarsest = (0..8)
                .map(|o| {
                    let back = IVec3::new(o & 1, o >> 1 & 1, o >> 2 & 1);
                    self.leaf_at(u - back)
                })
                .max_by_key(|&l| self.leaves[l].level)
                .unwrap_or(leaf);
            if self.leaves[coarsest].level > level {
                let v = self.interpolate_in(coarsest, u.as_dvec3());
                out.push((leaf * LEAF + n, v as f32));
            }
        }
        out
    }

    fn count_volume(&self) -> f64 {
        let cubes: Vec<f64> = (0..self.leaves.len())
            .into_par_iter()
            .map(|l| {
                let h = self.step * f64::from(1u32 << self.leaves[l].level);
                let s = &self.data[l * LEAF..(l + 1) * LEAF];
                if self.ranges.leaf(l).lo >= 0.0 {
                    return 0.0;
                }
                let mut cells = 0.0;
                for k in 0..SIDE - 1 {
                    for j in 0..SIDE - 1 {
                        for i in 0..SIDE - 1 {
                            cells += inside_share(s, i + SIDE * (j + SIDE * k));
                        }
                    }
                }
                cells * h * h * h
            })
            .collect();
        cubes.iter().sum()
    }
}

/// Share of a cell that is inside, from its corner values: exact for a plane across an axis, within
/// a few per cent for others, unbiased over a surface.
fn inside_share(s: &[f32], at: usize) -> f64 {
    let v = [0, 1, 9, 10, 81, 82, 90, 91].map(|o| f64::from(s[at + o]));
    let (neg, all) = v.iter().fold((0.0, 0.0), |(n, a), &x| (n + (-x).max(0.0), a + x.abs()));
    if all > 0.0 { neg / all } else { 0.0 }
}

/// Where samples lie.
struct Grid {
    origin: DVec3,
    step: f64,
}

impl Grid {
    fn point(&self, cell: IVec3) -> DVec3 {
        self.origin + cell.as_dvec3() * self.step
    }

    /// The octree's leaves in a fixed order.
    fn leaves(
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
            let split: Vec<bool> =
                open.par_iter().map(|l| level > 0 && self.must_split(field, l)).collect();
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

    fn must_split(&self, field: &dyn Field, leaf: &Leaf) -> bool {
        let side = CELLS << leaf.level;
        let b = Aabb::new(self.point(leaf.corner), self.point(leaf.corner + side));
        let f = field.bound(&b);
        let keep = STAND_OFF * self.step * f64::from(side);
        f.lo < keep && f.hi > -keep
    }

    /// The 8³ near samples of every leaf; its far faces stay zero.
    fn cores(
        &self,
        field: &dyn Field,
        leaves: &[Leaf],
        job: &dyn Job,
    ) -> Result<Vec<f32>, Cancelled> {
        let order = &near_order()[..CORE];
        let mut data = vec![0f32; leaves.len() * LEAF];
        let finished = AtomicUsize::new(0);
        data.par_chunks_mut(LEAF).zip(leaves).try_for_each_init(
            || (vec![DVec3::ZERO; CORE], vec![0.0; CORE]),
            |(at, out), (samples, leaf)| {
                job::check(job)?;
                for (p, &n) in at.iter_mut().zip(order) {
                    *p = self.point(leaf.corner + place(n) * (1 << leaf.level));
                }
                field.values(at, out);
                for (&f, &n) in out.iter().zip(order) {
                    samples[n] = f as f32;
                }
                let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
                if n.is_multiple_of(64) {
                    job.done(n as f64 / leaves.len() as f64);
                }
                Ok(())
            },
        )?;
        Ok(data)
    }
}

/// Leaves whose far faces are held at once, beside the samples: a face sample takes four times the
/// memory here.
const AT_ONCE: usize = 1024;

/// Samples of a leaf without its far faces.
const CORE: usize = (SIDE - 1) * (SIDE - 1) * (SIDE - 1);

/// Sample `n` of a leaf as (i, j, k).
fn place(n: usize) -> IVec3 {
    IVec3::new((n % SIDE) as i32, (n / SIDE % SIDE) as i32, (n / (SIDE * SIDE)) as i32)
}

/// Sample indices so that runs of 8, 64 and 512 are cubes; the far faces come last.
fn near_order() -> Vec<usize> {
    let spread = |x: usize| (x & 1) | (x & 2) << 2 | (x & 4) << 4;
    let mut order: Vec<usize> = (0..LEAF).collect();
    order.sort_by_key(|&n| {
        let (i, j, k) = (n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE));
        let far = [i, j, k].map(|x| usize::from(x == SIDE - 1));
        let clamped = [i, j, k].map(|x| x.min(SIDE - 2));
        let z = spread(clamped[0]) | spread(clamped[1]) << 1 | spread(clamped[2]) << 2;
        (far[0] | far[1] << 1 | far[2] << 2, z)
    });
    order
}

fn fill_table(leaves: &[Leaf], size: IVec3) -> Vec<u32> {
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
