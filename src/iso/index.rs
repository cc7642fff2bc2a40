//! Which points and faces each brick makes, and their numbers in the mesh.
//!
//! A point on an edge belongs to the brick of the edge's first sample, an apex to the brick of its
//! cell's; so each has one number, whichever cell asks.

use super::block::{Closed, SIDE, candidates, cut};
use super::cell::{Cell, Planes, values};
use super::loops::{Edge, PATCHES, Patches};
use crate::grid::Bricks;
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};
use rayon::prelude::*;

/// Which patches get an apex.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Apexes {
    /// Those of four or more crossings; three make one triangle.
    Wide,
    /// All of them.
    All,
}

impl Apexes {
    /// Points and triangles of some patches.
    fn count(self, patches: &Patches) -> [u32; 2] {
        let mut count = [0; 2];
        for edges in patches.loops() {
            let apex = self.given(edges);
            count[0] += u32::from(apex);
            count[1] += if apex { edges.len() as u32 } else { 1 };
        }
        count
    }

    /// Whether a patch gets one.
    pub(super) fn given(self, edges: &[Edge]) -> bool {
        self == Self::All || edges.len() > 3
    }
}

/// The corners of a cell that are inside, for all cells of a brick: a bit for each sample of a row.
struct Signs([[u16; SIDE]; SIDE]);

/// The bits of a row.
const ROW: u16 = (1 << SIDE) - 1;

impl Signs {
    /// None where all samples have one sign.
    fn new(block: &Closed) -> Option<Self> {
        let rows = dispatch!(Level::new(), s => rows(s, block));
        let all = rows.as_flattened().iter();
        let (some, each) = all.fold((0, ROW), |(some, each), r| (some | r, each & r));
        (some != 0 && each != ROW).then_some(Self(rows))
    }

    /// Shows the cells of the brick that hold both signs, x fastest: their numbers, places and corners.
    fn mixed(&self, mut show: impl FnMut(usize, [usize; 3], u8)) {
        for (y, z) in (0..8).flat_map(|z| (0..8).map(move |y| (y, z))) {
            let four = [self.0[z][y], self.0[z][y + 1], self.0[z + 1][y], self.0[z + 1][y + 1]];
            let some = four.iter().fold(0, |some, r| some | r | r >> 1);
            let each = four.iter().fold(ROW, |each, r| each & r & r >> 1);
            // a bit for each cell of the row
            let mut mixed = some & !each & 0xff;
            while mixed != 0 {
                let x = mixed.trailing_zeros() as usize;
                mixed &= mixed - 1;
                show(x + 8 * (y + 8 * z), [x, y, z], self.config([x, y, z]));
            }
        }
    }

    /// Bit n is set where corner n of cell (x, y, z) is inside.
    fn config(&self, [x, y, z]: [usize; 3]) -> u8 {
        let pair = |y: usize, z: usize| (self.0[z][y] >> x & 3) as u8;
        pair(y, z) | pair(y + 1, z) << 2 | pair(y, z + 1) << 4 | pair(y + 1, z + 1) << 6
    }
}

#[inline(always)]
fn rows<S: Simd>(s: S, block: &Closed) -> [[u16; SIDE]; SIDE] {
    let (mut rows, zero) = ([[0; SIDE]; SIDE], f32x8::splat(s, 0.0));
    for (n, row) in block.samples.chunks_exact(SIDE).enumerate() {
        let inside = f32x8::from_slice(s, &row[..8]).simd_lt(zero).to_bitmask();
        rows[n / SIDE][n % SIDE] = inside as u16 | u16::from(row[8] < 0.0) << 8;
    }
    rows
}

/// Which of the three edges from corner 0 the surface crosses.
pub(super) fn crossed(config: u8) -> u16 {
    let differs = |n: u8| u16::from((config ^ config >> n) & 1);
    differs(1) | differs(2) << 1 | differs(4) << 2
}

/// How many bits of a number are set.
const ONES: [u32; 8] = [0, 1, 1, 2, 1, 2, 2, 3];

/// The surface's points of one brick: for each sample those on its three edges, then the apexes
/// of its cell.
pub(super) struct Index {
    pub brick: [u32; 3],
    /// For each sample: `first point << 3 | crossed edges`.
    tags: Box<[u16; 512]>,
    pub points: u32,
    pub triangles: u32,
}

impl Index {
    fn new(brick: [u32; 3], signs: &Signs, counts: &[[u32; 2]; 256]) -> Option<Self> {
        let mut tags = Box::new([0; 512]);
        let (mut points, mut triangles, mut done) = (0, 0, 0);
        signs.mixed(|n, _, config| {
            let edges = crossed(config);
            // at most (3 + 4) * 512 points, so 13 bits hold the first
            let first = (points as u16) << 3;
            tags[done..n].fill(first);
            tags[n] = first | edges;
            done = n + 1;
            let [apexes, faces] = counts[usize::from(config)];
            points += edges.count_ones() + apexes;
            triangles += faces;
        });
        tags[done..].fill((points as u16) << 3);
        // a triangle may stand on points of other bricks alone
        let used = points > 0 || triangles > 0;
        used.then_some(Self { brick, tags, points, triangles })
    }

    /// The number within the brick of the point on an edge from a sample; from axis 3 on it is
    /// that of the cell's first apex.
    fn point(&self, sample: usize, axis: u8) -> u32 {
        let tag = self.tags[sample];
        u32::from(tag >> 3) + ONES[usize::from(tag & 7 & ((1 << axis) - 1))]
    }
}

/// The bricks that hold parts of the surface, and where in the mesh these begin.
pub(super) struct Surface<'a> {
    pub bricks: &'a Bricks<f32>,
    pub indices: Vec<Index>,
    pub starts: Vec<u32>,
    /// For every brick its place in `indices`, or `u32::MAX`.
    found: Vec<u32>,
}

impl<'a> Surface<'a> {
    pub(super) fn new(
        bricks: &'a Bricks<f32>,
        apexes: Apexes,
        job: &dyn Job,
    ) -> Result<Self, Cancelled> {
        let counts = std::array::from_fn(|config| apexes.count(&PATCHES[config]));
        let index = |&n: &usize| {
            check(job)?;
            let brick = bricks.place(n);
            let signs = Signs::new(&Closed::gather(bricks, brick));
            Ok(signs.and_then(|signs| Index::new(brick, &signs, &counts)))
        };
        let indices = candidates(bricks, 0).par_iter().map(index).collect::<Result<Vec<_>, _>>()?;
        let indices: Vec<Index> = indices.into_iter().flatten().collect();
        let mut found = vec![u32::MAX; bricks.bricks.len()];
        let (mut starts, mut next) = (Vec::with_capacity(indices.len()), 0u32);
        for (n, index) in indices.iter().enumerate() {
            found[bricks.index(index.brick)] = n as u32;
            starts.push(next);
            next = next.wrapping_add(index.points);
        }
        Ok(Self { bricks, indices, starts, found })
    }

    /// A mesh with all its points and faces, at zero.
    pub(super) fn blank(&self) -> TriMesh {
        let total = |of: fn(&Index) -> u32| self.indices.iter().map(|i| of(i) as usize).sum();
        // the system has zeros, and gives them when they are first touched: by all threads
        let points = bytemuck::zeroed_vec(total(|i| i.points));
        TriMesh { points, faces: bytemuck::zeroed_vec(total(|i| i.triangles)) }
    }

    /// The parts that the bricks own of a list of one entry a point.
    pub(super) fn points_of<'b, T>(&self, all: &'b mut [T]) -> Vec<&'b mut [T]> {
        cut(all, self.indices.iter().map(|i| i.points as usize))
    }

    /// The parts that the bricks own of a list of one entry a triangle.
    pub(super) fn faces_of<'b, T>(&self, all: &'b mut [T]) -> Vec<&'b mut [T]> {
        cut(all, self.indices.iter().map(|i| i.triangles as usize))
    }

    /// The index of brick `at`, and its first point.
    fn index(&self, at: [u32; 3]) -> Option<(&Index, u32)> {
        self.bricks.brick(at)?;
        let n = *self.found.get(self.bricks.index(at))? as usize;
        Some((self.indices.get(n)?, self.starts[n]))
    }

    /// The indices of a brick and the seven next ones upwards.
    pub(super) fn beside(&self, b: [u32; 3]) -> Beside<'_> {
        let up = |d: usize| std::array::from_fn(|a| b[a] + (d >> a & 1) as u32);
        Beside(std::array::from_fn(|d| self.index(up(d))))
    }

    /// Shows all cells of a brick that hold both signs, in order.
    pub(super) fn visit(&self, n: usize, mut each: impl FnMut(&Cell, u8)) {
        let brick = self.indices[n].brick;
        let block = Closed::gather(self.bricks, brick);
        let planes = Planes::new(&self.bricks.lattice, brick);
        if let Some(signs) = Signs::new(&block) {
            signs.mixed(|_, at, config| {
                each(&Cell { at, planes: &planes, values: values(&block, at) }, config);
            });
        }
    }

    /// The only apex of the cell at a sample of the lattice, if it has just one.
    pub(super) fn only_apex(&self, cell: [i64; 3]) -> Option<u32> {
        let cell = cell.map(|i| u32::try_from(i).unwrap_or(u32::MAX));
        let (index, start) = self.index(cell.map(|i| i / 8))?;
        let sample = cell.iter().rev().fold(0, |n, i| 8 * n + (i % 8) as usize);
        let first = index.point(sample, 3);
        let after = if sample < 511 { index.point(sample + 1, 0) } else { index.points };
        (after == first + 1).then_some(start + first)
    }
}

/// An index and its first point for each brick from a cell's own upwards.
pub(super) struct Beside<'a>([Option<(&'a Index, u32)>; 8]);

impl Beside<'_> {
    /// The mesh's point on an edge of a cell of the first brick.
    pub(super) fn point(&self, at: [usize; 3], edge: Edge) -> u32 {
        let corner = [0, 1, 2].map(|a| at[a] + usize::from(edge.corner >> a & 1));
        let brick = [0, 1, 2].iter().fold(0, |d, &a| d | (corner[a] >> 3) << a);
        let sample = (corner[0] & 7) + 8 * (corner[1] & 7) + 64 * (corner[2] & 7);
        self.0[brick].map_or(0, |(index, start)| start + index.point(sample, edge.axis))
    }
}
