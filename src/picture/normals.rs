//! Normals that round off what is meant to be round and leave edges crisp.

use super::alike::firsts;
use glam::{Vec3, Vec4, Vec4Swizzles as _};
use rayon::prelude::*;

/// Faces whose normals differ by more than this are drawn with an edge between them. Wider, and
/// the rims of turned legs blur; narrower, and coarse round legs show their facets. cos 40°.
const CREASE: f32 = 0.766;

/// A vertex of more faces than this is a hub of a fan: comparing all with all would take
/// quadratic time, and each face keeps its own normal there.
const HUB: usize = 64;

/// The normals of a mesh, by face and by corner.
pub(super) struct Normals {
    /// Unit normal and area of each face.
    faces: Vec<Vec4>,
    /// For each corner the first point at its place.
    corners: Vec<[u32; 3]>,
    /// Faces round each point: `round[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    round: Vec<u32>,
}

impl Normals {
    pub fn new(points: &[Vec3], faces: &[[u32; 3]]) -> Self {
        let bits = |v: u32| (points[v as usize] + 0.0).to_array().map(f32::to_bits);
        let first = firsts(points.len(), bits);
        let corners: Vec<[u32; 3]> =
            faces.par_iter().map(|f| f.map(|v| first[v as usize])).collect();
        let mut start = vec![0_u32; points.len() + 1];
        corners.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
        for v in 0..points.len() {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut round = vec![0_u32; faces.len() * 3];
        for (i, f) in corners.iter().enumerate() {
            for &v in f {
                round[next[v as usize] as usize] = i as u32;
                next[v as usize] += 1;
            }
        }
        let normal = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| points[v as usize]);
            let vector = (b - a).cross(c - a);
            vector.normalize_or(Vec3::Z).extend(vector.length())
        };
        Self { faces: faces.par_iter().map(normal).collect(), corners, start, round }
    }

    /// Unit normal of a face.
    pub fn flat(&self, face: usize) -> Vec3 {
        self.faces[face].xyz()
    }

    /// Unit normals at the corners of a face: each the mean, by area, of the faces at its vertex
    /// that bend away less than a crease. A neighbour that is turned over counts as if it were
    /// not: furniture files have such faces, and the light should not break there.
    pub fn smooth(&self, face: usize) -> [Vec3; 3] {
        let own = self.flat(face);
        self.corners[face].map(|v| {
            let v = v as usize;
            let round = &self.round[self.start[v] as usize..self.start[v + 1] as usize];
            if round.len() > HUB {
                return own;
            }
            let mut sum = Vec3::ZERO;
            for &j in round {
                let other = self.faces[j as usize];
                let bend = other.xyz().dot(own);
                if bend.abs() > CREASE {
                    sum += other.xyz() * (other.w * bend.signum());
                }
            }
            sum.normalize_or(own)
        })
    }
}
