//! `run.json`: what was made, from what, how long it took.

use super::{AnimationReport, Feet};
use crate::check::{Crumbs, Health};
use crate::scene::{Input, LiveShape, Search};
use serde::Serialize;

/// Seconds of each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Fixing the time, measuring what is automatic.
    pub morph: f64,
    /// Sampling the field.
    pub sample: f64,
    /// Making triangles.
    pub mesh: f64,
    /// Counting the cells in which the samples cannot exclude a surface.
    pub undecided: f64,
    /// Crumbs, the check.
    pub check: f64,
    /// Writing the mesh and reading it back.
    pub write: f64,
    /// The picture.
    pub picture: f64,
}

/// One frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameReport {
    /// The hybrid's name, empty for a recipe's only one.
    pub hybrid: String,
    /// The time.
    pub t: f64,
    /// The mesh, when it was written.
    pub file: Option<String>,
    /// Its size.
    pub file_bytes: Option<u64>,
    /// The picture, when it was written.
    pub picture: Option<String>,
    /// Why there is no mesh.
    pub error: Option<String>,
    /// Seconds of each stage.
    pub seconds: Seconds,
    /// Side of a cell, mm.
    pub voxel_mm: f64,
    /// Bricks that hold samples.
    pub active_bricks: u64,
    /// Bricks of the lattice.
    pub bricks: u64,
    /// Points at which the field was evaluated.
    pub evaluated: u64,
    /// Whether the shape reached the border of the lattice and was closed there.
    pub border_clipped: bool,
    /// Cells that look empty or full but may hold something smaller: at most so many, or with
    /// `--verify` so many left after a subdivision.
    pub undecided_cells: Option<u64>,
    /// Solids, crumbs left out.
    pub pieces: Option<u64>,
    /// Feet that should stand on the floor, and those that do; where there are features.
    pub feet: Option<Feet>,
    /// Loose pieces that were dropped.
    pub crumbs: Crumbs,
    /// Volume over the weighted mean of the parents' volumes.
    pub volume_kept: Option<f64>,
    /// The state of the mesh.
    pub health: Option<Health>,
    /// What the method found at this frame and had not said before; goes to the run's notes.
    #[serde(skip)]
    pub notes: Vec<String>,
}

impl FrameReport {
    /// Fills in the volume kept.
    pub(super) fn mean_volume(&mut self, mean: f64) {
        let volume = self.health.as_ref().and_then(|h| h.volume_mm3);
        self.volume_kept = volume.filter(|_| mean > 0.0).map(|v| v / mean);
    }
}

/// One shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShapeReport {
    /// Its name.
    pub name: String,
    /// Volume of the inside, mm³.
    pub volume_mm3: f64,
    /// Lowest and highest corner of the box round it.
    pub bbox_mm: [[f64; 3]; 2],
    /// Seconds to make its field.
    pub seconds_field: f64,
    /// Seconds to sample it.
    pub seconds_samples: f64,
}

impl ShapeReport {
    /// What there is to tell of a shape.
    pub fn of(s: &LiveShape) -> Self {
        let [seconds_field, seconds_samples] = s.seconds;
        Self {
            name: s.name.clone(),
            volume_mm3: s.volume,
            bbox_mm: [s.bounds.min.to_array(), s.bounds.max.to_array()],
            seconds_field,
            seconds_samples,
        }
    }
}

/// A whole run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Version of this program.
    pub version: String,
    /// The recipe's file, if there is one.
    pub recipe: Option<String>,
    /// SHA-256 of the recipe's text.
    pub recipe_sha256: String,
    /// What the command line said.
    pub arguments: Vec<String>,
    /// The files read.
    pub inputs: Vec<Input>,
    /// The shapes made of them.
    pub shapes: Vec<ShapeReport>,
    /// Nothing here is random; the seed of what may become so.
    pub seed: u64,
    /// Threads used.
    pub threads: usize,
    /// Seconds from files to fields.
    pub seconds_shapes: f64,
    /// Seconds in all.
    pub seconds_total: f64,
    /// Largest resident set, megabytes of 10^6 bytes.
    pub peak_memory_mb: Option<f64>,
    /// What was assumed and found.
    pub notes: Vec<String>,
    /// What was chosen for the hybrids whose method was `auto`.
    pub searches: Vec<Search>,
    /// The frames.
    pub frames: Vec<FrameReport>,
    /// The files that play them.
    pub animations: Vec<AnimationReport>,
}

impl Report {
    /// As JSON, with a newline at the end.
    pub fn to_json(&self) -> String {
        // plain data with string keys: there is nothing that cannot be serialised
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Whether every frame has its mesh, and every animation was written.
    pub fn complete(&self) -> bool {
        self.frames.iter().all(|f| f.error.is_none())
            && self.animations.iter().all(|a| a.error.is_none())
    }

    /// Whether every mesh there is can be printed.
    pub fn printable(&self) -> bool {
        self.frames.iter().filter_map(|f| f.health.as_ref()).all(|h| h.printable)
    }
}
