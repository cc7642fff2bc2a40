//! How large a run will be, before it is one.

use crate::field::sample::sample;
use crate::grid::{BRICK, Lattice};
use crate::iso::{Mesher, extract};
use crate::job::{Cancelled, Job};
use crate::memory::{peak_memory, resident_memory};
use crate::morph::MorphError;
use crate::num::Aabb;
use crate::picture::working_memory;
use crate::recipe::MorphEntry;
use crate::scene::{Draft, Held, Scene, Tessellated, some};
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
/// A brick of the lattice, whatever it holds.
const PLACE_BYTES: f64 = 16.0;
/// Samples of a brick, and what is held beside them while it is meshed.
const BRICK_BYTES: f64 = 512.0 * 4.0 + 256.0;
/// A triangle and its half point.
const TRIANGLE_BYTES: f64 = 24.0;
/// What a triangle takes beside that while the mesh is checked, or written and read back.
const WORK_BYTES: f64 = 130.0;
/// The same while loose pieces are dropped.
const SWEPT_BYTES: f64 = 150.0;
/// What a triangle takes while it is drawn: single precision, normals, its place in bands.
const DRAWN_BYTES: f64 = 50.0;
/// What a triangle of an input takes while the field of its mesh is made.
const FIELD_BYTES: f64 = 550.0;
/// A triangle in the field of a surface that is closed: in two trees, of the faces and of what tells
/// inside from outside. Measured on tori of 20 000 to 720 000 triangles: 640 to 720.
const SOLID_BYTES: f64 = 650.0;
/// The same in the field of a sheet: one tree. Measured: 460 to 630.
const SHEET_BYTES: f64 = 460.0;
/// What a triangle takes beside that while such a field is made. Measured: 270 to 350.
const MAKING_BYTES: f64 = 300.0;
/// Triangles of a surface's own mesh for one of the result, roughly.
const OWN_SHARE: f64 = 0.3;
/// The sampled form of a shape: leaves of 9³ samples, some of them coarse.
const LEAF_BYTES: f64 = 729.0 * 4.0 * 1.6;
/// Share of a frame that the heap keeps while the next one is made.
const LEFT: f64 = 0.35;
/// The program and its threads, where the system does not tell what they have.
const PROGRAM_BYTES: f64 = 12e6;

/// What is known before anything large is made.
struct Known<'a> {
    frames: u64,
    lattice: &'a Lattice,
    /// Taken already: the program, its threads, inputs, and what was worked out on the way.
    taken: f64,
    /// Held beside each frame: the shapes.
    held: f64,
    /// Taken while shapes and what methods need are made, and given back after.
    passing: f64,
    /// All that there is while shapes are made whose exact fields do not stay.
    making: f64,
    /// Free in what is taken, for frames to use again.
    free: f64,
    /// Whether loose pieces are dropped.
    swept: bool,
    /// Width and height of the pictures, if there are any.
    picture: Option<[u32; 2]>,
}

impl Known<'_> {
    /// However much surface lies folded into it, the lattice holds no more.
    fn prediction(&self, size: Size) -> Prediction {
        let bricks: f64 =
            self.lattice.size.iter().map(|&n| (f64::from(n) / f64::from(BRICK)).ceil()).product();
        let size = Size {
            active_bricks: size.active_bricks.min(bricks),
            triangles: size.triangles.min(bricks * MOST_A_BRICK),
        };
        Prediction {
            frames: self.frames,
            voxel_mm: self.lattice.step,
            bricks: bricks as u64,
            active_bricks: size.active_bricks as u64,
            triangles: size.triangles as u64,
            memory_bytes: self.peak(bricks, size) as u64,
            file_bytes: (84.0 + 50.0 * size.triangles) as u64,
        }
    }

    /// The larger of two peaks: while shapes are made, and while a frame is.
    fn peak(&self, bricks: f64, size: Size) -> f64 {
        let samples = bricks * PLACE_BYTES + size.active_bricks * BRICK_BYTES;
        let drawing = |p| working_memory(p) + size.triangles * DRAWN_BYTES;
        let checking = size.triangles * if self.swept { SWEPT_BYTES } else { WORK_BYTES };
        let work = checking.max(self.picture.map_or(0.0, drawing));
        let mesh = samples + size.triangles * TRIANGLE_BYTES;
        let frame = mesh + work;
        let left = if self.frames > 1 { LEFT * (mesh + checking) } else { 0.0 };
        let later = (frame + left - self.free).max(self.passing);
        self.making.max(self.taken + self.held + later)
    }
}

/// From the shapes' areas alone: rough, but known before anything large is made. `picture` is the
/// size of pictures, if there will be any.
pub fn predict(draft: &Draft, picture: Option<[u32; 2]>) -> Prediction {
    let h = draft.step();
    let areas = draft.areas();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    // a hybrid that unites its parents has at most the surface of all of them
    let hybrid = areas.iter().sum::<f64>().min(2.0 * largest);
    let times = |v: &MorphEntry| v.t.as_ref().map_or(1, |t| t.0.len() as u64);
    let surfaces = size(draft.largest_surface(), h).triangles * OWN_SHARE;
    let known = Known {
        frames: draft.recipe().variants().iter().map(|(_, v)| times(v)).sum(),
        lattice: &Lattice::covering(&draft.domain(), h),
        taken: taken(),
        held: sampled_bytes(draft, h),
        passing: (surfaces.max(draft.faces_at_once() as f64) * FIELD_BYTES)
            .max(draft.method_bytes()),
        making: 0.0,
        free: 0.0,
        swept: !draft.recipe().features.is_empty(),
        picture,
    };
    known.prediction(size(hybrid, h))
}

/// From the area (mm²) of one shape that is sampled directly.
pub fn predict_one(area: f64, lattice: &Lattice) -> Prediction {
    let known = Known {
        frames: 1,
        lattice,
        taken: taken(),
        held: 0.0,
        passing: 0.0,
        making: 0.0,
        free: 0.0,
        swept: true,
        picture: None,
    };
    known.prediction(size(area, lattice.step))
}

/// Memory that this process has, bytes.
fn taken() -> f64 {
    resident_memory().map_or(PROGRAM_BYTES, |b| b as f64)
}

/// Bricks along a surface of that area (mm²) in cells of `h` mm.
fn bricks(area: f64, h: f64) -> f64 {
    area / (h * h) * CELLS_PER_SQUARE / f64::from(BRICK * BRICK) * BRICK_ROOM
}

fn size(area: f64, h: f64) -> Size {
    let cells = area / (h * h) * CELLS_PER_SQUARE;
    Size { active_bricks: bricks(area, h), triangles: cells * TRIANGLES_PER_CELL }
}

/// The sampled forms of all shapes with cells of `h` mm.
fn sampled_bytes(draft: &Draft, h: f64) -> f64 {
    let blocks = |b: &Aabb| (b.size() / (h * 8.0)).ceil().element_product();
    let bytes = |(box_, area): &(Aabb, f64)| bricks(*area, h) * LEAF_BYTES + blocks(box_) * 4.0;
    draft.sampled(h).iter().map(bytes).sum()
}

/// How many times larger cells a scene may have that predicts one of these cells: at most 4, and
/// no fewer than 64 along the longest side.
pub fn coarsening(draft: &Draft) -> f64 {
    (draft.longest() / draft.step() / 64.0).clamp(1.0, 4.0)
}

/// What a coarse scene is looked at for.
pub struct Probe<'a> {
    /// The scene, with cells `coarser` times as large.
    pub coarse: &'a Scene,
    /// How many times as large its cells are.
    pub coarser: f64,
    /// What was predicted from the areas.
    pub first: Prediction,
    /// What the run takes beyond it.
    pub growth: Growth,
    /// Width and height of pictures, if there will be any.
    pub picture: Option<[u32; 2]>,
}

/// What a run takes beyond a scene with larger cells, bytes.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// Held beside each frame: sampled forms, and what shapes that move keep.
    held: f64,
    /// While a shape whose field stays, or what a method needs, is made.
    passing: f64,
    /// All that there is while a shape is made whose exact field does not stay.
    making: f64,
    /// What the process had before any field was made, and the sampled forms of the coarse scene.
    before: f64,
}

impl Growth {
    /// From a scene with cells `coarser` times as large to that of the draft.
    pub fn of(draft: &Draft, coarser: f64) -> Self {
        let h = draft.step();
        let coarse = sampled_bytes(draft, h * coarser);
        let before = taken() + coarse;
        let sampled = sampled_bytes(draft, h) - coarse;
        let fine = draft.tessellated(h);
        let first = held(&fine);
        let kept =
            first - if coarser > 1.0 { held(&draft.tessellated(h * coarser)) } else { first };
        let (stays, goes) = making(&fine);
        let passing = stays.max(draft.method_bytes());
        Self { held: sampled + kept, passing, making: before - coarse + goes, before }
    }
}

/// Bytes of a surface's field, and of all its triangles while it is made.
fn field_bytes(s: &Tessellated) -> f64 {
    s.triangles as f64 * if s.sheet { SHEET_BYTES } else { SOLID_BYTES }
}

/// The fields of surfaces that are there at once: all the first ones, and one that is of the frame.
fn held(surfaces: &[Tessellated]) -> f64 {
    let of = |held| surfaces.iter().filter(move |s| s.held == held).map(field_bytes);
    of(Held::First).sum::<f64>() + of(Held::Last).fold(0.0, f64::max)
}

/// What is taken while the largest field is made: beyond what is held, of those that stay; of those that
/// do not, beyond the program: they are made first.
fn making(surfaces: &[Tessellated]) -> (f64, f64) {
    let most = |stays: bool| {
        let of = surfaces.iter().filter(|s| (s.held != Held::Never) == stays);
        let own = |s: &Tessellated| if stays { 0.0 } else { field_bytes(s) };
        of.map(|s| own(s) + s.triangles as f64 * MAKING_BYTES).fold(0.0, f64::max)
    };
    (most(true), most(false))
}

impl Probe<'_> {
    /// The largest of some frames, scaled up with the surface; beside it what this process has taken
    /// to come so far, which the run will take too: program, inputs, fields, what searches leave.
    ///
    /// # Errors
    /// Cancelled.
    pub fn predict(&self, lattice: &Lattice, job: &dyn Job) -> Result<Prediction, Cancelled> {
        let (before, now) = (peak_memory().map(|b| b as f64), taken());
        let (most, with_fields) = self.largest(job)?;
        let known = Known {
            frames: self.first.frames,
            lattice,
            // with what shapes that move keep from time to time
            taken: with_fields.max(now),
            held: self.growth.held,
            passing: before.map_or(0.0, |peak| peak - now).max(self.growth.passing),
            making: self.growth.making,
            // fields leave holes, which pictures and meshes fill by about a half
            free: (now - self.growth.before).max(0.0) / 2.0,
            swept: self.coarse.variants.iter().any(|v| v.crumbs > 0.0),
            picture: self.picture,
        };
        Ok(known.prediction(most))
    }

    /// And what the process has while it holds the fields of a variant.
    fn largest(&self, job: &dyn Job) -> Result<(Size, f64), Cancelled> {
        let grow = self.coarser * self.coarser;
        let (mut most, mut with_fields) = (Size::default(), 0.0f64);
        for v in &self.coarse.variants {
            for t in some(&v.times) {
                let morph = match v.morph(t, job) {
                    Ok(morph) => morph,
                    Err(MorphError::Cancelled(stop)) => return Err(stop),
                    Err(_) => continue,
                };
                let field = morph.at(t, job)?;
                let samples = sample(&*field, self.coarse.lattice, job)?;
                let mesh = extract(&samples.bricks, Mesher::Cone, job)?;
                let bricks = samples.stats.active_bricks as f64;
                most.active_bricks = most.active_bricks.max(bricks * grow);
                most.triangles = most.triangles.max(mesh.faces.len() as f64 * grow);
            }
            with_fields = with_fields.max(taken());
            // as the run does
            v.forget();
        }
        Ok((most, with_fields))
    }
}
