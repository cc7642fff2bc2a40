//! Triangle meshes and their files. A [`TriMesh`] is plain data: points in millimetres, Z up,
//! faces counter-clockwise seen from outside.
//!
//! [`read`] takes files as they are: what is odd about their geometry is counted in [`Found`], not
//! refused. [`write()`] makes files that read back as the same mesh, or none.
//!
//! - A *shell* is a set of faces that hang together by edges; it is *open* when one of its edges
//!   has a single face.
//! - To *weld* is to merge points at exactly the same position; to *snap* is to round positions to
//!   f32, as files hold them.
//!
//! ```
//! use fieldgraft::mesh::{Assume, TriMesh, read, write};
//! use glam::DVec3;
//!
//! let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let mesh = TriMesh { points, faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] };
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("corner.ply");
//! write(&path, &mesh, "an example", false)?;
//! let loaded = read(&path, Assume::default())?;
//! assert_eq!(loaded.mesh, mesh);
//! assert_eq!(loaded.found.to_string(), "4 triangles, 4 points, 1 shell");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod edges;
mod error;
mod found;
mod frame;
pub(crate) mod polygon;
mod read;
mod soup;
mod weld;
mod write;

pub use edges::shells;
pub use error::MeshError;
pub use found::Found;
pub use frame::{Assume, Unit, UnknownWord, Up};
pub use read::{Loaded, read};
pub(crate) use weld::twins;
pub use weld::{snap, weld};
pub use write::{FlipBook, Motion, check_output, write, write_motion};

use crate::num::Aabb;
use glam::{DAffine3, DVec3};

/// Triangles over shared points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Positions in mm, Z up.
    pub points: Vec<DVec3>,
    /// Point indices, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The three corners of face `i`.
    pub fn corners(&self, i: usize) -> [DVec3; 3] {
        self.faces[i].map(|v| self.points[v as usize])
    }

    /// The box round all points that a face uses; empty for a mesh without faces.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.faces.iter().flatten().map(|&v| self.points[v as usize]))
    }

    /// Half the cross product of two edges of face `i`: its normal, as long as its area (mm²).
    pub fn area_vector(&self, i: usize) -> DVec3 {
        let [a, b, c] = self.corners(i);
        (b - a).cross(c - a) * 0.5
    }

    /// Total area in mm².
    pub fn area(&self) -> f64 {
        (0..self.faces.len()).map(|i| self.area_vector(i).length()).sum()
    }

    /// Signed volume in mm³ by the divergence theorem; meaningful for a closed mesh.
    pub fn volume(&self) -> f64 {
        let origin = self.bounds().centre();
        (0..self.faces.len())
            .map(|i| {
                let [a, b, c] = self.corners(i).map(|p| p - origin);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    /// Moves every point; a mirroring map also turns the faces over, so outside stays outside.
    pub fn transform(&mut self, by: &DAffine3) {
        for p in &mut self.points {
            *p = by.transform_point3(*p);
        }
        if by.matrix3.determinant() < 0.0 {
            self.flip();
        }
    }

    /// Turns every face over.
    pub fn flip(&mut self) {
        for f in &mut self.faces {
            f.swap(1, 2);
        }
    }

    /// Adds the triangles of another mesh, sharing no points with them.
    pub fn append(&mut self, other: &TriMesh) {
        let shift = self.points.len() as u32;
        self.points.extend_from_slice(&other.points);
        self.faces.extend(other.faces.iter().map(|f| f.map(|v| v + shift)));
    }
}
