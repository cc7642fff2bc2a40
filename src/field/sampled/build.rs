//! From a field to leaves.

use super::octree::{Grid, fill_table};
use super::range::{Ranges, crossed};
use super::{CELLS, SIDE, Sampled};
use crate::field::Shared;
use crate::job::{self, Cancelled, Job};
use crate::num::{Aabb, Interval};
use glam::{DVec3, IVec3};
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Levels at most: the coarsest leaf is 8 * 2^5 fine steps wide.
const LEVELS: u32 = 5;
/// Cells kept free round the support, so that the surface never lies on the side of the box.
const MARGIN: f64 = 4.0;

/// A field that takes more than so many times the memory of the leaves it would make later makes them at
/// once, and need not stay.
const KEPT: usize = 4;

impl Sampled {
    /// Samples `field` over its support at a fine step in mm.
    ///
    /// # Errors
    /// [`Cancelled`] when the job is.
    pub fn new(field: Shared, step: f64, job: &dyn Job) -> Result<Self, Cancelled> {
        let mut s = Self::blank(field, step, job)?;
        s.complete(job)?;
        s.ranges = Ranges::new(&s, &vec![Interval::ALL; s.leaves.len()]);
        s.volume = s.count_volume();
        Ok(s)
    }

    /// The same, but a leaf through which the surface does not go is sampled when a value of it is asked
    /// for; the field stays for that, unless it takes far more memory.
    ///
    /// # Errors
    /// [`Cancelled`] when the job is.
    pub fn on_demand(field: Shared, step: f64, job: &dyn Job) -> Result<Self, Cancelled> {
        let mut s = Self::blank(field.clone(), step, job)?;
        let mut promised = s.grid.promises(&*field, &s.leaves, job)?;
        let open = |&l: &usize| crossed(promised[l]);
        let crossed: Vec<usize> = (0..s.leaves.len()).filter(open).collect();
        s.make_all(&crossed, job)?;
        // joined to a coarser leaf, a leaf has the values of that one on the common face; those stand
        // first, and their neighbours are joined already
        for leaf in 0..promised.len() {
            let level = s.leaves[leaf].level;
            let coarser = s.beside(leaf).into_iter().filter(|&l| s.leaves[l].level > level);
            promised[leaf] = coarser.fold(promised[leaf], |own, l| own.hull(promised[l]));
        }
        s.ranges = Ranges::new(&s, &promised);
        s.volume = s.count_volume();
        if field.bytes() > KEPT * s.bytes().1 {
            s.complete(job)?;
        }
        Ok(s)
    }

    /// The leaves, not made yet.
    fn blank(field: Shared, step: f64, job: &dyn Job) -> Result<Self, Cancelled> {
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
        let leaves = grid.leaves(&*field, roots, top, job)?;
        let table_size = cells / CELLS;
        Ok(Self {
            field: Some(field),
            grid,
            inverse: 1.0 / step,
            bounds: Aabb::new(origin, origin + cells.as_dvec3() * step),
            table: fill_table(&leaves, table_size),
            table_size,
            samples: leaves.iter().map(|_| OnceLock::new()).collect(),
            leaves,
            ranges: Ranges::default(),
            support,
            volume: 0.0,
        })
    }

    /// Makes the leaves that are not made yet, and lets go of the field.
    fn complete(&mut self, job: &dyn Job) -> Result<(), Cancelled> {
        let all: Vec<usize> = (0..self.leaves.len()).collect();
        self.make_all(&all, job)?;
        self.field = None;
        Ok(())
    }

    /// The last ones first: they give the others their far faces.
    fn make_all(&self, leaves: &[usize], job: &dyn Job) -> Result<(), Cancelled> {
        let finished = AtomicUsize::new(0);
        leaves.par_iter().rev().try_for_each(|&leaf| {
            job::check(job)?;
            self.samples(leaf);
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            if n.is_multiple_of(64) {
                job.done(n as f64 / leaves.len() as f64);
            }
            Ok(())
        })
    }

    fn count_volume(&self) -> f64 {
        let cubes: Vec<f64> = (0..self.leaves.len())
            .into_par_iter()
            .map(|l| {
                let h = self.grid.step * f64::from(1u32 << self.leaves[l].level);
                let range = self.ranges.leaf(l);
                let all = f64::from(CELLS).powi(3) * h * h * h;
                if range.lo >= 0.0 {
                    return 0.0;
                }
                if range.hi < 0.0 {
                    return all;
                }
                let s = self.samples(l);
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
