//! The octree of bounds.

use super::{on_border, region};
use crate::field::Field;
use crate::grid::{BRICK, Bricks, Lattice};
use crate::job::{Cancelled, Job, check};
use crate::num::{Aabb, Interval};
use rayon::prelude::*;

/// The one sign that a box of space has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Inside,
    Outside,
}

/// Asks a field which boxes have one sign.
pub(super) struct Pruner<'a> {
    f: &'a dyn Field,
    lattice: &'a Lattice,
    support: Aabb,
    /// What a bound must clear zero by: its own round-off, and values that f32 rounds to zero.
    slack: f64,
}

/// The signs of a brick's eight cubes of 4³ samples that bounds could tell; the rest is open.
pub(super) type Cubes = [Option<Side>; 8];

/// Bricks by what their bounds say; the rest is outside.
pub(super) struct Split {
    pub inside: Vec<usize>,
    /// In order.
    pub active: Vec<(usize, Cubes)>,
}

/// A cube of 2^`level` bricks a side.
#[derive(Clone, Copy)]
struct Node {
    lo: [u32; 3],
    level: u32,
}

enum Verdict {
    One(Side),
    Open,
    Leaf(Cubes),
}

impl<'a> Pruner<'a> {
    pub(super) fn new(f: &'a dyn Field, lattice: &'a Lattice) -> Self {
        let b = lattice.bounds();
        let scale = b.min.abs().max(b.max.abs()).max_element() + b.size().length();
        let slack = (1e-9 * scale).max(f64::from(f32::MIN_POSITIVE));
        Self { f, lattice, support: f.support().grow(slack), slack }
    }

    /// The sign each whole box has, if field and bound can tell.
    pub(super) fn sides(&self, boxes: &[Aabb]) -> Vec<Option<Side>> {
        let near = |b: &Aabb| !b.meet(self.support).is_empty();
        let asked: Vec<Aabb> = boxes.iter().copied().filter(near).collect();
        let mut bounds = vec![Interval::ALL; asked.len()];
        self.f.bounds(&asked, &mut bounds);
        let mut bounds = bounds.into_iter();
        let side = |b: &Aabb| {
            let bound = if near(b) { bounds.next()? } else { return Some(Side::Outside) };
            match bound {
                Interval { lo, .. } if lo > self.slack => Some(Side::Outside),
                Interval { hi, .. } if hi < -self.slack => Some(Side::Inside),
                _ => None,
            }
        };
        boxes.iter().map(side).collect()
    }

    /// The sign of all samples from each of `lo` to `lo + cells`, both included. The border is outside,
    /// so what reaches it is never all inside.
    pub(super) fn closed_sides(&self, lo: &[[u32; 3]], cells: u32) -> Vec<Option<Side>> {
        let last = |a: usize| self.lattice.size[a].saturating_sub(1);
        let corners = |lo: &[u32; 3]| -> [[u32; 3]; 2] {
            let hi: [u32; 3] = std::array::from_fn(|a| lo[a].saturating_add(cells).min(last(a)));
            [std::array::from_fn(|a| lo[a].min(hi[a])), hi]
        };
        let corners: Vec<_> = lo.iter().map(corners).collect();
        let boxes: Vec<_> = corners.iter().map(|&[lo, hi]| region(self.lattice, lo, hi)).collect();
        let sides = corners.iter().zip(self.sides(&boxes));
        sides
            .map(|(corners, side)| {
                let reaches = corners.iter().any(|&c| on_border(self.lattice, c));
                side.filter(|&side| side == Side::Outside || !reaches)
            })
            .collect()
    }

    /// Sorts all bricks by their bounds, level by level.
    pub(super) fn split(&self, bricks: &Bricks<f32>, job: &dyn Job) -> Result<Split, Cancelled> {
        let most = bricks.size.iter().copied().max().unwrap_or(0);
        let mut level = most.max(1).next_power_of_two().ilog2();
        let mut open = vec![Node { lo: [0; 3], level }];
        let mut split = Split { inside: Vec::new(), active: Vec::new() };
        if bricks.bricks.is_empty() {
            return Ok(split);
        }
        loop {
            let ask = |nodes: &[Node]| {
                check(job)?;
                Ok(self.verdicts(nodes, level))
            };
            let asked = open.par_chunks(8).map(ask).collect::<Result<Vec<_>, Cancelled>>()?;
            for (node, verdict) in
                std::mem::take(&mut open).into_iter().zip(asked.into_iter().flatten())
            {
                match verdict {
                    Verdict::One(Side::Outside) => {}
                    Verdict::One(Side::Inside) => split.inside.extend(node.bricks(bricks)),
                    Verdict::Leaf(cubes) => split.active.push((bricks.index(node.lo), cubes)),
                    Verdict::Open => open.extend(node.children(bricks.size)),
                }
            }
            if level == 0 {
                split.active.sort_unstable_by_key(|a| a.0);
                return Ok(split);
            }
            level -= 1;
        }
    }

    /// What the bounds say of some nodes of one level.
    fn verdicts(&self, nodes: &[Node], level: u32) -> Vec<Verdict> {
        let lo: Vec<_> = nodes.iter().map(|n| n.lo.map(|b| b * BRICK)).collect();
        let sides = lo.iter().zip(self.closed_sides(&lo, BRICK << level));
        sides
            .map(|(&lo, side)| match side {
                Some(side) => Verdict::One(side),
                None if level == 0 => self.leaf(lo),
                None => Verdict::Open,
            })
            .collect()
    }

    fn leaf(&self, lo: [u32; 3]) -> Verdict {
        let at: [_; 8] = std::array::from_fn(|n| cube(lo, n));
        let beyond = |at: &[u32; 3]| (0..3).any(|a| at[a] >= self.lattice.size[a]);
        let there: Vec<_> = at.iter().copied().filter(|at| !beyond(at)).collect();
        let mut sides = self.closed_sides(&there, CUBE).into_iter();
        let cubes: Cubes =
            at.map(|at| if beyond(&at) { Some(Side::Outside) } else { sides.next().flatten() });
        match cubes[0] {
            Some(side) if cubes.iter().all(|&c| c == cubes[0]) => Verdict::One(side),
            _ => Verdict::Leaf(cubes),
        }
    }
}

/// Samples along a side of a cube, the least that is evaluated at once. Against whole bricks it
/// saves four values in ten (ball and gyroid at 256 cells) for eight more bounds a brick; cubes of
/// 2³ would ask for as many bounds as they save values.
pub(super) const CUBE: u32 = BRICK / 2;

/// The first sample of cube n of the brick that starts at `lo`.
pub(super) fn cube(lo: [u32; 3], n: usize) -> [u32; 3] {
    std::array::from_fn(|a| lo[a].saturating_add(CUBE * (n as u32 >> a & 1)))
}

impl Node {
    /// The eight halves that hold bricks.
    fn children(self, size: [u32; 3]) -> impl Iterator<Item = Node> {
        let level = self.level.saturating_sub(1);
        (0..8)
            .map(move |n| Node {
                lo: std::array::from_fn(|a| self.lo[a] + ((n >> a & 1) << level)),
                level,
            })
            .filter(move |c| c.lo.iter().zip(size).all(|(&b, n)| b < n))
    }

    /// All its bricks.
    fn bricks(self, of: &Bricks<f32>) -> impl Iterator<Item = usize> {
        let range = move |a: usize| {
            let lo = self.lo[a];
            lo..lo.saturating_add(1 << self.level).min(of.size[a])
        };
        range(2).flat_map(move |z| {
            range(1).flat_map(move |y| range(0).map(move |x| of.index([x, y, z])))
        })
    }
}
