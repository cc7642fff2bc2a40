//! Cone marching cubes: each patch of a cell is a cone from one apex over its loop of crossings.
//!
//! Why the mesh cannot intersect itself: neighbouring cells have the same segments on their common
//! face, and those on an ambiguous face cut off different corners. A cone from a point inside a
//! convex cell over a simple loop on its boundary is embedded. The convex hulls of two patches of
//! one cell are separated by a plane, so apexes within their hulls keep them apart; in a cell of
//! one patch the apex may be anywhere inside.
//!
//! All of it holds for rounded positions, because the lattice itself is rounded to f32 first
//! (planes stay planes), crossings and apexes keep a margin from the planes, and
//! the separation of two hulls shrinks with that margin only.

use super::cell::Cell;
use super::index::{Apexes, Beside, Surface, crossed};
use super::loops::{Edge, PATCHES};
use crate::grid::Bricks;
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// The whole surface.
pub(super) fn extract(bricks: &Bricks<f32>, job: &dyn Job) -> Result<TriMesh, Cancelled> {
    let surface = Surface::new(bricks, Apexes::Wide, job)?;
    let mut mesh = surface.blank();
    let points = surface.points_of(&mut mesh.points);
    let parts: Vec<_> = points.into_iter().zip(surface.faces_of(&mut mesh.faces)).collect();
    parts.into_par_iter().enumerate().try_for_each(|(n, (points, faces))| {
        check(job)?;
        fill(&surface, n, points, faces);
        Ok(())
    })?;
    Ok(mesh)
}

/// Writes the points and faces of one brick.
fn fill(surface: &Surface, n: usize, points: &mut [DVec3], faces: &mut [[u32; 3]]) {
    let beside = surface.beside(surface.indices[n].brick);
    let (points, faces) = (points.iter_mut(), faces.iter_mut());
    let mut out = Writer { points, faces, next: surface.starts[n] };
    surface.visit(n, |cell, config| out.cell(cell, config, &beside));
}

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
        let id = |e: &Edge| beside.point(cell.at, *e);
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
