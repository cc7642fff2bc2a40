//! How large a run will be, before it is one.

use crate::field::sample::sample;
use crate::grid::{BRICK, Lattice};
use crate::iso::{Mesher, extract};
use crate::job::{Cancelled, Job};
use crate::morph::MorphError;
use crate::recipe::MorphEntry;
use crate::scene::{Draft, Scene};
use serde::Serialize;

/// Bricks, triangles and bytes of the largest frame, and of the run's memory at its peak.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Prediction {
    /// Frames to make.
    pub frames: u64,
    /// Side of a cell, mm.
    pub voxel_mm: f64,
    /// Bricks of the lattice.
    pub bricks: u64,
    /// Bricks that will hold samples.
    pub active_bricks: u64,
    /// Triangles of a frame.
    pub triangles: u64,
    /// Memory at the peak.
    pub memory_bytes: u64,
    /// Size of a frame's binary STL.
    pub file_bytes: u64,
}

/// How much surface there will be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Size {
    /// Bricks that will hold samples.
    active_bricks: f64,
    /// Triangles.
    triangles: f64,
}

// Per square of one cell's side, a surface in general position crosses 1.5 cells on average.
const CELLS_PER_SQUARE: f64 = 1.5;
// A cone has a triangle a corner of its loop, and loops have four on average.
const TRIANGLES_PER_CELL: f64 = 4.0;
// Bricks overlap the surface by their own size, and furniture has many edges.
const BRICK_ROOM: f64 = 2.5;
/// Triangles of a brick at most, every cell crossed.
const MOST_A_BRICK: f64 = 512.0 * TRIANGLES_PER_CELL;
/// Samples of a brick, and what is held beside them while it is meshed.
const BRICK_BYTES: f64 = 512.0 * 4.0 + 256.0;
/// A triangle and its half point, while the mesh is made, checked, written and read back.
const TRIANGLE_BYTES: f64 = 300.0;
/// The program, its threads and the input meshes.
const BASE_BYTES: f64 = 40e6;
/// The sampled form of a shape: leaves of 9³ samples, some of them coarse.
const LEAF_BYTES: f64 = 729.0 * 4.0 * 1.6;

/// From the shapes' areas alone: rough, but known before anything large is made.
pub fn predict(draft: &Draft) -> Prediction {
    let h = draft.step();
    let squares = |area: f64| area / (h * h);
    let areas = draft.areas();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    let bricks =
        |area: f64| squares(area) * CELLS_PER_SQUARE / f64::from(BRICK * BRICK) * BRICK_ROOM;
    // a hybrid that unites its parents has at most the surface of all of them
    let hybrid = areas.iter().sum::<f64>().min(2.0 * largest);
    let size = Size {
        active_bricks: bricks(hybrid),
        triangles: squares(hybrid) * CELLS_PER_SQUARE * TRIANGLES_PER_CELL,
    };
    let blocks = |b: &crate::num::Aabb| (b.size() / (h * 8.0)).ceil().element_product();
    let tables: f64 = draft.boxes().iter().map(|b| blocks(b) * 4.0).sum();
    let shapes = areas.iter().map(|&a| bricks(a) * LEAF_BYTES).sum::<f64>() + tables;
    let times = |v: &MorphEntry| v.t.as_ref().map_or(1, |t| t.0.len() as u64);
    let frames = draft.recipe().variants().iter().map(|(_, v)| times(v)).sum();
    let held = shapes + draft.method_bytes();
    total(frames, &Lattice::covering(&draft.domain(), h), size, held)
}

/// From the area (mm²) of one shape that is sampled directly.
pub fn predict_one(area: f64, lattice: &Lattice) -> Prediction {
    let squares = area / (lattice.step * lattice.step);
    let cells = squares * CELLS_PER_SQUARE;
    let size = Size {
        active_bricks: cells / f64::from(BRICK * BRICK) * BRICK_ROOM,
        triangles: cells * TRIANGLES_PER_CELL,
    };
    total(1, lattice, size, 0.0)
}

fn total(frames: u64, lattice: &Lattice, size: Size, shapes: f64) -> Prediction {
    let bricks: f64 =
        lattice.size.iter().map(|&n| (f64::from(n) / f64::from(BRICK)).ceil()).product();
    // however much surface lies folded into it, the lattice holds no more
    let size = Size {
        active_bricks: size.active_bricks.min(bricks),
        triangles: size.triangles.min(bricks * MOST_A_BRICK),
    };
    let memory = BASE_BYTES
        + shapes
        + bricks * 16.0
        + size.active_bricks * BRICK_BYTES
        + size.triangles * TRIANGLE_BYTES;
    Prediction {
        frames,
        voxel_mm: lattice.step,
        bricks: bricks as u64,
        active_bricks: size.active_bricks as u64,
        triangles: size.triangles as u64,
        memory_bytes: memory as u64,
        file_bytes: (84.0 + 50.0 * size.triangles) as u64,
    }
}

/// How many times larger cells a scene may have that predicts one of these cells: at most 4, and
/// no fewer than 64 along the longest side.
pub fn coarsening(draft: &Draft) -> f64 {
    (draft.longest() / draft.step() / 64.0).clamp(1.0, 4.0)
}

/// From a scene built with cells `coarser` times larger: the largest frame, scaled up with the
/// surface.
///
/// # Errors
/// Cancelled.
pub fn probe(
    coarse: &Scene,
    first: &Prediction,
    coarser: f64,
    job: &dyn Job,
) -> Result<Prediction, Cancelled> {
    let grow = coarser * coarser;
    let mut most = Size::default();
    for v in &coarse.variants {
        for &t in &v.times {
            let morph = match v.morph(t, job) {
                Ok(morph) => morph,
                Err(MorphError::Cancelled(stop)) => return Err(stop),
                Err(_) => continue,
            };
            let field = morph.at(t, job)?;
            let samples = sample(&*field, coarse.lattice, job)?;
            let mesh = extract(&samples.bricks, Mesher::Cone, job)?;
            let bricks = samples.stats.active_bricks as f64;
            most.active_bricks = most.active_bricks.max(bricks * grow);
            most.triangles = most.triangles.max(mesh.faces.len() as f64 * grow);
        }
    }
    let fixed = first.memory_bytes as f64
        - first.active_bricks as f64 * BRICK_BYTES
        - first.triangles as f64 * TRIANGLE_BYTES;
    Ok(Prediction {
        active_bricks: most.active_bricks as u64,
        triangles: most.triangles as u64,
        memory_bytes: (fixed + most.active_bricks * BRICK_BYTES + most.triangles * TRIANGLE_BYTES)
            as u64,
        file_bytes: (84.0 + 50.0 * most.triangles) as u64,
        ..*first
    })
}
