//! Shapes of surface files: placed once, made solid at every t.

use super::place::Similarity;
use super::surface::{Parametric, Still};
use crate::field::Shared;
use crate::field::skin::{Sides, Skin, SkinError, SkinOptions, skin};
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::recipe::{CurveEntry, ShapeEntry, SkinEntry};
use crate::surface::nurbs::{Curve, extrude, polyline, tube};
use crate::surface::tessellate::tessellate;
use crate::surface::{Surface, SurfaceError};
use glam::{DAffine3, DVec2, DVec3};
use std::sync::Arc;

/// A shape that moves is placed by the box of these times, whatever times are asked for: it must not
/// jump when they change.
const STANDS: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

/// Chord tolerance of outlines, as a part of the size: good enough for boxes and areas.
const ROUGH: f64 = 2e-3;

/// A closed curve farther from its plane than this part of its size is not planar.
const PLANAR: f64 = 1e-6;

/// Chord tolerance of what is made, as a part of a cell.
const FINE: f64 = 0.1;

/// A shell thinner than this many cells has holes.
const THINNEST: f64 = 2.0;

/// Why a shape of a surface file has no field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkinnedError {
    /// What the surface or its motion says.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// What its triangles say.
    #[error("{0}")]
    Skin(SkinError),
    /// The job was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<SkinError> for SkinnedError {
    fn from(e: SkinError) -> Self {
        match e {
            SkinError::Cancelled(c) => Self::Cancelled(c),
            other => Self::Skin(other),
        }
    }
}

/// How a surface or curve is made solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct How {
    pub skin: SkinOptions,
    /// `Auto` is decided when the shape is read.
    pub curve: CurveEntry,
    /// Chord tolerance, mm.
    pub tolerance: Option<f64>,
}

impl How {
    pub fn of(entry: &ShapeEntry) -> Self {
        let skin = match entry.skin {
            SkinEntry::Auto => Skin::Auto,
            SkinEntry::Solid => Skin::Solid,
            SkinEntry::Shell => Skin::Shell,
        };
        let skin = SkinOptions { thickness: entry.thickness, skin };
        Self { skin, curve: entry.curve, tolerance: entry.tolerance }
    }

    /// Chord tolerance at cells of `step` mm.
    pub fn tolerance(&self, step: f64) -> f64 {
        self.tolerance.unwrap_or(FINE * step)
    }
}

/// A surface or curve, placed.
#[derive(Clone)]
pub(super) struct Skinned {
    object: Parametric,
    pub how: How,
    /// From the file's space to ours, at t = 0 and at t = 1.
    by: [Similarity; 2],
    /// The time it is held at.
    at: Option<f64>,
    outlines: Vec<(f64, Arc<Outline>)>,
}

/// A rough picture of a surface or curve at one time, in the file's space.
struct Outline {
    points: Vec<DVec3>,
    /// Area; of a line its length.
    area: f64,
    room: Room,
}

/// What the thickness adds to the points of an outline.
#[derive(Clone, Copy, PartialEq)]
enum Room {
    None,
    /// Half of it all round.
    Round,
    /// The same, round a line.
    Tube,
    /// All of it along a unit vector.
    Along(DVec3),
}

impl Skinned {
    /// Takes outlines and decides what is automatic.
    pub fn new(
        object: Parametric,
        how: How,
        by: Similarity,
        at: Option<f64>,
    ) -> Result<Self, SkinnedError> {
        Self::between(object, how, [by; 2], at)
    }

    /// As [`Skinned::new`], but standing elsewhere at t = 1 than at t = 0.
    pub fn between(
        object: Parametric,
        mut how: How,
        by: [Similarity; 2],
        at: Option<f64>,
    ) -> Result<Self, SkinnedError> {
        let times = if object.moves() && at.is_none() { &STANDS[..] } else { &[at.unwrap_or(0.0)] };
        let stills: Vec<_> = times.iter().map(|&t| (t, object.at(t))).collect();
        if how.curve == CurveEntry::Auto {
            let flat = stills.iter().flat_map(|s| &s.1).all(|s| match s {
                Still::Curve(c) => planar(&**c),
                Still::Surface(_) => false,
            });
            how.curve = if flat { CurveEntry::Extrude } else { CurveEntry::Tube };
        }
        let mut all = Self { object, how, by, at, outlines: vec![] };
        let mut first = None;
        for (t, still) in stills {
            match still.and_then(|s| Outline::of(&s, &how)) {
                Ok(outline) => all.outlines.push((t, Arc::new(outline))),
                Err(e) => first = first.or(Some(e)),
            }
        }
        // a motion may fail at some times; those frames will say so
        match first {
            Some(e) if all.outlines.is_empty() => Err(e.into()),
            _ => Ok(all),
        }
    }

    /// Refuses sheets and curves without a thickness.
    pub fn encloses(&self) -> Result<(), SkinnedError> {
        if self.how.skin.thickness.is_some() {
            return Ok(());
        }
        let time = self.outlines[0].0;
        match self.object.at(time)? {
            Still::Curve(_) => {
                let why = "it encloses nothing by itself; give it a `thickness`, in mm";
                Err(SurfaceError::new("curve", why).into())
            }
            Still::Surface(s) if self.how.skin.skin == Skin::Auto => {
                let sides = Sides::of(&tessellate(&*s, ROUGH * size(&*s)?)?.mesh);
                if sides.whole() { Ok(()) } else { Err(SkinError::Sheet(sides).into()) }
            }
            Still::Surface(_) => Ok(()),
        }
    }

    /// What it is.
    pub fn object(&self) -> &Parametric {
        &self.object
    }

    /// Where it stands: the similarity from the file's space to ours.
    pub fn stands(&self) -> Similarity {
        self.by[0]
    }

    /// Whether it depends on t.
    pub fn moves(&self) -> bool {
        self.at.is_none() && (self.object.moves() || self.by[0] != self.by[1])
    }

    fn time(&self, t: f64) -> f64 {
        if self.object.moves() { self.at.unwrap_or(t) } else { t }
    }

    fn by(&self, t: f64) -> Similarity {
        self.by[0].between(&self.by[1], t)
    }

    /// The same elsewhere.
    pub fn moved(mut self, by: &Similarity) -> Self {
        self.by = self.by.map(|mine| mine.then(by));
        self
    }

    /// The scale that gives the box at all its times this height, mm, thickness included.
    pub fn scale_to(&self, height: f64) -> Option<f64> {
        let thickness = self.how.skin.thickness.unwrap_or(0.0);
        let tall = |thickness: f64| {
            let boxes = self.outlines.iter().map(|(t, o)| o.bounds(&self.by(*t), thickness));
            boxes.fold(Aabb::EMPTY, Aabb::hull).size().z
        };
        let bare = tall(0.0);
        let scale = (height - (tall(thickness) - bare)) / bare;
        (scale > 0.0 && scale.is_finite()).then_some(scale)
    }

    /// The box by which it is placed, mm: of all its times.
    pub fn bounds(&self) -> Aabb {
        let boxes = self.outlines.iter().map(|(t, o)| self.box_of(*t, o));
        boxes.fold(Aabb::EMPTY, Aabb::hull)
    }

    fn box_of(&self, t: f64, outline: &Outline) -> Aabb {
        outline.bounds(&self.by(t), self.how.skin.thickness.unwrap_or(0.0))
    }

    /// The box at the given times, mm. Times without a surface are left out.
    pub fn bounds_at(&self, times: &[f64]) -> Aabb {
        if !self.moves() {
            return self.bounds();
        }
        let mut all = Aabb::EMPTY;
        for &t in times {
            let known = self.outlines.iter().find(|(at, _)| *at == t).map(|(_, o)| o.clone());
            let made = || {
                let still = self.object.at(t).ok()?;
                Outline::of(&still, &self.how).ok().map(Arc::new)
            };
            if let Some(outline) = known.or_else(made) {
                all = all.hull(self.box_of(t, &outline));
            }
        }
        if all.is_empty() { self.bounds() } else { all }
    }

    /// The largest area that is known of it, mm², both sides of a sheet.
    pub fn area(&self) -> f64 {
        let thickness = self.how.skin.thickness.unwrap_or(0.0);
        let areas = self.outlines.iter().map(|(t, o)| o.area(self.by(*t).scale, thickness));
        areas.fold(0.0, f64::max)
    }

    /// Its triangles at `t`, none farther than `tolerance` (mm) from it. Curves are solid already.
    pub fn mesh(&self, t: f64, tolerance: f64) -> Result<TriMesh, SurfaceError> {
        let by = self.by(t);
        let fine = tolerance / by.scale;
        let mut mesh = match self.object.at(self.time(t))? {
            Still::Surface(s) => tessellate(&*s, fine)?.mesh,
            Still::Curve(c) => {
                let thickness = self.how.skin.thickness.unwrap_or(0.0) / by.scale;
                match self.how.curve {
                    CurveEntry::Extrude => extrude(&*c, thickness, fine)?,
                    _ => tessellate(&tube(c, thickness / 2.0)?, fine)?.mesh,
                }
            }
        };
        mesh.transform(&by.affine());
        Ok(mesh)
    }

    /// What is to be said about cells of `step` mm.
    pub fn too_thin(&self, step: f64) -> Option<String> {
        let mm = self.how.skin.thickness?;
        let shell = self.outlines.iter().any(|(_, o)| o.room != Room::None);
        (shell && mm < THINNEST * step).then(|| {
            format!(
                "the thickness of {mm} mm is less than {THINNEST} cells of {step:.3} mm: expect \
                 holes; use smaller cells, or more thickness"
            )
        })
    }

    /// Whether it is made solid as a sheet of some thickness, mm.
    pub fn sheet(&self) -> Option<f64> {
        let sheet = self.outlines.iter().any(|(_, o)| o.room == Room::Round);
        self.how.skin.thickness.filter(|_| sheet)
    }

    /// Triangles that the solid at `t` is made from for cells of `step` mm.
    pub fn triangles(&self, t: f64, step: f64) -> usize {
        self.mesh(t, self.how.tolerance(step)).map_or(0, |m| m.faces.len())
    }

    /// The solid at `t` for cells of `step` mm, and what the surface is.
    pub fn field(&self, t: f64, step: f64, job: &dyn Job) -> Result<(Shared, Sides), SkinnedError> {
        let mesh = self.mesh(t, self.how.tolerance(step))?;
        crate::job::check(job)?;
        let curve = matches!(self.object, Parametric::Curve(_) | Parametric::CurveMotion(_));
        // a curve has been given its thickness
        let options = if curve { SkinOptions::default() } else { self.how.skin };
        Ok(skin(&mesh, &options, job)?)
    }
}

impl Outline {
    fn of(still: &Still, how: &How) -> Result<Self, SurfaceError> {
        match still {
            Still::Surface(s) => {
                let mesh = tessellate(&**s, ROUGH * size(&**s)?)?.mesh;
                let sheet = match how.skin.skin {
                    Skin::Auto => !Sides::of(&mesh).whole(),
                    Skin::Solid => false,
                    Skin::Shell => true,
                };
                let room = if sheet { Room::Round } else { Room::None };
                Ok(Self { area: mesh.area(), points: mesh.points, room })
            }
            Still::Curve(c) => Self::of_curve(&**c, how),
        }
    }

    fn of_curve(curve: &dyn Curve, how: &How) -> Result<Self, SurfaceError> {
        let points = polyline(curve, ROUGH * long(curve)?)?;
        let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        if how.curve != CurveEntry::Extrude {
            return Ok(Self { area: length, points, room: Room::Tube });
        }
        let solid = extrude(curve, 1.0, ROUGH * long(curve)?)?;
        let along = solid.points[solid.points.len() / 2] - solid.points[0];
        Ok(Self { area: solid.area(), points, room: Room::Along(along) })
    }

    fn bounds(&self, by: &Similarity, thickness: f64) -> Aabb {
        let bare = Aabb::of(self.points.iter().map(|&p| by.point(p)));
        match self.room {
            Room::None => bare,
            Room::Round | Room::Tube => bare.grow(thickness / 2.0),
            Room::Along(n) => {
                let up = by.turn * n * thickness;
                bare.hull(Aabb { min: bare.min + up, max: bare.max + up })
            }
        }
    }

    fn area(&self, scale: f64, thickness: f64) -> f64 {
        match self.room {
            Room::Tube => std::f64::consts::PI * thickness * self.area * scale,
            Room::Round => 2.0 * self.area * scale * scale,
            _ => self.area * scale * scale,
        }
    }
}

/// Points of a patch and of a curve's piece that are looked at, along each parameter, for its size.
const LOOKS: u32 = 12;

/// The diagonal of the surface's box, as far as a few points tell.
fn size(surface: &dyn Surface) -> Result<f64, SurfaceError> {
    let mut all = Aabb::EMPTY;
    for patch in 0..surface.patches() {
        let d = surface.domain(patch);
        let at = |[a, b]: [f64; 2], i: u32| a + (b - a) * f64::from(i) / f64::from(LOOKS);
        for i in 0..=LOOKS {
            for j in 0..=LOOKS {
                all = all.with(surface.point(patch, DVec2::new(at(d.u, i), at(d.v, j))));
            }
        }
    }
    diagonal(&all)
}

/// The diagonal of the curve's box, as far as a few points tell.
fn long(curve: &dyn Curve) -> Result<f64, SurfaceError> {
    let pieces = curve.breaks().windows(2).enumerate();
    let looks = pieces.flat_map(|(piece, ends)| {
        let (a, b) = (ends[0], ends[1]);
        (0..=LOOKS).map(move |i| curve.jet(piece, a + (b - a) * f64::from(i) / f64::from(LOOKS)).c)
    });
    diagonal(&Aabb::of(looks))
}

fn diagonal(b: &Aabb) -> Result<f64, SurfaceError> {
    let d = b.size().length();
    if d > 0.0 && d.is_finite() {
        return Ok(d);
    }
    Err(SurfaceError::new("surface", format!("has no size: its box has a diagonal of {d}")))
}

/// Whether the curve is closed and stays in a plane; a curve that has shrunk to a line does.
fn planar(curve: &dyn Curve) -> bool {
    let ring = match long(curve).map(|d| polyline(curve, ROUGH * d)) {
        Ok(Ok(ring)) if curve.closed() => ring,
        _ => return false,
    };
    let o = ring[0];
    let normal: DVec3 = ring.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum();
    let size = Aabb::of(ring.iter().copied()).size().length();
    let normal = normal.try_normalize().filter(|_| normal.length() > PLANAR * size * size);
    normal.is_none_or(|n| ring.iter().all(|p| (p - o).dot(n).abs() <= PLANAR * size))
}

impl Similarity {
    /// As a map.
    fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(DVec3::splat(self.scale), self.turn, self.shift)
    }
}

#[cfg(test)]
mod tests;
