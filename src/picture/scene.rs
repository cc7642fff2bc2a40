//! A mesh made ready to draw: in a frame of unit size, with normals.

use super::normals::Normals;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// What is drawn, scaled so that the frame's half diagonal is 1 and its centre the origin.
pub(super) struct Scene {
    pub points: Vec<Vec3>,
    pub faces: Vec<[u32; 3]>,
    pub normals: Normals,
    /// The box round the mesh.
    pub min: Vec3,
    pub max: Vec3,
    /// The frame, when it is not the mesh itself.
    pub frame: Option<[Vec3; 8]>,
}

impl Scene {
    /// `None` when there is nothing to draw.
    pub fn new(mesh: &TriMesh, frame: Option<Aabb>) -> Option<Self> {
        let drawable = |f: &&[u32; 3]| {
            f.iter().all(|&v| mesh.points.get(v as usize).is_some_and(|p| p.is_finite()))
        };
        let mut faces: Vec<[u32; 3]> = mesh.faces.iter().filter(drawable).copied().collect();
        let own = Aabb::of(faces.iter().flatten().map(|&v| mesh.points[v as usize]));
        let framed = frame.filter(|f| f.is_finite() && f.radius() > 0.0);
        let view = framed.unwrap_or(own);
        let (centre, scale) = (view.centre(), 1.0 / view.radius());
        if faces.is_empty() || !centre.is_finite() || !scale.is_finite() {
            return None;
        }
        let local = |p: DVec3| ((p - centre) * scale).as_vec3();
        let points: Vec<Vec3> = mesh.points.par_iter().map(|&p| local(p)).collect();
        let vector = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| points[v as usize]);
            (b - a).cross(c - a)
        };
        faces.retain(|f| vector(f).is_finite() && vector(f).length_squared() > 0.0);
        if faces.is_empty() {
            return None;
        }
        let normals = Normals::new(&points, &faces);
        let (min, max) = (local(own.min), local(own.max));
        let frame = framed.map(|f| f.corners().map(local));
        Some(Self { points, faces, normals, min, max, frame })
    }

    /// The eight corners of the box round the mesh.
    pub fn corners(&self) -> [Vec3; 8] {
        Aabb::new(self.min.as_dvec3(), self.max.as_dvec3()).corners().map(|p| p.as_vec3())
    }
}
