//! Shapes read and placed: enough to know how large the work will be.

use super::auto::{self, Featured, Search};
use super::body::Body;
use super::live::LiveShape;
use super::live::{self, Exact, Placed, Stop, Want};
use super::variant::{Parts, Variant, asked};
use super::{Scene, SceneError, mesh_element, pair, pairs, plan, scheme};
use crate::element::Element;
use crate::grid::{BRICK, Lattice};
use crate::job::{self, Job};
use crate::morph::MorphError;
use crate::num::Aabb;
use crate::recipe::{
    GridEntry, MethodEntry, MorphEntry, PlaceLike, PlainOr, Problem, Recipe, Source, join,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A recipe whose shapes have been read and placed.
pub struct Draft {
    recipe: Recipe,
    source: Source,
    /// The folder paths are relative to.
    beside: PathBuf,
    placed: Vec<Placed>,
    /// What the shapes are for, by name.
    uses: BTreeMap<String, Use>,
    /// Side of a cell, mm.
    step: f64,
    /// What `auto` found on the shapes.
    found: Vec<String>,
    /// Fields it has made of them.
    ready: BTreeMap<String, Exact>,
}

impl Draft {
    /// Reads and places the shapes that take part; `beside` is the folder paths are relative to.
    ///
    /// # Errors
    /// What is wrong in the recipe or a file, by its key; cancelled.
    pub fn open(
        recipe: Recipe,
        source: Source,
        beside: &Path,
        job: &dyn Job,
    ) -> Result<Self, SceneError> {
        job.stage("read");
        // names are looked up freely from here on
        recipe.validate().map_err(|p| source.locate(p))?;
        let featured = auto::with_features(recipe, &source, beside, job)?;
        let Featured { recipe, found, ready } = featured;
        let uses = uses(&recipe).map_err(|p| source.locate(p))?;
        // those that stand like another come after it
        let like = |n: &String| match &recipe.shapes[n].place {
            PlainOr::Table(PlaceLike { like }) => Some(like.clone()),
            PlainOr::Plain(_) => None,
        };
        let (second, first): (Vec<&String>, Vec<&String>) =
            uses.keys().partition(|&n| like(n).is_some());
        let load = |name: &String, like: Option<Aabb>| {
            let (at, entry) = (join("shapes", name), &recipe.shapes[name]);
            let want = Want { like, times: &uses[name].times, solid: true };
            live::load(name, entry, beside, &want, &at)
                .map_err(|p| SceneError::from(source.locate(p)))
        };
        let short = |n: &&String| pairs::is_short(&recipe.shapes[*n], beside);
        let alone = |n: &String, _: &dyn Job| load(n, None);
        let mut placed = pairs::in_pairs(first, ("read", |n| n), short, job, alone)?;
        for name in second {
            job::check(job)?;
            job.stage(&format!("read {name}"));
            let like = like(name);
            let box_ = placed.iter().find(|p| Some(&p.name) == like.as_ref()).map(|p| p.stands);
            placed.push(load(name, box_)?);
        }
        placed.sort_by(|a, b| a.name.cmp(&b.name));
        let step = step(&recipe.grid, longest(&placed));
        Ok(Self { recipe, source, beside: beside.to_owned(), placed, uses, step, found, ready })
    }

    /// Side of a cell, mm.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The longest side of all shapes together, mm.
    pub fn longest(&self) -> f64 {
        longest(&self.placed)
    }

    /// The space that results are sampled in, as far as it is known without the fields.
    pub fn domain(&self) -> Aabb {
        hull(&self.placed).grow(self.padding())
    }

    /// Area of the triangles of each shape, mm².
    pub fn areas(&self) -> Vec<f64> {
        self.placed.iter().map(|p| p.area).collect()
    }

    /// Triangles of meshes whose fields are made at once, at most.
    pub fn faces_at_once(&self) -> usize {
        pairs::faces_at_once(&self.placed)
    }

    /// Area of the largest surface among the shapes, mm².
    pub fn largest_surface(&self) -> f64 {
        let surfaces = self.placed.iter().filter(|p| matches!(p.body, Body::Surface(_)));
        surfaces.map(|p| p.area).fold(0.0, f64::max)
    }

    /// The surfaces among the shapes, and those between two of them, as cells of `step` mm ask.
    pub fn tessellated(&self, step: f64) -> Vec<Tessellated> {
        let shapes = self.placed.iter().filter_map(|p| {
            let Body::Surface(s) = &p.body else { return None };
            let purpose = &self.uses[&p.name];
            let first = purpose.times.first().copied().unwrap_or(0.5);
            let of = |triangles, held| Tessellated { triangles, sheet: s.sheet().is_some(), held };
            let at_first = s.triangles(first, step);
            if !s.moves() {
                let held = if purpose.alone { Held::First } else { Held::Never };
                return Some(vec![of(at_first, held)]);
            }
            // the first for the whole run, and that of the frame
            let later = some(&purpose.times).into_iter().filter(|&t| t != first);
            let most = later.map(|t| s.triangles(t, step)).fold(at_first, usize::max);
            Some(vec![of(at_first, Held::First), of(most, Held::Last)])
        });
        let pairs = self.recipe.variants().into_iter().filter_map(|(at, entry)| {
            let method = entry.method?.surface()?;
            let names = plan::shape_names(&entry, &self.recipe, &at).ok()?;
            let [a, b] = names.as_slice() else { return None };
            let placed = |n: &String| self.placed.iter().find(|p| p.name == *n);
            let (Body::Surface(from), Body::Surface(to)) = (&placed(a)?.body, &placed(b)?.body)
            else {
                return None;
            };
            let entries = [a, b].map(|n| &self.recipe.shapes[n]);
            let (s, _) = pair::between([from, to], entries, method, &self.beside, &at).ok()?;
            let times = asked(&entry);
            let middle = times.get(times.len() / 2).copied().unwrap_or(0.5);
            let sheet = s.sheet().is_some();
            Some(Tessellated { triangles: s.triangles(middle, step), sheet, held: Held::Last })
        });
        shapes.flatten().chain(pairs).collect()
    }

    /// The box and the area (mm²) of each shape that has a sampled form in cells of `step` mm. Both sides
    /// of a sheet thinner than a brick lie in the same bricks.
    pub fn sampled(&self, step: f64) -> Vec<(Aabb, f64)> {
        let sampled = self.placed.iter().filter(|p| {
            let purpose = &self.uses[&p.name];
            let moves = matches!(&p.body, Body::Surface(s) if s.moves());
            purpose.morphs || !(purpose.alone || moves)
        });
        let thin = |p: &Placed| match &p.body {
            Body::Surface(s) => s.sheet().is_some_and(|mm| mm < f64::from(BRICK) * step),
            _ => false,
        };
        sampled.map(|p| (p.bounds, if thin(p) { p.area / 2.0 } else { p.area })).collect()
    }

    /// The lattice that results are sampled on, as far as it is known without the fields.
    pub fn lattice(&self) -> Lattice {
        Lattice::covering(&self.domain(), self.step)
    }

    /// The recipe.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Memory (bytes) that the methods need beside the shapes and the frames, all held at once.
    pub fn method_bytes(&self) -> f64 {
        let domain = hull(&self.placed);
        let bytes = |(at, entry): &(String, MorphEntry)| -> Option<f64> {
            let names = plan::shape_names(entry, &self.recipe, at).ok()?;
            let method = plan::method(entry, &names, &self.recipe, at).ok()?;
            let of: Vec<&str> = names.iter().map(String::as_str).collect();
            let scheme = scheme::scheme(entry, method, &of, self.step, &self.recipe).ok()?;
            Some(scheme.bytes(&domain, of.len()))
        };
        self.recipe.variants().iter().filter_map(bytes).sum()
    }

    fn padding(&self) -> f64 {
        self.longest() * self.recipe.grid.padding.unwrap_or(GridEntry::PADDING)
    }

    /// Makes the fields, elements and plans.
    ///
    /// # Errors
    /// What is wrong in the recipe or a file, by its key; cancelled.
    pub fn build(self, job: &dyn Job) -> Result<Scene, SceneError> {
        let (scene, refused) = self.build_each(job)?;
        refused.into_iter().next().map_or(Ok(scene), |(_, why)| Err(why))
    }

    /// [`Draft::build`], but a hybrid that cannot be planned does not stop the others: its name and
    /// what is wrong come back beside the scene.
    ///
    /// # Errors
    /// What is wrong with the shapes or the grid, by its key; cancelled.
    pub fn build_each(
        self,
        job: &dyn Job,
    ) -> Result<(Scene, Vec<(String, SceneError)>), SceneError> {
        let (padding, step) = (self.padding(), self.step);
        let Self { mut recipe, source, beside, placed, uses, found, mut ready, .. } = self;
        let locate = |p: Problem| SceneError::Bad(source.locate(p));
        let box_ = hull(&placed);
        fits(&Lattice::covering(&box_.grow(padding), step)).map_err(locate)?;
        let meshes = mesh_element::read_all(&recipe.features, &beside, job).map_err(locate)?;
        let (mut notes, mut inputs, mut shapes) = (found, Vec::new(), Vec::new());
        let placed = placed.into_iter().map(|p| (ready.remove(&p.name), p)).collect();
        let light =
            |(ready, p): &(Option<Exact>, Placed)| ready.is_none() && pairs::is_light(&p.body);
        let make = |(ready, shape): (Option<Exact>, Placed), job: &dyn Job| {
            let (entry, purpose) = (&recipe.shapes[&shape.name], &uses[&shape.name]);
            let known = (shape.notes.clone(), shape.inputs.clone());
            let made = live::make(shape, entry, purpose, step, ready, job);
            made.map(|made| (known, made)).map_err(|stop| match stop {
                Stop::Problem(p) => locate(p),
                Stop::Cancelled(c) => c.into(),
            })
        };
        for made in pairs::in_pairs(placed, ("shape", |p| &p.1.name), light, job, make)? {
            let ((said, files), (shape, found)) = made;
            notes.extend(said.into_iter().chain(found));
            inputs.extend(files);
            shapes.push(shape);
        }
        let searches = self::searches(&mut recipe, &shapes, &meshes, job).map_err(|e| match e {
            Stop::Problem(p) => locate(p),
            Stop::Cancelled(c) => c.into(),
        })?;
        let parts =
            Parts { recipe: &recipe, beside: &beside, shapes: &shapes, meshes: &meshes, step };
        let (mut variants, mut refused) = (Vec::new(), Vec::new());
        for (at, entry) in recipe.variants() {
            match Variant::new(&entry, &at, &parts) {
                Ok(variant) => variants.push(variant),
                Err(p) => refused.push((entry.name, locate(p))),
            }
        }
        notes.extend(variants.iter().flat_map(|v| v.notes.clone()));
        // where no hybrid can be planned, the shapes themselves
        let domain = variants.iter().map(Variant::domain).reduce(Aabb::hull).unwrap_or(box_);
        let lattice = Lattice::covering(&domain.grow(padding), step);
        fits(&lattice).map_err(locate)?;
        let name = recipe.name.clone();
        let scene = Scene { name, shapes, variants, lattice, notes, inputs, searches, recipe };
        Ok((scene, refused))
    }
}

/// Carries `auto` out: each hybrid of that method that has features gets what a search chose.
fn searches(
    recipe: &mut Recipe,
    shapes: &[LiveShape],
    meshes: &BTreeMap<String, Element>,
    job: &dyn Job,
) -> Result<Vec<Search>, Stop> {
    let mut all = Vec::new();
    for (n, (at, entry)) in recipe.variants().into_iter().enumerate() {
        let Ok(names) = plan::shape_names(&entry, recipe, &at) else { continue };
        let live: Vec<&LiveShape> =
            names.iter().filter_map(|n| shapes.iter().find(|s| s.name == *n)).collect();
        let auto = entry.method.unwrap_or_default() == MethodEntry::Auto;
        // what moves is another shape at every time; one choice would not fit
        if !auto || recipe.features.is_empty() || live.len() < 2 || live.iter().any(|s| s.moves()) {
            continue;
        }
        // what is wrong with an entry is told when its variant is made
        let planned = plan::method(&entry, &names, recipe, &at)
            .and_then(|method| plan::plan(&entry, method, &live, meshes, recipe, &at));
        let Ok(plan) = planned else { continue };
        let volumes: Vec<f64> = live.iter().map(|s| s.volume).collect();
        let found = auto::searched(&entry, &plan, &volumes, job).map_err(|e| match e {
            MorphError::Cancelled(c) => Stop::Cancelled(c),
            e => Stop::Problem(Problem::new(at, e.to_string())),
        });
        let (chosen, search) = found?;
        all.push(search);
        recipe.output.crumbs.get_or_insert(auto::CRUMBS);
        match recipe.hybrids.get_mut(n) {
            Some(hybrid) => *hybrid = chosen,
            None => recipe.morph = chosen,
        }
    }
    Ok(all)
}

/// The triangles that a surface is made solid from.
#[derive(Clone, Copy, Debug)]
pub struct Tessellated {
    /// How many.
    pub triangles: usize,
    /// Whether they are a sheet with a thickness.
    pub sheet: bool,
    /// Whose fields are there while a frame is made.
    pub held: Held,
}

/// For how long a surface's exact field stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Until its sampled form is made.
    Never,
    /// As long as the run.
    First,
    /// For its frame.
    Last,
}

/// The first, the middle and the last: surfaces change little between times.
pub fn some(times: &[f64]) -> Vec<f64> {
    let mut at = vec![0, times.len() / 2, times.len().saturating_sub(1)];
    at.dedup();
    at.into_iter().filter_map(|i| times.get(i).copied()).collect()
}

/// What a shape is for.
#[derive(Default)]
pub(super) struct Use {
    /// Times at which it is wanted, without repetition, in the order of the variants.
    pub times: Vec<f64>,
    /// Whether some variant is this shape alone.
    pub alone: bool,
    /// Whether some variant looks its field up many times.
    pub morphs: bool,
    /// Whether some variant looks it up nearly everywhere: one of two shapes, or without features.
    pub everywhere: bool,
}

/// The shapes that some variant, or the place of one of them, needs, by name.
fn uses(recipe: &Recipe) -> Result<BTreeMap<String, Use>, Problem> {
    let mut uses: BTreeMap<String, Use> = BTreeMap::new();
    for (at, entry) in recipe.variants() {
        let of = plan::shape_names(&entry, recipe, &at)?;
        plan::method(&entry, &of, recipe, &at)?;
        let count = of.len();
        let alone = count == 1;
        for name in of {
            let known = uses.entry(name.clone()).or_default();
            known.alone |= alone;
            known.morphs |= !alone;
            known.everywhere |= count < 3 || recipe.features.is_empty();
            known.add(&asked(&entry));
            if let PlainOr::Table(PlaceLike { like }) = &recipe.shapes[&name].place {
                uses.entry(like.clone()).or_default().add(&asked(&entry));
            }
        }
    }
    Ok(uses)
}

impl Use {
    fn add(&mut self, times: &[f64]) {
        for t in times {
            if !self.times.contains(t) {
                self.times.push(*t);
            }
        }
    }
}

fn hull(placed: &[Placed]) -> Aabb {
    placed.iter().fold(Aabb::EMPTY, |b, p| b.hull(p.bounds))
}

fn longest(placed: &[Placed]) -> f64 {
    hull(placed).size().max_element()
}

/// Side of a cell, mm, where the longest side of all is known.
pub(super) fn step(grid: &GridEntry, longest: f64) -> f64 {
    let cells = grid.resolution.unwrap_or(GridEntry::RESOLUTION);
    grid.voxel.unwrap_or(longest / f64::from(cells))
}

/// The lattice of one shape that grows by `room` mm.
pub(super) fn cells(grid: &GridEntry, box_: Aabb, room: f64) -> Result<Lattice, Problem> {
    let box_ = box_.grow(room);
    let longest = box_.size().max_element();
    let step = step(grid, longest);
    // two cells keep the surface off the border; more only costs
    let padding = grid.padding.map_or(2.0 * step, |p| p * longest);
    let lattice = Lattice::covering(&box_.grow(padding), step);
    fits(&lattice).map(|()| lattice)
}

fn fits(lattice: &Lattice) -> Result<(), Problem> {
    if lattice.fits_f32() {
        return Ok(());
    }
    let far = lattice.bounds();
    let why = format!(
        "cells of {} mm are too fine for coordinates up to {:.0} mm in a file of f32 numbers; use \
         larger cells, or place = \"floor\"",
        lattice.step,
        far.min.abs().max(far.max.abs()).max_element()
    );
    Err(Problem::new("grid", why))
}
