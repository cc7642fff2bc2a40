//! From a field to leaves: the octree, the samples, the common faces.

use super::range::Ranges;
use super::{CELLS, LEAF, Leaf, SIDE, Sampled};
use crate::field::Field;
use crate::job::{self, Cancelled, Job};
use crate::num::{Aabb, Interval};
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

    /// Fills the samples of the far faces: from the neighbours that have them in their cores; on the
    /// sides of the box from the field.
    fn fill_far_faces(
        &mut self,
        grid: &Grid,
        field: &dyn Field,
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let far = far_blocks();
        let mut faces = vec![0f32; (LEAF - CORE) * AT_ONCE.min(self.leaves.len())];
        for first in (0..self.leaves.len()).step_by(AT_ONCE) {
            let some = first..(first + AT_ONCE).min(self.leaves.len());
            let faces = &mut faces[..(LEAF - CORE) * some.len()];
            let fill = |(leaf, faces): (usize, &mut [f32])| {
                job::check(job)?;
                self.far_faces(leaf, &far, grid, field, faces);
                Ok(())
            };
            let leaves = some.clone().into_par_iter();
            leaves.zip(faces.par_chunks_mut(LEAF - CORE)).try_for_each(fill)?;
            let data = &mut self.data[some.start * LEAF..some.end * LEAF];
            let each = data.par_chunks_mut(LEAF).zip(faces.par_chunks(LEAF - CORE));
            each.for_each(|(samples, faces)| {
                for (&(n, _), &f) in far.iter().flat_map(|b| &b.samples).zip(faces) {
                    samples[n] = f;
                }
            });
        }
        Ok(())
    }

    /// The samples of a leaf's far faces, in the order of `far`.
    fn far_faces(
        &self,
        leaf: usize,
        far: &[Block],
        grid: &Grid,
        field: &dyn Field,
        mut faces: &mut [f32],
    ) {
        let Leaf { corner, level } = self.leaves[leaf];
        let (mut at, mut out) = (Vec::new(), Vec::new());
        for Block { shift, samples } in far {
            let (here, rest) = faces.split_at_mut(samples.len());
            faces = rest;
            let cell = corner + shift * (CELLS << level);
            let beside = self.leaves[self.leaf_at(cell)].level;
            let cells = samples.iter().map(|&(n, _)| corner + place(n) * (1 << level));
            if cell.cmpge(self.table_size * CELLS).any() {
                at.clear();
                at.extend(cells.map(|c| grid.point(c)));
                out.resize(at.len(), 0.0);
                field.values(&at, &mut out);
                here.iter_mut().zip(&out).for_each(|(f, &v)| *f = v as f32);
            } else if beside == level {
                let core = self.samples(self.leaf_at(cell));
                here.iter_mut().zip(samples).for_each(|(f, &(_, o))| *f = core[o]);
            } else if beside < level {
                here.iter_mut().zip(cells).for_each(|(f, cell)| *f = self.near_sample(cell));
            }
            // a coarser one gives its values when levels are joined
        }
    }

    /// The sample at a cell's low corner, which must be one of its leaf's core.
    fn near_sample(&self, cell: IVec3) -> f32 {
        let leaf = self.leaf_at(cell);
        let Leaf { corner, level } = self.leaves[leaf];
        let o = (cell - corner).map(|x| x >> level).as_usizevec3();
        self.samples(leaf)[o.x + SIDE * (o.y + SIDE * o.z)]
    }

    fn samples(&self, leaf: usize) -> &[f32] {
        &self.data[leaf * LEAF..(leaf + 1) * LEAF]
    }

    /// Gives fine leaves the values of coarser neighbours on common faces, coarsest first.
    fn join_levels(&mut self, top: u32) {
        let sides = side_blocks();
        for level in (0..top).rev() {
            let fix = |(leaf, l): (usize, &Leaf)| match l.level == level {
                true => self.coarser_on_faces(leaf, &sides),
                false => Vec::new(),
            };
            let fixes: Vec<Vec<(usize, f32)>> =
                self.leaves.par_iter().enumerate().map(|(leaf, l)| fix((leaf, l))).collect();
            self.data.par_chunks_mut(LEAF).zip(fixes).for_each(|(samples, fixes)| {
                fixes.into_iter().for_each(|(n, value)| samples[n] = value);
            });
        }
    }

    /// Sample index and new value, for each sample on a face shared with a coarser leaf.
    fn coarser_on_faces(&self, leaf: usize, sides: &[Block]) -> Vec<(usize, f32)> {
        let Leaf { corner, level } = self.leaves[leaf];
        let side = CELLS << level;
        // a coarser leaf beside this one fills all of a block of its size
        let near: [usize; 27] = std::array::from_fn(|n| {
            let n = n as i32;
            let shift = IVec3::new(n % 3, n / 3 % 3, n / 9) - 1;
            self.leaf_at(corner + side / 2 + shift * side)
        });
        let mut out = Vec::new();
        if near.iter().all(|&l| self.leaves[l].level <= level) {
            return out;
        }
        for Block { shift, samples } in sides {
            // the blocks that meet in these samples
            let meet = (0..8).map(|o| {
                let back = IVec3::new(o & 1, o >> 1 & 1, o >> 2 & 1);
                let at = (shift.max(IVec3::ZERO) - back * shift.abs()) + 1;
                near[(at.x + 3 * (at.y + 3 * at.z)) as usize]
            });
            let coarsest = meet.max_by_key(|&l| self.leaves[l].level).unwrap_or(leaf);
            if self.leaves[coarsest].level > level {
                out.extend(samples.iter().map(|&(n, _)| {
                    let u = corner + place(n) * (1 << level);
                    (n, self.interpolate_in(coarsest, u.as_dvec3()) as f32)
                }));
            }
        }
        out
    }

    fn count_volume(&self) -> f64 {
        let cubes: Vec<f64> = (0..self.leaves.len())
            .into_par_iter()
            .map(|l| {
                let h = self.step * f64::from(1u32 << self.leaves[l].level);
                let s = self.samples(l);
                let range = self.ranges.leaf(l);
                let all = f64::from(CELLS).powi(3) * h * h * h;
                if range.lo >= 0.0 {
                    return 0.0;
                }
                if range.hi < 0.0 {
                    return all;
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
        let region =
            |l: &Leaf| Aabb::new(self.point(l.corner), self.point(l.corner + (CELLS << l.level)));
        let boxes: Vec<Aabb> = leaves.iter().map(region).collect();
        let mut bounds = vec![Interval::ALL; boxes.len()];
        field.bounds(&boxes, &mut bounds);
        let near = |(l, f): (&Leaf, Interval)| {
            let keep = STAND_OFF * self.step * f64::from(CELLS << l.level);
            f.lo < keep && f.hi > -keep
        };
        leaves.iter().zip(bounds).map(near).collect()
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

/// Leaves whose far faces are held at once, beside the samples.
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

/// Samples of a leaf that it shares with the same other leaves.
struct Block {
    /// Along each axis on the near side (-1), on neither (0), or on the far side (1).
    shift: IVec3,
    /// Each with its place in the leaf on the other side of the far faces it lies on.
    samples: Vec<(usize, usize)>,
}

impl Block {
    /// Puts samples into blocks by where they lie.
    fn all(samples: &[usize], shift: impl Fn(IVec3) -> IVec3) -> Vec<Self> {
        let mut blocks: Vec<Self> = Vec::new();
        for &n in samples {
            let ijk = place(n);
            let o = ijk.map(|x| x % CELLS).as_usizevec3();
            let (shift, one) = (shift(ijk), (n, o.x + SIDE * (o.y + SIDE * o.z)));
            match blocks.iter_mut().find(|b| b.shift == shift) {
                Some(block) => block.samples.push(one),
                None => blocks.push(Self { shift, samples: vec![one] }),
            }
        }
        blocks
    }
}

/// The samples of the far faces by the neighbour that has them in its core.
fn far_blocks() -> Vec<Block> {
    Block::all(&near_order()[CORE..], |ijk| ijk / CELLS)
}

/// The samples on faces by the neighbours that have them too.
fn side_blocks() -> Vec<Block> {
    let on_face = |&n: &usize| place(n).to_array().iter().any(|x| x % CELLS == 0);
    let samples: Vec<usize> = (0..LEAF).filter(on_face).collect();
    Block::all(&samples, |ijk| ijk / CELLS - ijk.map(|x| i32::from(x == 0)))
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
