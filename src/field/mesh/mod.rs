//! A mesh as a field: signed distance, whatever state the mesh is in.
//!
//! Shells (faces that hang together) are turned to face outwards, cavities inwards. The
//! winding number says what is inside; it changes the sign only, never the distance. The distance
//! is measured to the surface: to those faces, or pieces of faces, across which inside and outside
//! change. A face buried in the union of several shells is none, so it leaves no zero and no dent.
//! Sheets, which enclose nothing, are thickened on request.
//!
//! A field of closed shells is 1-Lipschitz. Over the hole of an open shell the sign changes
//! without the distance being zero: there the surface is where the winding number is one half.

mod build;
mod buried;
mod cut;
mod inside;
mod orient;
mod report;
mod seams;
mod shells;
mod signs;
mod solid;
mod soup;
#[cfg(test)]
mod tests;

pub use report::MeshReport;

use super::Field;
use crate::bvh::Bvh;
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;
use crate::num::{Aabb, Interval};
use glam::DVec3;
use solid::Solid;

/// How a mesh becomes a field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshOptions {
    /// Gives sheets a thickness.
    pub thicken: Option<Thicken>,
    /// What the sign goes by.
    pub sign: Sign,
    /// Size (mm) to which faces that cross others are cut at most; by default 1/5000 of the box's
    /// diagonal.
    pub floor: Option<f64>,
}

/// What tells inside from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sign {
    /// The winding number: inside where it is at least one half.
    #[default]
    Winding,
    /// Nothing: every face is a sheet. Needs a thickness.
    Unsigned,
}

/// A thickness for sheets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thicken {
    /// Full thickness, mm: half of it on either side.
    pub mm: f64,
    /// Which faces get it.
    pub which: Which,
}

/// Which faces are thickened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Which {
    /// Those of every shell with a rim.
    #[default]
    Open,
    /// All faces.
    All,
}

/// Why a mesh cannot become a field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFieldError {
    /// There is no triangle with area.
    #[error("mesh has no triangles with area (faces given: {faces})")]
    Empty {
        /// Faces given.
        faces: usize,
    },
    /// A face names a point that is not there.
    #[error("face {face} uses point {corner}, but there are {points} points")]
    Corner {
        /// Index of the face.
        face: usize,
        /// Index of the missing point.
        corner: u32,
        /// Number of points.
        points: usize,
    },
    /// A coordinate is not a number, or too large to calculate with.
    #[error("face {face} uses point {corner}, which has a coordinate beyond 1e60 or not a number")]
    Coordinate {
        /// Index of the face.
        face: usize,
        /// Index of the point.
        corner: u32,
    },
    /// Nothing is enclosed and nothing is thickened.
    #[error(
        "mesh encloses nothing: {open} of its {shells} shells are open; give its sheets a \
         thickness with thicken"
    )]
    NoInside {
        /// Shells with a rim.
        open: usize,
        /// All shells.
        shells: usize,
    },
    /// Without a sign only a thickness makes a solid.
    #[error("sign = unsigned encloses nothing without a thickness; set thicken")]
    Unsigned,
    /// The thickness is no positive number.
    #[error("thicken is {0} mm; it must be a positive number")]
    Thickness(f64),
    /// The floor is no positive number.
    #[error("floor is {0} mm; it must be a positive number")]
    Floor(f64),
    /// The job was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The signed distance to a mesh, mm. See the [module](self).
#[derive(Clone, Debug)]
pub struct MeshField {
    solid: Option<Solid>,
    sheet: Option<Sheet>,
}

/// Faces with a thickness.
#[derive(Clone, Debug)]
struct Sheet {
    faces: Bvh,
    /// Half the thickness, mm.
    half: f64,
}

impl MeshField {
    /// The field of a mesh (mm), and what was found in it.
    ///
    /// # Errors
    /// See [`MeshFieldError`].
    pub fn new(
        mesh: &TriMesh,
        options: &MeshOptions,
        job: &dyn Job,
    ) -> Result<(Self, MeshReport), MeshFieldError> {
        build::field(mesh, options, job)
    }
}

impl Field for MeshField {
    fn value(&self, p: DVec3) -> f64 {
        let solid = self.solid.as_ref().map_or(f64::INFINITY, |s| s.value(p));
        let sheet = self.sheet.as_ref().map_or(f64::INFINITY, |s| s.faces.distance(p) - s.half);
        solid.min(sheet)
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        match &self.solid {
            Some(solid) => solid.values(at, out),
            None => out.fill(f64::INFINITY),
        }
        if let Some(sheet) = &self.sheet {
            for (f, hit) in out.iter_mut().zip(sheet.faces.nearest_all(at)) {
                *f = f.min(hit.distance2.sqrt() - sheet.half);
            }
        }
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let mut out = [Interval::ALL];
        self.bounds(&[*b], &mut out);
        out[0]
    }

    fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        match &self.solid {
            Some(solid) => solid.bounds(boxes, out),
            None => out.fill(Interval::ALL),
        }
        let Some(sheet) = &self.sheet else {
            return;
        };
        for (b, bound) in boxes.iter().zip(out) {
            let centre = b.centre();
            let round_off = 1e-12 * (sheet.half + centre.abs().max_element());
            if b.radius().is_finite() {
                let near = sheet.faces.distance(centre) - sheet.half;
                let near = Interval::ball(near, b.radius()).widen(round_off);
                *bound = if self.solid.is_some() { bound.min(near) } else { near };
            }
        }
    }

    fn support(&self) -> Aabb {
        let solid = self.solid.as_ref().map_or(Aabb::EMPTY, Solid::support);
        let sheet = self.sheet.as_ref().map_or(Aabb::EMPTY, |s| s.faces.bounds().grow(s.half));
        solid.hull(sheet)
    }

    fn bytes(&self) -> usize {
        let solid = self.solid.as_ref().map_or(0, Solid::bytes);
        solid + self.sheet.as_ref().map_or(0, |s| s.faces.bytes())
    }
}
