//! One brick with its surroundings, as the meshers see it.

use crate::grid::{BRICK, Brick, Bricks, Lattice};
use rayon::prelude::*;

/// The samples round a brick: `N` a side, of which the first is `back` before the brick's first.
pub(super) struct Block<const N: usize> {
    /// x fastest.
    pub samples: Vec<f32>,
}

/// The samples of a brick and the first ones of the next bricks.
pub(super) struct Closed {
    /// x fastest.
    pub samples: [f32; SIDE * SIDE * SIDE],
}

/// Samples along a side of [`Closed`].
pub(super) const SIDE: usize = 9;

impl Closed {
    /// Whatever lies on the border of the lattice or beyond is outside.
    pub(super) fn gather(bricks: &Bricks<f32>, b: [u32; 3]) -> Self {
        let fill = bricks.lattice.step as f32;
        let mut closed = Self { samples: [fill; SIDE * SIDE * SIDE] };
        if on_border(&bricks.lattice, first(b), SIDE) {
            bricks.cube(first(b), SIDE, -fill, fill, &mut closed.samples);
            put_outside(&bricks.lattice, first(b), SIDE, &mut closed.samples);
            return closed;
        }
        let whole = [-fill; 512];
        let samples: [Option<&[f32; 512]>; 8] = std::array::from_fn(|d| {
            let up = [0, 1, 2].map(|a| b[a] + (d >> a & 1) as u32);
            match bricks.brick(up)? {
                Brick::Band(samples) => Some(&**samples),
                Brick::Inside => Some(&whole),
                Brick::Outside => None,
            }
        });
        for (n, row) in closed.samples.chunks_exact_mut(SIDE).enumerate() {
            let (y, z) = (n % SIDE, n / SIDE);
            let (own, at) = ((y >> 3) << 1 | (z >> 3) << 2, 8 * (y & 7) + 64 * (z & 7));
            if let Some(samples) = samples[own] {
                row[..8].copy_from_slice(&samples[at..at + 8]);
            }
            if let Some(samples) = samples[own | 1] {
                row[8] = samples[at];
            }
        }
        closed
    }
}

/// The first sample of brick `b`.
pub(super) fn first(b: [u32; 3]) -> [i64; 3] {
    b.map(|n| i64::from(n) * i64::from(BRICK))
}

impl<const N: usize> Block<N> {
    /// None where all samples have one sign. Whatever lies on the border of the lattice or beyond
    /// is outside.
    pub(super) fn gather(bricks: &Bricks<f32>, b: [u32; 3], back: u32) -> Option<Self> {
        let lo = first(b).map(|i| i - i64::from(back));
        let fill = bricks.lattice.step as f32;
        let mut samples = vec![fill; N * N * N];
        bricks.cube(lo, N, -fill, fill, &mut samples);
        if on_border(&bricks.lattice, lo, N) {
            put_outside(&bricks.lattice, lo, N, &mut samples);
        }
        let inside = samples.iter().filter(|&&v| v < 0.0).count();
        if inside == 0 || inside == samples.len() { None } else { Some(Self { samples }) }
    }
}

/// Whether the cube of `side` samples from `lo` on reaches the border of the lattice.
fn on_border(lattice: &Lattice, lo: [i64; 3], side: usize) -> bool {
    (0..3).any(|a| lo[a] <= 0 || lo[a] + side as i64 >= i64::from(lattice.size[a]))
}

/// What lies on the border in such a cube, or beyond, becomes outside.
fn put_outside(lattice: &Lattice, lo: [i64; 3], side: usize, samples: &mut [f32]) {
    for (n, row) in samples.chunks_exact_mut(side).enumerate() {
        let at = [lo[0], lo[1] + (n % side) as i64, lo[2] + (n / side) as i64];
        put_border_outside(lattice, at, row);
    }
}

/// Bricks whose blocks may hold both signs, in order.
pub(super) fn candidates(bricks: &Bricks<f32>, back: u32) -> Vec<usize> {
    let all = (0..bricks.bricks.len()).into_par_iter();
    all.filter(|&n| !uniform(bricks, bricks.place(n), back)).collect()
}

/// Samples on the border and beyond become positive, as `field::sample` leaves them.
fn put_border_outside(lattice: &Lattice, at: [i64; 3], row: &mut [f32]) {
    let last = lattice.size.map(|n| i64::from(n) - 1);
    let least = (lattice.step * 1e-3) as f32;
    let whole = (1..3).any(|a| at[a] <= 0 || at[a] >= last[a]);
    for (i, v) in (at[0]..).zip(row) {
        if whole || i <= 0 || i >= last[0] {
            *v = v.max(least);
        }
    }
}

/// Whether the brick and its surroundings certainly have one sign.
fn uniform(bricks: &Bricks<f32>, b: [u32; 3], back: u32) -> bool {
    let lo = first(b);
    let on_border = (0..3)
        .any(|a| lo[a] == 0 || lo[a] + i64::from(BRICK) + 1 >= i64::from(bricks.lattice.size[a]));
    let kind = |d: [i64; 3]| {
        let at = [0, 1, 2].map(|a| i64::from(b[a]) + d[a]);
        let at = at.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        match bricks.brick(at) {
            Some(Brick::Inside) if on_border => None,
            Some(Brick::Inside) => Some(true),
            Some(Brick::Outside) | None => Some(false),
            Some(Brick::Band(_)) => None,
        }
    };
    let Some(mine) = kind([0; 3]) else {
        return false;
    };
    let range = || -i64::from(back.min(1))..=1;
    range().all(|z| range().all(|y| range().all(|x| kind([x, y, z]) == Some(mine))))
}

/// Cuts a slice into consecutive parts of the given sizes.
pub(super) fn cut<T>(mut all: &mut [T], sizes: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let mut parts = Vec::new();
    for size in sizes {
        let (part, rest) = all.split_at_mut(size.min(all.len()));
        parts.push(part);
        all = rest;
    }
    parts
}
