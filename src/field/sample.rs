//! Sampling a field into sparse bricks without missing anything the dense samples would show.
//!
//! A sample is inside when its f32 value is below zero. A brick is skipped only if the field's
//! bound over the closed box of its cells (its own samples and the first ones of the next bricks)
//! excludes zero. So every lattice edge that changes sign starts in a brick that holds samples,
//! and [`crate::field::Field`]s with an honest bound give the same mesh sparse as dense, bit for
//! bit.
//!
//! The outermost samples of the lattice are outside whatever the field says, so that every mesh
//! is closed; [`SampleStats::border_clipped`] tells when that cut something off.

mod prune;
mod undecided;

#[cfg(test)]
pub(crate) mod shapes;
#[cfg(test)]
mod tests;

pub use undecided::{Undecided, undecided};

use super::Field;
use crate::grid::{BRICK, Brick, Bricks, Lattice};
use crate::job::{Cancelled, Job, check};
use glam::DVec3;
use prune::{Pruner, Side, Split};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What [`sample`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// The samples.
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

/// Samples the field where its surface may be, by an octree of bounds from the whole lattice down
/// to bricks.
pub fn sample(f: &dyn Field, lattice: Lattice, job: &dyn Job) -> Result<Sampling, Cancelled> {
    job.stage("sample");
    let mut bricks = Bricks::outside(lattice);
    let Split { inside, active } = Pruner::new(f, &lattice).split(&bricks, job)?;
    for i in inside {
        bricks.bricks[i] = Brick::Inside;
    }
    let mut clipped = fill(f, &mut bricks, &active, job)?;
    let promoted = promoted(&bricks, &active, job)?;
    clipped |= fill(f, &mut bricks, &promoted, job)?;
    Ok(finish(bricks, clipped))
}

/// Samples the field everywhere: the reference for [`sample`].
pub fn sample_dense(f: &dyn Field, lattice: Lattice, job: &dyn Job) -> Result<Sampling, Cancelled> {
    job.stage("sample");
    let mut bricks = Bricks::outside(lattice);
    let all: Vec<usize> = (0..bricks.bricks.len()).collect();
    let clipped = fill(f, &mut bricks, &all, job)?;
    Ok(finish(bricks, clipped))
}

fn finish(bricks: Bricks<f32>, border_clipped: bool) -> Sampling {
    let active_bricks = bricks.active() as u64;
    let stats = SampleStats {
        evaluated: 512 * active_bricks,
        active_bricks,
        bricks: bricks.bricks.len() as u64,
        border_clipped,
    };
    Sampling { bricks, stats }
}

/// Evaluates the listed bricks; whether the border clipped one of them.
fn fill(
    f: &dyn Field,
    bricks: &mut Bricks<f32>,
    list: &[usize],
    job: &dyn Job,
) -> Result<bool, Cancelled> {
    let finished = AtomicUsize::new(0);
    let evaluate = |&i: &usize| {
        check(job)?;
        let done = evaluate(f, &bricks.lattice, bricks.place(i).map(|b| b * BRICK));
        let n = finished.fetch_add(1, Ordering::Relaxed) + 1;
        if n % 16 == 0 {
            job.done(n as f64 / list.len() as f64);
        }
        Ok(done)
    };
    let filled = list
        .par_iter()
        .map(evaluate)
        .collect::<Result<Vec<_>, _>>()?;
    let mut clipped = false;
    for (&i, (samples, cut)) in list.iter().zip(filled) {
        bricks.bricks[i] = Brick::Band(samples);
        clipped |= cut;
    }
    Ok(clipped)
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
fn evaluate(f: &dyn Field, lattice: &Lattice, lo: [u32; 3]) -> (Box<[f32; 512]>, bool) {
    let at = MORTON.map(|m| {
        let [i, j, k]: [u32; 3] = std::array::from_fn(|a| lo[a].saturating_add(u32::from(m[a])));
        lattice.point(i, j, k)
    });
    let mut values = [0.0; 512];
    f.values(&at, &mut values);
    let mut samples = Box::new([0.0; 512]);
    let mut clipped = false;
    for (m, v) in MORTON.iter().zip(values) {
        let slot = &mut samples[m.iter().rev().fold(0, |n, &x| 8 * n + usize::from(x))];
        *slot = stored(v);
        let at: [u32; 3] = std::array::from_fn(|a| lo[a].saturating_add(u32::from(m[a])));
        if on_border(lattice, at) {
            clipped |= *slot < 0.0 && at.iter().zip(lattice.size).all(|(&i, n)| i < n);
            *slot = slot.max(border_value(lattice));
        }
    }
    (samples, clipped)
}

/// A value as a sample: finite, so that crossings can be interpolated. What is no number is
/// outside.
fn stored(v: f64) -> f32 {
    const LARGEST: f64 = 1e30;
    if v.is_nan() {
        LARGEST as f32
    } else {
        v.clamp(-LARGEST, LARGEST) as f32
    }
}

/// The least value of an outermost sample.
fn border_value(lattice: &Lattice) -> f32 {
    (lattice.step * 1e-3) as f32
}

/// Whether a sample is outermost, or beyond.
fn on_border(lattice: &Lattice, at: [u32; 3]) -> bool {
    at.iter()
        .zip(lattice.size)
        .any(|(&i, n)| i == 0 || i.saturating_add(1) >= n)
}

/// Skipped bricks that a cell with both signs touches: the mesher reads their samples.
///
/// Only cells of active bricks hold both signs, and a cell lies in the closed box of the brick of
/// its lowest corner; so only bricks one step up from an active one can be needed, and no brick
/// needs another one in turn.
fn promoted(
    bricks: &Bricks<f32>,
    active: &[usize],
    job: &dyn Job,
) -> Result<Vec<usize>, Cancelled> {
    let touched = |&i: &usize| {
        check(job)?;
        Ok(touched(bricks, bricks.place(i)))
    };
    let lists = active
        .par_iter()
        .map(touched)
        .collect::<Result<Vec<_>, Cancelled>>()?;
    let mut all: Vec<usize> = lists.into_iter().flatten().collect();
    all.sort_unstable();
    all.dedup();
    Ok(all)
}

/// Skipped bricks that a cell of brick `b` with both signs touches.
fn touched(bricks: &Bricks<f32>, b: [u32; 3]) -> Vec<usize> {
    let mut found = Vec::new();
    for step in 1..8u32 {
        let d: [u32; 3] = std::array::from_fn(|a| step >> a & 1);
        let next: [u32; 3] = std::array::from_fn(|a| b[a] + d[a]);
        let inside = match bricks.brick(next) {
            Some(Brick::Inside) => true,
            Some(Brick::Outside) => false,
            _ => continue,
        };
        // the corners of all cells of `b` that touch `next`; one that differs makes a mixed cell
        let range = |a: usize| {
            let lo = b[a] * BRICK;
            lo + 7 * d[a]..(lo + 9).min(bricks.lattice.size[a])
        };
        let mixed = range(2).any(|k| {
            range(1).any(|j| {
                let mut row = [0.0; 9];
                let (x, len) = (range(0).start, range(0).len());
                let from = [i64::from(x), i64::from(j), i64::from(k)];
                bricks.row(from, -1.0, 1.0, &mut row[..len]);
                row[..len].iter().any(|&v| (v < 0.0) != inside)
            })
        });
        if mixed {
            found.push(bricks.index(next));
        }
    }
    found
}

/// The samples from `lo` to `hi`, both included, as a box.
fn region(lattice: &Lattice, lo: [u32; 3], hi: [u32; 3]) -> crate::num::Aabb {
    let corner = |[i, j, k]: [u32; 3]| -> DVec3 { lattice.point(i, j, k) };
    crate::num::Aabb::new(corner(lo), corner(hi))
}

/// The sign a sample has.
fn side(v: f32) -> Side {
    if v < 0.0 { Side::Inside } else { Side::Outside }
}
