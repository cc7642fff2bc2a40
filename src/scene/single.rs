//! One shape on its own, as `convert` needs it.

use super::draft::cells;
use super::live::{self, Stop, Want};
use super::{Input, SceneError};
use crate::field::Shared;
use crate::grid::Lattice;
use crate::job::Job;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::recipe::{
    GridEntry, PlainOr, Problem, Recipe, ShapeEntry, Source, ThickenEntry, ThickenWhich, join,
};
use crate::surface::SurfaceError;
use std::collections::BTreeMap;
use std::path::Path;

/// A shape read and placed, not yet a field.
pub struct Single {
    placed: live::Placed,
    entry: ShapeEntry,
    /// The time at which it is taken: of what moves that of its entry, else 0.5; of the rest 0.
    pub t: f64,
    /// Where to sample it.
    pub lattice: Lattice,
}

impl Single {
    /// Reads and places a shape; its name serves messages.
    ///
    /// # Errors
    /// What is wrong with the entry, the grid or a file.
    pub fn open(
        name: &str,
        entry: ShapeEntry,
        grid: &GridEntry,
        beside: &Path,
    ) -> Result<Self, SceneError> {
        Self::read(name, entry, grid, beside, true)
    }

    /// As [`Single::open`], for its triangles alone: a surface may lack the thickness that its field
    /// would need.
    ///
    /// # Errors
    /// As [`Single::open`].
    pub fn outline(
        name: &str,
        entry: ShapeEntry,
        grid: &GridEntry,
        beside: &Path,
    ) -> Result<Self, SceneError> {
        Self::read(name, entry, grid, beside, false)
    }

    fn read(
        name: &str,
        entry: ShapeEntry,
        grid: &GridEntry,
        beside: &Path,
        solid: bool,
    ) -> Result<Self, SceneError> {
        let source = Source::unwritten();
        let shapes = BTreeMap::from([(name.to_owned(), entry.clone())]);
        let recipe = Recipe {
            version: crate::recipe::VERSION,
            grid: grid.clone(),
            shapes,
            ..Recipe::default()
        };
        let locate = |p: Problem| SceneError::Bad(source.locate(p));
        recipe.validate().map_err(locate)?;
        let at = join("shapes", name);
        let t = entry.at.unwrap_or(0.5);
        let want = Want { like: None, times: &[t], solid };
        let placed = live::load(name, &entry, beside, &want, &at).map_err(locate)?;
        let t = if placed.body.follows() { t } else { 0.0 };
        let lattice = cells(grid, placed.bounds, thickness(&entry)).map_err(locate)?;
        Ok(Self { placed, entry, t, lattice })
    }

    /// The box round it, mm.
    pub fn bounds(&self) -> Aabb {
        self.placed.bounds
    }

    /// Area of its triangles, mm².
    pub fn area(&self) -> f64 {
        self.placed.area
    }

    /// The same with what is thinner than `mm` made so thick, where the entry is a mesh and says nothing
    /// of it.
    pub(super) fn no_thinner(mut self, mm: f64) -> Self {
        if self.entry.mesh.is_some() && self.entry.thicken.is_none() && mm > 0.0 {
            let which = ThickenWhich::Thin;
            self.entry.thicken = Some(PlainOr::Table(ThickenEntry { mm, which }));
        }
        self
    }

    /// Its entry.
    pub(super) fn entry(&self) -> &ShapeEntry {
        &self.entry
    }

    /// What was assumed and found.
    pub fn notes(&self) -> &[String] {
        &self.placed.notes
    }

    /// The files it came from.
    pub fn inputs(&self) -> &[Input] {
        &self.placed.inputs
    }

    /// The triangles it is made of: the mesh itself, the raw shells of a solid's parts, or a surface
    /// without its thickness.
    ///
    /// # Errors
    /// What the surface says.
    pub fn shells(&self) -> Result<TriMesh, SceneError> {
        let bad = |e: SurfaceError| {
            let problem = Problem::new(join("shapes", &self.placed.name), e.to_string());
            SceneError::Bad(Source::unwritten().locate(problem))
        };
        self.placed.body.raw_shells(self.t, self.lattice.step).map_err(bad)
    }

    /// Its field, and what was found on the way.
    ///
    /// # Errors
    /// A mesh that encloses nothing; cancelled.
    pub fn field(self, job: &dyn Job) -> Result<(Shared, Vec<String>), SceneError> {
        self.exact(job).map(|made| (made.field, made.notes))
    }

    pub(super) fn exact(self, job: &dyn Job) -> Result<live::Exact, SceneError> {
        let source = Source::unwritten();
        let (t, step) = (self.t, self.lattice.step);
        live::exact(self.placed, &self.entry, t, step, job).map_err(|stop| match stop {
            Stop::Problem(p) => SceneError::Bad(source.locate(p)),
            Stop::Cancelled(c) => c.into(),
        })
    }
}

/// How far sheets grow beyond their mesh, mm.
fn thickness(entry: &ShapeEntry) -> f64 {
    entry.thicken.as_ref().map_or(0.0, |t| crate::recipe::ThickenEntry::of(t).mm / 2.0)
}
