//! A mesh made ready to draw: in a frame of unit size, with a normal for each corner.

use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Faces whose normals differ by more than this are drawn with an edge between them. Wider, and
/// the rims of turned legs blur; narrower, and coarse round legs show their facets. cos 40°.
const CREASE: f32 = 0.766;

/// A vertex of more faces than this is a hub of a fan: comparing all with all would take
/// quadratic time, and each face keeps its own normal there.
const HUB: usize = 64;

/// What is drawn, scaled so that the frame's half diagonal is 1 and its centre the origin.
pub(super) struct Scene {
    pub points: Vec<Vec3>,
    pub faces: Vec<[u32; 3]>,
    /// Unit normals of the faces.
    pub flat: Vec<Vec3>,
    /// Unit normals at the corners of the faces.
    pub smooth: Vec<[Vec3; 3]>,
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
            f.iter()
                .all(|&v| mesh.points.get(v as usize).is_some_and(|p| p.is_finite()))
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
        let vectors: Vec<Vec3> = faces.par_iter().map(vector).collect();
        let smooth = corner_normals(&points, &faces, &vectors);
        let flat = vectors
            .into_par_iter()
            .map(|v| v.normalize_or(Vec3::Z))
            .collect();
        let (min, max) = (local(own.min), local(own.max));
        let frame = framed.map(|f| f.corners().map(local));
        Some(Self {
            points,
            faces,
            flat,
            smooth,
            min,
            max,
            frame,
        })
    }

    /// The eight corners of the box round the mesh.
    pub fn corners(&self) -> [Vec3; 8] {
        Aabb::new(self.min.as_dvec3(), self.max.as_dvec3())
            .corners()
            .map(|p| p.as_vec3())
    }
}

/// For each corner the mean of the area vectors of the faces at its vertex that bend away less
/// than a crease. A neighbour that is turned over counts as if it were not: furniture files
/// have such faces, and the light should not break there.
fn corner_normals(points: &[Vec3], faces: &[[u32; 3]], vectors: &[Vec3]) -> Vec<[Vec3; 3]> {
    let vertex = joined(points);
    let mut start = vec![0_u32; points.len() + 1];
    let named = || faces.iter().map(|f| f.map(|v| vertex[v as usize] as usize));
    named().flatten().for_each(|v| start[v + 1] += 1);
    for v in 0..points.len() {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut round = vec![0_u32; faces.len() * 3];
    for (i, corners) in named().enumerate() {
        for v in corners {
            round[next[v] as usize] = i as u32;
            next[v] += 1;
        }
    }
    let unit: Vec<Vec3> = vectors.par_iter().map(|v| v.normalize_or_zero()).collect();
    let smooth = |(i, f): (usize, &[u32; 3])| {
        f.map(|v| {
            let v = vertex[v as usize] as usize;
            let round = &round[start[v] as usize..start[v + 1] as usize];
            if round.len() > HUB {
                return unit[i];
            }
            let mut sum = Vec3::ZERO;
            for &j in round {
                let bend = unit[j as usize].dot(unit[i]);
                if bend.abs() > CREASE {
                    sum += vectors[j as usize] * bend.signum();
                }
            }
            sum.normalize_or(unit[i])
        })
    };
    faces.par_iter().enumerate().map(smooth).collect()
}

/// For each point the first one at the same place.
fn joined(points: &[Vec3]) -> Vec<u32> {
    let bits = |v: u32| (points[v as usize] + 0.0).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (bits(v), v));
    let mut first: Vec<u32> = (0..points.len() as u32).collect();
    for pair in order.windows(2) {
        if bits(pair[0]) == bits(pair[1]) {
            first[pair[1] as usize] = first[pair[0] as usize];
        }
    }
    first
}
