//! Shapes of a recipe, read, placed and made fields.

use super::body::Body;
use super::draft::Use;
use super::moving::Moving;
use super::place::{Similarity, place};
use super::skinned::{How, Skinned, SkinnedError};
use super::{Input, digest, surface};
use crate::field::Shared;
use crate::field::csg::Moved;
use crate::field::mesh::{MeshField, MeshFieldError, MeshOptions, Sign, Thicken, Which};
use crate::field::sampled::Sampled;
use crate::field::solid::Assembly;
use crate::field::walls::thickened;
use crate::job::{Cancelled, Job};
use crate::mesh::{Assume, TriMesh, Unit, Up, read};
use crate::morph::{Foot, MorphError};
use crate::num::Aabb;
use crate::parts;
use crate::recipe::{
    self, LengthUnit, PlainOr, Problem, ShapeEntry, SignEntry, ThickenEntry, ThickenWhich, UpAxis,
    join,
};
use glam::{DAffine3, DQuat};
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// A shape read and placed, not yet a field.
pub(super) struct Placed {
    pub name: String,
    pub body: Body,
    /// The box at the times asked for, mm.
    pub bounds: Aabb,
    /// The box that others may stand like, mm.
    pub stands: Aabb,
    /// Area of its triangles, mm², for predictions.
    pub area: f64,
    /// A mesh before it was turned and shifted, and how it was: its field is made there, whatever its
    /// pose.
    pub still: Option<(TriMesh, Similarity)>,
    pub notes: Vec<String>,
    pub inputs: Vec<Input>,
}

/// A shape as a field.
pub struct LiveShape {
    /// Its name in the recipe.
    pub name: String,
    /// The field that is looked up: its sampled form; of a shape that moves, at its first time.
    pub field: Shared,
    /// Volume of the inside, mm³; not a number where it was not wanted: of a shape alone.
    pub volume: f64,
    /// The box round it, mm; of a shape that moves, at all times asked for.
    pub bounds: Aabb,
    /// Where it touches the floor; of a shape that moves, or stands alone, unknown.
    pub feet: Vec<Foot>,
    /// Seconds to make its field and to sample it.
    pub seconds: [f64; 2],
    /// The field itself, where a hybrid is this shape alone.
    pub(super) exact: Option<Shared>,
    /// The surface it comes from.
    pub(super) surface: Option<Skinned>,
    /// Its fields at other times.
    pub(super) moving: Option<Arc<Moving>>,
}

impl LiveShape {
    /// Whether it has another field at each t.
    pub fn moves(&self) -> bool {
        self.moving.is_some()
    }
}

/// What is wanted of a shape.
pub(super) struct Want<'a> {
    /// The box of the shape it stands like.
    pub like: Option<Aabb>,
    /// Times at which it is wanted.
    pub times: &'a [f64],
    /// Whether it must enclose something.
    pub solid: bool,
}

/// Reads and places a shape; `at` is its key.
pub(super) fn load(
    name: &str,
    entry: &ShapeEntry,
    beside: &Path,
    want: &Want<'_>,
    at: &str,
) -> Result<Placed, Problem> {
    let read = match (&entry.mesh, &entry.solid, &entry.surface) {
        (Some(file), ..) => mesh(entry, &beside.join(file), at)?,
        (None, Some(PlainOr::Plain(file)), _) => solid_file(&beside.join(file), at)?,
        (None, Some(PlainOr::Table(solid)), _) => {
            Read::new(Body::solid(solid, &format!("{at}.solid"))?, "solid".to_owned())
        }
        (None, None, Some(file)) => surface_file(entry, &beside.join(file), want.solid, at)?,
        (None, None, None) => {
            return Err(Problem::new(at, "no source: give `mesh`, `solid` or `surface`"));
        }
    };
    let Read { body, story, warnings, inputs } = read;
    let (body, still) = place(body, entry, want.like, at)?;
    let (bounds, stands) = (body.bounds_at(want.times), body.bounds());
    if bounds.is_empty() || !bounds.is_finite() {
        return Err(Problem::new(at, "the shape is empty: it has no triangle with a size"));
    }
    let size = bounds.size();
    let mut notes =
        vec![format!("{name}: {story}; {:.0} x {:.0} x {:.0} mm", size.x, size.y, size.z)];
    notes.extend(warnings.into_iter().map(|w| format!("{name}: {w}")));
    let (name, area) = (name.to_owned(), body.area());
    Ok(Placed { name, area, body, bounds, stands, still, notes, inputs })
}

/// What was read for a shape.
struct Read {
    body: Body,
    story: String,
    warnings: Vec<String>,
    inputs: Vec<Input>,
}

impl Read {
    fn new(body: Body, story: String) -> Self {
        Self { body, story, warnings: vec![], inputs: vec![] }
    }
}

fn up(axis: UpAxis) -> Up {
    match axis {
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    }
}

fn unit(unit: LengthUnit) -> Unit {
    match unit {
        LengthUnit::M => Unit::M,
        LengthUnit::Cm => Unit::Cm,
        LengthUnit::Mm => Unit::Mm,
        LengthUnit::In => Unit::In,
    }
}

fn mesh(entry: &ShapeEntry, path: &Path, at: &str) -> Result<Read, Problem> {
    let at = format!("{at}.mesh");
    let assume = Assume { up: entry.up.map(up), unit: entry.unit.map(unit) };
    let loaded = read(path, assume).map_err(|e| Problem::new(&at, e.to_string()))?;
    let input = digest(path).map_err(|e| Problem::new(&at, format!("{}: {e}", path.display())))?;
    let summary = loaded.found.summary().replace('\n', "; ");
    let story = format!("{}, {} up, unit {}: {summary}", path.display(), loaded.up, loaded.unit);
    Ok(Read { inputs: vec![input], ..Read::new(Body::Mesh(loaded.mesh), story) })
}

fn solid_file(path: &Path, at: &str) -> Result<Read, Problem> {
    let at = format!("{at}.solid");
    let fail = |e: String| Problem::new(&at, e);
    let text = recipe::read_text(path).map_err(|why| fail(format!("{}: {why}", path.display())))?;
    let solid = recipe::parse_solid(&text, path).map_err(|e| fail(e.to_string()))?;
    let body = Body::solid(&solid, "").map_err(|e| fail(format!("{}: {e}", path.display())))?;
    let input = digest(path).map_err(|e| fail(format!("{}: {e}", path.display())))?;
    let story = format!("{}, solid of {} parts", path.display(), solid.parts.len());
    Ok(Read { inputs: vec![input], ..Read::new(body, story) })
}

fn surface_file(entry: &ShapeEntry, path: &Path, solid: bool, at: &str) -> Result<Read, Problem> {
    let key = format!("{at}.surface");
    let fail = |why: String| Problem::new(&key, why);
    let file = surface::open(path).map_err(|e| fail(e.to_string()))?;
    let by = Similarity {
        scale: entry.unit.map_or(1.0, |u| unit(u).mm()),
        turn: match entry.up {
            Some(UpAxis::Y) => DQuat::from_rotation_x(FRAC_PI_2),
            Some(UpAxis::Z) | None => DQuat::IDENTITY,
        },
        ..Similarity::NONE
    };
    let named = |e: SkinnedError| fail(format!("{}: {e}", path.display()));
    let skinned = Skinned::new(file.object, How::of(entry), by, entry.at).map_err(named)?;
    if solid {
        skinned.encloses().map_err(|e| {
            Problem::new(format!("{at}.thickness"), format!("{}: {e}", path.display()))
        })?;
    }
    let story = format!("{}, {}", path.display(), file.story);
    Ok(Read { body: Body::Surface(skinned), story, warnings: file.warnings, inputs: file.inputs })
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

/// The field of a placed shape.
#[derive(Clone)]
pub(super) struct Exact {
    pub field: Shared,
    /// What was found on the way.
    pub notes: Vec<String>,
    /// Whether something of a mesh was too thin and was made thicker.
    pub thickened: bool,
}

impl Exact {
    fn new(field: Shared, notes: Vec<String>) -> Self {
        Self { field, notes, thickened: false }
    }

    /// The same, turned and shifted.
    fn moved(self, by: &Similarity) -> Self {
        let affine = DAffine3::from_rotation_translation(by.turn, by.shift);
        // a turn and a shift are never uneven
        match Moved::new(self.field.clone(), affine) {
            Ok(moved) => Self { field: Arc::new(moved), ..self },
            Err(_) => self,
        }
    }
}

/// The field of a placed shape for cells of `step` mm; of a shape that moves, at `t`.
pub(super) fn exact(
    placed: Placed,
    entry: &ShapeEntry,
    t: f64,
    step: f64,
    job: &dyn Job,
) -> Result<Exact, Stop> {
    match placed.body {
        Body::Surface(skinned) => {
            let (field, sides) = skinned.field(t, step, job).map_err(|e| match e {
                SkinnedError::Cancelled(c) => Stop::Cancelled(c),
                e => Problem::new(join("shapes", &placed.name), e.to_string()).into(),
            })?;
            let told = [Some(sides.story()), skinned.too_thin(step)].into_iter().flatten();
            let notes = told.map(|n| format!("{}: {n}", placed.name)).collect();
            Ok(Exact::new(field, notes))
        }
        Body::Solid(parts) => {
            let at = join("shapes", &placed.name);
            let parts: Vec<_> = parts.into_iter().map(|p| p.part).collect();
            let solid = Assembly::new(&parts).map_err(|e| Problem::new(at, e.to_string()))?;
            Ok(Exact::new(Arc::new(solid), Vec::new()))
        }
        Body::Mesh(mesh) => {
            let at = join("shapes", &placed.name);
            let fail = |e: MeshFieldError| match e {
                MeshFieldError::Cancelled(c) => Stop::Cancelled(c),
                other => Stop::Problem(Problem::new(at, other.to_string())),
            };
            let still = placed.still.as_ref();
            let mesh = still.map_or(&mesh, |(still, _)| still);
            let mut made = mesh_field(mesh, entry, job).map_err(fail)?;
            made.notes.iter_mut().for_each(|n| *n = format!("{}: {n}", placed.name));
            Ok(match still {
                Some((_, by)) => made.moved(by),
                None => made,
            })
        }
    }
}

/// The field of a mesh with what is thin made as thick as its entry says, and what was found.
fn mesh_field(mesh: &TriMesh, entry: &ShapeEntry, job: &dyn Job) -> Result<Exact, MeshFieldError> {
    let mut options = options(entry);
    let thin = entry.thicken.as_ref().map(ThickenEntry::of);
    let thin = thin.filter(|t| t.which == ThickenWhich::Thin && entry.sign == SignEntry::Winding);
    if thin.is_some() {
        options.thicken = None;
    }
    let (field, report) = match (MeshField::new(mesh, &options, job), thin) {
        // nothing but sheets
        (Err(MeshFieldError::NoInside { .. }), Some(t)) => {
            options.thicken = Some(Thicken { mm: t.mm, which: Which::Open });
            MeshField::new(mesh, &options, job)?
        }
        (made, _) => made?,
    };
    let mut notes = report.summary();
    let field: Shared = Arc::new(field);
    let Some(t) = thin.filter(|_| options.thicken.is_none()) else {
        return Ok(Exact { field, notes, thickened: thin.is_some() });
    };
    let (field, changed) = thickened(field, mesh, t.mm, job)?;
    // what was lost is there now
    notes.retain(|n| changed.sheets <= 0.0 || !n.contains("is lost"));
    let percent = |share: f64| format!("{:.1}% of the area", share * 100.0);
    let both = [(changed.sheets, "without thickness"), (changed.walls, "of thinner walls")];
    let said: Vec<_> = both
        .iter()
        .filter(|(share, _)| *share > 5e-4)
        .map(|(share, what)| format!("{} {what}", percent(*share)))
        .collect();
    if !said.is_empty() {
        notes.push(format!("made {} mm thick: {}", t.mm, said.join(", ")));
    }
    Ok(Exact { field, notes, thickened: !said.is_empty() })
}

/// A placed shape brought to life, and what was found on the way; `ready` is its field as it was before
/// it was turned and shifted, where that has been made.
pub(super) fn make(
    placed: Placed,
    entry: &ShapeEntry,
    purpose: &Use,
    step: f64,
    ready: Option<Exact>,
    job: &dyn Job,
) -> Result<(LiveShape, Vec<String>), Stop> {
    let start = Instant::now();
    let (name, bounds) = (placed.name.clone(), placed.bounds);
    let surface = match &placed.body {
        Body::Surface(s) => Some(s.clone()),
        _ => None,
    };
    let moves = surface.as_ref().filter(|s| s.moves());
    if let Some(moves) = moves {
        let moving = Arc::new(Moving::new(&name, moves.clone(), step));
        let notes = moves.too_thin(step).map(|n| format!("{name}: {n}")).into_iter().collect();
        let (field, volume) = first(&moving, &purpose.times, purpose.morphs, job)?;
        let seconds = [start.elapsed().as_secs_f64(), 0.0];
        let moving = Some(moving);
        let shape = LiveShape {
            name,
            field,
            volume,
            bounds,
            feet: Vec::new(),
            seconds,
            exact: None,
            surface,
            moving,
        };
        return Ok((shape, notes));
    }
    let Exact { field: exact, notes, .. } = match (ready, &placed.still) {
        (Some(ready), Some((_, by))) => ready.moved(by),
        (Some(ready), None) => ready,
        (None, _) => exact(placed, entry, 0.5, step, job)?,
    };
    let made = start.elapsed().as_secs_f64();
    let (field, volume) = if purpose.morphs || !purpose.alone {
        sampled(exact.clone(), purpose.everywhere, step, job)?
    } else {
        (exact.clone(), f64::NAN)
    };
    let feet = if purpose.morphs { parts::feet(&*field, job)? } else { Vec::new() };
    let feet = feet.into_iter().map(|f| Foot { at: f.at, reach: f.reach }).collect();
    let seconds = [made, start.elapsed().as_secs_f64() - made];
    let exact = purpose.alone.then_some(exact);
    let shape =
        LiveShape { name, field, volume, bounds, feet, seconds, exact, surface, moving: None };
    Ok((shape, notes))
}

/// What moves at the first of the times at which it has a field.
fn first(
    moving: &Moving,
    times: &[f64],
    morphs: bool,
    job: &dyn Job,
) -> Result<(Shared, f64), Stop> {
    let mut why = None;
    for &t in times {
        match moving.at(t, job) {
            Ok(moment) if morphs => return Ok(moment.sampled(job)?),
            Ok(moment) => return Ok((moment.exact.clone(), f64::NAN)),
            Err(MorphError::Cancelled(c)) => return Err(c.into()),
            Err(e) => why = why.or(Some(e)),
        }
    }
    let why = why.map_or_else(String::new, |e| e.to_string());
    Err(Problem::new(join("shapes", moving.name()), why).into())
}

fn options(entry: &ShapeEntry) -> MeshOptions {
    let thicken = entry.thicken.as_ref().map(|t| {
        let ThickenEntry { mm, which } = ThickenEntry::of(t);
        let which = match which {
            ThickenWhich::Open => Which::Open,
            // sheets without a sign are thin all over
            ThickenWhich::All | ThickenWhich::Thin => Which::All,
        };
        Thicken { mm, which }
    });
    let sign = match entry.sign {
        SignEntry::Winding => Sign::Winding,
        SignEntry::Unsigned => Sign::Unsigned,
    };
    MeshOptions { thicken, sign, ..MeshOptions::default() }
}

/// The sampled form of a field at a fine step, mm; of one that is not looked up everywhere,
/// made where it is.
pub(super) fn sampled(
    exact: Shared,
    everywhere: bool,
    step: f64,
    job: &dyn Job,
) -> Result<(Shared, f64), Cancelled> {
    let new = if everywhere { Sampled::new } else { Sampled::on_demand };
    let sampled = new(exact, step, job)?;
    let volume = sampled.volume();
    Ok((Arc::new(sampled), volume))
}
