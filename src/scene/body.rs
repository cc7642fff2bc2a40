//! A shape before it is a field: a mesh or the parts of a solid, read and movable.

use super::elements;
use super::place::Similarity;
use crate::element::{Element, tessellate};
use crate::field::csg::Join;
use crate::field::solid::Part as SolidPart;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::recipe::{Mirror, Op, Problem, Solid};
use glam::DAffine3;

/// What a shape is made of.
pub(super) enum Body {
    Mesh(TriMesh),
    Solid(Vec<SolidPart>),
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
            let join = match part.op {
                Op::Add => Join::Add,
                Op::Cut => Join::Cut,
                Op::Blend => Join::Blend(part.blend.unwrap_or(0.0)),
            };
            for element in images(element, part.mirror) {
                parts.push(SolidPart { element, round, join });
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
                Self::Solid(parts.into_iter().map(|p| moved_part(p, by)).collect())
            }
        }
    }

    /// The box round it, mm; parts that are cut away do not count.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Solid(_) => self.shells().bounds(),
        }
    }

    /// The triangles it is made of: the mesh itself, or the raw shells of the parts that are not
    /// cut away.
    pub fn shells(&self) -> TriMesh {
        match self {
            Self::Mesh(mesh) => mesh.clone(),
            Self::Solid(parts) => {
                let mut all = TriMesh::default();
                for p in parts.iter().filter(|p| p.join != Join::Cut) {
                    // parts of solids are primitives, all of which have an outline
                    if let Some(shell) = tessellate(&p.element, SEGMENTS) {
                        all.append(&shell);
                    }
                }
                all
            }
        }
    }
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
