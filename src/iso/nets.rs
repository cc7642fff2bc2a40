//! Naive surface nets by the crate `fast-surface-nets`, a chunk a brick.
//!
//! A chunk is a brick with one more sample before and after it. It makes the faces round the edges
//! it owns; these need the points of the cells before it, which the bricks there own too. Chunks
//! join by the cells' places, never by position.

use super::block::{Block, candidates, cut, first};
use crate::grid::Bricks;
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use fast_surface_nets::ndshape::{ConstShape, ConstShape3u32};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::DVec3;
use rayon::prelude::*;

type Chunk = Block<10>;
type Shape = ConstShape3u32<10, 10, 10>;

/// What a chunk makes.
struct Net {
    brick: [u32; 3],
    /// Points of the brick's own cells.
    points: Vec<DVec3>,
    /// For every own cell its point, or `NONE`.
    cells: Box<[u16; 512]>,
    /// Faces over cells of the chunk.
    faces: Vec<[u16; 3]>,
}

const NONE: u16 = u16::MAX;

/// The whole surface.
pub(super) fn extract(bricks: &Bricks<f32>, job: &dyn Job) -> Result<TriMesh, Cancelled> {
    let make = |buffer: &mut SurfaceNetsBuffer, &n: &usize| {
        check(job)?;
        let brick = bricks.place(n);
        Ok(Chunk::gather(bricks, brick, 1).map(|chunk| Net::new(bricks, brick, chunk, buffer)))
    };
    let list = candidates(bricks, 1);
    let nets = list.par_iter().map_init(SurfaceNetsBuffer::default, make);
    let nets = nets.collect::<Result<Vec<_>, Cancelled>>()?;
    let nets = Nets::new(bricks, nets.into_iter().flatten().collect());
    let mut faces = vec![[0; 3]; nets.nets.iter().map(|n| n.faces.len()).sum()];
    let parts = cut(&mut faces, nets.nets.iter().map(|n| n.faces.len()));
    nets.nets.par_iter().zip(parts).for_each(|(net, faces)| {
        for (face, cells) in faces.iter_mut().zip(&net.faces) {
            *face = cells.map(|c| nets.point(net.brick, c));
        }
    });
    let points = nets.nets.into_iter().flat_map(|n| n.points).collect();
    Ok(TriMesh { points, faces })
}

/// All chunks, and where in the mesh their points begin.
struct Nets<'a> {
    bricks: &'a Bricks<f32>,
    nets: Vec<Net>,
    starts: Vec<u32>,
    /// For every brick its place in `nets`, or `u32::MAX`.
    found: Vec<u32>,
}

impl<'a> Nets<'a> {
    fn new(bricks: &'a Bricks<f32>, nets: Vec<Net>) -> Self {
        let mut found = vec![u32::MAX; bricks.bricks.len()];
        let (mut starts, mut next) = (Vec::with_capacity(nets.len()), 0);
        for (n, net) in nets.iter().enumerate() {
            found[bricks.index(net.brick)] = n as u32;
            starts.push(next);
            next += net.points.len() as u32;
        }
        Self { bricks, nets, starts, found }
    }

    /// The mesh's point in a cell of the chunk of a brick.
    fn point(&self, brick: [u32; 3], cell: u16) -> u32 {
        let cell = Shape::delinearize(u32::from(cell));
        // a chunk begins one cell before its brick
        let at: [u32; 3] = std::array::from_fn(|a| (8 * brick[a] + cell[a]).saturating_sub(1));
        let slot = at.iter().rev().fold(0, |n, i| 8 * n + (i % 8) as usize);
        let owner = self.found.get(self.bricks.index(at.map(|n| n / 8)));
        let owner = owner.map_or(usize::MAX, |&n| n as usize);
        self.nets.get(owner).map_or(0, |net| self.starts[owner] + u32::from(net.cells[slot]))
    }
}

impl Net {
    fn new(
        bricks: &Bricks<f32>,
        brick: [u32; 3],
        mut chunk: Chunk,
        buffer: &mut SurfaceNetsBuffer,
    ) -> Self {
        // an infinity beside a crossing would make its position NaN
        for v in &mut chunk.samples {
            *v = if v.is_nan() { 1e30 } else { v.clamp(-1e30, 1e30) };
        }
        surface_nets(&chunk.samples, &Shape {}, [0; 3], [9; 3], buffer);
        let mut net = Self { brick, points: vec![], cells: Box::new([NONE; 512]), faces: vec![] };
        let lo = first(brick);
        for (at, p) in buffer.surface_points.iter().zip(&buffer.positions) {
            if at.iter().all(|&n| n > 0) {
                let [x, y, z] = at.map(|n| n as usize - 1);
                net.cells[x + 8 * y + 64 * z] = net.points.len() as u16;
                let share = |a: usize| lo[a] as f64 - 1.0 + f64::from(p[a]);
                let p = DVec3::new(share(0), share(1), share(2));
                net.points
                    .push((bricks.lattice.origin + bricks.lattice.step * p).as_vec3().as_dvec3());
            }
        }
        let cell = |n: u32| buffer.surface_strides[n as usize] as u16;
        let faces = buffer.indices.chunks_exact(3);
        net.faces.extend(faces.map(|f| [cell(f[0]), cell(f[1]), cell(f[2])]));
        net
    }
}
