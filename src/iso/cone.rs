//! Cone marching cubes: each patch of a cell is a cone from one apex over its loop of crossings.
//!
//! Why the mesh cannot intersect itself: neighbouring cells have the same segments on their common
//! face, and those on an ambiguous face cut off different corners. A cone from a point inside a
//! convex cell over a simple loop on its boundary is embedded. The convex hulls of two patches of
//! one cell are separated by a plane, so apexes within their hulls keep them apart; in a cell of
//! one patch the apex may be anywhere inside.
//!
//! All of it holds for rounded positions, because the lattice itself is rounded to f32 first
//! (planes stay planes), crossings and apexes keep [`MARGIN`] and [`ULPS`] from the planes, and
//! the separation of two hulls shrinks with that margin only.

use super::block::{Block, cut, first};
use super::loops::{Edge, PATCHES, Patches};
use crate::grid::{Bricks, Lattice, ulp};
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// Least distance of a crossing from the ends of its edge, as a share of the edge. Larger bends
/// flat faces that lie on samples; smaller makes slivers.
const MARGIN: f64 = 1e-3;

/// The same in f32 ulps of the coordinate: rounding moves a point by half of one.
const ULPS: f64 = 16.0;

/// The samples of a brick and the first ones of the next bricks.
type Closed = Block<9>;

/// The surface's points of one brick: for each sample those on its three edges, then the apexes
/// of its cell.
struct Index {
    brick: [u32; 3],
    /// For each sample: `first point << 3 | crossed edges`.
    tags: Box<[u16; 512]>,
    points: u32,
    triangles: u32,
}

/// The whole surface.
pub(super) fn extract(bricks: &Bricks<f32>, job: &dyn Job) -> Result<TriMesh, Cancelled> {
    let count = |n: usize| {
        check(job)?;
        let brick = bricks.place(n);
        Ok(Closed::gather(bricks, brick, 0).and_then(|block| Index::new(brick, &block)))
    };
    let counted = (0..bricks.bricks.len()).into_par_iter().map(count);
    let counted = counted.collect::<Result<Vec<_>, Cancelled>>()?;
    let surface = Surface::new(bricks, counted);

    let total = |of: fn(&Index) -> u32| surface.indices.iter().map(|i| of(i) as usize).sum();
    let mut points = vec![DVec3::ZERO; total(|i| i.points)];
    let mut faces = vec![[0; 3]; total(|i| i.triangles)];
    let points_of = cut(
        &mut points,
        surface.indices.iter().map(|i| i.points as usize),
    );
    let faces_of = cut(
        &mut faces,
        surface.indices.iter().map(|i| i.triangles as usize),
    );
    let parts: Vec<_> = points_of.into_iter().zip(faces_of).enumerate().collect();
    parts.into_par_iter().try_for_each(|(n, (points, faces))| {
        check(job)?;
        surface.fill(n, points, faces);
        Ok(())
    })?;
    Ok(TriMesh { points, faces })
}

/// The corners of a cell that are inside, for all cells of a brick.
struct Signs([[u16; 9]; 9]);

impl Signs {
    fn new(block: &Closed) -> Self {
        let mut rows = [[0; 9]; 9];
        for (n, row) in block.samples.chunks_exact(9).enumerate() {
            let bits = row
                .iter()
                .rev()
                .fold(0, |bits, &v| bits << 1 | u16::from(v < 0.0));
            rows[n / 9][n % 9] = bits;
        }
        Self(rows)
    }

    /// Bit n is set where corner n of cell (x, y, z) is inside.
    fn config(&self, [x, y, z]: [usize; 3]) -> u8 {
        let pair = |y: usize, z: usize| (self.0[z][y] >> x & 3) as u8;
        pair(y, z) | pair(y + 1, z) << 2 | pair(y, z + 1) << 4 | pair(y + 1, z + 1) << 6
    }
}

/// Cells of a brick, x fastest.
fn cells() -> impl Iterator<Item = [usize; 3]> {
    (0..512).map(|n| [n & 7, n >> 3 & 7, n >> 6])
}

/// Which of the three edges from corner 0 the surface crosses.
fn crossed(config: u8) -> u16 {
    let differs = |n: u8| u16::from((config ^ config >> n) & 1);
    differs(1) | differs(2) << 1 | differs(4) << 2
}

impl Index {
    fn new(brick: [u32; 3], block: &Closed) -> Option<Self> {
        let signs = Signs::new(block);
        let mut tags = Box::new([0; 512]);
        let (mut points, mut triangles) = (0, 0);
        for (tag, cell) in tags.iter_mut().zip(cells()) {
            let config = signs.config(cell);
            let patches = &PATCHES[usize::from(config)];
            let edges = crossed(config);
            // at most (3 + 4) * 512 points, so 13 bits hold the first
            *tag = (points as u16) << 3 | edges;
            points += edges.count_ones() + patches.apexes;
            triangles += patches.triangles;
        }
        (points > 0 || triangles > 0).then_some(Self {
            brick,
            tags,
            points,
            triangles,
        })
    }

    /// The number within the brick of the point on an edge from a sample.
    fn edge(&self, sample: usize, axis: u8) -> u32 {
        let tag = self.tags[sample];
        u32::from(tag >> 3) + (tag & ((1 << axis) - 1)).count_ones()
    }
}

/// The bricks that hold points, and where in the mesh these begin.
struct Surface<'a> {
    bricks: &'a Bricks<f32>,
    indices: Vec<Index>,
    starts: Vec<u32>,
    /// For every brick its place in `indices`, or `u32::MAX`.
    found: Vec<u32>,
}

impl<'a> Surface<'a> {
    fn new(bricks: &'a Bricks<f32>, counted: Vec<Option<Index>>) -> Self {
        let mut found = vec![u32::MAX; counted.len()];
        let (mut indices, mut starts, mut next) = (Vec::new(), Vec::new(), 0u32);
        for (slot, index) in found.iter_mut().zip(counted) {
            if let Some(index) = index {
                *slot = indices.len() as u32;
                starts.push(next);
                next = next.wrapping_add(index.points);
                indices.push(index);
            }
        }
        Self {
            bricks,
            indices,
            starts,
            found,
        }
    }

    /// The index of the brick `d` steps up from `b`, and its first point.
    fn beside(&self, b: [u32; 3], d: usize) -> Option<(&Index, u32)> {
        let at: [u32; 3] = std::array::from_fn(|a| b[a] + (d >> a & 1) as u32);
        self.bricks.brick(at)?;
        let n = *self.found.get(self.bricks.index(at))? as usize;
        Some((self.indices.get(n)?, self.starts[n]))
    }

    /// Writes the points and faces of one brick.
    fn fill(&self, n: usize, points: &mut [DVec3], faces: &mut [[u32; 3]]) {
        let index = &self.indices[n];
        let Some(block) = Closed::gather(self.bricks, index.brick, 0) else {
            return;
        };
        let beside = std::array::from_fn(|d| self.beside(index.brick, d));
        let signs = Signs::new(&block);
        let planes = Planes::new(&self.bricks.lattice, index.brick);
        let (points, faces) = (points.iter_mut(), faces.iter_mut());
        let mut out = Writer {
            points,
            faces,
            next: self.starts[n],
        };
        for at in cells() {
            let config = signs.config(at);
            if config != 0 && config != 255 {
                let cell = Cell {
                    at,
                    planes: &planes,
                    values: values(&block, at),
                };
                out.cell(&cell, config, &beside);
            }
        }
    }
}

/// An index and its first point for each brick from a cell's own upwards.
type Beside<'a> = [Option<(&'a Index, u32)>; 8];

/// Fills a brick's share of the mesh.
struct Writer<'a> {
    points: std::slice::IterMut<'a, DVec3>,
    faces: std::slice::IterMut<'a, [u32; 3]>,
    next: u32,
}

impl Writer<'_> {
    fn point(&mut self, p: DVec3) -> u32 {
        if let Some(slot) = self.points.next() {
            *slot = p;
        }
        self.next += 1;
        self.next - 1
    }

    fn face(&mut self, f: [u32; 3]) {
        if let Some(slot) = self.faces.next() {
            *slot = f;
        }
    }

    fn cell(&mut self, cell: &Cell, config: u8, beside: &Beside) {
        for axis in (0..3).filter(|&a| crossed(config) >> a & 1 == 1) {
            self.point(cell.position(cell.crossing(Edge { axis, corner: 0 })));
        }
        let patches = &PATCHES[usize::from(config)];
        let id = |e: &Edge| point_on(beside, cell.at, *e);
        for edges in patches.loops() {
            if let [a, b, c] = edges {
                self.face([id(a), id(b), id(c)]);
                continue;
            }
            let apex = self.point(cell.position(cell.apex(patches, edges)));
            for (a, b) in edges.iter().zip(edges.iter().cycle().skip(1)) {
                self.face([apex, id(a), id(b)]);
            }
        }
    }
}

/// The mesh's point on an edge of a cell.
fn point_on(beside: &Beside, at: [usize; 3], edge: Edge) -> u32 {
    let corner = [0, 1, 2].map(|a| at[a] + usize::from(edge.corner >> a & 1));
    let brick = [0, 1, 2].iter().fold(0, |d, &a| d | (corner[a] >> 3) << a);
    let sample = (corner[0] & 7) + 8 * (corner[1] & 7) + 64 * (corner[2] & 7);
    beside[brick].map_or(0, |(index, start)| start + index.edge(sample, edge.axis))
}

/// The values at the corners of a cell.
fn values(block: &Closed, [x, y, z]: [usize; 3]) -> [f64; 8] {
    std::array::from_fn(|n| {
        let [x, y, z] = [x + (n & 1), y + (n >> 1 & 1), z + (n >> 2)];
        f64::from(block.samples[x + 9 * (y + 9 * z)])
    })
}

/// The planes of the lattice that pass through a brick's samples, rounded to f32, and the least
/// share of a cell's side that points keep from them.
struct Planes {
    at: [[f64; 9]; 3],
    margin: [[f64; 8]; 3],
}

impl Planes {
    fn new(lattice: &Lattice, brick: [u32; 3]) -> Self {
        let lo = first(brick);
        let plane = |a: usize, n: usize| {
            let origin = lattice.origin[a];
            f64::from((origin + lattice.step * (lo[a] as f64 + n as f64)) as f32)
        };
        let at: [[f64; 9]; 3] = std::array::from_fn(|a| std::array::from_fn(|n| plane(a, n)));
        let margin = at.map(|p| {
            std::array::from_fn(|n| {
                let room = ULPS * ulp(p[n].abs().max(p[n + 1].abs())) / (p[n + 1] - p[n]);
                room.clamp(MARGIN, 0.25)
            })
        });
        Self { at, margin }
    }
}

/// A cell that the surface crosses; its points are told in shares of its sides.
struct Cell<'a> {
    at: [usize; 3],
    planes: &'a Planes,
    values: [f64; 8],
}

impl Cell<'_> {
    fn margin(&self) -> DVec3 {
        let of = |a: usize| self.planes.margin[a][self.at[a]];
        DVec3::new(of(0), of(1), of(2))
    }

    /// Where the surface crosses an edge, by linear interpolation.
    fn crossing(&self, edge: Edge) -> DVec3 {
        let axis = usize::from(edge.axis);
        let (a, b) = (
            self.values[usize::from(edge.corner)],
            self.values[usize::from(edge.end())],
        );
        let share = a / (a - b);
        let margin = self.margin()[axis];
        let share = if share.is_finite() {
            share.clamp(margin, 1.0 - margin)
        } else {
            0.5
        };
        let mut p = corner(edge.corner);
        p[axis] = share;
        p
    }

    /// The apex of a patch: the mean of its crossings; where the cell has no other patch, moved
    /// onto the zero set of the trilinear interpolation.
    fn apex(&self, patches: &Patches, edges: &[Edge]) -> DVec3 {
        let sum: DVec3 = edges.iter().map(|&e| self.crossing(e)).sum();
        let mean = sum / edges.len() as f64;
        if patches.count() > 1 {
            mean
        } else {
            self.settle(mean)
        }
    }

    /// Two Newton steps along the gradient, inside the cell. On a ball they take a third off the
    /// largest distance error (ball of radius 10, step 0.5: 0.0092 to 0.0063).
    fn settle(&self, mut p: DVec3) -> DVec3 {
        for _ in 0..2 {
            let (value, gradient) = self.trilinear(p);
            let step = gradient * (value / gradient.length_squared());
            if !step.is_finite() {
                break;
            }
            p = (p - step).clamp(self.margin(), 1.0 - self.margin());
        }
        p
    }

    /// The trilinear interpolation of the corners, and its gradient.
    fn trilinear(&self, p: DVec3) -> (f64, DVec3) {
        let v = &self.values;
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let x: [f64; 4] = std::array::from_fn(|n| mix(v[2 * n], v[2 * n + 1], p.x));
        let dx: [f64; 4] = std::array::from_fn(|n| v[2 * n + 1] - v[2 * n]);
        let y = [mix(x[0], x[1], p.y), mix(x[2], x[3], p.y)];
        let slope = DVec3::new(
            mix(mix(dx[0], dx[1], p.y), mix(dx[2], dx[3], p.y), p.z),
            mix(x[1] - x[0], x[3] - x[2], p.z),
            y[1] - y[0],
        );
        (mix(y[0], y[1], p.z), slope)
    }

    /// In mm, rounded to f32.
    fn position(&self, p: DVec3) -> DVec3 {
        let of = |a: usize| {
            let [lo, hi] = [0, 1].map(|n| self.planes.at[a][self.at[a] + n]);
            f64::from((lo + (hi - lo) * p[a]) as f32)
        };
        DVec3::new(of(0), of(1), of(2))
    }
}

fn corner(n: u8) -> DVec3 {
    let bit = |a: u8| f64::from(n >> a & 1);
    DVec3::new(bit(0), bit(1), bit(2))
}
