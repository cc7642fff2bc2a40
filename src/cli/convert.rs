//! `convert`: any mesh, solid or surface, into a clean watertight mesh.

use super::failure::Failure;
use super::inputs::{self, Fineness, Reading};
use super::watch::Watch;
use super::{Making, npy, steps};
use clap::Args;
use fieldgraft::check::{Options, inspect};
use fieldgraft::field::Shared;
use fieldgraft::grid::Lattice;
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::{check_output, write};
use fieldgraft::recipe::{GridEntry, MesherEntry, RecipeError};
use fieldgraft::run::{self, FrameReport, FrameResult, Names, Report, Work, predict_one};
use fieldgraft::scene::{SceneError, Single, sha256};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to convert.
#[derive(Args)]
pub struct Convert {
    /// A mesh (OBJ, STL, PLY, GLB, glTF), or a solid or surface (`.toml`)
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// A mesh (STL, OBJ, PLY, GLB), or a field: the dense samples as `.npy`, with a `.json` beside
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    fineness: Fineness,
    /// Write the triangles as they are: the mesh itself, the raw shells of a solid's parts, or a
    /// surface without its thickness
    #[arg(long, conflicts_with_all = ["resolution", "voxel", "thicken", "sign"])]
    shells: bool,
    /// Drop loose pieces below this share of the volume
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    crumbs: f64,
    /// How triangles are made: print, sharp (keeps edges and corners) or preview
    #[arg(long, value_name = "MESHER", value_parser = inputs::mesher)]
    mesher: Option<MesherEntry>,
    #[command(flatten)]
    making: Making,
}

impl Convert {
    /// Converts.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        let name = self.input.display().to_string();
        self.convert(watch).map_err(|e| e.about(&name))
    }

    fn convert(self, watch: &Watch) -> Result<(), Failure> {
        let start = Instant::now();
        let field_out =
            self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) && !self.shells;
        self.check_output(field_out)?;
        let single = self.open(watch)?;
        if self.shells {
            return self.write_shells(&single, watch);
        }
        let prediction = predict_one(single.area(), &single.lattice);
        if self.making.dry_run {
            steps::tell_prediction(&prediction, &self.making, watch)?;
        }
        steps::refuse(&prediction, steps::limit(&self.making))?;
        if self.making.dry_run {
            return Ok(());
        }
        let (lattice, t, inputs) = (single.lattice, single.t, single.inputs().to_vec());
        let mut notes = single.notes().to_vec();
        let (field, found) = single.field(watch).map_err(plain)?;
        found.iter().for_each(|n| watch.say(unnamed(n)));
        notes.extend(found);
        if field_out {
            return npy::write(&self.output, &*field, lattice, self.making.force, watch);
        }
        let report = Report {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            recipe_sha256: sha256(b""),
            arguments: steps::arguments(),
            inputs,
            threads: rayon::current_num_threads(),
            seconds_shapes: start.elapsed().as_secs_f64(),
            notes,
            ..Report::default()
        };
        self.make(&field, (lattice, t), report, start, watch)
    }

    /// Refuses options and outputs that cannot be, before any work.
    fn check_output(&self, field_out: bool) -> Result<(), Failure> {
        if !(0.0..1.0).contains(&self.crumbs) {
            return Err(Failure::usage("--crumbs: expected a share of the volume, 0 to below 1"));
        }
        match field_out {
            _ if self.making.dry_run => Ok(()),
            true => npy::check_output(&self.output, self.making.force),
            false => Ok(check_output(&self.output, self.making.force)?),
        }
    }

    fn open(&self, watch: &Watch) -> Result<Single, Failure> {
        let Some(entry) = self.reading.shapes(&[&self.input])?.pop() else {
            return Err(Failure::usage("nothing to convert"));
        };
        let grid = GridEntry {
            resolution: self.fineness.resolution,
            voxel: self.fineness.voxel,
            ..GridEntry::default()
        };
        watch.stage("read");
        let single = Single::open("input", entry, &grid, Path::new("")).map_err(plain)?;
        single.notes().iter().for_each(|n| watch.say(unnamed(n)));
        Ok(single)
    }

    /// Makes the mesh, writes it and its report.
    fn make(
        &self,
        field: &Shared,
        (lattice, t): (Lattice, f64),
        mut report: Report,
        start: Instant,
        watch: &Watch,
    ) -> Result<(), Failure> {
        let work = Work {
            variant: "",
            t,
            lattice,
            mesher: self.mesher.unwrap_or_default(),
            crumbs: self.crumbs,
            verify: self.making.verify || self.making.strict,
        };
        let FrameResult { mesh, report: mut frame, .. } =
            run::make(&work, &|_| Ok(field.clone()), watch)?;
        if let Some(mesh) = &mesh {
            self.write_mesh(&mut frame, mesh, watch)?;
        }
        steps::tell(&frame, watch);
        report.frames.push(frame);
        report.seconds_total = start.elapsed().as_secs_f64();
        report.peak_memory_mb = run::peak_memory().map(|b| b as f64 / 1e6);
        // the mesh is there already; its report belongs to it and follows it
        run::place_text(&beside(&self.output), &report.to_json(), true)?;
        steps::finish(&report, &self.making, watch)
    }

    fn write_mesh(
        &self,
        frame: &mut FrameReport,
        mesh: &fieldgraft::mesh::TriMesh,
        watch: &Watch,
    ) -> Result<(), Failure> {
        job::check(watch)?;
        watch.stage("write");
        let start = Instant::now();
        let bytes = write(&self.output, mesh, "", self.making.force)?;
        frame.seconds.write = start.elapsed().as_secs_f64();
        frame.file = Some(self.output.display().to_string());
        frame.file_bytes = Some(bytes);
        Ok(())
    }

    fn write_shells(&self, single: &Single, watch: &Watch) -> Result<(), Failure> {
        let mesh = single.shells().map_err(plain)?;
        if self.making.dry_run {
            return watch.put(&format!("triangles  {}", mesh.faces.len()));
        }
        job::check(watch)?;
        write(&self.output, &mesh, "", self.making.force)?;
        let health = inspect(&mesh, &Options { self_intersections: false });
        watch.say(&format!(
            "{}: {} triangles as they are, {} shells, closed {}",
            self.output.display(),
            health.triangles,
            health.components,
            if health.closed { "yes" } else { "no" }
        ));
        if self.making.json {
            watch.put(&serde_json::to_string_pretty(&health).unwrap_or_default())?;
        }
        Ok(())
    }
}

/// A note without the name that only this command gave.
pub fn unnamed(note: &str) -> &str {
    note.strip_prefix("input: ").unwrap_or(note)
}

/// The report beside a mesh: `chair.stl` -> `chair.run.json`.
pub fn beside(output: &Path) -> PathBuf {
    output.with_extension("run.json")
}

/// An error without the key of a recipe that the user never wrote.
pub fn plain(e: SceneError) -> Failure {
    match e {
        SceneError::Bad(RecipeError { file, line, at, why }) => {
            let invented = file.as_os_str().is_empty() && at.starts_with("shapes.");
            let at = if invented { String::new() } else { at };
            RecipeError { file, line, at, why }.into()
        }
        SceneError::Cancelled(c) => c.into(),
    }
}

/// Names of results for a template that stands on the command line.
pub fn names(output: &str, picture: Option<String>) -> Names {
    let bare = output.replace("{t}", "").replace("{name}", "");
    let report = beside(Path::new(&bare)).display().to_string();
    let folder = PathBuf::new();
    // `hybrid-{t}.stl` has its report in `hybrid.run.json`
    let report = report.replace("-.run.json", ".run.json").replace("_.run.json", ".run.json");
    Names {
        folder,
        mesh: output.to_owned(),
        picture,
        animations: vec![],
        report,
        unnamed: String::new(),
    }
}
