//! Running a scene: each frame becomes a mesh, a file, perhaps a picture, and a line in the
//! report that lies beside them.

mod animation;
pub mod compare;
mod feet;
mod files;
mod frame;
mod predict;
mod report;
mod system;

pub use crate::memory::{address_space, available_memory, peak_memory, reset_peak};
pub use animation::{AnimationReport, MOST_FRAMES, Playing, Reel, animation_memory};
pub use feet::Feet;
pub use files::{Names, place_text, time_word};
pub use frame::{FrameResult, Work, make};
pub use predict::{Growth, Prediction, Probe, coarsening, predict, predict_one};
pub use report::{FrameReport, Report, Seconds, ShapeReport};
pub use system::Machine;

use crate::job::{Cancelled, Job};
use crate::mesh::{self, MeshError};
use crate::morph::MorphError;
use crate::num::Aabb;
use crate::picture::{Image, PictureError, Style, render, save_png};
use crate::recipe::MesherEntry;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A morph that cannot be made.
    #[error(transparent)]
    Morph(#[from] MorphError),
    /// A mesh that cannot be written.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A picture that cannot be made or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Two results would be one file.
    #[error("{}: {count} results would be written to this one file; {cure}", file.display())]
    Collision {
        /// The file.
        file: PathBuf,
        /// How many.
        count: usize,
        /// What to change.
        cure: String,
    },
    /// An animation of too many frames.
    #[error("{}: {frames} frames; an animation has at most {MOST_FRAMES}", file.display())]
    Frames {
        /// The animation.
        file: PathBuf,
        /// How many it would have.
        frames: usize,
    },
    /// An output that is there already.
    #[error("{}: exists already; overwrite it with --force", .0.display())]
    Exists(PathBuf),
    /// An output that cannot be placed.
    #[error("{}: cannot be written: {why}", file.display())]
    Place {
        /// The file or folder.
        file: PathBuf,
        /// What the system said.
        why: std::io::Error,
    },
}

/// How to run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where results go.
    pub names: Names,
    /// Which mesher.
    pub mesher: MesherEntry,
    /// Whether files may be overwritten.
    pub force: bool,
    /// Whether to count self-intersections.
    pub verify: bool,
    /// How animations are played.
    pub playing: Playing,
    /// How pictures look; all at one scale, that of the shapes unless it has a frame.
    pub style: Style,
    /// SHA-256 of the recipe's text.
    pub recipe_hash: String,
}

impl Settings {
    /// What stands in the head of a mesh file.
    fn note(&self) -> String {
        format!("recipe={}", self.recipe_hash.get(..16).unwrap_or_default())
    }
}

/// Runs every frame of a scene and writes the report.
///
/// A frame that fails is reported and does not stop the others; being cancelled does.
///
/// # Errors
/// Outputs that collide or exist, a report that cannot be written, cancelled.
pub fn run(
    scene: &Scene,
    settings: &Settings,
    mut report: Report,
    job: &dyn Job,
    told: &mut dyn FnMut(&FrameReport),
) -> Result<Report, RunError> {
    let start = Instant::now();
    let mut settings = settings.clone();
    let shapes = scene.shapes.iter().fold(Aabb::EMPTY, |b, s| b.hull(s.bounds));
    settings.style.frame = settings.style.frame.or(Some(shapes));
    let settings = &settings;
    for variant in &scene.variants {
        let mut reel = Reel::new(&variant.name, settings);
        for &t in &variant.times {
            let work = Work {
                variant: &variant.name,
                t,
                lattice: scene.lattice,
                mesher: settings.mesher,
                crumbs: variant.crumbs,
                verify: settings.verify,
            };
            let start = Instant::now();
            let made = variant.morph(t, job);
            // a shape that moves is made anew
            let fresh = start.elapsed().as_secs_f64();
            let (made, notes) = match made {
                Ok(morph) => (make(&work, &|job| morph.at(t, job), job)?, morph.notes()),
                Err(MorphError::Cancelled(stop)) => return Err(stop.into()),
                Err(e) => (FrameResult::failed(&work, e.to_string()), Vec::new()),
            };
            let FrameResult { mesh, parts, report: mut frame } = made;
            frame.seconds.morph += fresh;
            frame.notes = notes.into_iter().filter(|n| !report.notes.contains(n)).collect();
            report.notes.extend(frame.notes.iter().cloned());
            frame.mean_volume(variant.mean_volume(t));
            let feet = variant.feet(t);
            if let Some(mesh) = mesh.as_ref().filter(|_| !feet.is_empty()) {
                frame.feet = Some(Feet::of(mesh, &parts, &feet, frame.voxel_mm));
            }
            drop(parts);
            let image = match &mesh {
                Some(mesh) => put(&mut frame, mesh, settings, job)?,
                None => None,
            };
            reel.add(t, mesh.as_ref(), image, job)?;
            told(&frame);
            report.frames.push(frame);
        }
        variant.forget();
        report.animations.extend(reel.finish(job)?);
    }
    report.seconds_total += start.elapsed().as_secs_f64();
    report.peak_memory_mb = peak_memory().map(|b| b as f64 / 1e6);
    place_text(&settings.names.report(), &report.to_json(), settings.force)?;
    Ok(report)
}

/// Writes the mesh and the picture of a frame, side by side, and gives the picture.
fn put(
    frame: &mut FrameReport,
    mesh: &mesh::TriMesh,
    settings: &Settings,
    job: &dyn Job,
) -> Result<Option<Image>, RunError> {
    crate::job::check(job)?;
    let file = settings.names.mesh(&frame.hybrid, frame.t);
    let picture = settings.names.picture(&frame.hybrid, frame.t);
    job.stage(if picture.is_some() { "write and draw" } else { "write" });
    files::folder_of(&file)?;
    picture.as_ref().map_or(Ok(()), |picture| files::folder_of(picture))?;
    let start = Instant::now();
    let write = || {
        let written = mesh::write(&file, mesh, &settings.note(), settings.force);
        (written, start.elapsed().as_secs_f64())
    };
    let draw = |picture: &Path| {
        let drawn = render(mesh, &settings.style).and_then(|image| {
            save_png(picture, &image, settings.force)?;
            Ok(image)
        });
        (drawn, start.elapsed().as_secs_f64())
    };
    // on one thread, the memory of what was made before is used again
    let ((written, writing), drawn) = match &picture {
        Some(picture) => rayon::join(write, || Some((picture, draw(picture)))),
        None => (write(), None),
    };
    frame.seconds.write = writing;
    match written {
        Ok(bytes) => {
            frame.file = Some(file.display().to_string());
            frame.file_bytes = Some(bytes);
        }
        Err(e) => frame.error = Some(e.to_string()),
    }
    let Some((picture, (drawn, drawing))) = drawn else {
        return Ok(None);
    };
    frame.seconds.picture = drawing;
    match drawn {
        Ok(image) => {
            frame.picture = Some(picture.display().to_string());
            Ok(Some(image))
        }
        Err(e) => {
            frame.error = Some(e.to_string());
            Ok(None)
        }
    }
}

/// The folder of a path, the current one for a bare name.
pub(crate) fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    }
}
