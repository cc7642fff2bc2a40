//! Shapes of a recipe, read, placed and made fields.

use super::body::Body;
use super::place::place;
use super::{Input, digest};
use crate::field::mesh::{MeshField, MeshFieldError, MeshOptions, Sign, Thicken, Which};
use crate::field::sampled::Sampled;
use crate::field::solid::Assembly;
use crate::field::{Field, Shared};
use crate::job::{Cancelled, Job};
use crate::mesh::{Assume, Unit, Up, read};
use crate::num::Aabb;
use crate::recipe::{
    self, LengthUnit, PlainOr, Problem, ShapeEntry, SignEntry, ThickenEntry, ThickenWhich, UpAxis,
    join,
};
use std::path::Path;
use std::sync::Arc;

/// A shape read and placed, not yet a field.
pub(super) struct Placed {
    pub name: String,
    pub body: Body,
    pub bounds: Aabb,
    /// Area of its triangles, mm², for predictions.
    pub area: f64,
    pub note: String,
    pub input: Option<Input>,
}

/// A shape as a field.
pub struct LiveShape {
    /// Its name in the recipe.
    pub name: String,
    /// The field that is looked up: its sampled form.
    pub field: Shared,
    /// Volume of the inside, mm³.
    pub volume: f64,
    /// The box round it, mm.
    pub bounds: Aabb,
    /// Seconds to make its field and to sample it.
    pub seconds: [f64; 2],
}

/// Reads and places a shape; `at` is its key, `like` the box of the shape it stands like.
pub(super) fn load(
    name: &str,
    entry: &ShapeEntry,
    beside: &Path,
    like: Option<Aabb>,
    at: &str,
) -> Result<Placed, Problem> {
    let (body, input, story) = match (&entry.mesh, &entry.solid) {
        (Some(file), _) => mesh(entry, &beside.join(file), at)?,
        (None, Some(PlainOr::Plain(file))) => solid_file(&beside.join(file), at)?,
        (None, Some(PlainOr::Table(solid))) => {
            (Body::solid(solid, &format!("{at}.solid"))?, None, "solid".to_owned())
        }
        (None, None) => return Err(Problem::new(at, "no source: give `mesh` or `solid`")),
    };
    let body = place(body, entry, like);
    let shells = body.shells();
    let bounds = shells.bounds();
    if bounds.is_empty() || !bounds.is_finite() {
        return Err(Problem::new(at, "the shape is empty: it has no triangle with a size"));
    }
    let size = bounds.size();
    let note = format!("{name}: {story}; {:.0} x {:.0} x {:.0} mm", size.x, size.y, size.z);
    Ok(Placed { name: name.to_owned(), area: shells.area(), body, bounds, note, input })
}

fn mesh(
    entry: &ShapeEntry,
    path: &Path,
    at: &str,
) -> Result<(Body, Option<Input>, String), Problem> {
    let at = format!("{at}.mesh");
    let assume = Assume {
        up: entry.up.map(|u| match u {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
        }),
        unit: entry.unit.map(|u| match u {
            LengthUnit::M => Unit::M,
            LengthUnit::Cm => Unit::Cm,
            LengthUnit::Mm => Unit::Mm,
            LengthUnit::In => Unit::In,
        }),
    };
    let loaded = read(path, assume).map_err(|e| Problem::new(&at, e.to_string()))?;
    let input = digest(path).map_err(|e| Problem::new(&at, format!("{}: {e}", path.display())))?;
    let summary = loaded.found.summary().replace('\n', "; ");
    let story = format!("{}, {} up, unit {}: {summary}", path.display(), loaded.up, loaded.unit);
    Ok((Body::Mesh(loaded.mesh), Some(input), story))
}

fn solid_file(path: &Path, at: &str) -> Result<(Body, Option<Input>, String), Problem> {
    let at = format!("{at}.solid");
    let fail = |e: String| Problem::new(&at, e);
    let text = recipe::read_text(path).map_err(|why| fail(format!("{}: {why}", path.display())))?;
    let solid = recipe::parse_solid(&text, path).map_err(|e| fail(e.to_string()))?;
    let body = Body::solid(&solid, "").map_err(|e| fail(format!("{}: {e}", path.display())))?;
    let input = digest(path).map_err(|e| fail(format!("{}: {e}", path.display())))?;
    Ok((body, Some(input), format!("{}, solid of {} parts", path.display(), solid.parts.len())))
}

/// What ends the making of a field.
pub(super) enum Stop {
    Problem(Problem),
    Cancelled(Cancelled),
}

impl From<Problem> for Stop {
    fn from(p: Problem) -> Self {
        Self::Problem(p)
    }
}

impl From<Cancelled> for Stop {
    fn from(c: Cancelled) -> Self {
        Self::Cancelled(c)
    }
}

/// The field of a placed shape, and what was found on the way.
pub(super) fn exact(
    placed: Placed,
    entry: &ShapeEntry,
    job: &dyn Job,
) -> Result<(Shared, Vec<String>), Stop> {
    match placed.body {
        Body::Solid(parts) => {
            let at = join("shapes", &placed.name);
            let parts: Vec<_> = parts.into_iter().map(|p| p.part).collect();
            let solid = Assembly::new(&parts).map_err(|e| Problem::new(at, e.to_string()))?;
            Ok((Arc::new(solid), Vec::new()))
        }
        Body::Mesh(mesh) => {
            let at = join("shapes", &placed.name);
            let fail = |e: MeshFieldError| match e {
                MeshFieldError::Cancelled(c) => Stop::Cancelled(c),
                other => Stop::Problem(Problem::new(at, other.to_string())),
            };
            let (field, report) = MeshField::new(&mesh, &options(entry), job).map_err(fail)?;
            let notes = report.summary().into_iter().map(|n| format!("{}: {n}", placed.name));
            Ok((Arc::new(field), notes.collect()))
        }
    }
}

fn options(entry: &ShapeEntry) -> MeshOptions {
    let thicken = entry.thicken.as_ref().map(|t| {
        let ThickenEntry { mm, which } = ThickenEntry::of(t);
        let which = match which {
            ThickenWhich::Open => Which::Open,
            ThickenWhich::All => Which::All,
        };
        Thicken { mm, which }
    });
    let sign = match entry.sign {
        SignEntry::Winding => Sign::Winding,
        SignEntry::Unsigned => Sign::Unsigned,
    };
    MeshOptions { thicken, sign, ..MeshOptions::default() }
}

/// The sampled form of a field at a fine step, mm.
pub(super) fn sampled(
    exact: &dyn Field,
    step: f64,
    job: &dyn Job,
) -> Result<(Shared, f64), Cancelled> {
    let sampled = Sampled::new(exact, step, job)?;
    let volume = sampled.volume();
    Ok((Arc::new(sampled), volume))
}
