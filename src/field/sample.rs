//! Sampling a field into sparse bricks without missing anything the dense samples would show.
//!
//! A sample is inside when its f32 value is below zero. Space is pruned by an octree of bounds,
//! from the whole lattice down to cubes of 4³ samples: a cube is skipped only if the field's bound
//! over the closed box of its cells (its own samples and the first ones of the next cubes)
//! excludes zero. So every lattice edge that changes sign starts in a cube that was evaluated. The
//! other samples of such cells are then evaluated too: the mesh is that of the dense samples, bit
//! for bit.
//!
//! The outermost samples of the lattice are outside whatever the field says, so that every mesh
//! is closed; [`SampleStats::border_clipped`] tells when that cut something off.

mod prune;
mod undecided;

#[cfg(test)]
pub(crate) mod shapes;
#[cfg(test)]
mod tests;

pub use undecided::{Undecided, undecided, undecided_at_most};

use super::Field;
use crate::grid::{BRICK, Brick, Bricks, Lattice};
use crate::job::{Cancelled, Job, check};
use glam::DVec3;
use prune::{CUBE, Cubes, Pruner, Side, Split, cube};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What [`sample`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// The samples. Those of a skipped cube in a brick that holds samples are infinite: only the
    /// sign is known there, and no cell with both signs has such a corner.
    pub bricks: Bricks<f32>,
    /// What they cost.
    pub stats: SampleStats,
}

/// The cost of a sampling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleStats {
    /// Points at which the field was evaluated.
    pub evaluated: u64,
    /// Bricks that hold samples.
    pub active_bricks: u64,
    /// Bricks of the lattice.
    pub bricks: u64,
    /// Whether an outermost sample was inside and was put outside.
    pub border_clipped: bool,
}

/// Samples the field where its surface may be, by an octree of bounds.
pub fn sample(f: &dyn Field, lattice: Lattice, job: &dyn Job) -> Result<Sampling, Cancelled> {
    job.stage("sample");
    let mut sampling = Sampling::outside(lattice);
    let Split { inside, active } = Pruner::new(f, &lattice).split(&sampling.bricks, job)?;
    for i in inside {
        sampling.bricks.bricks[i] = Brick::Inside;
    }
    sampling.fill(f, &active, job)?;
    let promoted = promoted(&sampling.bricks, &active, job)?;
    sampling.fill(f, &promoted, job)?;
    Ok(sampling)
}

/// Samples the field everywhere: the reference for [`sample`].
pub fn sample_dense(f: &dyn Field, lattice: Lattice, job: &dyn Job) -> Result<Sampling, Cancelled> {
    job.stage("sample");
    let mut sampling = Sampling::outside(lattice);
    let all: Vec<_> = (0..sampling.bricks.bricks.len()).map(|i| (i, [None; 8])).collect();
    sampling.fill(f, &all, job)?;
    Ok(sampling)
}

impl Sampling {
    fn outside(lattice: Lattice) -> Self {
        let bricks = Bricks::outside(lattice);
        let stats = SampleStats { bricks: bricks.bricks.len() as u64, ..SampleStats::default() };
        Self { bricks, stats }
    }

    /// Evaluates the open cubes of the listed bricks; the rest of a brick keeps what it holds, or
    /// gets the sign listed.
    fn fill(
        &mut self,
        f: &dyn Field,
        list: &[(usize, Cubes)],
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let finished = AtomicUsize::new(0);
        let evaluate = |&(i, ref cubes): &(usize, Cubes)| {
            check(job)?;
            let held = match self.bricks.bricks.get(i) {
                Some(Brick::Band(held)) => Some(&**held),
                _ => None,
            };
            let lo = self.bricks.place(i).map(|b| b * BRICK);
            let done = evaluate(f, &self.bricks.lattice, lo, cubes, held);
            let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
            if n.is_multiple_of(16) {
                job.done(n as f64 / list.len() as f64);
            }
            Ok((i, done))
        };
        let filled = list.par_iter().map(evaluate).collect::<Result<Vec<_>, _>>()?;
        for (i, (samples, clipped)) in filled {
            self.stats.border_clipped |= clipped;
            self.bricks.bricks[i] = Brick::Band(samples);
        }
        let open = |(_, cubes): &(usize, Cubes)| cubes.iter().filter(|c| c.is_none()).count();
        self.stats.evaluated += 64 * list.iter().map(open).sum::<usize>() as u64;
        self.stats.active_bricks = self.bricks.active() as u64;
        Ok(())
    }
}

/// Place of the n-th point of a brick: Morton order, so that every aligned run of 8, 64 or 512
/// points is a cube.
const MORTON: [[u8; 3]; 512] = {
    let mut order = [[0; 3]; 512];
    let mut n = 0;
    while n < 512 {
        let mut bit = 0;
        while bit < 9 {
            order[n][bit % 3] |= ((n >> bit & 1) as u8) << (bit / 3);
            bit += 1;
        }
        n += 1;
    }
    order
};

/// The samples of the brick that starts at sample `lo`, and whether the border clipped it.
fn evaluate(
    f: &dyn Field,
    lattice: &Lattice,
    lo: [u32; 3],
    cubes: &Cubes,
    held: Option<&[f32; 512]>,
) -> (Box<[f32; 512]>, bool) {
    let mut samples = Box::new(held.copied().unwrap_or([f32::INFINITY; 512]));
    let (mut order, mut at) = (Vec::with_capacity(512), Vec::with_capacity(512));
    for (cube, side) in MORTON.chunks_exact(64).zip(cubes) {
        match side {
            None => order.extend(cube.iter().map(|m| (*m, sample_of(lo, *m)))),
            Some(_) if held.is_some() => {}
            Some(side) => cube.iter().for_each(|m| samples[slot(*m)] = side.infinite()),
        }
    }
    at.extend(order.iter().map(|&(_, [i, j, k])| lattice.point(i, j, k)));
    let mut values = [0.0; 512];
    let values = &mut values[..at.len()];
    f.values(&at, values);
    let mut clipped = false;
    for ((m, at), &mut v) in order.into_iter().zip(values) {
        let mut v = stored(v);
        if on_border(lattice, at) {
            clipped |= v < 0.0 && at.iter().zip(lattice.size).all(|(&i, n)| i < n);
            v = v.max(border_value(lattice));
        }
        samples[slot(m)] = v;
    }
    (samples, clipped)
}

/// The sample at a place of the brick that starts at `lo`.
fn sample_of(lo: [u32; 3], place: [u8; 3]) -> [u32; 3] {
    std::array::from_fn(|a| lo[a].saturating_add(u32::from(place[a])))
}

/// Where a brick holds the sample at a place.
fn slot([i, j, k]: [u8; 3]) -> usize {
    usize::from(i) + 8 * usize::from(j) + 64 * usize::from(k)
}

/// A value as a sample: finite, so that crossings can be interpolated. What is no number is
/// outside.
fn stored(v: f64) -> f32 {
    const LARGEST: f64 = 1e30;
    if v.is_nan() { LARGEST as f32 } else { v.clamp(-LARGEST, LARGEST) as f32 }
}

/// The least value of an outermost sample.
fn border_value(lattice: &Lattice) -> f32 {
    (lattice.step * 1e-3) as f32
}

/// Whether a sample is outermost, or beyond.
fn on_border(lattice: &Lattice, at: [u32; 3]) -> bool {
    at.iter().zip(lattice.size).any(|(&i, n)| i == 0 || i.saturating_add(1) >= n)
}

/// Skipped cubes that a cell with both signs touches: the mesher reads their samples.
///
/// Only cells of open cubes hold both signs, and a cell lies in the closed box of the cube of its
/// lowest corner; so only cubes one step up from an open one can be needed, and no cube needs
/// another one in turn.
fn promoted(
    bricks: &Bricks<f32>,
    active: &[(usize, Cubes)],
    job: &dyn Job,
) -> Result<Vec<(usize, Cubes)>, Cancelled> {
    let touched = |(i, cubes): &(usize, Cubes)| {
        check(job)?;
        let lo = bricks.place(*i).map(|b| b * BRICK);
        let open = (0..8).filter(|&n| cubes[n].is_none());
        Ok(open.flat_map(|n| touched(bricks, cube(lo, n))).collect::<Vec<_>>())
    };
    let lists = active.par_iter().map(touched).collect::<Result<Vec<_>, Cancelled>>()?;
    let mut all: BTreeMap<usize, Cubes> = BTreeMap::new();
    for ([x, y, z], side) in lists.into_iter().flatten() {
        let brick = bricks.index([x, y, z].map(|i| i / BRICK));
        let n = [x, y, z].iter().rev().fold(0, |n, i| 2 * n + (i / CUBE % 2) as usize);
        all.entry(brick).or_insert([Some(side); 8])[n] = None;
    }
    Ok(all.into_iter().collect())
}

/// The first samples and the signs of skipped cubes that a cell with both signs, of the cube that
/// starts at sample `lo`, touches.
fn touched(bricks: &Bricks<f32>, lo: [u32; 3]) -> Vec<([u32; 3], Side)> {
    let mut found = Vec::new();
    for n in 1..8 {
        let next = cube(lo, n);
        let first = bricks.sample(next.map(i64::from), f32::NEG_INFINITY, f32::INFINITY);
        if first.is_finite() || (0..3).any(|a| next[a] >= bricks.lattice.size[a]) {
            continue;
        }
        // the corners of all cells that touch `next`; one that differs makes a mixed cell
        let range = |a: usize| {
            let hi = (lo[a] + CUBE + 1).min(bricks.lattice.size[a]);
            if next[a] > lo[a] { next[a] - 1..hi } else { lo[a]..hi }
        };
        let mut row = [0.0; CUBE as usize + 1];
        let row = &mut row[..range(0).len()];
        let mut mixed = |j: u32, k: u32| {
            let from = [range(0).start, j, k].map(i64::from);
            bricks.row(from, -1.0, 1.0, row);
            row.iter().any(|&v| side(v) != side(first))
        };
        if range(2).any(|k| range(1).any(|j| mixed(j, k))) {
            found.push((next, side(first)));
        }
    }
    found
}

/// The samples from `lo` to `hi`, both included, as a box.
fn region(lattice: &Lattice, lo: [u32; 3], hi: [u32; 3]) -> crate::num::Aabb {
    let corner = |[i, j, k]: [u32; 3]| -> DVec3 { lattice.point(i, j, k) };
    crate::num::Aabb::new(corner(lo), corner(hi))
}

impl Side {
    /// What stands for a sample of which only the sign is known.
    fn infinite(self) -> f32 {
        match self {
            Side::Inside => f32::NEG_INFINITY,
            Side::Outside => f32::INFINITY,
        }
    }
}

/// The sign a sample has.
fn side(v: f32) -> Side {
    if v < 0.0 { Side::Inside } else { Side::Outside }
}
