//! What samples alone cannot show: components and holes smaller than a cell.

use super::prune::Pruner;
use super::{Sampling, side, stored};
use crate::field::Field;
use crate::grid::{BRICK, Brick, Bricks, Lattice};
use crate::job::{Cancelled, Job, check};
use crate::num::Aabb;
use glam::DVec3;
use rayon::prelude::*;

/// Cells that look empty or full by their eight samples, though the bound over them contains zero.
///
/// When none is missed and none left, the samples show every component of the shape and of the
/// space round it, except those that lie wholly in cells that the surface crosses anyway.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Undecided {
    /// Cells of one sign whose own bound contains zero; the sum of the three below.
    pub undecided: u64,
    /// Of these, cells whose parts all have bounds that exclude zero.
    pub decided: u64,
    /// Of these, cells inside which a point of the other sign was found.
    pub missed: u64,
    /// Of these, cells that remain undecided at the floor of the subdivision.
    pub left: u64,
    /// A point of the other sign, the first in order.
    pub example: Option<DVec3>,
}

/// At most how many cells are undecided, counted from the samples alone: all cells of one sign in
/// the cubes of 4³ that a bound could not exclude. [`undecided`] asks the bound of each cell, and
/// takes several times what sampling takes.
pub fn undecided_at_most(of: &Sampling) -> u64 {
    let bricks = &of.bricks;
    let count = |i: usize| match bricks.bricks.get(i) {
        Some(Brick::Band(_)) => open_cells(bricks, bricks.place(i).map(|b| i64::from(b * BRICK))),
        _ => 0,
    };
    (0..bricks.bricks.len()).into_par_iter().map(count).sum()
}

/// Cells of one sign in the brick that starts at sample `at`, in cubes that hold finite samples.
fn open_cells(bricks: &Bricks<f32>, at: [i64; 3]) -> u64 {
    let mut s = [[[0f32; 9]; 9]; 9];
    for (k, plane) in s.iter_mut().enumerate() {
        for (j, row) in plane.iter_mut().enumerate() {
            let from = [at[0], at[1] + j as i64, at[2] + k as i64];
            bricks.row(from, f32::NEG_INFINITY, f32::INFINITY, row);
        }
    }
    let mut open = 0;
    for k in 0..8 {
        for j in 0..8 {
            for i in 0..8 {
                let corners =
                    (0..8).filter(|c| s[k + (c >> 2)][j + (c >> 1 & 1)][i + (c & 1)] < 0.0);
                let held = s[k][j][i].is_finite();
                open += u64::from(held && matches!(corners.count(), 0 | 8));
            }
        }
    }
    open
}

/// Counts undecided cells, and subdivides each of them `floor_levels` times to decide it. With
/// none they are only counted, and all are left.
///
/// Costs a bound for every cell near the surface, and up to `27 * 8^(floor_levels - 1)` values for
/// every undecided one.
pub fn undecided(
    f: &dyn Field,
    of: &Sampling,
    floor_levels: u32,
    job: &dyn Job,
) -> Result<Undecided, Cancelled> {
    job.stage("decide");
    let bricks = &of.bricks;
    let search = Search { f, lattice: &bricks.lattice, pruner: Pruner::new(f, &bricks.lattice) };
    let count = |i: usize| {
        check(job)?;
        let mut found = Undecided::default();
        if matches!(bricks.bricks.get(i), Some(Brick::Band(_))) {
            let lo = bricks.place(i).map(|b| b * BRICK);
            search.blocks(of, &[lo], BRICK, floor_levels, &mut found);
        }
        Ok(found)
    };
    let parts = (0..bricks.bricks.len()).into_par_iter().map(count);
    let parts = parts.collect::<Result<Vec<_>, Cancelled>>()?;
    Ok(parts.into_iter().fold(Undecided::default(), |a, b| Undecided {
        undecided: a.undecided + b.undecided,
        decided: a.decided + b.decided,
        missed: a.missed + b.missed,
        left: a.left + b.left,
        example: a.example.or(b.example),
    }))
}

struct Search<'a> {
    f: &'a dyn Field,
    lattice: &'a Lattice,
    pruner: Pruner<'a>,
}

/// What the subdivision of a cell shows.
enum Found {
    Decided,
    Left,
    Other(DVec3),
}

impl Search<'_> {
    /// Counts the cells of blocks, each from a sample of `lo` on, `cells` a side.
    fn blocks(&self, of: &Sampling, lo: &[[u32; 3]], cells: u32, levels: u32, out: &mut Undecided) {
        let sides = self.pruner.closed_sides(lo, cells);
        for (&lo, _) in lo.iter().zip(sides).filter(|(_, side)| side.is_none()) {
            if cells == 1 {
                self.cell(of, lo, levels, out);
                continue;
            }
            let part = |n: u32| std::array::from_fn(|a| lo[a] + cells / 2 * (n >> a & 1));
            let within = |lo: &[u32; 3]| (0..3).all(|a| lo[a] + 1 < self.lattice.size[a]);
            let parts: Vec<[u32; 3]> = (0..8).map(part).filter(within).collect();
            self.blocks(of, &parts, cells / 2, levels, out);
        }
    }

    fn cell(&self, of: &Sampling, lo: [u32; 3], levels: u32, out: &mut Undecided) {
        let corner = |n: u32| -> [i64; 3] {
            std::array::from_fn(|a| i64::from(lo[a]) + i64::from(n >> a & 1))
        };
        let sign = |n| of.bricks.sample(corner(n), -1.0, 1.0) < 0.0;
        let inside = sign(0);
        if (1..8).any(|n| sign(n) != inside) {
            return;
        }
        out.undecided += 1;
        let [i, j, k] = lo;
        let b = Aabb::new(self.lattice.point(i, j, k), self.lattice.point(i + 1, j + 1, k + 1));
        match self.subdivide(&b, inside, levels) {
            Found::Decided => out.decided += 1,
            Found::Left => out.left += 1,
            Found::Other(p) => {
                out.missed += 1;
                out.example = out.example.or(Some(p));
            }
        }
    }

    /// Halves a box that its bound does not decide.
    fn subdivide(&self, b: &Aabb, inside: bool, levels: u32) -> Found {
        if levels == 0 {
            return Found::Left;
        }
        let steps = [b.min, b.centre(), b.max];
        let point = |n: usize| DVec3::new(steps[n % 3].x, steps[n / 3 % 3].y, steps[n / 9].z);
        let at: [DVec3; 27] = std::array::from_fn(point);
        let mut values = [0.0; 27];
        self.f.values(&at, &mut values);
        let other = |v: &f64| (side(stored(*v)) == super::Side::Inside) != inside;
        if let Some(n) = values.iter().position(other) {
            return Found::Other(at[n]);
        }
        let mut all = Found::Decided;
        let parts: [Aabb; 8] = std::array::from_fn(|n| {
            let lo = (n & 1) + 3 * (n >> 1 & 1) + 9 * (n >> 2);
            Aabb::new(at[lo], at[lo + 13])
        });
        let sides = self.pruner.sides(&parts);
        for (part, _) in parts.iter().zip(sides).filter(|(_, side)| side.is_none()) {
            match self.subdivide(part, inside, levels - 1) {
                Found::Other(p) => return Found::Other(p),
                Found::Left => all = Found::Left,
                Found::Decided => {}
            }
        }
        all
    }
}
