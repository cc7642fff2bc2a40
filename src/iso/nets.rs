//! Naive surface nets by the crate `fast-surface-nets`, a chunk a brick.
//!
//! A chunk is a brick with one more sample before and after it. It makes the faces round the edges
//! it owns; these need the points of the cells before it, which the bricks there own too. Chunks
//! join by the cells' places, never by position.

use super::block::{Block, cut, first};
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
    let make = |buffer: &mut SurfaceNetsBuffer, n: usize| {
        check(job)?;
        let brick = bricks.place(n);
        Ok(Chunk::gather(bricks, brick, 1).map(|chunk| Net::new(bricks, brick, chunk, buffer)))
    };
    let nets = (0..bricks.bricks.len())
        .into_par_iter()
        .map_init(SurfaceNetsBuffer::default, make);
    let nets = nets.collect::<Result<Vec<_>, Cancelled>>()?;
    let mut starts = Vec::with_capacity(nets.len());
    let mut points = Vec::new();
    for net in &nets {
        starts.push(points.len() as u32);
        points.extend(net.iter().flat_map(|n| &n.points));
    }
    let sizes = || nets.iter().flatten().map(|n| n.faces.len());
    let mut faces = vec![[0; 3]; sizes().sum()];
    let parts = cut(&mut faces, sizes());
    nets.iter()
        .flatten()
        .zip(parts)
        .par_bridge()
        .for_each(|(net, faces)| {
            for (face, cells) in faces.iter_mut().zip(&net.faces) {
                *face = cells.map(|c| point_of(bricks, &nets, &starts, net.brick, c));
            }
        });
    Ok(TriMesh { points, faces })
}

/// The mesh's point in a cell of the chunk of a brick.
fn point_of(
    bricks: &Bricks<f32>,
    nets: &[Option<Net>],
    starts: &[u32],
    brick: [u32; 3],
    cell: u16,
) -> u32 {
    let cell = Shape::delinearize(u32::from(cell));
    // a chunk begins one cell before its brick
    let at: [u32; 3] = std::array::from_fn(|a| (8 * brick[a] + cell[a]).saturating_sub(1));
    let owner = bricks.index(at.map(|n| n / 8));
    let local = at.map(|n| n as usize % 8);
    let slot = local[0] + 8 * local[1] + 64 * local[2];
    match (nets.get(owner), starts.get(owner)) {
        (Some(Some(net)), Some(start)) => start + u32::from(net.cells[slot]),
        _ => 0,
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
            *v = if v.is_nan() {
                1e30
            } else {
                v.clamp(-1e30, 1e30)
            };
        }
        surface_nets(&chunk.samples, &Shape {}, [0; 3], [9; 3], buffer);
        let mut net = Self {
            brick,
            points: vec![],
            cells: Box::new([NONE; 512]),
            faces: vec![],
        };
        let lo = first(brick);
        for (at, p) in buffer.surface_points.iter().zip(&buffer.positions) {
            if at.iter().all(|&n| n > 0) {
                let [x, y, z] = at.map(|n| n as usize - 1);
                net.cells[x + 8 * y + 64 * z] = net.points.len() as u16;
                let share = |a: usize| lo[a] as f64 - 1.0 + f64::from(p[a]);
                let p = DVec3::new(share(0), share(1), share(2));
                net.points.push(
                    (bricks.lattice.origin + bricks.lattice.step * p)
                        .as_vec3()
                        .as_dvec3(),
                );
            }
        }
        let cell = |n: u32| buffer.surface_strides[n as usize] as u16;
        let faces = buffer.indices.chunks_exact(3);
        net.faces
            .extend(faces.map(|f| [cell(f[0]), cell(f[1]), cell(f[2])]));
        net
    }
}
