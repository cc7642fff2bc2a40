//! Comparing methods: the same shapes, times, lattice and mesher, the same measures, one report.

mod claims;
mod html;
mod measure;
mod methods;
mod row;
mod summary;

pub use claims::{Claim, Verdict, claims};
pub use measure::ParentReport;
pub use methods::{Chosen, METHODS, Method, OWN, choose, help};
pub use row::{Best, COLUMNS, Column, Row, csv};
pub use summary::{MEASURES, Measure, Summary};

use super::files::{folder_of, place_text, time_word};
use super::system::Machine;
use super::{
    AnimationReport, FrameResult, Names, Playing, Reel, RunError, Settings, ShapeReport, Work,
    make, peak_memory,
};
use crate::check::Shell;
use crate::field::Shared;
use crate::job::{self, Cancelled, Job};
use crate::memory::reset_peak;
use crate::mesh::{self, TriMesh};
use crate::morph::MorphError;
use crate::num::Aabb;
use crate::picture::{Cell, Image, Layout, Style, render, save_png, sheet};
use crate::recipe::MesherEntry;
use crate::scene::{Input, Scene, Search, Variant};
use measure::Parent;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How to compare.
#[derive(Clone, Debug)]
pub struct Compare {
    /// Where everything goes.
    pub folder: PathBuf,
    /// Whether files may be overwritten.
    pub force: bool,
    /// Whether to count self-intersections.
    pub verify: bool,
    /// Whether to write the meshes.
    pub meshes: bool,
    /// Which mesher.
    pub mesher: MesherEntry,
    /// Loose pieces below this share of the volume are dropped; the same for every method.
    pub crumbs: f64,
    /// Names of the shapes, those at t = 0 and 1 first.
    pub parents: Vec<String>,
    /// How pictures look.
    pub style: Style,
    /// Endings of the animations of each method: `webp`, `gif`, `glb`.
    pub animations: Vec<String>,
    /// How animations are played.
    pub playing: Playing,
}

/// Everything that was found: `metrics.json`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// Version of this program.
    pub version: String,
    /// The recipe's name.
    pub name: String,
    /// The recipe's file.
    pub recipe: Option<String>,
    /// SHA-256 of the recipe's text.
    pub recipe_sha256: String,
    /// What the command line said.
    pub arguments: Vec<String>,
    /// The machine.
    pub machine: Machine,
    /// The files read.
    pub inputs: Vec<Input>,
    /// The shapes made of them.
    pub shapes: Vec<ShapeReport>,
    /// The parents on the lattice of the frames.
    pub parents: Vec<ParentReport>,
    /// Side of a cell, mm.
    pub voxel_mm: f64,
    /// Samples along x, y, z.
    pub samples: [u32; 3],
    /// The times, in order; beforehand those asked for.
    pub times: Vec<f64>,
    /// What each method is, in the order of the rows.
    pub says: Vec<[String; 2]>,
    /// What was assumed and found.
    pub notes: Vec<String>,
    /// What the search of `auto` chose.
    pub searches: Vec<Search>,
    /// Seconds from files to fields.
    pub seconds_shapes: f64,
    /// Seconds in all.
    pub seconds_total: f64,
    /// Largest resident set, megabytes of 10^6 bytes.
    pub peak_memory_mb: Option<f64>,
    /// Each method over all times.
    pub methods: Vec<Summary>,
    /// What became of the animations.
    pub animations: Vec<AnimationReport>,
    /// What paper 001 says of these methods, and what the numbers say.
    pub claims: Vec<Claim>,
    /// Each method at each time.
    pub rows: Vec<Row>,
}

impl Comparison {
    /// As JSON, with a newline at the end.
    pub fn to_json(&self) -> String {
        // plain data with string keys: there is nothing that cannot be serialised
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The rows of a method, in the order of t.
    pub fn rows_of<'a>(&'a self, method: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |r| r.method == method)
    }
}

/// The fixed names of what is written.
const FILES: [&str; 4] = ["report.html", "metrics.csv", "metrics.json", "sheet.png"];

impl Compare {
    /// Whether everything can be written.
    ///
    /// # Errors
    /// The first file that is there already and not to be overwritten.
    pub fn check(&self, methods: &[String], times: &[f64]) -> Result<(), RunError> {
        if self.force {
            return Ok(());
        }
        let meshes = methods.iter().flat_map(|m| times.iter().map(|&t| mesh_name(m, t)));
        let films = methods.iter().flat_map(|m| {
            self.animations
                .iter()
                .map(move |ending| format!("animations/{}.{ending}", file_word(m)))
        });
        let meshes = meshes.filter(|_| self.meshes);
        let all = FILES.iter().map(|f| (*f).to_owned()).chain(meshes).chain(films);
        for name in all {
            let file = self.folder.join(name);
            if file.symlink_metadata().is_ok() {
                return Err(RunError::Exists(file));
            }
        }
        Ok(())
    }

    /// Collects the frames of a method for its animations.
    fn reel(&self, method: &str, recipe_hash: &str) -> Reel {
        let animations = self.animations.iter().map(|e| format!("animations/{{name}}.{e}"));
        let names = Names {
            folder: self.folder.clone(),
            mesh: String::new(),
            picture: None,
            animations: animations.collect(),
            report: String::new(),
            unnamed: String::new(),
        };
        let settings = Settings {
            names,
            mesher: self.mesher,
            force: self.force,
            verify: self.verify,
            playing: self.playing,
            style: self.style,
            recipe_hash: recipe_hash.to_owned(),
        };
        Reel::new(&file_word(method), &settings)
    }
}

/// A method's name in file names.
fn file_word(method: &str) -> String {
    method.replace([':', '/', '\\'], "-")
}

/// The mesh of a method at a time, relative to the folder.
fn mesh_name(method: &str, t: f64) -> String {
    format!("meshes/{}-{}.stl", file_word(method), time_word(t))
}

/// The box that all pictures are fitted to.
fn stage(scene: &Scene) -> Aabb {
    scene.shapes.iter().fold(Aabb::EMPTY, |b, s| b.hull(s.bounds))
}

/// Makes every method at every time and writes everything. `refused` are methods that do not
/// apply, and why; `about` is what is known beforehand.
///
/// A method or frame that fails leaves a row that says why; being cancelled ends it all.
///
/// # Errors
/// Outputs that exist or cannot be written, cancelled.
pub fn compare(
    scene: &Scene,
    refused: &[(String, String)],
    how: &Compare,
    mut about: Comparison,
    job: &dyn Job,
    told: &mut dyn FnMut(&Row),
) -> Result<Comparison, RunError> {
    let start = Instant::now();
    let mut how = how.clone();
    how.style.frame = how.style.frame.or(Some(stage(scene)));
    let mut parents = Vec::new();
    for name in how.parents.iter().take(2) {
        if let Some(shape) = scene.shapes.iter().find(|s| s.name == *name) {
            parents.push(Parent::new(shape, scene.lattice, job)?);
        }
    }
    about.parents = parents.iter().map(|p| p.about.clone()).collect();
    about.voxel_mm = scene.lattice.step;
    about.samples = scene.lattice.size;
    let handles = about.parents.iter().filter_map(|p| p.genus).max().unwrap_or(0);
    let mut pictures: Vec<Option<Image>> = Vec::new();
    about.times.sort_by(f64::total_cmp);
    about.times.dedup();
    for [method, _] in about.says.clone() {
        if let Some((_, why)) = refused.iter().find(|(name, _)| *name == method) {
            about.methods.push(Summary::refused(&method, why));
            about.rows.extend(about.times.iter().map(|&t| Row::refused(&method, t, why)));
            pictures.resize(about.rows.len(), None);
            continue;
        }
        let Some(variant) = scene.variants.iter().find(|v| v.name == method) else { continue };
        let mut reel = how.reel(&method, &about.recipe_sha256);
        let rows = frames(scene, variant, &parents, &how, job, (&mut pictures, &mut reel), told)?;
        // a method that vanishes has its rows to say so, and nothing to play
        if rows.iter().filter(|r| r.error.is_none()).count() > 1 {
            about.animations.extend(reel.finish(job)?);
        }
        about.notes.extend(notes(variant, &rows, job)?);
        about.methods.push(Summary::of(&method, &rows, handles));
        about.rows.extend(rows);
    }
    about.times = about.rows.iter().map(|r| r.t).collect();
    about.times.sort_by(f64::total_cmp);
    about.times.dedup();
    about.claims = claims(&about);
    about.seconds_total += start.elapsed().as_secs_f64();
    // peaks were reset on the way
    let peaks = about.methods.iter().filter_map(|m| m.peak_mb);
    about.peak_memory_mb = peaks.chain(peak_memory().map(|b| b as f64 / 1e6)).reduce(f64::max);
    job::check(job)?;
    write(&about, &pictures, &how, job)?;
    Ok(about)
}

/// One method at every time.
fn frames(
    scene: &Scene,
    variant: &Variant,
    parents: &[Parent],
    how: &Compare,
    job: &dyn Job,
    (pictures, reel): (&mut Vec<Option<Image>>, &mut Reel),
    told: &mut dyn FnMut(&Row),
) -> Result<Vec<Row>, RunError> {
    let mut times = variant.times.clone();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut rows = Vec::with_capacity(times.len());
    let mut before: Option<Shell> = None;
    for t in times {
        job::check(job)?;
        let work = Work {
            variant: &variant.name,
            t,
            lattice: scene.lattice,
            mesher: how.mesher,
            crumbs: how.crumbs,
            verify: how.verify,
        };
        let mut row =
            Row { method: variant.name.clone(), t, voxel_mm: scene.lattice.step, ..Row::default() };
        let fresh = reset_peak();
        let (made, field) = made(variant, &work, job)?;
        row.peak_mb = peak_memory().filter(|_| fresh).map(|b| b as f64 / 1e6);
        let mut report = made.report;
        report.mean_volume(variant.mean_volume(t));
        measure::health(&mut row, &report);
        let s = report.seconds;
        row.seconds = made.mesh.is_some().then_some(s.morph + s.sample + s.mesh);
        let start = Instant::now();
        let shell = made.mesh.map(Shell::new);
        let mut drawn = None;
        if let Some(shell) = &shell {
            // what of one is not for all cores is done beside the other
            let (measured, picture) = rayon::join(
                || measure::mesh(&mut row, shell, parents, before.as_ref(), job),
                || render(shell.mesh(), &how.style),
            );
            measured?;
            drawn = Some(picture?);
            row.gradient_error =
                field.and_then(|f| measure::gradient_error(&*f, shell.mesh(), scene.lattice.step));
        }
        row.seconds_measures = Some(s.check + start.elapsed().as_secs_f64());
        if let Some(shell) = shell.as_ref().filter(|_| how.meshes) {
            row.file = put(&mut row, shell.mesh(), how, job)?;
        }
        reel.add(t, shell.as_ref().map(Shell::mesh), drawn.clone(), job)?;
        pictures.push(drawn);
        told(&row);
        rows.push(row);
        before = shell;
    }
    Ok(rows)
}

/// What a method says of how it works, once it has been made.
fn notes(variant: &Variant, rows: &[Row], job: &dyn Job) -> Result<Vec<String>, Cancelled> {
    let Some(row) = rows.iter().find(|r| r.error.is_none()) else { return Ok(Vec::new()) };
    match variant.morph(row.t, job) {
        Err(MorphError::Cancelled(stop)) => Err(stop),
        morph => Ok(morph.map_or(Vec::new(), |m| m.notes())),
    }
}

/// The mesh of a frame and its field.
fn made(
    variant: &Variant,
    work: &Work<'_>,
    job: &dyn Job,
) -> Result<(FrameResult, Option<Shared>), Cancelled> {
    let start = Instant::now();
    job.stage("morph");
    let morph = match variant.morph(work.t, job) {
        Ok(morph) => morph,
        Err(MorphError::Cancelled(stop)) => return Err(stop),
        Err(e) => return Ok((FrameResult::failed(work, e.to_string()), None)),
    };
    let field = morph.at(work.t, job)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut made = make(work, &|_| Ok(field.clone()), job)?;
    made.report.seconds.morph += seconds;
    made.parts = Default::default();
    Ok((made, Some(field)))
}

/// Writes a mesh; what keeps it from being written is told in the row.
fn put(
    row: &mut Row,
    mesh: &TriMesh,
    how: &Compare,
    job: &dyn Job,
) -> Result<Option<String>, RunError> {
    job.stage("write");
    let name = mesh_name(&row.method, row.t);
    let path = how.folder.join(&name);
    folder_of(&path)?;
    match mesh::write(&path, mesh, &format!("{} t={}", row.method, time_word(row.t)), how.force) {
        Ok(_) => Ok(Some(name)),
        Err(e) => {
            row.error = Some(e.to_string());
            Ok(None)
        }
    }
}

/// Writes everything but the meshes.
fn write(
    about: &Comparison,
    pictures: &[Option<Image>],
    how: &Compare,
    job: &dyn Job,
) -> Result<(), RunError> {
    job.stage("report");
    let at = |name: &str| -> PathBuf { how.folder.join(name) };
    let [report, table, json, picture] = FILES.map(at);
    folder_of(&report)?;
    if !pictures.is_empty() {
        save_png(&picture, &contact_sheet(about, pictures)?, how.force)?;
    }
    place(&table, &csv(&about.rows), how)?;
    place(&json, &about.to_json(), how)?;
    place(&report, &html::page(about, pictures), how)
}

fn place(path: &Path, text: &str, how: &Compare) -> Result<(), RunError> {
    place_text(path, text, how.force)
}

/// Rows are methods, columns are times.
fn contact_sheet(about: &Comparison, pictures: &[Option<Image>]) -> Result<Image, RunError> {
    let mut cells = Vec::new();
    let mut labels = Vec::new();
    for s in about.methods.iter().filter(|s| s.frames > 0) {
        labels.push(s.method.clone());
        for &t in &about.times {
            let at = about.rows.iter().position(|r| r.method == s.method && r.t == t);
            let image = at.and_then(|i| pictures.get(i).cloned().flatten());
            cells.push(Cell { image, caption: String::new() });
        }
    }
    let layout = Layout {
        columns: about.times.len(),
        title: about.name.clone(),
        row_labels: labels,
        column_labels: about.times.iter().map(|t| format!("t = {}", time_word(*t))).collect(),
        ..Layout::default()
    };
    Ok(sheet(&cells, &layout)?)
}
