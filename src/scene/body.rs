//! A shape before it is a field: a mesh, the parts of a solid or a surface, read and movable.

use super::elements;
use super::place::Similarity;
use super::skinned::Skinned;
use crate::element::{Element, Shape, middle_sheet, tessellate};
use crate::field::csg::Join;
use crate::field::solid::Part as SolidPart;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::recipe::{Mirror, Op, Problem, Solid};
use crate::surface::SurfaceError;
use glam::DAffine3;

/// What a shape is made of.
pub(super) enum Body {
    Mesh(TriMesh),
    Solid(Vec<Piece>),
    Surface(Skinned),
}

/// A part of a solid.
pub(super) struct Piece {
    pub part: SolidPart,
    /// Written as a bare sheet among raw shells.
    sheet: bool,
}

/// Sides of a round section when a solid is taken as triangles.
const SEGMENTS: u32 = 48;

impl Body {
    /// The elements of a solid's parts, mirror images included; `at` is the solid's key.
    pub fn solid(solid: &Solid, at: &str) -> Result<Self, Problem> {
        let mut parts = Vec::new();
        for (i, part) in solid.parts.iter().enumerate() {
            let at = if at.is_empty() { format!("parts[{i}]") } else { format!("{at}.parts[{i}]") };
            let (element, round) = elements::part(part, &at)?;
            if part.sheet && !matches!(element.shape, Shape::Block | Shape::Prism(_)) {
                return Err(Problem::new(at, "only a box or a prism can be a sheet"));
            }
            let join = match part.op {
                Op::Add => Join::Add,
                Op::Cut => Join::Cut,
                Op::Blend => Join::Blend(part.blend.unwrap_or(0.0)),
            };
            for element in images(element, part.mirror) {
                let sheet = part.sheet;
                parts.push(Piece { part: SolidPart { element, round, join }, sheet });
            }
        }
        Ok(Self::Solid(parts))
    }

    /// The same body elsewhere.
    pub fn moved(self, by: &Similarity) -> Self {
        match self {
            Self::Mesh(mut mesh) => {
                mesh.transform(&DAffine3::from_scale_rotation_translation(
                    glam::DVec3::splat(by.scale),
                    by.turn,
                    by.shift,
                ));
                Self::Mesh(mesh)
            }
            Self::Solid(parts) => {
                let moved = |p: Piece| Piece { part: moved_part(p.part, by), sheet: p.sheet };
                Self::Solid(parts.into_iter().map(moved).collect())
            }
            Self::Surface(skinned) => Self::Surface(skinned.moved(by)),
        }
    }

    /// The scale that gives it this height, mm; none for a flat surface, or a thickness above it. A mesh
    /// or solid without height keeps its size.
    pub fn scale_to(&self, height: f64) -> Option<f64> {
        if let Self::Surface(skinned) = self {
            return skinned.scale_to(height);
        }
        let tall = self.bounds().size().z;
        Some(if tall > 0.0 { height / tall } else { 1.0 })
    }

    /// The box round it, mm; parts that are cut away do not count, the thickness of a surface does; of
    /// what moves, the box at all times.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Solid(parts) => solid_triangles(parts, false).bounds(),
            Self::Surface(skinned) => skinned.bounds(),
        }
    }

    /// Whether it is a surface that is another at each t, even if it is held at one.
    pub fn follows(&self) -> bool {
        matches!(self, Self::Surface(skinned) if skinned.object().moves())
    }

    /// The box at the given times, mm.
    pub fn bounds_at(&self, times: &[f64]) -> Aabb {
        match self {
            Self::Surface(skinned) => skinned.bounds_at(times),
            still => still.bounds(),
        }
    }

    /// Area of its triangles, mm²; the largest of what moves.
    pub fn area(&self) -> f64 {
        match self {
            Self::Mesh(mesh) => mesh.area(),
            Self::Solid(parts) => solid_triangles(parts, false).area(),
            Self::Surface(skinned) => skinned.area(),
        }
    }

    /// The triangles it is made of: the mesh itself, closed shells of the parts that are not cut
    /// away (those that are sheets left open), or the surface at `t` as fine as cells of `step` mm ask.
    ///
    /// # Errors
    /// What the surface says.
    pub fn raw_shells(&self, t: f64, step: f64) -> Result<TriMesh, SurfaceError> {
        match self {
            Self::Mesh(mesh) => Ok(mesh.clone()),
            Self::Solid(parts) => Ok(solid_triangles(parts, true)),
            Self::Surface(skinned) => skinned.mesh(t, skinned.how.tolerance(step)),
        }
    }
}

/// Closed shells of the parts that are not cut away; `bare` leaves the sheets among them open.
fn solid_triangles(parts: &[Piece], bare: bool) -> TriMesh {
    let mut all = TriMesh::default();
    for Piece { part, sheet } in parts.iter().filter(|p| p.part.join != Join::Cut) {
        let outline = if bare && *sheet { middle_sheet } else { tessellate };
        // parts of solids are primitives, all of which have an outline
        if let Some(shell) = outline(&part.element, SEGMENTS) {
            all.append(&shell);
        }
    }
    all
}

fn images(element: Element, mirror: Option<Mirror>) -> Vec<Element> {
    let (x, y) = (0, 1);
    match mirror {
        None => vec![element],
        Some(Mirror::X) => vec![element.mirrored(x), element],
        Some(Mirror::Y) => vec![element.mirrored(y), element],
        Some(Mirror::Xy) => {
            let other = element.mirrored(x);
            vec![other.mirrored(y), other, element.mirrored(y), element]
        }
    }
    .into_iter()
    .rev()
    .collect()
}

fn moved_part(mut p: SolidPart, by: &Similarity) -> SolidPart {
    p.element.centre = by.point(p.element.centre);
    p.element.rotation = (by.turn * p.element.rotation).normalize();
    p.element.half *= by.scale;
    p.round *= by.scale;
    if let Join::Blend(width) = &mut p.join {
        *width *= by.scale;
    }
    p
}
